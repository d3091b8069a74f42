"""Sufficient statistics of a babbling table: exact integers, so order and splits never matter.

Letters: G gaits, K counted cells, P intermediate poses per gait (0 without path columns).
Everything is held in whole numbers: cell counts, and sums of poses in fixed point (nanometres for
displacements, 1e-9 for the cosine and sine of headings). Integer addition is associative, therefore
any order, any split and any merging of the same rows gives the same bits.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.bins import EFFECTS, ENERGY, EffectAxes
from bayeshunt.core.errors import DataError, InputError, ZeroCountError
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.core.geometry import wrap
from bayeshunt.models.counting.cells import MAX_DISTANCE_BINS, CountedCells
from bayeshunt.models.counting.energy import add_up, count_energy, energy_reached, nothing, tally_energy
from bayeshunt.models.counting.tally import SCALE, tally_rows

__all__ = ["JointCounts"]

_COUNTED = ("cells", "counts", "sums", "energy", "spent")


@dataclass(frozen=True, eq=False)
class JointCounts:
    """How often each (gait, Distance, Angle, Heading) cell was seen, and summed poses of each gait.

    gaits: the repertoire; its order is the order of the gait indices.
    axes: the effect axes; the distance axis reaches at least as far as the counted cells.
    cells: int64 [K, 4], bin indices of (gait, Distance, Angle, Heading), sorted and unique.
    counts: int64 [K], rows seen in each cell, >= 1.
    sums: int64 [G, P + 1, 4], per gait and pose (P part-way poses, then the final one) the sum of
        forward [nm], right [nm], cos(heading) [1e-9] and sin(heading) [1e-9].
    energy: int64 [G + 1, G, 3], what gaits cost by gait before and gait, see ``models.counting.energy``; of rows that
        do not say it, of shape [0, 0, 3].
    spent: int64 [E, G], rows in each bin of Energy by gait; [0, 0] where Energy is no node.
    """

    gaits: GaitRepertoire
    axes: EffectAxes
    cells: np.ndarray
    counts: np.ndarray
    sums: np.ndarray
    energy: np.ndarray = field(default_factory=nothing)
    spent: np.ndarray = field(default_factory=lambda: np.zeros((0, 0), dtype=np.int64))

    def __post_init__(self) -> None:
        if (axis := self.axes.energy) is not None:
            wide = np.zeros((axis.bins, len(self.gaits)), dtype=np.int64)
            wide[: len(self.spent)] = self.spent if len(self.spent) else 0
            object.__setattr__(self, "spent", wide)
        for name in _COUNTED:
            array = np.array(getattr(self, name), dtype=np.int64)
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @classmethod
    def empty(cls, gaits: GaitRepertoire, axes: EffectAxes) -> JointCounts:
        """Nothing counted yet."""
        return cls(gaits, axes, np.zeros((0, 4)), np.zeros(0), np.zeros((len(gaits), 1, 4)))

    @classmethod
    def of(cls, frame: pd.DataFrame, gaits: GaitRepertoire, axes: EffectAxes) -> JointCounts:
        """Count a validated babbling table; the distance axis grows to the farthest row.

        Raises DataError if a row lies absurdly far out (more than MAX_DISTANCE_BINS bins).
        """
        energy_bins = 1 if axes.energy is None else energy_reached(frame, axes.energy)
        axes = axes.extended(_bins_reached(frame, axes), energy_bins)
        counted = (*tally_rows(frame, gaits, axes), tally_energy(frame, gaits))
        if axes.energy is None:
            return cls(gaits, axes, *counted)
        return cls(gaits, axes, *counted, count_energy(frame, gaits, axes.energy))

    def merge(self, other: JointCounts) -> JointCounts:
        """Return the counts of both; equal, bit for bit, to counting all rows at once.

        Raises InputError if the gaits or bins differ, DataError if only one side has path columns
        or if the exact sums would overflow (not below 4e9 rows).
        """
        _check_same_grid(self, other)
        if np.abs(self.sums).max() + np.abs(other.sums).max() >= 1 << 62:
            raise DataError("too many rows, or rows too far away, for exact sums")
        if not (self.total and other.total):
            sums = other.sums if other.total else self.sums
        elif self.sums.shape != other.sums.shape:
            raise DataError(
                f"cannot join rows with {self.points} and with {other.points} part-way poses per gait; "
                "babble both with the same number of path points"
            )
        else:
            sums = self.sums + other.sums
        axes = self.axes.covering(other.axes)
        spent = self.spent
        if axes.energy is not None:
            one, two = (replace(part, axes=axes).spent for part in (self, other))
            spent = one + two
        cells, counts = _add_up(np.concatenate([self.cells, other.cells]), np.concatenate([self.counts, other.counts]))
        return JointCounts(self.gaits, axes, cells, counts, sums, add_up(self.energy, other.energy), spent)

    @property
    def total(self) -> int:
        """Number of rows counted."""
        return int(self.counts.sum())

    @property
    def points(self) -> int:
        """Number of part-way poses per gait, P."""
        return int(self.sums.shape[1]) - 1

    def marginal(self, variable: str) -> np.ndarray:
        """Return int64 counts [K, G] of an effect variable's bins by gait, or [G] for "Gait"."""
        if variable == "Gait":
            return self._tabulate(self.cells[:, 0], (len(self.gaits),))
        if variable == ENERGY:
            return self.spent
        axis = self.axes[variable]
        column = 1 + EFFECTS.index(variable)
        shape = (axis.bins, len(self.gaits))
        return self._tabulate(self.cells[:, column] * shape[1] + self.cells[:, 0], shape)

    @cached_property
    def support(self) -> np.ndarray:
        """Return int64 counts [D, A]: rows seen at each (Distance, Angle) cell, whatever the gait."""
        shape = self.axes.shape[:2]
        support = self._tabulate(self.cells[:, 1] * shape[1] + self.cells[:, 2], shape)
        support.setflags(write=False)
        return support

    @property
    def table(self) -> CountedCells:
        """The cells over (Gait, Distance, Angle, Heading), for tables of any structure."""
        return CountedCells(("Gait", *EFFECTS), (len(self.gaits), *self.axes.shape), self.cells, self.counts)

    def mean_poses(self, gait: int) -> np.ndarray:
        """Return float64 [P + 1, 3] of one gait: mean forward, right [m], circular mean heading [rad].

        Raises ZeroCountError if the gait has no rows: there is nothing to take a mean of.
        """
        rows = int(self.marginal("Gait")[gait])
        if not rows:
            raise ZeroCountError(f"gait {self.gaits.names[gait]!r} has no rows, so no mean pose; babble it")
        forward, right, cosine, sine = self.sums[gait].T
        headings = np.arctan2(sine, cosine)
        return np.column_stack([forward / (SCALE * rows), right / (SCALE * rows), wrap(headings)])

    def heading_spread(self, gait: int) -> float:
        """Return the circular standard deviation of one gait's final heading, ``sqrt(-2 ln R)`` [rad].

        From the exact sums, R being the length of the mean of (cosine, sine). Raises ZeroCountError
        if the gait has no rows.
        """
        rows = int(self.marginal("Gait")[gait])
        if not rows:
            raise ZeroCountError(f"gait {self.gaits.names[gait]!r} has no rows, so no heading; babble it")
        resultant = math.hypot(*self.sums[gait, -1, 2:].tolist()) / (SCALE * rows)
        return math.sqrt(-2.0 * math.log(min(max(resultant, 1e-12), 1.0)))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, JointCounts):
            return NotImplemented
        return (
            self.gaits == other.gaits
            and self.axes == other.axes
            and all(np.array_equal(getattr(self, n), getattr(other, n)) for n in _COUNTED)
        )

    def __hash__(self) -> int:
        return hash((self.gaits, self.axes, self.cells.tobytes(), self.counts.tobytes()))

    def __reduce__(self) -> tuple[Any, ...]:
        # Through the constructor, so that arrays sent to another process are read-only there too.
        return JointCounts, (self.gaits, self.axes, self.cells, self.counts, self.sums, self.energy, self.spent)

    def _tabulate(self, flat: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
        table = np.zeros(int(np.prod(shape)), dtype=np.int64)
        np.add.at(table, flat, self.counts)
        return table.reshape(shape)


def _bins_reached(frame: pd.DataFrame, axes: EffectAxes) -> int:
    """Number of distance bins up to the farthest row."""
    distances = frame["distance"].to_numpy(dtype=float)
    row = int(distances.argmax())
    limit = MAX_DISTANCE_BINS * axes.distance.width
    if not distances[row] < limit:
        raise DataError(f"row {row}: distance is {distances[row]} m; the distance grid ends at {limit:g} m")
    if distances.min() < 0:
        raise DataError(f"row {int(distances.argmin())}: distance is {distances.min()}; expected metres >= 0")
    return int(axes.distance.index(float(distances[row]))) + 1


def _check_same_grid(one: JointCounts, other: JointCounts) -> None:
    if one.gaits.names != other.gaits.names:
        raise InputError("cannot join counts of different gaits")
    if one.axes.covering(other.axes) != other.axes.covering(one.axes):
        raise InputError("cannot join counts made with different bins")


def _add_up(cells: np.ndarray, counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return sorted unique cells [K, 4] and the summed counts [K] of cells that occur twice."""
    if not len(cells):
        return cells, counts
    order = np.lexsort(cells.T[::-1])
    cells, counts = cells[order], counts[order]
    first = np.r_[True, np.any(cells[1:] != cells[:-1], axis=1)]
    return cells[first], np.add.reduceat(counts, np.flatnonzero(first))
