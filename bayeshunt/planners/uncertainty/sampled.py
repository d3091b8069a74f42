"""Futures drawn from a belief: where the prey may be, and where it then goes. Letters: K futures, B legs, W walls."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bayeshunt.core.geometry import FloatArray, Pose, wrap
from bayeshunt.core.protocols import MovingBelief
from bayeshunt.perception.trackers.cloud import systematic
from bayeshunt.planners.interception.bouncing import Walls
from bayeshunt.planners.interception.futures import Futures

__all__ = ["Start", "going_away", "sampled_futures"]

#: So many draws for each that is kept, where only those that go away are wanted.
_DRAWS = 16

#: Straight runs of a path in a room, and in the open: there one turn.
_LEGS, _OPEN_LEGS = 6, 2


@dataclass(frozen=True, eq=False)
class Start:
    """K prey as they may be now.

    pose: in the frame in which the hunter started. speed: m/s [K]. turn_at: seconds from now at which each turns by
    chance, inf if never [K]; turn: by how much [rad, clockwise, K].
    """

    pose: Pose[FloatArray]
    speed: FloatArray
    turn_at: FloatArray
    turn: FloatArray


def going_away(
    belief: MovingBelief, count: int, own: Pose, spread: float, rng: np.random.Generator
) -> tuple[Pose[FloatArray], FloatArray]:
    """Return ``count`` poses and speeds [m/s] of a belief, of those that go away from ``own``.

    spread: radians, the standard deviation of their headings about straight away.
    """
    pose, speed = belief.sample_motion(_DRAWS * count, rng=rng)
    off = np.asarray(wrap(pose.theta - np.arctan2(pose.y - own.y, pose.x - own.x)))
    square = np.square(off / spread)
    chosen = systematic(np.exp(-0.5 * (square - square.min())), count, rng)
    return Pose(*(part[chosen] for part in pose)), speed[chosen]


def sampled_futures(start: Start, own: Pose, walls: Walls | None) -> Futures:
    """Return K equally weighted futures, as the hunter at ``own`` sees them; prey leave walls as they come in."""
    room = walls if walls is not None and len(walls.normals) else None
    legs = _in_a_room(start, room) if room is not None else _in_the_open(start)
    starts, x, y, theta = (np.stack(part, axis=1) for part in zip(*legs, strict=True))
    dx, dy = x - own.x, y - own.y
    cos, sin = math.cos(own.theta), math.sin(own.theta)
    count = len(start.speed)
    return Futures(
        weights=np.full(count, 1.0 / count),
        starts=starts,
        forward=cos * dx + sin * dy,
        right=sin * dx - cos * dy,
        heading=own.theta - theta,
        speed=start.speed,
        groups=np.zeros(count, dtype=int),
        foreseen=room is not None,
    )


def _in_the_open(start: Start) -> list[tuple[FloatArray, ...]]:
    x, y, theta = start.pose
    turning = np.isfinite(start.turn_at)
    run = np.where(turning, start.speed * np.where(turning, start.turn_at, 0.0), 0.0)
    return [
        (np.zeros(len(x)), x, y, theta),
        (start.turn_at, x + run * np.cos(theta), y + run * np.sin(theta), theta - start.turn),
    ]


def _in_a_room(start: Start, walls: Walls) -> list[tuple[FloatArray, ...]]:
    normals, offsets = np.array(walls.normals), np.array(walls.offsets)[:, None]
    facing = np.arctan2(normals[:, 1], normals[:, 0])
    x, y, theta = start.pose
    time, turn_at = np.zeros(len(x)), start.turn_at
    speed = np.maximum(start.speed, 1e-9)
    legs: list[tuple[FloatArray, ...]] = [(time, x, y, theta)]
    for _ in range(_LEGS - 1):
        ux, uy = np.cos(theta), np.sin(theta)
        towards = normals[:, :1] * ux + normals[:, 1:] * uy
        room = np.maximum(offsets - normals[:, :1] * x - normals[:, 1:] * y, 0.0)
        gaps = np.where(towards > 1e-9, room / np.where(towards > 1e-9, towards, 1.0), np.inf)
        wall = gaps.argmin(axis=0)
        gap = gaps.min(axis=0)
        turns = turn_at < time + gap / speed
        left = np.subtract(turn_at, time, where=turns, out=np.zeros(len(x)))
        gap = np.where(turns, left * speed, gap)
        met = np.isfinite(gap)
        run = np.where(met, gap, 0.0)
        side = np.where(np.asarray(wrap(theta - facing[wall])) >= 0.0, 1.0, -1.0)
        along = facing[wall] + side * (0.5 * math.pi + walls.rebound)
        theta = np.where(turns, theta - start.turn, np.where(met, along, theta))
        x, y, time = x + run * ux, y + run * uy, np.where(met, time + run / speed, np.inf)
        turn_at = np.where(turns, np.inf, turn_at)
        legs.append((time, x, y, theta))
    return legs
