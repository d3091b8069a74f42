"""Counting babbling tables that need not fit into memory: bounded memory, any order, any split.

What a fit needs of the rows is their counts (sufficient statistics), and counts of parts add up
exactly; so files are read 100,000 rows at a time and only the counts are kept.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from typing import Any

import pandas as pd

from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.errors import InputError
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.data.babbling_table import Batches
from bayeshunt.data.plausibility import warn_implausible
from bayeshunt.models.counting.joint import JointCounts
from bayeshunt.models.counting.measures import measured
from bayeshunt.models.counting.previous import PreviousCounts, counts_for, previous_codes
from bayeshunt.models.tables.structures import Structure

__all__ = ["count_tables", "open_tables", "rows_of"]

#: What a babbling table records of the robot that decides what its rows mean.
_ROBOT = "robot"


def open_tables(paths: Sequence[str | os.PathLike[str]]) -> list[Batches]:
    """Open babbling tables that are to be counted together, without reading their rows.

    Raises DataError for one that cannot be read, InputError if they were made by different robots
    or a file is given twice.
    """
    tables = [Batches(path) for path in paths]
    names = [os.path.realpath(path) for path in paths]
    for path, name in zip(paths, names, strict=True):
        if names.count(name) > 1:
            raise InputError(f"{os.fspath(path)} is given twice; its rows would count twice")
        if tables[names.index(name)].provenance.get(_ROBOT) != tables[0].provenance.get(_ROBOT):
            raise InputError(f"{os.fspath(path)} was made by another robot than {os.fspath(paths[0])}; fit them apart")
    return tables


def count_tables(
    tables: Sequence[Batches],
    gaits: GaitRepertoire,
    *,
    axes: EffectAxes | None = None,
    structure: str | Structure = "naive",
    progress: Callable[[int], None] | None = None,
) -> tuple[JointCounts | PreviousCounts, dict[str, Any]]:
    """Return the counts of all rows, and the provenance ``{"sources": [record of each table]}``.

    Equal, bit for bit, for any order of the tables and any split of the rows. Memory: one batch of
    100,000 rows, and the counted cells. structure: what is to be fitted to them; "previous_gait" takes
    PreviousCounts. progress: called with the number of rows just counted.

    Raises DataError naming the file and the row that is wrong.
    """
    kind: Any = counts_for(structure)
    counts = kind.empty(*measured(gaits, axes, tables[0].provenance if tables else None))
    for table in tables:
        first = 0
        for frame in table.of(gaits.names):
            if kind is PreviousCounts:
                previous_codes(frame, gaits, source=table.name, first_row=first)  # names the file and the row
            if not first:  # one warning a table is enough
                warn_implausible(frame, counts.gaits, counts.axes, source=table.name)
            counts = counts.merge(kind.of(frame, counts.gaits, counts.axes))
            first += len(frame)
            if progress is not None:
                progress(len(frame))
    return counts, _sources(tables)


def rows_of(
    tables: Sequence[Batches], gaits: GaitRepertoire, progress: Callable[[int], None] | None = None
) -> tuple[pd.DataFrame, dict[str, Any]]:
    """Return all rows as one table in memory, for fits that choose bins or a motion, and the provenance as above."""
    parts = []
    for table in tables:
        for frame in table.of(gaits.names):
            parts.append(frame)
            if progress is not None:
                progress(len(frame))
    rows = parts[0] if len(parts) == 1 else pd.concat(parts, ignore_index=True)
    rows.attrs = dict(parts[0].attrs)
    return rows, _sources(tables)


def _sources(tables: Sequence[Batches]) -> dict[str, Any]:
    """The record of each table, in an order of their own: the model file does not depend on the order of the tables."""
    sources = sorted({json.dumps(table.provenance, sort_keys=True) for table in tables if table.provenance})
    return {"sources": [json.loads(text) for text in sources]} if sources else {}
