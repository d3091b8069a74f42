"""What stands in the hunter's way, in every future. Letters: G gaits, P part-way poses of a gait, K futures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bayeshunt.core.geometry import FloatArray, Pose, placed
from bayeshunt.models.arena.free_space import FreeSpace
from bayeshunt.models.arena.obstacles import TouchedObstacles
from bayeshunt.planners.detour.ways import WayFinder
from bayeshunt.planners.interception.futures import Futures
from bayeshunt.planners.interception.homing import Homing
from bayeshunt.planners.interception.lookahead import Outlook, PairPaths, keep_highest

__all__ = ["Obstructed"]

#: A cell in which nothing was touched is as good as free on the way round, one that is blocked as good as not.
_FREE, _BLOCKED = 1000, 20


@dataclass(frozen=True, eq=False)
class Obstructed:
    """Turns what pairs of gaits bring were nothing in the way into what they bring among touched obstacles.

    A pair that leads into an obstacle is stopped there: it captures nothing from then on, and costs ``stuck`` [s]. From
    where a pair ends the hunter goes for the prey, straight and round what stands between it and where the prey is.
    """

    obstacles: TouchedObstacles
    finder: WayFinder
    stuck: float

    @classmethod
    def by(cls, obstacles: TouchedObstacles, stuck: float) -> Obstructed:
        """Return it for obstacles that were touched; where nothing was, the way is free."""
        space, blocked = obstacles.space, obstacles.blocked
        free = FreeSpace(space.cell, space.origin, np.where(blocked, 0, _FREE), np.where(blocked, _BLOCKED, 0))
        return cls(obstacles, WayFinder(free), stuck)

    def outlook(self, found: Outlook, pairs: PairPaths, futures: Futures, pose: Pose, homing: Homing) -> Outlook:
        """Return ``found`` with what is in the way of the hunter at ``pose``, in the frame of the start."""
        count, points = pairs.first.shape[1:3]
        both = np.broadcast_to(pairs.first[:2, :, None, :, 0], (2, count, count, points))
        x, y = placed(pose, *np.concatenate([both, pairs.second[:2, ..., 0]], axis=-1))  # [G, G, 2 P]
        met = np.maximum.accumulate(self.obstacles.inside(x, y), axis=-1)
        stopped = met[..., -1:]
        last = np.where(stopped[..., 0], met.argmax(axis=-1), 2 * points)  # how many places come before it
        end_x, end_y = (
            np.take_along_axis(np.insert(way, 0, at, axis=-1), last[..., None], axis=-1)[..., 0]
            for way, at in ((x, pose.x), (y, pose.y))
        )
        goal_x, goal_y = placed(pose, *(part[:, 0] for part in futures.at(pairs.times[-1:])))
        straight, more = self._ways(end_x, end_y, goal_x, goal_y)
        first = np.where(met[:, 0, :points, None], 0.0, found.first)
        second = np.where(met[..., points:, None], 0.0, found.second)
        keep_highest(first)
        np.maximum(second[:, :, 0], first[:, None, -1], out=second[:, :, 0])
        keep_highest(second)
        during = pairs.times[0] * ((points - first.sum(axis=-2))[:, None] + (points - second.sum(axis=-2)))
        escaped = 1.0 - second[:, :, -1]
        late = during + escaped * (self.stuck + straight / homing.top_speed)
        time = np.where(stopped, late, found.time) + escaped * more / homing.top_speed
        return Outlook(first, second, time)

    def _ways(
        self, x: FloatArray, y: FloatArray, goal_x: FloatArray, goal_y: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Metres straight from places [G, G] to those of the prey [K], and how many more round what is between."""
        across = np.broadcast_arrays(x[..., None], y[..., None], goal_x, goal_y)
        straight = np.hypot(across[2] - across[0], across[3] - across[1])
        between = self.obstacles.met(*(part.ravel() for part in across)).reshape(straight.shape)
        more = np.zeros(straight.shape)
        for k in np.flatnonzero(between.any(axis=(0, 1))).tolist():
            length = self.finder.to(float(goal_x[k]), float(goal_y[k])).length(x, y)
            more[..., k] = np.where(between[..., k], np.maximum(length - straight[..., k], 0.0), 0.0)
        return straight, more
