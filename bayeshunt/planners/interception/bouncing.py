"""Where a prey goes among known walls: straight on, and along the wall that it meets.

Everything is computed in the hunter's starting frame (x ahead, y to the left, counter-clockwise)
and returned in its present one. Letters: W walls, K futures, B legs.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from bayeshunt.core.geometry import Polar, Pose
from bayeshunt.planners.interception.futures import Futures

__all__ = ["LEGS", "Walls", "room_futures"]

#: Straight runs of a path between walls: enough for a minute of a prey as fast as the hunter.
LEGS = 9
#: A side that is less probable than this is left out.
_NEGLIGIBLE = 0.02


class Walls(NamedTuple):
    """Half-planes ``nx x + ny y <= offset`` that a prey's centre does not leave, and how it leaves a wall.

    normals: [W] pairs. offsets: metres [W]. rebound: angle between the wall and the prey that has turned, radians.
    """

    normals: tuple[tuple[float, float], ...]
    offsets: tuple[float, ...]
    rebound: float

    def meet(self, pose: Pose) -> tuple[int, float]:
        """Return the wall that lies ahead of ``pose`` and the metres to it; (-1, inf) if there is none."""
        ux, uy = math.cos(pose.theta), math.sin(pose.theta)
        found, least = -1, math.inf
        for wall, ((nx, ny), offset) in enumerate(zip(self.normals, self.offsets, strict=True)):
            towards = nx * ux + ny * uy
            if towards > 1e-9:
                gap = max(0.0, (offset - nx * pose.x - ny * pose.y) / towards)
                if gap < least:
                    found, least = wall, gap
        return found, least

    def slant(self, wall: int, theta: float) -> float:
        """Return how far ``theta`` is off head-on at ``wall``, radians counter-clockwise in (-pi/2, pi/2)."""
        nx, ny = self.normals[wall]
        return math.atan2(nx * math.sin(theta) - ny * math.cos(theta), nx * math.cos(theta) + ny * math.sin(theta))

    def leave(self, wall: int, side: float) -> float:
        """Return the heading [rad] with which a prey leaves ``wall`` to a side: +1 left of the normal, -1 right."""
        nx, ny = self.normals[wall]
        return math.atan2(ny, nx) + side * (0.5 * math.pi + self.rebound)


def room_futures(
    prey: Polar, pose: Pose, walls: Walls, speed: float, drift: float, time_step: float, *, legs: int = LEGS
) -> Futures | None:
    """Return the prey's paths among ``walls``; None if there is no wall ahead of it.

    The prey goes straight at ``speed`` [m/s] and leaves a wall on the side that it comes in on. On
    its way to the first wall its heading wanders, a random walk of ``drift`` [rad] per time-step,
    so it may take the other side, a second path: ``P(left) = Phi(slant / (drift sqrt(steps to the wall)))``.
    pose: the hunter's, in its starting frame. legs: straight runs of each path, the last for ever.
    """
    at = Pose(*(float(part) for part in pose.compose(prey)))
    wall, gap = walls.meet(at)
    if wall < 0:
        return None
    slant = walls.slant(wall, at.theta)
    side = 1.0 if slant >= 0 else -1.0
    paths = [_path(at, walls, speed, side, legs)]
    steps = gap / (speed * time_step) if speed > 0 else 0.0
    wander = max(drift * math.sqrt(2.0 * steps), 1e-9)  # sqrt(2): of the error function
    other = 0.5 * math.erfc(abs(slant) / wander)
    weights = [1.0]
    if other >= _NEGLIGIBLE and speed > 0:
        paths.append(_path(at, walls, speed, -side, legs))
        weights = [1.0 - other, other]
    starts, x, y, theta = np.moveaxis(np.array(paths), -1, 0)  # [K, B] each
    dx, dy = x - pose.x, y - pose.y
    cos, sin = math.cos(pose.theta), math.sin(pose.theta)
    apart = speed > 0 and steps < 1.0
    return Futures(
        weights=np.array(weights),
        starts=starts,
        forward=cos * dx + sin * dy,
        right=sin * dx - cos * dy,
        heading=pose.theta - theta,
        speed=np.full(len(weights), speed),
        groups=np.arange(1, len(weights) + 1) if apart else np.zeros(len(weights), dtype=int),
        foreseen=True,
    )


def _path(pose: Pose, walls: Walls, speed: float, side: float, count: int) -> list[tuple[float, float, float, float]]:
    """Return (start [s], x, y [m], theta [rad]) of each leg; ``side`` is taken at the first wall."""
    legs = [(0.0, pose.x, pose.y, pose.theta)]
    while len(legs) < count:
        start, x, y, theta = legs[-1]
        wall, gap = walls.meet(Pose(x, y, theta))
        if wall < 0 or speed <= 0:
            legs.append((math.inf, x, y, theta))
            continue
        if len(legs) > 1:
            side = 1.0 if walls.slant(wall, theta) >= 0 else -1.0
        x, y = x + gap * math.cos(theta), y + gap * math.sin(theta)
        legs.append((start + gap / speed, x, y, walls.leave(wall, side)))
    return legs
