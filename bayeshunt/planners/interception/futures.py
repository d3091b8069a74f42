"""Where the prey may go: weighted paths made of straight legs, as the hunter sees them now.

Letters: K futures, B legs, J times.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bayeshunt.core.geometry import FloatArray, Polar
from bayeshunt.models.target.turns import TurnModel

__all__ = ["NEGLIGIBLE", "Futures", "mix", "turning_futures"]

#: What is less probable than this is left out of a decision.
NEGLIGIBLE = 0.02
#: The likeliest futures that a decision is taken over.
_MOST = 24


@dataclass(frozen=True, eq=False)
class Futures:
    """Weighted prey paths in the hunter's present frame; in each, the prey keeps its speed on all legs.

    weights: [K], sum to 1.
    starts: seconds from now at which each leg begins, increasing, the first 0, inf where there is none [K, B].
    forward, right: metres, where each leg begins [K, B]. heading: radians clockwise, its direction [K, B].
    speed: metres per second [K].
    groups: int [K], 0..M-1; futures of one group cannot be told apart at the next decision. Group 0 is those in
        which the prey has not turned by then.
    pace: share of the speed at which each leg is gone [K, B]; None: 1.
    foreseen: whether the hunter can know of a leg before it begins (a wall that it knows of).
    """

    weights: np.ndarray
    starts: np.ndarray
    forward: np.ndarray
    right: np.ndarray
    heading: np.ndarray
    speed: np.ndarray
    groups: np.ndarray
    foreseen: bool = False
    pace: np.ndarray | None = None

    def leg_speed(self, leg: int) -> np.ndarray:
        """Return the speed on a leg, metres per second [K]."""
        return self.speed if self.pace is None else self.speed * self.pace[:, leg]

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the positions (forward, right) [m] at ``times`` [s, J]: arrays [K, J]."""
        leg = (self.starts.T[:, :, None] <= times).sum(axis=0) - 1
        row = np.arange(len(leg))[:, None]
        run = self.speed[:, None] * (times - self.starts[row, leg])
        if self.pace is not None:
            run *= self.pace[row, leg]
        x = self.forward[row, leg] + run * np.cos(self.heading)[row, leg]
        y = self.right[row, leg] + run * np.sin(self.heading)[row, leg]
        return x, y

    def only(self, chosen: np.ndarray) -> Futures:
        """Return some of these futures, bool [K] or their numbers; their weights no longer sum to 1."""
        pace = None if self.pace is None else self.pace[chosen]
        names = ("weights", "starts", "forward", "right", "heading", "speed", "groups")
        return replace(self, pace=pace, **{name: getattr(self, name)[chosen] for name in names})

    def likely(self, most: int) -> Futures:
        """Return the ``most`` likeliest of these futures, in their order; their weights sum to 1."""
        chosen = np.sort(np.argsort(-self.weights, kind="stable")[:most])
        some = self.only(chosen)
        _, groups = np.unique(np.append(0, some.groups), return_inverse=True)  # group 0 stays that without a turn
        return replace(some, weights=some.weights / some.weights.sum(), groups=groups[1:])

    def standing_still(self) -> Futures:
        """Return these futures for a prey that does not move."""
        still = [np.repeat(a[:, :1], a.shape[1], axis=1) for a in (self.forward, self.right)]
        return replace(self, forward=still[0], right=still[1], speed=np.zeros(len(self.speed)))

    def likeliest(self, times: np.ndarray) -> Polar[FloatArray]:
        """Return the most probable path at ``times`` [s, J], the present pose first: Polar of arrays [J + 1]."""
        best = int(self.weights.argmax())
        when = np.concatenate([[0.0], times])
        x, y = (a[best] for a in self.at(when))
        leg = (self.starts[best] <= when[:, None]).sum(axis=1) - 1
        heading: FloatArray = self.heading[best, leg]
        return Polar.from_cartesian(x, y, heading)


def turning_futures(prey: Polar, model: TurnModel, time_step: float, steps: int) -> Futures:
    """Return the straight path and, for each of the next ``steps`` time-steps, one path per turn of the model.

    The prey goes straight at the model's speed, turns at most once, half-way through a time-step,
    and goes on straight. ``P(turn l in step i) = hazard (1 - hazard)^i P(l)``, i = 0, 1, ...
    """
    turns, chances = model.turn_table
    hazard, speed = model.hazard, model.speed / time_step
    if not len(turns) or hazard == 0.0:
        turns, chances, steps = turns[:0], chances[:0], 0
    survival = (1.0 - hazard) ** np.arange(steps + 1) if steps else np.ones(1)
    weights = np.concatenate([survival[-1:], (hazard * survival[:-1, None] * chances).ravel()])
    when = np.concatenate([[np.inf], np.repeat((np.arange(steps) + 0.5) * time_step, len(turns))])
    heading = float(prey.heading)
    turned = heading + np.concatenate([[0.0], np.tile(turns, steps)])
    run = speed * np.where(np.isfinite(when), when, 0.0)
    x, y = float(prey.forward), float(prey.right)
    groups = np.where(when < time_step, np.arange(len(when)), 0)
    return Futures(
        weights=weights,
        starts=np.stack([np.zeros(len(when)), when], axis=1),
        forward=np.stack([np.full(len(when), x), x + run * np.cos(heading)], axis=1),
        right=np.stack([np.full(len(when), y), y + run * np.sin(heading)], axis=1),
        heading=np.stack([np.full(len(when), heading), turned], axis=1),
        speed=np.full(len(when), speed),
        groups=groups,
    )


def mix(parts: Sequence[tuple[float, Futures]], most: int = _MOST) -> Futures:
    """Return one set of futures from several, each with its probability (any positive scale).

    Legs are foreseen if those of all parts are. Futures that do not turn before the next decision cannot be told
    apart by it. most: of more futures than these, only the likeliest are kept.
    """
    legs = max(futures.starts.shape[1] for _, futures in parts)
    weights = np.concatenate([chance * futures.weights for chance, futures in parts])
    # A leg that never begins may stand anywhere.
    starts, forward, right, heading = (
        np.concatenate([_padded(getattr(futures, name), legs, fill) for _, futures in parts])
        for name, fill in (("starts", np.inf), ("forward", 0.0), ("right", 0.0), ("heading", 0.0))
    )
    quiet = np.concatenate([futures.groups == 0 for _, futures in parts])
    groups = np.where(quiet, 0, np.cumsum(~quiet))
    speed = np.concatenate([futures.speed for _, futures in parts])
    pace = None
    if any(futures.pace is not None for _, futures in parts):
        own = (np.ones(f.starts.shape) if f.pace is None else f.pace for _, f in parts)
        pace = np.concatenate([_padded(one, legs, 1.0) for one in own])
    foreseen = all(futures.foreseen for chance, futures in parts if chance > 0)
    mixed = Futures(weights / weights.sum(), starts, forward, right, heading, speed, groups, foreseen, pace)
    return mixed if len(weights) <= most else mixed.likely(most)


def _padded(array: np.ndarray, legs: int, fill: float) -> np.ndarray:
    return np.concatenate([array, np.full((len(array), legs - array.shape[1]), fill)], axis=1)
