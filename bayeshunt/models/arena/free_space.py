"""Where the hunter can be: a table of cells that anyone can open, counted while it babbled in the arena.

Cells are squares in the frame in which the hunter started (x ahead, y to the left), one of them centred on its start.
Letters: I columns of cells along x, J along y.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core import displays
from bayeshunt.core.arguments import check_fields, checked
from bayeshunt.core.checks import check_number, check_numbers, check_positive
from bayeshunt.core.errors import DataError, InputError
from bayeshunt.core.geometry import FloatArray
from bayeshunt.models.arena.contacts import Contacts

__all__ = ["FreeSpace"]

#: Side of a cell [body lengths]: a robot crosses some of them in a step, and a gap as wide as it is has two.
CELL = 0.5
#: Beta prior of P(free): as if half a look had been taken, and found the cell free one time in ten.
_FREE, _LOOKS = 0.05, 0.5


@dataclass(frozen=True, eq=False, repr=False)
class FreeSpace(displays.Displayed):
    """Counts of the hunter's centre in cells: how often it was there, how often it was stopped on its way there.

    ``P(free) = (visits + 0.05) / (visits + hits + 0.5)``: what was never visited is taken to be blocked, more or less.
    cell: metres. origin: number of the first column and of the first row; cell (0, 0) is centred on the start.
    visits, hits: whole numbers [I, J].
    """

    cell: float
    origin: tuple[int, int]
    visits: np.ndarray
    hits: np.ndarray

    @classmethod
    def empty(cls, cell: float) -> FreeSpace:
        """Return the table of a hunter that has been nowhere but at its start."""
        return cls(cell, (0, 0), np.ones((1, 1), dtype=np.int64), np.zeros((1, 1), dtype=np.int64))

    @classmethod
    def count(cls, places: FloatArray, contacts: Contacts | None, body: float) -> FreeSpace:
        """Return the table of a way through ``places`` [N, 2] and of what was touched on it.

        A visit is a part-way pose; a hit the cell that lies a cell beyond a touch, towards what was touched.
        body: of the hunter [m]; a cell is half of it.
        """
        cell = CELL * body
        touched = np.zeros((0, 2)) if contacts is None else contacts.places + cell * contacts.towards
        return cls.of(cell, np.vstack([np.zeros((1, 2)), places]), touched)

    @classmethod
    @checked
    def of(cls, cell: float, visited: FloatArray, touched: FloatArray) -> FreeSpace:
        """Return the table with a visit at each point of ``visited`` [N, 2] and a hit at each of ``touched`` [M, 2]."""
        check_positive(cell, "cell", "metres")
        points = [check_numbers(given, name) for name, given in (("visited", visited), ("touched", touched))]
        if any(given.ndim != 2 or given.shape[1] != 2 or not np.isfinite(given).all() for given in points):
            raise InputError("free space: visited and touched: expected finite points [N, 2] in metres")
        numbers = [np.rint(given / cell).astype(int) for given in points]
        low, high = (getattr(np.vstack(numbers), edge)(axis=0) for edge in ("min", "max"))
        tables = []
        for cells in numbers:
            table = np.zeros(tuple(high - low + 1), dtype=np.int64)
            np.add.at(table, tuple((cells - low).T), 1)
            tables.append(table)
        return cls(cell, (int(low[0]), int(low[1])), *tables)

    def __post_init__(self) -> None:
        check_fields(self)
        for name in ("visits", "hits"):
            array = np.array(check_numbers(getattr(self, name), name), dtype=np.int64)
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        if self.visits.ndim != 2 or self.visits.shape != self.hits.shape or not self.cell > 0:
            raise DataError("free space: expected visits and hits in the same cells, of a size above 0")
        if (self.visits < 0).any() or (self.hits < 0).any():
            raise DataError("free space: expected counts of at least 0")

    @property
    def probabilities(self) -> FloatArray:
        """P(free) of every cell [I, J]."""
        chance: FloatArray = (self.visits + _FREE) / (self.visits + self.hits + _LOOKS)
        return chance

    def at(self, x: Any, y: Any) -> FloatArray:
        """Return P(free) at points [m], in the shape of ``x``; what lies outside the table was never looked at."""
        x, y = check_numbers(x, "x"), check_numbers(y, "y")
        padded = np.pad(self.probabilities, 1, constant_values=_FREE / _LOOKS)
        chance: FloatArray = padded[self.indices(x, y, margin=1)]
        return chance

    def visited(self, x: Any, y: Any) -> np.ndarray:
        """Return whether the cells at points [m] were visited: bool in the shape of ``x``."""
        known: np.ndarray = np.pad(self.visits > 0, 1)[self.indices(x, y, margin=1)]
        return known

    def indices(self, x: Any, y: Any, *, margin: int = 0) -> tuple[np.ndarray, np.ndarray]:
        """Return column and row of points [m] in the table with ``margin`` cells around it; beyond it, of its edge."""
        found = []
        for axis, value in enumerate((x, y)):
            number = np.rint(np.asarray(value, dtype=float) / self.cell).astype(int) - self.origin[axis] + margin
            found.append(np.clip(number, 0, self.visits.shape[axis] + 2 * margin - 1))
        return found[0], found[1]

    def table(self, level: float = 0.95) -> pd.DataFrame:
        """Return one row per cell that was visited or hit.

        Columns: x, y (of its middle, metres ahead and to the left of the start), visits, hits, p_free, low, high (the
        Beta credible interval at ``level``).
        """
        from scipy.stats import beta

        if not 0 < check_number(level, "level", "between 0 and 1") < 1:
            raise InputError(f"level must be in (0, 1), got {level}")
        columns, rows = np.nonzero(self.visits + self.hits)
        visits, hits = self.visits[columns, rows], self.hits[columns, rows]
        free, blocked = visits + _FREE, hits + _LOOKS - _FREE
        tail = 0.5 * (1.0 - level)
        return pd.DataFrame(
            {
                "x": (columns + self.origin[0]) * self.cell,
                "y": (rows + self.origin[1]) * self.cell,
                "visits": visits,
                "hits": hits,
                "p_free": free / (free + blocked),
                "low": beta.ppf(tail, free, blocked),
                "high": beta.ppf(1.0 - tail, free, blocked),
            }
        ).rename_axis("Cell")

    def __repr__(self) -> str:
        known, stopped = int((self.visits > 0).sum()), int((self.hits > 0).sum())
        return f"<FreeSpace: {known} cells visited, {stopped} hit, {1000 * self.cell:g} mm>"

    def to_dict(self) -> dict[str, Any]:
        """Return plain values for JSON: the cells that were visited or hit, as [column, row, visits, hits]."""
        columns, rows = np.nonzero(self.visits + self.hits)
        cells = np.column_stack(
            [columns + self.origin[0], rows + self.origin[1], self.visits[columns, rows], self.hits[columns, rows]]
        )
        return {"cell": self.cell, "cells": cells.tolist()}

    @classmethod
    def from_dict(cls, record: Mapping[str, Any]) -> FreeSpace:
        """Rebuild from :meth:`to_dict`; ValueError, KeyError or TypeError if the record is something else."""
        cells = np.array(record["cells"], dtype=np.int64).reshape(-1, 4)
        if not len(cells):
            return cls.empty(float(record["cell"]))
        low = cells[:, :2].min(axis=0)
        tables = np.zeros((2, *(cells[:, :2].max(axis=0) - low + 1)), dtype=np.int64)
        tables[:, cells[:, 0] - low[0], cells[:, 1] - low[1]] = cells[:, 2:].T
        return cls(float(record["cell"]), (int(low[0]), int(low[1])), *tables)
