"""The babbling table: what it must hold, how it is checked, stored and turned into bin indices.

One row is one executed gait and where it took the robot, in the robot's own earlier frame:
``gait`` (name), ``distance`` [m], ``angle`` and ``heading`` [rad, clockwise]. Optional columns:
``step`` (order of execution), ``previous_gait``, ``energy`` [J], and ``path_NN_forward`` [m], ``path_NN_right`` [m],
``path_NN_heading`` [rad clockwise], the pose part-way through the gait at NN of N equal intervals.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.arguments import checked
from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.errors import DataError
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.data.gait_labels import positions, stored
from bayeshunt.data.validating import COLUMNS, check_gaits, path_column_names, path_columns, validate
from bayeshunt.files import parquet
from bayeshunt.files.atomic import check_source
from bayeshunt.files.endings import check_ending
from bayeshunt.files.records import plain_record

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
    "save_dataset",
    "to_arrow",
    "validate",
]

#: Key of the provenance record in the Parquet file's metadata and in ``frame.attrs``.
PROVENANCE_KEY = parquet.PROVENANCE_KEY

#: How a file may store its numbers; others (categories, decimals) are written as the first.
_PLAIN = ("float64", "float32", "float16", *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)))

_WHAT = "a babbling table"
_MAKER = "bayeshunt babble"
_FIX = f"give a table made by: {_MAKER}"


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
        check_gaits(values, gaits.names, "table", first_row)
    return codes


@checked
def save_dataset(
    frame: pd.DataFrame, path: str | os.PathLike[str], provenance: Mapping[str, Any] | None = None
) -> None:
    """Write a babbling table as Parquet with its provenance inside; the file is replaced atomically.

    provenance: settings, seed and versions; by default ``frame.attrs["bayeshunt"]``.
    Raises DataError if ``frame`` is not a babbling table or a column or the provenance cannot be stored,
    InputError for the name of another kind of file.
    """
    check_ending(path, "tables", ".parquet")
    validate(frame)
    odd = [name for name in (*COLUMNS[1:], *path_columns(frame.columns)) if str(frame[name].dtype) not in _PLAIN]
    save(frame.assign(**{name: frame[name].to_numpy(dtype=float) for name in odd}), path, provenance)


def save(frame: pd.DataFrame, path: str | os.PathLike[str], provenance: Mapping[str, Any] | None = None) -> None:
    """Write a table that babbling has just made: :func:`save_dataset` without its checks."""
    record = provenance if provenance is not None else frame.attrs.get(PROVENANCE_KEY, {})
    parquet.write(to_arrow(frame), plain_record(record, "provenance"), path)


def to_arrow(frame: pd.DataFrame) -> Any:
    """Return a babbling table as the Arrow table that its file holds."""
    import pyarrow as pa

    plain = frame.copy(deep=False)
    plain.attrs = {}
    plain["gait"] = stored(frame["gait"])
    try:
        return _table(plain)
    except (pa.ArrowException, TypeError, ValueError):
        mixed = next((name for name in plain.columns if not _fits(plain[[name]])), plain.columns[0])
        raise DataError(
            f"column {mixed!r} holds values of several kinds, or of one, that Parquet cannot hold; "
            f"convert it, for example: frame[{mixed!r}].astype(str)"
        ) from None


def _table(plain: pd.DataFrame) -> Any:
    import pyarrow as pa

    return parquet.storable(pa.Table.from_pandas(plain, preserve_index=False).replace_schema_metadata(None))


def _fits(column: pd.DataFrame) -> bool:
    """Whether Parquet can hold a table of one column."""
    import pyarrow as pa

    try:
        _table(column)
    except (pa.ArrowException, TypeError, ValueError):
        return False
    return True


def load(path: str | os.PathLike[str]) -> pd.DataFrame:
    """Read and validate a babbling table written by :func:`save`; provenance in ``frame.attrs``.

    Raises DataError if the file is missing, is not Parquet, is damaged or is not a babbling table.
    """
    check_source(path, _MAKER, DataError)
    name = os.fspath(path)
    table, record = parquet.read(path, what=_WHAT, fix=_FIX)
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
        self._reader = parquet.Reader(path, what=_WHAT, fix=_FIX)
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
