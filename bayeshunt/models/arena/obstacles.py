"""What stands in the arena as far as the hunter has touched it: cells that nothing is in, nor is seen behind."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bayeshunt.core.geometry import FloatArray
from bayeshunt.models.arena.free_space import FreeSpace

__all__ = ["TouchedObstacles"]

#: A touched cell is blocked if it is free with less than this probability.
_BLOCKED = 0.5
#: Bearings into which the view round the hunter is divided: a cell at 1 m is two of them wide.
_RAYS = 360


@dataclass(frozen=True, eq=False)
class TouchedObstacles:
    """Cells of a table of free space in which something was touched; see ``bayeshunt.perception.setting``.

    space: where the hunter could be. blocked: bool [I, J], of its cells.
    """

    space: FreeSpace
    blocked: np.ndarray

    @classmethod
    def of(cls, space: FreeSpace | None, normals: FloatArray, offsets: FloatArray) -> TouchedObstacles | None:
        """Return the blocked cells inside the walls ``normals`` [W, 2], ``offsets`` [m, W]; None if there are none.

        A cell that was never touched is not taken to be blocked, visited or not: nobody knows.
        """
        if space is None:
            return None
        columns, rows = np.nonzero((space.hits > 0) & (space.probabilities < _BLOCKED))
        places = np.column_stack([columns + space.origin[0], rows + space.origin[1]]) * space.cell
        inside = (places @ np.reshape(normals, (-1, 2)).T <= np.asarray(offsets) - space.cell).all(axis=1)
        if not inside.any():
            return None
        blocked = np.zeros(space.hits.shape, dtype=bool)
        blocked[columns[inside], rows[inside]] = True
        blocked.setflags(write=False)
        return cls(space, blocked)

    def inside(self, x: FloatArray, y: FloatArray) -> np.ndarray:
        """Return whether points [m] lie in blocked cells: bool in the shape of ``x``."""
        found: np.ndarray = np.pad(self.blocked, 1)[self.space.indices(x, y, margin=1)]
        return found

    def met(self, from_x: FloatArray, from_y: FloatArray, x: FloatArray, y: FloatArray) -> np.ndarray:
        """Return whether ways from points [m, N] to points [N] lead into a blocked cell: bool [N].

        A way that begins in one leads out of it.
        """
        dx, dy = x - from_x, y - from_y
        parts = max(1, math.ceil(float(np.hypot(dx, dy).max(initial=0.0)) / self.space.cell))
        share = np.arange(1, parts + 1)[:, None] / parts
        way = self.inside(from_x + share * dx, from_y + share * dy)
        into: np.ndarray = way.any(axis=0) & ~self.inside(from_x, from_y)
        return into

    def hidden(self, from_x: float, from_y: float, x: FloatArray, y: FloatArray) -> np.ndarray:
        """Return whether a blocked cell lies between a point and the points [N], ends left out: bool [N]."""
        dx, dy = x - from_x, y - from_y
        distance = np.hypot(dx, dy)
        step = 0.5 * self.space.cell
        reach = np.arange(2, max(3, math.ceil(float(distance.max()) / step))) * step
        bearings = (np.arange(_RAYS) + 0.5) * (2.0 * math.pi / _RAYS) - math.pi
        along = self.inside(from_x + np.cos(bearings)[:, None] * reach, from_y + np.sin(bearings)[:, None] * reach)
        free = np.where(along.any(axis=1), reach[along.argmax(axis=1)], np.inf)  # metres to the first one
        ray = np.floor((np.arctan2(dy, dx) + math.pi) * (_RAYS / (2.0 * math.pi))).astype(int) % _RAYS
        behind: np.ndarray = distance > free[ray] + self.space.cell
        return behind
