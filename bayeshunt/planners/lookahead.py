"""Two time-steps ahead, part-way poses included, and an estimate of what remains after them.

Letters: G gaits, P part-way poses of a gait, K prey futures, M groups of futures.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bayeshunt.geometry import wrap
from bayeshunt.models.forward import ForwardModel
from bayeshunt.planners.futures import Futures

#: A prey faster than this share of the hunter's top speed is taken to go at this share beyond the
#: lookahead: it might never be met, and then a longer chase must still cost more than a shorter one.
_CHASE_SHARE = 0.9


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
        angle = float(end.angle) if abs(end.angle) > 1e-9 else 1e-9
        chord = float(end.distance) * np.sin(share * angle) / np.sin(angle)
        bearing = share * angle
        paths.append(np.stack([chord * np.cos(bearing), chord * np.sin(bearing), share * float(end.heading)], axis=1))
    return np.stack(paths)


@dataclass(frozen=True, eq=False)
class PairPaths:
    """The mean poses of every pair of gaits, composed once; they do not depend on the situation.

    times: seconds, of the first and the second step [2 P].
    first: forward and right, metres [2, G, P]. second: the same after a first gait [2, G, G, P].
    first_end, end: forward, right, heading (not wrapped) at the steps' ends [3, G] and [3, G, G].
    """

    times: np.ndarray
    first: np.ndarray
    second: np.ndarray
    first_end: np.ndarray
    end: np.ndarray

    @classmethod
    def compile(cls, paths: np.ndarray, time_step: float) -> PairPaths:
        """Compose mean paths [G, P, 3] with themselves; ``time_step`` in seconds."""
        points = paths.shape[1]
        x, y, heading = np.moveaxis(paths, -1, 0)
        cos, sin = np.cos(heading[:, -1, None, None]), np.sin(heading[:, -1, None, None])
        second = np.stack([x[:, -1, None, None] + cos * x - sin * y, y[:, -1, None, None] + sin * x + cos * y])
        turned = heading[:, -1, None] + heading[:, -1]
        times = np.arange(1, 2 * points + 1) * (time_step / points)
        end = np.concatenate([second[..., -1], turned[None]])
        return cls(times, np.stack([x, y]), second, paths[:, -1].T.copy(), end)


@dataclass(frozen=True)
class Chase:
    """The estimate of the time from the end of the lookahead to the capture.

    top_speed: m/s, of the hunter. reach: metres, the distance that is a capture.
    heading_price: seconds for each radian between the hunter's heading and the way to the meeting point.
    """

    top_speed: float
    reach: float
    heading_price: float

    def time(self, end: np.ndarray, futures: Futures, start: float) -> np.ndarray:
        """Return the estimated seconds from ``start`` [s from now] to the capture, [G, G, K].

        end: the hunter's poses at ``start``, [3, G, G]. It heads straight, at top speed, for the
        point where it meets the prey; every change of heading costs ``heading_price``. A foreseen
        path is met where it leads; otherwise the hunter believes in the prey's present leg until
        the next one begins.
        """
        return self._foreseen(end, futures, start) if futures.foreseen else self._surprised(end, futures, start)

    def _foreseen(self, end: np.ndarray, futures: Futures, start: float) -> np.ndarray:
        x, y, heading = (a[..., None] for a in end)
        best = np.full(np.broadcast_shapes(x.shape, futures.weights.shape), np.inf)
        for leg, over in _legs(futures):
            ahead, right = _position(futures, leg, start)
            wait = futures.starts[:, leg] - start
            time, to_x, to_y = self._meet(ahead - x, right - y, futures.heading[:, leg], futures.speed)
            cost = np.maximum(time, wait) + self._turning(to_x, to_y, heading)
            # The gap to what the hunter can reach only shrinks, so the first leg with a meeting is the one.
            best = np.where(np.isinf(best) & (time <= over - start), cost, best)
        return best

    def _surprised(self, end: np.ndarray, futures: Futures, start: float) -> np.ndarray:
        x, y, heading = (a[..., None] for a in end)
        clock = np.full(np.broadcast_shapes(x.shape, futures.weights.shape), start)
        price, met = np.zeros(clock.shape), np.zeros(clock.shape, dtype=bool)
        for leg, over in _legs(futures):
            ahead, right = _position(futures, leg, clock)
            time, to_x, to_y = self._meet(ahead - x, right - y, futures.heading[:, leg], futures.speed)
            chasing = ~met & (over > clock)
            run = np.where(chasing, np.minimum(time, over - clock), 0.0)
            price = price + np.where(chasing, self._turning(to_x, to_y, heading), 0.0)
            met = met | (chasing & (clock + time <= over))
            if leg + 1 < futures.starts.shape[1]:
                way = np.where(chasing, np.arctan2(to_y, to_x), heading)
                x, y = x + self.top_speed * run * np.cos(way), y + self.top_speed * run * np.sin(way)
                heading = way
            clock = clock + run
        return clock - start + price

    def _meet(self, ahead: np.ndarray, right: np.ndarray, heading: np.ndarray, speed: float) -> tuple[np.ndarray, ...]:
        """Return the time [s] at which the prey, now at (ahead, right) of the hunter, can be met, and where it is then.

        ``|q + v u t| = reach + V t``, with v < V: one root t > 0; 0 if the prey is within reach.
        """
        v = min(speed, _CHASE_SHARE * self.top_speed)
        ux, uy = v * np.cos(heading), v * np.sin(heading)
        a = self.top_speed**2 - v**2
        b = self.reach * self.top_speed - (ahead * ux + right * uy)
        c = np.minimum(self.reach**2 - (ahead * ahead + right * right), 0.0)
        time = np.where(c < 0.0, (np.sqrt(b * b - a * c) - b) / a, 0.0)
        return time, ahead + ux * time, right + uy * time

    def _turning(self, ahead: np.ndarray, right: np.ndarray, heading: np.ndarray) -> np.ndarray:
        """Return the price [s] of turning from ``heading`` to the direction of (ahead, right)."""
        return self.heading_price * np.abs(wrap(np.arctan2(right, ahead) - heading))


def _legs(futures: Futures) -> Iterator[tuple[int, np.ndarray]]:
    """Yield the number of each leg and when it is over [s from now, K]."""
    count = futures.starts.shape[1]
    for leg in range(count):
        yield leg, futures.starts[:, leg + 1] if leg + 1 < count else np.full(len(futures.starts), np.inf)


def _position(futures: Futures, leg: int, time: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
    """Return where the leg's line is at ``time`` [s from now]; a leg that never begins is at its start."""
    begin = futures.starts[:, leg]
    run = futures.speed * (time - np.where(np.isfinite(begin), begin, time))
    heading = futures.heading[:, leg]
    return futures.forward[:, leg] + run * np.cos(heading), futures.right[:, leg] + run * np.sin(heading)


