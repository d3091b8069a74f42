"""From a row to the table cells that count it, and to the model that never saw it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.bins import EFFECTS, ENERGY
from bayeshunt.core.errors import InputError, shown
from bayeshunt.models.body.rows import CountedRows
from bayeshunt.models.counting.previous import previous_codes
from bayeshunt.models.tables.sources import TableSource
from bayeshunt.models.tables.structures import PREVIOUS, depends_on_previous

__all__ = ["cells_of_row", "remaining"]


def remaining(counted: CountedRows, rows: Any) -> pd.DataFrame:
    """Return the rows that a model has counted, but for ``rows``: a frame of some of them, or their index labels.

    Raises InputError for labels that are not the table's, or a frame whose rows are others than the table's.
    """
    frame = counted.frame
    labels = _labels(rows)
    if not frame.index.is_unique:
        raise InputError("the table's index labels are not unique, so they name no rows; reset its index and fit again")
    if unknown := [label for label in labels if label not in frame.index]:
        raise InputError(f"the model counted no row {shown(unknown[0])}; its labels are those of model.rows")
    if isinstance(rows, pd.DataFrame):
        columns = [c for c in ("gait", "distance", "angle", "heading") if c in rows]
        if not rows[columns].equals(frame.loc[labels, columns]):
            raise InputError("these are other rows than those of these labels that the model counted")
    return frame.drop(index=labels)


def cells_of_row(source: TableSource, counted: CountedRows, row: Any) -> pd.DataFrame:
    """Return the table cells that count one row; see ``ForwardModel.uses``."""
    labels = _labels(row if isinstance(row, pd.DataFrame) else [row.name if isinstance(row, pd.Series) else row])
    if len(labels) != 1:
        raise InputError(f"row: expected one row or its label, got {len(labels)}")
    at = np.flatnonzero(counted.frame.index == labels[0])
    if len(at) != 1:
        raise InputError(f"the model counted {len(at) or 'no'} rows {shown(labels[0])}; its labels are of model.rows")
    bins = dict(zip(("Gait", *EFFECTS), counted.cells[at[0]].tolist(), strict=True))
    if source.structure.has_energy:
        bins[ENERGY] = int(counted.bins(ENERGY)[at[0]])
    if depends_on_previous(source.structure):
        bins[PREVIOUS] = int(previous_codes(counted.frame.iloc[at], source.gaits)[0])
    tables = source.local
    return pd.DataFrame([_cell(source, name, bins, tables[name]) for name in tables])


def _cell(source: TableSource, name: str, bins: dict[str, int], table: np.ndarray) -> dict[str, Any]:
    parents = source.structure.parents(name)
    at = tuple(bins[v] for v in (name, *parents))
    return {
        "variable": name,
        "state": source.states[name][bins[name]],
        "given": ", ".join(f"{p} = {source.states[p][bins[p]]}" for p in parents),
        "count": int(source.counts_of(name)[at]),
        "probability": float(table[at]),
    }


def _labels(rows: Any) -> list[Any]:
    if isinstance(rows, pd.DataFrame):
        return list(rows.index)
    if isinstance(rows, (str, bytes)) or not isinstance(rows, Iterable):
        return [rows]
    return list(rows)
