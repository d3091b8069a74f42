"""Counted cells of several discrete variables: what every table of a Bayesian network is made of.

Letters: V variables, K counted cells, N rows, S states of one variable.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

__all__ = [
    "MAX_DISTANCE_BINS",
    "MAX_TABLE_CELLS",
    "CountedCells",
    "conditional",
    "count_numbers",
    "log_likelihood",
    "mutual_information",
    "number_cells",
    "parameters",
]

#: The open-ended distance grid stops here: one absurd row must not ask for gigabytes of table.
MAX_DISTANCE_BINS = 100_000
#: Tables larger than this (128 MB of probabilities) are refused rather than allocated.
MAX_TABLE_CELLS = 1 << 24
#: A dense tally (64 MB at most) is faster than sorting the rows, unless they are few among many cells.
_DENSE_CELLS, _DENSE_CELLS_PER_ROW = 1 << 23, 16


@dataclass(frozen=True, eq=False)
class CountedCells:
    """How often each combination of states was seen.

    names: the variables. sizes: number of states of each.
    cells: int64 [K, V], state indices. counts: int64 [K], rows seen in each cell.
    """

    names: tuple[str, ...]
    sizes: tuple[int, ...]
    cells: np.ndarray
    counts: np.ndarray

    @classmethod
    def of_rows(cls, names: Sequence[str], sizes: Sequence[int], rows: np.ndarray) -> CountedCells:
        """Count the rows [N, V] of state indices; cells come out sorted."""
        return cls.of_columns(names, sizes, rows.T)

    @classmethod
    def of_columns(cls, names: Sequence[str], sizes: Sequence[int], columns: Iterable[np.ndarray]) -> CountedCells:
        """Count rows given as the state indices [N] of each variable; ValueError for one outside its states."""
        shape = tuple(int(s) for s in sizes)
        return cls(tuple(names), shape, *count_numbers(number_cells(columns, shape), shape))

    @property
    def total(self) -> int:
        """Number of rows counted, N."""
        return int(self.counts.sum())

    def size(self, name: str) -> int:
        """Number of states of a variable."""
        return self.sizes[self.names.index(name)]

    def indices(self, names: Sequence[str]) -> tuple[np.ndarray, ...]:
        """State indices [K] of the variables asked for: they index a table over those variables."""
        return tuple(self.cells[:, self.names.index(name)] for name in names)

    def tabulate(self, names: Sequence[str]) -> np.ndarray:
        """Return int64 counts over ``names``, one axis per variable; no name gives the total."""
        table = np.zeros([self.size(name) for name in names], dtype=np.int64)
        np.add.at(table, self.indices(names), self.counts)
        return table


def number_cells(columns: Iterable[np.ndarray], shape: Sequence[int]) -> np.ndarray:
    """Return int64 [N], a row's cell as its position in a flat table of ``shape``.

    columns: state indices [N] of each variable, any whole type; ValueError for one outside its states.
    As ``numpy.ravel_multi_index``, in half the time.
    """
    numbers: np.ndarray | None = None
    for column, size in zip(columns, shape, strict=True):
        if column.size and not (column.min() >= 0 and column.max() < size):
            raise ValueError(f"state indices from {column.min()} to {column.max()}; expected 0 to {size - 1}")
        if numbers is None:
            numbers = column.astype(np.int64)
        else:
            numbers *= size
            numbers += column
    return np.zeros(0, dtype=np.int64) if numbers is None else numbers


def count_numbers(numbers: np.ndarray, shape: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Return the cells [K, V] that occur, sorted, and how often each does [K].

    numbers: [N], see :func:`number_cells`: one number per row is counted an order of magnitude faster than a row.
    """
    if np.prod(shape, dtype=float) <= min(_DENSE_CELLS, _DENSE_CELLS_PER_ROW * len(numbers)):
        dense = np.bincount(numbers)
        keys = np.flatnonzero(dense)
        counts = dense[keys]
    else:
        keys, counts = np.unique(numbers, return_counts=True)
    return np.column_stack(np.unravel_index(keys, shape)), counts


def conditional(counts: np.ndarray, prior: float) -> np.ndarray:
    """Return P(child | parents), child axis first, of ``counts`` [S, ...parents].

    ``P[s, u] = (N[s, u] + a) / (N[u] + S a)`` with ``a = prior`` per cell. With ``a = 0`` a column
    whose parents were never seen together holds zeros: nothing is known there, and nothing is claimed.
    """
    weights = counts + float(prior)
    totals = weights.sum(axis=0, keepdims=True)
    found: np.ndarray = np.divide(weights, totals, out=np.zeros_like(weights), where=totals > 0)
    return found


def log_likelihood(counts: np.ndarray) -> float:
    """Return the maximised log-likelihood [nat] of ``counts`` [S, ...parents]: sum of N log(N / N_parents)."""
    totals = np.broadcast_to(counts.sum(axis=0, keepdims=True), counts.shape)
    seen = counts > 0
    return float(np.sum(counts[seen] * np.log(counts[seen] / totals[seen])))


def parameters(counts: np.ndarray) -> int:
    """Number of free probabilities of a table [S, ...parents]: (S - 1) for each combination of parents."""
    found: int = (counts.shape[0] - 1) * int(np.prod(counts.shape[1:]))
    return found


def mutual_information(counts: np.ndarray) -> float:
    """Return I(X; Y | Z) [nat] of the empirical distribution in ``counts`` [X, Y, Z]."""
    x = counts.sum(axis=1, keepdims=True)
    y = counts.sum(axis=0, keepdims=True)
    z = x.sum(axis=0, keepdims=True)
    seen = counts > 0
    ratio = (counts * z)[seen] / (x * y)[seen]
    return float(np.sum(counts[seen] * np.log(ratio)) / counts.sum())
