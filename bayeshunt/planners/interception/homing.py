"""What remains after the lookahead: an estimate of the time until the hunter meets the prey.

Letters: K prey futures; an end pose for each of ``...`` gait sequences.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from bayeshunt.planners.interception.futures import Futures

__all__ = ["CHASE_SHARE", "Homing"]

#: A prey faster than this share of the hunter's top speed is taken to go at this share beyond the
#: lookahead: it might never be met, and then a longer chase must still cost more than a shorter one.
CHASE_SHARE = 0.9


@dataclass(frozen=True)
class Homing:
    """The estimate of the time from the end of the lookahead to the capture.

    top_speed: m/s, of the hunter. reach: metres, the distance that is a capture.
    heading_price: seconds for each radian between the hunter's heading and the way to the meeting point.
    """

    top_speed: float
    reach: float
    heading_price: float

    def time(self, end: np.ndarray, futures: Futures, start: float) -> np.ndarray:
        """Return the estimated seconds from ``start`` [s from now] to the capture, [..., K].

        end: the hunter's poses at ``start``: forward, right, heading [3, ..., K or 1]. It heads straight,
        at top speed, for the point where it meets the prey; every change of heading costs
        ``heading_price``. A foreseen path is met where it leads; otherwise the hunter believes in the
        prey's present leg until the next one begins.
        """
        return self._foreseen(end, futures, start) if futures.foreseen else self._surprised(end, futures, start)

    def _foreseen(self, end: np.ndarray, futures: Futures, start: float) -> np.ndarray:
        chase, found = _Chase.of(end, futures), np.empty(_shape(end, futures))
        for leg, over in _legs(futures):
            future = chase.futures
            ahead, right = _position(future, leg, start)
            wait = future.starts[:, leg] - start
            time, to_x, to_y = self._meet(
                ahead - chase.x, right - chase.y, future.heading[:, leg], future.leg_speed(leg)
            )
            # The gap to what the hunter can reach only shrinks, so the first leg with a meeting is the one.
            meets = ~chase.met & (time <= over[chase.columns] - start)
            cost = np.maximum(time, wait) + self._turning(chase, to_x, to_y)
            found[..., chase.columns] = np.where(meets, cost, found[..., chase.columns])
            chase.met |= meets
            rest = np.logical_not(chase.met.all(axis=chase.others))
            if not rest.any():
                break
            chase = chase.only(rest)
        return found

    def _surprised(self, end: np.ndarray, futures: Futures, start: float) -> np.ndarray:
        chase, found = _Chase.of(end, futures), np.zeros(_shape(end, futures))
        clock = np.full(found.shape, start)
        for leg, over in _legs(futures):
            future, until = chase.futures, over[chase.columns]
            ahead, right = _position(future, leg, clock)
            time, to_x, to_y = self._meet(
                ahead - chase.x, right - chase.y, future.heading[:, leg], future.leg_speed(leg)
            )
            left = until - clock
            chasing = ~chase.met & (left > 0.0)
            run = np.where(chasing, np.minimum(time, left), 0.0)
            found[..., chase.columns] += np.where(chasing, run + self._turning(chase, to_x, to_y), 0.0)
            chase.met |= chasing & (time <= left)
            # Most paths have fewer legs than the longest, and most are met on an early one.
            going = np.isfinite(until) & ~chase.met.all(axis=chase.others)
            if not going.any():
                break
            chase, clock = chase.gone(to_x, to_y, chasing, self.top_speed * run).only(going), (clock + run)[..., going]
        return found

    def _meet(
        self, ahead: np.ndarray, right: np.ndarray, heading: np.ndarray, speed: np.ndarray
    ) -> tuple[np.ndarray, ...]:
        """Return the time [s] at which the prey, now at (ahead, right) of the hunter, can be met, and where it is then.

        ``|q + v u t| = reach + V t``, with v < V: one root t > 0; 0 if the prey is within reach.
        """
        v = np.minimum(speed, CHASE_SHARE * self.top_speed)
        ux, uy = v * np.cos(heading), v * np.sin(heading)
        a = self.top_speed**2 - v**2
        b = self.reach * self.top_speed - (ahead * ux + right * uy)
        c = np.minimum(self.reach**2 - (ahead * ahead + right * right), 0.0)
        time = np.where(c < 0.0, (np.sqrt(b * b - a * c) - b) / a, 0.0)
        return time, ahead + ux * time, right + uy * time

    def _turning(self, chase: _Chase, ahead: np.ndarray, right: np.ndarray) -> np.ndarray:
        """Return the price [s] of turning from the heading to the direction of (ahead, right)."""
        across = chase.cos * right - chase.sin * ahead
        found: np.ndarray = self.heading_price * np.arctan2(np.abs(across), chase.cos * ahead + chase.sin * right)
        return found


@dataclass
class _Chase:
    """Where the hunter is in each future that it has not met: its place [m] and heading [..., K or 1], bool met.

    futures: those followed. columns: their numbers among all.
    """

    futures: Futures
    columns: np.ndarray
    x: np.ndarray
    y: np.ndarray
    cos: np.ndarray
    sin: np.ndarray
    met: np.ndarray

    @classmethod
    def of(cls, end: np.ndarray, futures: Futures) -> _Chase:
        x, y, heading = end
        met = np.zeros(_shape(end, futures), dtype=bool)
        return cls(futures, np.arange(len(futures.weights)), x, y, np.cos(heading), np.sin(heading), met)

    @property
    def others(self) -> tuple[int, ...]:
        """All axes but that of the futures."""
        return tuple(range(self.met.ndim - 1))

    def only(self, chosen: np.ndarray) -> _Chase:
        """Return it for some of the futures, bool [K]."""
        if chosen.all():
            return self
        x, y, cos, sin = (
            part if part.shape[-1] == 1 else part[..., chosen] for part in (self.x, self.y, self.cos, self.sin)
        )
        return _Chase(self.futures.only(chosen), self.columns[chosen], x, y, cos, sin, self.met[..., chosen])

    def gone(self, ahead: np.ndarray, right: np.ndarray, chasing: np.ndarray, run: np.ndarray) -> _Chase:
        """Return it after ``run`` metres [..., K] in the direction of (ahead, right), where it is ``chasing``."""
        distance = np.hypot(ahead, right)
        with np.errstate(invalid="ignore", divide="ignore"):  # one that is there has no way to go
            cos, sin = ahead / distance, right / distance
        turned = chasing & (distance > 0.0)
        cos, sin = np.where(turned, cos, self.cos), np.where(turned, sin, self.sin)
        return replace(self, x=self.x + run * cos, y=self.y + run * sin, cos=cos, sin=sin)


def _shape(end: np.ndarray, futures: Futures) -> tuple[int, ...]:
    return np.broadcast_shapes(end[0].shape, futures.weights.shape)


def _legs(futures: Futures) -> Iterator[tuple[int, np.ndarray]]:
    """Yield the number of each leg and when it is over [s from now, K]."""
    count = futures.starts.shape[1]
    for leg in range(count):
        yield leg, futures.starts[:, leg + 1] if leg + 1 < count else np.full(len(futures.starts), np.inf)


def _position(futures: Futures, leg: int, time: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
    """Return where the leg's line is at ``time`` [s from now]; a leg that never begins is at its start."""
    begin = futures.starts[:, leg]
    run = futures.leg_speed(leg) * (time - np.where(np.isfinite(begin), begin, time))
    heading = futures.heading[:, leg]
    return futures.forward[:, leg] + run * np.cos(heading), futures.right[:, leg] + run * np.sin(heading)
