"""Where a prey goes among known walls: straight on, and away from the wall that it meets, or along it.

Everything is computed in the hunter's starting frame (x ahead, y to the left, counter-clockwise)
and returned in its present one. Letters: W walls, K futures, B legs.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from bayeshunt.core.geometry import Polar, Pose
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.planners.interception.futures import NEGLIGIBLE, Futures

__all__ = ["LEGS", "Walls", "rooms_futures", "sliding_future"]

#: Straight runs of a path between walls, the last for ever: with nine the hunts of eight worlds were the same.
LEGS = 3


class Walls(NamedTuple):
    """Half-planes ``nx x + ny y <= offset`` that a prey's centre does not leave, and how it leaves a wall.

    normals: [W] pairs. offsets: metres [W]. rebound: angle between the wall and the prey that has turned, radians.
    """

    normals: tuple[tuple[float, float], ...]
    offsets: tuple[float, ...]
    rebound: float

    @classmethod
    def of(cls, room: RoomModel) -> Walls:
        """Return the walls of a room where they stop a body of the hunter's size."""
        return cls(tuple((float(x), float(y)) for x, y in room.normals), tuple(map(float, room.offsets)), 0.0)

    def kept(self, clearance: float, rebound: float) -> Walls:
        """Return them as they are to a prey whose centre turns away from them ``clearance`` [m] before."""
        return Walls(self.normals, tuple(offset - clearance for offset in self.offsets), rebound)

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

    def beyond(self, wall: int, pose: Pose) -> float:
        """Return how far beyond ``wall`` a pose is [m], negative inside."""
        nx, ny = self.normals[wall]
        return nx * pose.x + ny * pose.y - self.offsets[wall]

    def left(self, wall: int, before: Pose, after: Pose, run: float) -> tuple[float, float]:
        """Return the angle to ``wall`` [rad] at which a prey left it, and how far from it [m] it turned.

        That is where a prey which goes ``run`` metres from ``before``, and turns at once, would have turned to be as
        far from the wall as ``after`` is: the time that a turn takes counts as distance kept from the wall.
        """
        rebound = 0.5 * math.pi - abs(self.slant(wall, after.theta + math.pi))
        steep = max(math.cos(self.slant(wall, before.theta)), 0.1)
        rest = run + self.beyond(wall, before) / steep  # left of the run at the wall itself
        kept = (-self.beyond(wall, after) - rest * math.sin(rebound)) / (1.0 + math.sin(rebound) / steep)
        return rebound, min(max(kept, 0.0), run)

    def leave(self, wall: int, side: float) -> float:
        """Return the heading [rad] with which a prey leaves ``wall`` to a side: +1 left of the normal, -1 right."""
        nx, ny = self.normals[wall]
        return math.atan2(ny, nx) + side * (0.5 * math.pi + self.rebound)


def rooms_futures(
    prey: Polar, pose: Pose, rooms: Iterable[tuple[float, Walls]], speed: float, drift: float, time_step: float, *,
    legs: int = LEGS,
) -> tuple[float, Futures | None]:  # fmt: skip
    """Return the probability of those of ``rooms`` (probability, walls) that have a wall ahead, and the paths in them.

    The prey goes straight at ``speed`` [m/s] and leaves a wall on the side that it comes in on. On
    its way to the first wall its heading wanders, a random walk of ``drift`` [rad] per time-step,
    so it may take the other side, a second path: ``P(left) = Phi(slant / (drift sqrt(steps to the wall)))``.
    pose: the hunter's, in its starting frame. legs: straight runs of each path, the last for ever.
    No paths, None, if no room has a wall ahead of the prey.
    """
    at = Pose(*(float(part) for part in pose.compose(prey)))
    paths, weights, apart = [], [], []
    for chance, walls in rooms:
        wall, gap = walls.meet(at)
        if wall < 0:
            continue
        slant = walls.slant(wall, at.theta)
        side = 1.0 if slant >= 0 else -1.0
        steps = gap / (speed * time_step) if speed > 0 else 0.0
        wander = max(drift * math.sqrt(2.0 * steps), 1e-9)  # sqrt(2): of the error function
        other = 0.5 * math.erfc(abs(slant) / wander)
        both = other >= NEGLIGIBLE and speed > 0
        for towards, share in ((side, 1.0 - other if both else 1.0), (-side, other))[: 1 + both]:
            paths.append(_path(at, walls, speed, towards, legs))
            weights.append(chance * share)
            apart.append(speed > 0 and steps < 1.0)
    if not paths:
        return 0.0, None
    groups = np.where(apart, np.arange(1, len(paths) + 1), 0)
    whole = math.fsum(weights)
    return whole, _seen(paths, pose, speed, np.array(weights) / whole, groups)


def sliding_future(prey: Polar, pose: Pose, walls: Walls, speed: float) -> Futures:
    """Return the path of a prey that keeps its heading at the wall ahead: along it, and to a stop at the next.

    ``speed``: metres per second, > 0; along the wall it keeps the part of it that the wall does not take. ``walls``:
    where its centre is stopped; one of them lies ahead.
    """
    x, y, theta = (float(part) for part in pose.compose(prey))
    wall, gap = walls.meet(Pose(x, y, theta))
    slant, (nx, ny) = walls.slant(wall, theta), walls.normals[wall]
    along, share = math.atan2(ny, nx) + math.copysign(0.5 * math.pi, slant), abs(math.sin(slant))
    met = (x + gap * math.cos(theta), y + gap * math.sin(theta))
    _, rest = walls.meet(Pose(*met, along))
    ends = speed * share > 1e-12 and rest < math.inf
    corner = (met[0] + rest * math.cos(along), met[1] + rest * math.sin(along)) if ends else met
    begin = gap / speed
    legs = [
        (0.0, x, y, theta),
        (begin, *met, along),
        (begin + rest / (speed * share) if ends else math.inf, *corner, theta),
    ]
    return _seen([legs], pose, speed, np.ones(1), np.zeros(1, dtype=int), np.array([[1.0, share, 0.0]]))


def _seen(
    paths: list[list[tuple[float, float, float, float]]], pose: Pose, speed: float, weights: np.ndarray,
    groups: np.ndarray, pace: np.ndarray | None = None,
) -> Futures:  # fmt: skip
    """Return paths of (start [s], x, y [m], theta [rad]) of each leg as futures in the present frame of ``pose``."""
    starts, x, y, theta = np.moveaxis(np.array(paths), -1, 0)  # [K, B] each
    dx, dy = x - pose.x, y - pose.y
    cos, sin = math.cos(pose.theta), math.sin(pose.theta)
    return Futures(
        weights=weights,
        starts=starts,
        forward=cos * dx + sin * dy,
        right=sin * dx - cos * dy,
        heading=pose.theta - theta,
        speed=np.full(len(weights), speed),
        groups=groups,
        foreseen=True,
        pace=pace,
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
