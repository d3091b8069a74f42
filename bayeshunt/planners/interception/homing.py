"""What remains after the lookahead: an estimate of the time until the hunter meets the prey.

Letters: K prey futures; an end pose for each of ``...`` gait sequences.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bayeshunt.core.geometry import wrap
from bayeshunt.planners.interception.futures import Futures

__all__ = ["Homing"]

#: A prey faster than this share of the hunter's top speed is taken to go at this share beyond the
#: lookahead: it might never be met, and then a longer chase must still cost more than a shorter one.
_CHASE_SHARE = 0.9


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
        x, y, heading = end
        best = np.full(np.broadcast_shapes(x.shape, futures.weights.shape), np.inf)
        for leg, over in _legs(futures):
            ahead, right = _position(futures, leg, start)
            wait = futures.starts[:, leg] - start
            time, to_x, to_y = self._meet(ahead - x, right - y, futures.heading[:, leg], futures.leg_speed(leg))
            cost = np.maximum(time, wait) + self._turning(to_x, to_y, heading)
            # The gap to what the hunter can reach only shrinks, so the first leg with a meeting is the one.
            best = np.where(np.isinf(best) & (time <= over - start), cost, best)
        return best

    def _surprised(self, end: np.ndarray, futures: Futures, start: float) -> np.ndarray:
        shape = np.broadcast_shapes(end[0].shape, futures.weights.shape)
        x, y, heading = (np.broadcast_to(part, shape) for part in end)
        clock, price, met = np.full(shape, start), np.zeros(shape), np.zeros(shape, dtype=bool)
        count = futures.starts.shape[1]
        for leg, over in _legs(futures):
            # Most paths have fewer legs than the longest: only those that have this one are followed.
            some = np.isfinite(futures.starts[:, leg])
            one = futures if some.all() else futures.only(some)
            columns = slice(None) if some.all() else some
            now, px, py, facing, done = (a[..., columns] for a in (clock, x, y, heading, met))
            until = over[columns]
            ahead, right = _position(one, leg, now)
            time, to_x, to_y = self._meet(ahead - px, right - py, one.heading[:, leg], one.leg_speed(leg))
            chasing = ~done & (until > now)
            run = np.where(chasing, np.minimum(time, until - now), 0.0)
            price[..., columns] += np.where(chasing, self._turning(to_x, to_y, facing), 0.0)
            met[..., columns] = done | (chasing & (now + time <= until))
            if leg + 1 < count:
                way = np.where(chasing, np.arctan2(to_y, to_x), facing)
                x, y, heading = (np.array(a) for a in (x, y, heading)) if leg == 0 else (x, y, heading)
                x[..., columns] = px + self.top_speed * run * np.cos(way)
                y[..., columns] = py + self.top_speed * run * np.sin(way)
                heading[..., columns] = way
            clock[..., columns] = now + run
        return clock - start + price

    def _meet(
        self, ahead: np.ndarray, right: np.ndarray, heading: np.ndarray, speed: np.ndarray
    ) -> tuple[np.ndarray, ...]:
        """Return the time [s] at which the prey, now at (ahead, right) of the hunter, can be met, and where it is then.

        ``|q + v u t| = reach + V t``, with v < V: one root t > 0; 0 if the prey is within reach.
        """
        v = np.minimum(speed, _CHASE_SHARE * self.top_speed)
        ux, uy = v * np.cos(heading), v * np.sin(heading)
        a = self.top_speed**2 - v**2
        b = self.reach * self.top_speed - (ahead * ux + right * uy)
        c = np.minimum(self.reach**2 - (ahead * ahead + right * right), 0.0)
        time = np.where(c < 0.0, (np.sqrt(b * b - a * c) - b) / a, 0.0)
        return time, ahead + ux * time, right + uy * time

    def _turning(self, ahead: np.ndarray, right: np.ndarray, heading: np.ndarray) -> np.ndarray:
        """Return the price [s] of turning from ``heading`` to the direction of (ahead, right)."""
        found: np.ndarray = self.heading_price * np.abs(wrap(np.arctan2(right, ahead) - heading))
        return found


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
