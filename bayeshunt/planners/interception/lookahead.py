"""Two time-steps ahead, part-way poses included: when would each pair of gaits first meet the prey?

Letters: G gaits, P part-way poses of a gait, K prey futures, S hunter outcomes (K of them, or one
for all futures), M groups of futures.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.tables.structures import depends_on_previous
from bayeshunt.planners.interception.futures import Futures
from bayeshunt.planners.interception.homing import Homing

__all__ = [
    "Charge",
    "Outlook",
    "PairPaths",
    "chance_within",
    "decide",
    "gait_paths",
    "keep_highest",
    "look_ahead",
    "path_lengths",
]


def gait_paths(model: ForwardModel, points: int = 13) -> np.ndarray:
    """Return the mean pose of every gait after each of P equal intervals, [G, P, 3]: forward m, right m, heading rad.

    From the babbled part-way poses; without them, circular arcs of ``points`` intervals that end at
    the mean outcome (wrong for a gait that turns by more than half a circle: babble the paths).
    """
    if model.mean_paths is not None:
        return model.mean_paths
    share = np.arange(1, points + 1) / points
    paths = []
    for gait in model.gaits:
        end = model.predict(gait)
        # A chord at angle a from the heading belongs to an arc that turns by 2 a: chord(f) ~ sin(f a) / sin(a).
        # One that ends behind is of a gait that drives backwards, not of the long way round.
        angle, distance = float(end.angle), float(end.distance)
        if abs(angle) > np.pi / 2:
            angle, distance = angle - np.copysign(np.pi, angle), -distance
        angle = angle if abs(angle) > 1e-9 else 1e-9
        chord = distance * np.sin(share * angle) / np.sin(angle)
        bearing = share * angle
        paths.append(np.stack([chord * np.cos(bearing), chord * np.sin(bearing), share * float(end.heading)], axis=1))
    return np.stack(paths)


def path_lengths(paths: np.ndarray) -> np.ndarray:
    """Return the metres along paths [G, P, 3] from the origin, [G]."""
    points = np.concatenate([np.zeros((len(paths), 1, 2)), paths[:, :, :2]], axis=1)
    found: np.ndarray = np.hypot(*np.moveaxis(np.diff(points, axis=1), 2, 0)).sum(axis=1)
    return found


@dataclass(frozen=True, eq=False)
class PairPaths:
    """The poses of every pair of gaits, composed once; they do not depend on the situation.

    times: seconds, part-way through the first and the second step [2 P].
    first: forward, right [m], heading [rad, not wrapped] in the first step [3, G, P, S]. second: the same in the
        second [3, G, G, P, S].
    """

    times: np.ndarray
    first: np.ndarray
    second: np.ndarray

    @cached_property
    def first_end(self) -> np.ndarray:
        """The poses at the end of the first step [3, G, S]."""
        return self.first[:, :, -1].copy()

    @cached_property
    def end(self) -> np.ndarray:
        """The poses at the end of the second step [3, G, G, S]."""
        return self.second[..., -1, :].copy()

    @classmethod
    def compile(cls, first: np.ndarray, second: np.ndarray, time_step: float) -> PairPaths:
        """Compose the paths of a first and of a second step, both [3, G, P, S]; ``time_step`` in seconds.

        second: [3, G, G, P, S] where it depends on the first gait, the first of the two axes.
        """
        points = first.shape[2]
        if second.ndim == first.ndim:
            second = second[:, None]
        start = first[:, :, None, None, -1]  # [3, G, 1, 1, S]
        cos, sin = np.cos(start[2]), np.sin(start[2])
        x = start[0] + cos * second[0] - sin * second[1]
        y = start[1] + sin * second[0] + cos * second[1]
        times = np.arange(1, 2 * points + 1) * (time_step / points)
        return cls(times, first, np.stack([x, y, start[2] + second[2]]))

    @classmethod
    def mean(cls, model: ForwardModel, previous_gait: str | None = None) -> PairPaths:
        """Return the pairs of the mean paths: S = 1.

        previous_gait: the gait just executed. It and the first gait of each pair say what follows
            where the model depends on the gait before.
        """
        paths = np.moveaxis(gait_paths(model.after(previous_gait)), -1, 0)[..., None]
        second = paths
        if depends_on_previous(model.structure):
            second = np.stack([gait_paths(model.after(gait)) for gait in model.gaits])
            second = np.moveaxis(second, -1, 0)[..., None]
        return cls.compile(paths, second, model.gaits.need("duration"))


@dataclass(frozen=True, eq=False)
class Outlook:
    """What every sequence of one or two gaits is expected to bring in each future.

    first, second: P(captured by t) part-way through the first step [G, P, K] and the second [G, G, P, K].
    time: expected seconds to the capture of each pair [G, G, K]; where a planner weighs other costs too, what they
        and the time come to, in seconds of the fastest gait.
    """

    first: np.ndarray
    second: np.ndarray
    time: np.ndarray


#: Turns the expected time of pairs into their cost.
Charge = Callable[[Outlook], Outlook]


def look_ahead(
    pairs: PairPaths, futures: Futures, homing: Homing, spread: float, charge: Charge | None = None
) -> Outlook:
    """Value every pair of gaits in every future.

    ``E[time] = integral of 1 - P(captured by t) over both steps + (1 - P(captured)) homing time``.
    P(captured by t) is the largest chance so far; the chance falls from 1 to 0 as the distance
    grows from ``reach - spread`` to ``reach + spread`` [m]. The spread stands for that of both
    robots about their means; it is 0 for sampled poses. charge: what is charged beside the time.
    """
    points = pairs.first.shape[2]
    forward, right = (a.T for a in futures.at(pairs.times))  # [2 P, K]
    first = chance_within(pairs.first, forward[:points], right[:points], homing.reach, spread)
    second = chance_within(pairs.second, forward[points:], right[points:], homing.reach, spread)
    keep_highest(first)
    np.maximum(second[:, :, 0], first[:, None, -1], out=second[:, :, 0])
    keep_highest(second)
    interval, end = pairs.times[0], pairs.times[-1]
    during = interval * ((points - first.sum(axis=-2))[:, None] + (points - second.sum(axis=-2)))
    found = Outlook(first, second, during + (1.0 - second[:, :, -1]) * homing.time(pairs.end, futures, end))
    return found if charge is None else charge(found)


def keep_highest(chance: np.ndarray) -> None:
    """Replace each of [..., P, K] by the highest so far, along P; faster than ``np.maximum.accumulate``."""
    for point in range(1, chance.shape[-2]):
        np.maximum(chance[..., point, :], chance[..., point - 1, :], out=chance[..., point, :])


def chance_within(
    hunter: np.ndarray, forward: np.ndarray, right: np.ndarray, reach: float, spread: float
) -> np.ndarray:
    """Return the chance of being within reach: hunter [2, ..., P, S] against prey [P, K] gives [..., P, K]."""
    square = hunter[0] - forward
    across = hunter[1] - right
    square *= square
    across *= across
    square += across
    if spread == 0.0:
        found: np.ndarray = (square <= reach * reach).astype(float)
        return found
    distance: np.ndarray = np.sqrt(square, out=square)
    np.subtract(reach + spread, distance, out=distance)
    distance /= 2.0 * spread
    np.clip(distance, 0.0, 1.0, out=distance)
    return distance


def decide(outlook: Outlook, futures: Futures) -> tuple[np.ndarray, np.ndarray]:
    """Return the expected time [s] of every first gait [G], and of every pair when nothing new is seen [G, G].

    After the first step the hunter sees which group of futures it is in, and picks the best second
    gait for that group: ``value(g) = sum over groups of min over g' of sum over k of P(k) time(g, g', k)``.
    """
    groups = int(futures.groups.max()) + 1
    member = np.zeros((len(futures.weights), groups))
    member[np.arange(len(futures.weights)), futures.groups] = futures.weights
    shares = outlook.time @ member  # [G, G, M]
    return shares.min(axis=1).sum(axis=1), outlook.time @ futures.weights
