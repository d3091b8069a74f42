"""Free space by looking instead of going: cells judged from where the hunter stands, before its first step.

Letters: I columns of cells along x, J along y.
"""

from __future__ import annotations

import math

import numpy as np

from bayeshunt.core.geometry import Pose
from bayeshunt.core.messages import Ray
from bayeshunt.core.protocols import Map
from bayeshunt.models.arena.free_space import CELL, FreeSpace

__all__ = ["scan"]

#: Points of the hunter's outline that must be free where its centre is to be.
_OUTLINE = 12


def scan(
    map: Map, start: Pose, body: float, *, looks: int, reach: float, above: bool, error: float,
    rng: np.random.Generator,
) -> FreeSpace:  # fmt: skip
    """Return what ``looks`` looks around from ``start`` count: visits of a cell that looks free, else hits.

    map: what stands where, in its own frame, in which ``start`` is given. body: of the hunter [m]. reach: metres that
    it sees. above: whether its eyes are higher than the obstacles, so that none hides what is behind it; else a cell
    is seen if the line to its middle is free as far as a cell before it. error: probability that a cell is taken for
    the other kind, in every look and cell anew.

    Looks outvote each other: where most of them agree, they all count. A hidden cell counts as one that looked free
    once: most of an arena is, and nothing is known to stand there.
    """
    cell, most = CELL * body, math.ceil(reach / (CELL * body))
    number = np.arange(-most, most + 1)
    x, y = np.meshgrid(number * cell, number * cell, indexing="ij")
    cos, sin = math.cos(start.theta), math.sin(start.theta)
    at_x, at_y = start.x + cos * x - sin * y, start.y + sin * x + cos * y
    free = np.asarray(map.free(at_x, at_y))
    for turn in np.linspace(0.0, 2.0 * math.pi, _OUTLINE, endpoint=False):
        free &= map.free(at_x + 0.5 * body * math.cos(turn), at_y + 0.5 * body * math.sin(turn))
    near = np.hypot(x, y) <= reach
    seen = near.copy()
    if not above:
        for index in np.argwhere(seen):
            column, row = index.tolist()
            seen[column, row] = not _hidden(map, start, at_x[column, row], at_y[column, row], cell)
    right = 2 * rng.binomial(looks, 1.0 - error, size=free.shape) > looks
    looks_free = free == right
    visits = np.where(seen, looks * looks_free, near)
    hits = looks * (seen & ~looks_free)
    visits[most, most] = max(1, int(visits[most, most]))  # it stands there
    return FreeSpace(cell, (-most, -most), visits, hits)


def _hidden(map: Map, start: Pose, x: float, y: float, cell: float) -> bool:
    """Whether something stands on the way to a point, short of it by a cell."""
    far = math.hypot(x - start.x, y - start.y)
    if far <= cell:
        return False
    share = 1.0 - cell / far
    return map.blocked(Ray(start.x, start.y, start.x + share * (x - start.x), start.y + share * (y - start.y)))
