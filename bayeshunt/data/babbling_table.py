"""The babbling table: what it must hold, how it is checked, stored and turned into bin indices.

One row is one executed gait and where it took the robot, in the robot's own earlier frame:
``gait`` (name), ``distance`` [m], ``angle`` and ``heading`` [rad, clockwise]. Optional columns:
``step`` (order of execution), ``previous_gait``, and ``path_NN_forward`` [m], ``path_NN_right`` [m],
``path_NN_heading`` [rad clockwise], the pose part-way through the gait at NN of N equal intervals.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.checks import FULL_TURN
from bayeshunt.core.errors import DataError
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.files import parquet
from bayeshunt.files.atomic import check_source

__all__ = [
    "COLUMNS",
    "PROVENANCE_KEY",
    "Batches",
    "discretise",
    "gait_codes",
    "load",
    "path_column_names",
    "path_columns",
    "positions",
    "save",
    "to_arrow",
    "validate",
]

#: The columns every babbling table has.
COLUMNS = ("gait", "distance", "angle", "heading")
#: Key of the provenance record in the Parquet file's metadata and in ``frame.attrs``.
PROVENANCE_KEY = parquet.PROVENANCE_KEY

_WHAT = "a babbling table"
_MAKER = "bayeshunt babble"
_MEND = f"give a table made by: {_MAKER}"

_PATH_COLUMN = re.compile(r"path_(\d+)_(forward|right|heading)$")


def validate(
    frame: pd.DataFrame, gaits: Iterable[str] | None = None, *, source: str = "table", first_row: int = 0
) -> None:
    """Raise DataError unless ``frame`` is a babbling table.

    gaits: the names that may stand in the gait column; None allows any.
    source: what the message calls the table, usually its file name.
    first_row: what it calls the first row, for a part of a larger table.
    """
    if not isinstance(frame, pd.DataFrame):
        raise DataError(f"{source}: expected a pandas DataFrame, got {type(frame).__name__}")
    missing = [c for c in COLUMNS if c not in frame.columns]
    if missing:
        raise DataError(f"{source}: column {missing[0]!r} is missing; a babbling table needs {', '.join(COLUMNS)}")
    part_way = path_columns(frame.columns)
    _check_columns(frame.columns, part_way, source)
    if frame.empty:
        raise DataError(f"{source}: the table has no rows; babble at least one step")
    numeric = [*COLUMNS[1:], *part_way]
    for column in numeric:
        _check_numbers(frame[column], column, source, first_row)
    row = _first(frame["distance"].to_numpy(dtype=float) < 0)
    if row is not None:
        raise DataError(
            f"{source}: row {first_row + row}: distance is {frame['distance'].iloc[row]}; expected metres >= 0"
        )
    for column in ("angle", "heading"):
        _check_radians(frame[column], column, source, first_row)
    _check_gaits(frame["gait"], gaits, source, first_row)


def path_columns(columns: Iterable[str]) -> list[str]:
    """Return the names of the part-way pose columns, ordered by interval: forward, right, heading."""
    found = {c: m for c in columns if (m := _PATH_COLUMN.match(str(c)))}
    order = {"forward": 0, "right": 1, "heading": 2}
    return sorted(found, key=lambda c: (int(found[c].group(1)), order[found[c].group(2)]))


def path_column_names(points: int) -> list[str]:
    """Return the part-way pose columns of ``points`` intermediate poses, in table order."""
    return [f"path_{i:02d}_{part}" for i in range(1, points + 1) for part in ("forward", "right", "heading")]


def discretise(frame: pd.DataFrame, gaits: GaitRepertoire, axes: EffectAxes) -> np.ndarray:
    """Return int64 indices [N, 4] of (gait, Distance, Angle, Heading) for every row.

    Distance indices may lie beyond the axis: the grid is open-ended.
    Raises DataError for a gait that is not in the repertoire.
    """
    indices = np.empty((4, len(frame)), dtype=np.int64)  # a variable after the other: they are used one at a time
    indices[0] = gait_codes(frame["gait"], gaits)
    for row, axis in enumerate(axes, start=1):
        indices[row] = axis.index(frame[axis.name.lower()].to_numpy(dtype=float))
    return indices.T


def gait_codes(values: pd.Series, gaits: GaitRepertoire, *, first_row: int = 0) -> np.ndarray:
    """Return the int64 index [N] of each gait name of a babbling table in the repertoire.

    Raises DataError for a name that is not there; first_row: what the message calls the first row.
    """
    codes = positions(values, gaits.names).astype(np.int64, copy=False)
    if codes.min(initial=0) < 0:
        _check_gaits(values, gaits.names, "table", first_row)
    return codes


def positions(values: pd.Series, names: Sequence[str]) -> np.ndarray:
    """Return the integer position [N] of each value among ``names`` (no two alike); -1 if it is not there.

    Names are compared once for each category or distinct value, or inside Arrow: never row by row in Python.
    """
    if getattr(values.dtype, "storage", None) == "pyarrow":
        import pyarrow as pa
        import pyarrow.compute as pc

        texts = pa.array(values.array)
        found = pc.index_in(texts, value_set=pa.array(names, type=texts.type))
        codes: np.ndarray = (found.fill_null(-1) if found.null_count else found).to_numpy()
        return codes
    index = pd.Index(np.array(names, dtype=object))
    if isinstance(values.dtype, pd.CategoricalDtype):
        stored = pd.Categorical(values)
        if list(stored.categories) == list(names):
            return np.asarray(stored.codes)
        places, distinct = np.asarray(stored.codes), stored.categories
    else:
        places, distinct = pd.factorize(values)
    found_at: np.ndarray = np.append(index.get_indexer(distinct), -1)[places]
    return found_at


def save(frame: pd.DataFrame, path: str | os.PathLike[str], provenance: dict[str, Any] | None = None) -> None:
    """Write a babbling table as Parquet with its provenance inside; the file is replaced atomically.

    provenance: settings, seed and versions; by default ``frame.attrs["bayeshunt"]``.
    """
    record = provenance if provenance is not None else frame.attrs.get(PROVENANCE_KEY, {})
    parquet.write(to_arrow(frame), record, path)


def to_arrow(frame: pd.DataFrame) -> Any:
    """Return a babbling table as the Arrow table that its file holds."""
    import pyarrow as pa

    plain = frame.copy(deep=False)
    plain.attrs = {}
    return pa.Table.from_pandas(plain, preserve_index=False).replace_schema_metadata(None)


def load(path: str | os.PathLike[str]) -> pd.DataFrame:
    """Read and validate a babbling table written by :func:`save`; provenance in ``frame.attrs``.

    Raises DataError if the file is missing, is not Parquet, is damaged or is not a babbling table.
    """
    check_source(path, _MAKER, DataError)
    name = os.fspath(path)
    table, record = parquet.read(path, what=_WHAT, mend=_MEND)
    frame: pd.DataFrame = table.to_pandas()
    validate(frame, source=name)
    frame.attrs[PROVENANCE_KEY] = record or {}
    return frame


class Batches:
    """A babbling table of any size, read and validated 100,000 rows at a time.

    name: the path as given. rows: number of rows in the file. provenance: its record, {} if it has none.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        """Open the file; raises DataError if it is missing, is not Parquet or is damaged."""
        check_source(path, _MAKER, DataError)
        self.name = os.fspath(path)
        self._reader = parquet.Reader(path, what=_WHAT, mend=_MEND)
        self.rows: int = self._reader.rows
        self.provenance: dict[str, Any] = self._reader.record or {}

    def of(self, gaits: Iterable[str] | None = None) -> Iterator[pd.DataFrame]:
        """Yield babbling tables with the file's provenance.

        gaits: the names that may stand in the gait column; None allows any.
        Raises DataError that names the row of the file.
        """
        first = 0
        for table in self._reader:
            frame = table.to_pandas()
            validate(frame, gaits, source=self.name, first_row=first)
            frame.attrs[PROVENANCE_KEY] = self.provenance
            first += len(frame)
            yield frame
        if not first:
            raise DataError(f"{self.name}: the table has no rows; babble at least one step")