@dataclass(frozen=True, eq=False)
class Outlook:
    """What a pair of gaits is expected to bring in each future.

    caught: P(captured by the end of the first and of the second step), [G, K] and [G, G, K].
    time: expected seconds to the capture [G, G, K].
    """

    caught_first: np.ndarray
    caught: np.ndarray
    time: np.ndarray


def look_ahead(pairs: PairPaths, futures: Futures, chase: Chase, ramp: float) -> Outlook:
    """Value every pair of gaits in every future.

    ``E[time] = integral of 1 - P(captured by t) over both steps + (1 - P(captured)) chase time``.
    P(captured by t) is the largest chance so far; the chance falls from 1 to 0 as the distance
    between the mean poses grows from ``reach - ramp`` to ``reach + ramp`` [m], which stands for the
    spread of both robots about their means.
    """
    points = pairs.first.shape[-1]
    forward, right = (a.T for a in futures.at(pairs.times))  # [2 P, K]
    first = _chance(pairs.first, forward[:points], right[:points], chase.reach, ramp)
    second = _chance(pairs.second, forward[points:], right[points:], chase.reach, ramp)
    np.maximum.accumulate(first, axis=-2, out=first)
    caught_first = first[:, -1]
    np.maximum(second[:, :, 0], caught_first[:, None], out=second[:, :, 0])
    np.maximum.accumulate(second, axis=-2, out=second)
    caught = second[:, :, -1]
    interval, end = pairs.times[0], pairs.times[-1]
    during = interval * ((points - first.sum(axis=-2))[:, None] + (points - second.sum(axis=-2)))
    return Outlook(caught_first, caught, during + (1.0 - caught) * chase.time(pairs.end, futures, end))


def _chance(hunter: np.ndarray, forward: np.ndarray, right: np.ndarray, reach: float, ramp: float) -> np.ndarray:
    """Return the chance of being within reach: hunter [2, ..., P] against prey [P, K] gives [..., P, K]."""
    distance = hunter[0][..., None] - forward
    across = hunter[1][..., None] - right
    distance *= distance
    across *= across
    distance += across
    np.sqrt(distance, out=distance)
    np.subtract(reach + ramp, distance, out=distance)
    distance /= 2.0 * ramp
    return np.clip(distance, 0.0, 1.0, out=distance)


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
