"""The babbling rows behind a table cell."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from bayeshunt.core.bins import EFFECTS
from bayeshunt.core.errors import DataError, InputError
from bayeshunt.core.gaits import Gait
from bayeshunt.data import babbling_table
from bayeshunt.models.counting.joint import JointCounts

if TYPE_CHECKING:
    from bayeshunt.models.body.forward import ForwardModel
    from bayeshunt.models.body.opening import OpenTables


class CountedRows:
    """The rows that a model has counted, with the cell that each of them fell into.

    frame: the rows [N], in order. cells: int64 [N, 4], bins of (gait, Distance, Angle, Heading).

    Raises DataError unless the counts of ``frames`` are the model's own.
    """

    def __init__(self, model: ForwardModel, frames: tuple[pd.DataFrame, ...]) -> None:
        rows, total = sum(map(len, frames)), model.joint.total
        if not rows:
            raise DataError(
                "the model holds tables, not rows (a model file has none): model.with_data(frame) adds them"
            )
        if rows != total:
            raise DataError(f"the model counted {total} rows, but {rows} are here; give all: model.with_data(frame)")
        # A copy, so that what is shown stays what was counted even if the caller's table changes.
        self.frame = pd.concat(frames, ignore_index=len(frames) > 1).copy()
        babbling_table.validate(self.frame, model.gaits.names)
        counted = JointCounts.of(self.frame, model.gaits, model.axes)
        mine = model.joint
        if not (np.array_equal(counted.cells, mine.cells) and np.array_equal(counted.counts, mine.counts)):
            raise DataError("these are not the rows that the model counted; give the table that it was fitted to")
        self.cells = babbling_table.discretise(self.frame, model.gaits, model.axes)

    def find(self, model: OpenTables, variable: str, bin: Any, gait: Gait | str | None) -> pd.DataFrame:
        """Return the rows in one cell; see ``ForwardModel.rows``."""
        if variable == "Gait":
            return self._where(self.cells[:, 0] == model.gaits.index(bin))
        hits = self.cells[:, 1 + EFFECTS.index(variable)] == _bin_index(model, variable, bin)
        if gait is not None:
            hits &= self.cells[:, 0] == model.gaits.index(gait)
        return self._where(hits)

    def _where(self, hits: np.ndarray) -> pd.DataFrame:
        found = self.frame[hits].copy()
        found.attrs = {}
        return found


def _bin_index(model: OpenTables, variable: str, bin: Any) -> int:
    """Index of a bin given by label or by number."""
    labels = model.axes[variable].labels
    if isinstance(bin, str):
        if bin not in labels:
            raise InputError(f"{variable} has no bin {bin!r}; its bins are {labels[0]!r} to {labels[-1]!r}")
        return labels.index(bin)
    if isinstance(bin, bool) or not isinstance(bin, (int, np.integer)) or not 0 <= bin < len(labels):
        raise InputError(f"bin {bin!r}: expected a label of {variable}, or a number from 0 to {len(labels) - 1}")
    return int(bin)
