"""A prey that is followed now: where it goes next, from what it did in this hunt.

A hunter sees one transition after the other, each in the prey's own frame of the step before. Put together they are the
path that a conditioned model asks for, and that constant velocity continues.
Letters: T places seen, n draws, S steps.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.geometry import FloatArray, Polar, wrap
from bayeshunt.core.statistics import spatial_median

if TYPE_CHECKING:
    from bayeshunt.models.target.conditions import Conditions

__all__ = ["MOST_FOLLOWED", "ConstantVelocity", "foreseen_path", "mean_transition", "places_of"]

#: Transitions of the present prey that are remembered.
MOST_FOLLOWED = 32
_DRAWS = 64
_ROUNDS = 20  # of the spatial median
_STANDS = 0.1  # a step shorter than this share of the typical one has no direction
_SEED = 20102  # private, so that the same path is foreseen when it is asked for again


class ConstantVelocity:
    """The prey goes on as in its last step: the baseline that needs no table. A ``TargetModel``.

    axes: not used; the door of prey models hands them over.
    """

    def __init__(self, axes: EffectAxes | None = None) -> None:
        self._last: Polar | None = None
        self.observations = 0

    @property
    def is_empty(self) -> bool:
        """True until the first transition."""
        return self._last is None

    def observe(self, transition: Polar) -> None:
        """Keep a transition, given in the prey's own frame of the step before."""
        self._last, self.observations = Polar(*map(float, transition)), self.observations + 1

    def predict_path(self, steps: int) -> Polar[FloatArray]:
        """Return the poses 0..steps ahead: Polar of arrays [steps + 1]; before anything is seen the prey stands."""
        far = 0.0 if self._last is None else self._last.distance
        turn = 0.0 if self._last is None else wrap(self._last.angle - self._last.heading)
        ahead: FloatArray = np.arange(steps + 1, dtype=np.float64)
        return Polar(far * ahead, turn * np.minimum(ahead, 1.0), turn * np.minimum(ahead, 1.0))

    def copy(self) -> ConstantVelocity:
        """Return an independent model that knows the same."""
        twin = ConstantVelocity()
        twin._last, twin.observations = self._last, self.observations
        return twin

    def cells(self) -> list[list[float]]:
        """Return no cells: nothing is counted."""
        return []


def mean_transition(transitions: Polar[FloatArray], weights: FloatArray) -> Polar:
    """Return the mean of transitions (Polar of arrays [N]) by weights [N] >= 0: of places, and of directions."""
    share = np.asarray(weights, dtype=float) / np.sum(weights)
    place = (share * transitions.distance * np.exp(1j * transitions.angle)).sum()
    turn = float(np.angle((share * np.exp(1j * transitions.heading)).sum()))
    return Polar.from_cartesian(float(place.real), float(place.imag), turn)


def places_of(transitions: Sequence[Polar]) -> FloatArray:
    """Return complex [T] places, forward + i left in the present frame, of T - 1 transitions; the last is 0."""
    place, facing, places = 0j, 1.0 + 0j, [0j]
    for step in reversed(transitions):
        # the frame of the step before, seen from the present one: it faces back by the turn of the step
        facing = facing * np.exp(1j * step.heading)
        place = place - step.distance * np.exp(-1j * step.angle) * facing
        places.append(place)
    return np.array(places[::-1])


def foreseen_path(conditions: Conditions, transitions: Sequence[Polar], steps: int) -> Polar[FloatArray]:
    """Return the poses 0..steps ahead of a prey that made these transitions: Polar of arrays [steps + 1].

    The point of each step is the spatial median of 64 futures, the same every time. A path shorter than the model's
    goes back along its first step; beyond the steps that the model foresees the last velocity is kept.
    """
    residual = conditions.residual
    places = places_of(transitions)
    more = 0 if residual is None else max(residual.seen - len(places), 0)
    if more:
        places = np.concatenate([places[0] - (places[1] - places[0]) * np.arange(more, 0, -1), places])
    asked = max(1, steps if residual is None else min(steps, residual.steps))
    rng = np.random.default_rng(_SEED)
    draws = conditions.futures(places[None], asked, _DRAWS, rng=rng, headings=None, made_up=more)
    path = np.concatenate([[0j], spatial_median(draws[0], axis=0, rounds=_ROUNDS)])
    if steps > asked:
        path = np.concatenate([path, path[-1] + (path[-1] - path[-2]) * np.arange(1, steps - asked + 1)])
    path = path[: steps + 1]
    return Polar.from_cartesian(path.real, -path.imag, _headings(path, _STANDS * conditions.scale))


def _headings(path: FloatArray, least: float) -> FloatArray:
    """Clockwise headings [S + 1] along a path; 0 at present, and the last one known while it stands."""
    stepped, heading, now = np.diff(path), np.zeros(len(path)), 0.0
    for number, step in enumerate(stepped, 1):
        now = -float(np.angle(step)) if abs(step) > least else now
        heading[number] = now
    return heading