def _check_columns(columns: pd.Index, part_way: list[str], source: str) -> None:
    """Raise DataError for a name that stands twice, or if a pose part-way through a gait is incomplete."""
    repeated = columns[columns.duplicated()]
    if len(repeated):
        raise DataError(f"{source}: column {repeated[0]!r} stands twice; names must be unique")
    # They are told apart by order alone: one that is missing would shift all that follow.
    missing = [name for name in path_column_names(-(-len(part_way) // 3)) if name not in part_way]
    if missing:
        raise DataError(
            f"{source}: column {missing[0]!r} is missing; part-way poses need forward, right and heading "
            "of every interval from 01 on"
        )


def _check_numbers(values: pd.Series, column: str, source: str, first_row: int) -> None:
    try:
        numbers = values.to_numpy(dtype=float, na_value=np.nan)
    except (TypeError, ValueError):
        raise DataError(f"{source}: column {column!r} holds {values.dtype}; expected numbers") from None
    row = _first(~np.isfinite(numbers))
    if row is not None:
        raise DataError(f"{source}: row {first_row + row}: {column} is {values.iloc[row]}; expected a finite number")


def _check_radians(values: pd.Series, column: str, source: str, first_row: int) -> None:
    numbers = values.to_numpy(dtype=float)
    row = _first(np.abs(numbers) > 2 * FULL_TURN)  # not wrapped yet is fine; degrees go far beyond
    if row is not None:
        raise DataError(
            f"{source}: row {first_row + row}: {column} is {numbers[row]:g}; expected radians from -4 pi to 4 pi; "
            f"if the column is in degrees, convert it: numpy.radians(frame[{column!r}])"
        )


def _check_gaits(values: pd.Series, gaits: Iterable[str] | None, source: str, first_row: int) -> None:
    row = _first(values.isna().to_numpy())
    if row is not None:
        raise DataError(f"{source}: row {first_row + row}: gait is empty; expected a gait name")
    if gaits is None:
        return
    known = list(gaits)
    row = _first(~values.isin(known).to_numpy())
    if row is not None:
        stranger = values.iloc[row]
        raise DataError(
            f"{source}: row {first_row + row}: gait {stranger!r} is not in the repertoire; "
            f"expected one of {', '.join(known)}"
        )


def _first(flags: np.ndarray) -> int | None:
    """Index of the first True, or None."""
    hits = np.flatnonzero(flags)
    return int(hits[0]) if hits.size else None
