"""The shortest ways to a place over a table of free space.

Letters: N cells of the table and a margin around it; ``...`` points.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bayeshunt.core.geometry import FloatArray
from bayeshunt.models.arena.free_space import FreeSpace

__all__ = ["WayFinder", "Ways"]

#: Cells around the table in which a goal or a way may lie; they were never looked at.
_MARGIN = 2
#: A way looks so many cells ahead for its direction, so that it does not follow the grid's.
_AHEAD = 4
#: Goals whose ways are kept.
_KEPT = 64
_EIGHT = [(dx, dy) for dx in (-1, 0, 1) for dy in (-1, 0, 1) if dx or dy]


@dataclass(frozen=True, eq=False)
class Ways:
    """Every cell's way to one goal: metres, each divided by P(free) there, and where the way leads.

    space: the table. distance: [I + 2 margin, J + 2 margin], metres over P(free). ahead: x, y of the place some
    cells further on the way, metres [..., 2].
    """

    space: FreeSpace
    distance: FloatArray
    ahead: FloatArray

    def length(self, x: Any, y: Any) -> FloatArray:
        """Return the metres from points [m] to the goal [...]: by way of the best of nine cells around each."""
        best = np.full(np.shape(x), np.inf)
        columns, rows = self.space.indices(x, y, margin=_MARGIN)
        for dx, dy in [(0, 0), *_EIGHT]:
            column = np.clip(columns + dx, 0, self.distance.shape[0] - 1)
            row = np.clip(rows + dy, 0, self.distance.shape[1] - 1)
            gap = np.hypot(
                (column + self.space.origin[0] - _MARGIN) * self.space.cell - x,
                (row + self.space.origin[1] - _MARGIN) * self.space.cell - y,
            )
            best = np.minimum(best, self.distance[column, row] + gap)
        return best

    def waypoint(self, x: float, y: float) -> tuple[float, float]:
        """Return the place [m] some cells further on the way from a point."""
        ahead_x, ahead_y = self.ahead[self.space.indices(x, y, margin=_MARGIN)].tolist()
        return ahead_x, ahead_y

    def direction(self, x: Any, y: Any) -> FloatArray:
        """Return where the way from points [m] leads, radians counter-clockwise in the table's frame [...]."""
        ahead = self.ahead[self.space.indices(x, y, margin=_MARGIN)]
        bearing: FloatArray = np.arctan2(ahead[..., 1] - y, ahead[..., 0] - x)
        return bearing


class WayFinder:
    """Finds ways over one table, by Dijkstra's algorithm over eight neighbours.

    A step between two cells costs its length over the smaller P(free) of the two, a diagonal one over the smallest of
    all four cells that it touches. The ways to goals that were asked before are kept.
    """

    def __init__(self, space: FreeSpace) -> None:
        self.space = space
        self._graph = _graph(space)
        self._known: dict[int, Ways] = {}

    def to(self, x: float, y: float) -> Ways:
        """Return the ways to the cell of (x, y) [m]."""
        goal = int(np.ravel_multi_index(self.space.indices(x, y, margin=_MARGIN), _shape(self.space)))
        if goal not in self._known:
            if len(self._known) >= _KEPT:
                self._known.clear()
            self._known[goal] = self._find(goal)
        return self._known[goal]

    def _find(self, goal: int) -> Ways:
        from scipy.sparse.csgraph import dijkstra

        space, shape = self.space, _shape(self.space)
        distance, before = dijkstra(self._graph, directed=False, indices=goal, return_predecessors=True)
        before[goal] = goal
        further = before
        for _ in range(_AHEAD - 1):
            further = before[further]
        columns, rows = np.unravel_index(further, shape)
        places = np.stack([columns + space.origin[0] - _MARGIN, rows + space.origin[1] - _MARGIN], axis=-1) * space.cell
        return Ways(space, distance.reshape(shape), places.reshape(*shape, 2))


def _shape(space: FreeSpace) -> tuple[int, int]:
    columns, rows = space.visits.shape
    return columns + 2 * _MARGIN, rows + 2 * _MARGIN


def _graph(space: FreeSpace) -> Any:
    """The cells and the costs of the steps between neighbours, a sparse matrix [N, N]."""
    from scipy.sparse import coo_array

    shape = _shape(space)
    column, row = np.meshgrid(*(np.arange(size) for size in shape), indexing="ij")
    xy = (column + space.origin[0] - _MARGIN) * space.cell, (row + space.origin[1] - _MARGIN) * space.cell
    chance, number = space.at(*xy), np.arange(column.size).reshape(shape)
    parts: list[tuple[NDArray[Any], ...]] = []
    for dx, dy in ((1, 0), (0, 1), (1, 1), (1, -1)):
        here = slice(None, -dx or None), slice(max(0, -dy), -dy if dy > 0 else None)
        there = slice(dx, None), slice(max(0, dy), dy if dy < 0 else None)
        least = np.minimum(chance[here], chance[there])
        if dx and dy:
            least = np.minimum(least, np.minimum(chance[here[0], there[1]], chance[there[0], here[1]]))
        parts.append((number[here].ravel(), number[there].ravel(), (space.cell * np.hypot(dx, dy) / least).ravel()))
    one, other, cost = (np.concatenate(part) for part in zip(*parts, strict=True))
    return coo_array((cost, (one, other)), shape=(column.size, column.size)).tocsr()
