"""The babbling rows behind a table cell."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.bins import EFFECTS, ENERGY, Axis
from bayeshunt.core.errors import DataError, InputError
from bayeshunt.core.gaits import Gait
from bayeshunt.data import babbling_table
from bayeshunt.models.counting.energy import energy_of
from bayeshunt.models.counting.joint import JointCounts

__all__ = ["CountedRows"]


class CountedRows:
    """The rows that a model has counted, with the cell that each of them fell into.

    frame: the rows [N], in order. cells: int64 [N, 4], bins of (gait, Distance, Angle, Heading).
    recast: gives rows as the model counts them, see ``TableSource.recast``.

    Raises DataError unless the counts of ``frames`` are ``mine``, the model's own.
    """

    def __init__(
        self,
        mine: JointCounts,
        frames: Sequence[pd.DataFrame],
        recast: Callable[[pd.DataFrame], pd.DataFrame] = lambda rows: rows,
    ) -> None:
        self.gaits, self.axes = mine.gaits, mine.axes
        rows, total = sum(map(len, frames)), mine.total
        if not rows:
            raise DataError(
                "the model holds tables, not rows (a model file has none): model.with_data(frame) adds them"
            )
        if rows != total:
            raise DataError(f"the model counted {total} rows, but {rows} are here; give all: model.with_data(frame)")
        # A copy, so that what is shown stays what was counted even if the caller's table changes.
        self.frame = pd.concat(frames, ignore_index=len(frames) > 1).copy()
        babbling_table.validate(self.frame, self.gaits.names)
        as_counted = recast(self.frame)
        counted = JointCounts.of(as_counted, self.gaits, self.axes)
        if not all(np.array_equal(getattr(counted, n), getattr(mine, n)) for n in ("cells", "counts", "spent")):
            raise DataError("these are not the rows that the model counted; give the table that it was fitted to")
        self.cells = babbling_table.discretise(as_counted, self.gaits, self.axes)

    def find(self, variable: str, bin: Any, gait: Gait | str | None) -> pd.DataFrame:
        """Return the rows in one cell; see ``ForwardModel.rows``."""
        if variable == "Gait":
            return self._where(self.cells[:, 0] == self.gaits.index(bin))
        hits = self.bins(variable) == _bin_index(self.axes[variable], bin)
        if gait is not None:
            hits &= self.cells[:, 0] == self.gaits.index(gait)
        return self._where(hits)

    def bins(self, variable: str) -> np.ndarray:
        """Return the bin [N] of an effect that each row fell into."""
        if variable == ENERGY:
            return np.asarray(self.axes[ENERGY].index(energy_of(self.frame)))
        return np.asarray(self.cells[:, 1 + EFFECTS.index(variable)])

    def _where(self, hits: np.ndarray) -> pd.DataFrame:
        found = self.frame[hits].copy()
        found.attrs = {}
        return found


def _bin_index(axis: Axis, bin: Any) -> int:
    """Index of a bin given by label or by number."""
    variable, labels = axis.name, axis.labels
    if isinstance(bin, str):
        if bin not in labels:
            raise InputError(f"{variable} has no bin {bin!r}; its bins are {labels[0]!r} to {labels[-1]!r}")
        return labels.index(bin)
    if isinstance(bin, bool) or not isinstance(bin, (int, np.integer)) or not 0 <= bin < len(labels):
        raise InputError(f"bin {bin!r}: expected a label of {variable}, or a number from 0 to {len(labels) - 1}")
    return int(bin)
