"""The babbling table: what it must hold, how it is checked, stored and turned into bin indices.

One row is one executed gait and where it took the robot, in the robot's own earlier frame:
``gait`` (name), ``distance`` [m], ``angle`` and ``heading`` [rad, clockwise]. Optional columns:
``step`` (order of execution), ``previous_gait``, and ``path_NN_forward`` [m], ``path_NN_right`` [m],
``path_NN_heading`` [rad clockwise], the pose part-way through the gait at NN of N equal intervals.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.axes import EffectAxes
from bayeshunt.errors import DataError
from bayeshunt.files import replace_atomically
from bayeshunt.gaits import GaitRepertoire

#: The columns every babbling table has.
COLUMNS = ("gait", "distance", "angle", "heading")
#: Key of the provenance record in the Parquet file's metadata and in ``frame.attrs``.
PROVENANCE_KEY = "bayeshunt"

_PATH_COLUMN = re.compile(r"path_(\d+)_(forward|right|heading)$")


def validate(frame: pd.DataFrame, gaits: Iterable[str] | None = None, *, source: str = "table") -> None:
    """Raise DataError unless ``frame`` is a babbling table.

    gaits: the names that may stand in the gait column; None allows any.
    source: what the message calls the table, usually its file name.
    """
    missing = [c for c in COLUMNS if c not in frame.columns]
    if missing:
        raise DataError(f"{source}: column {missing[0]!r} is missing; a babbling table needs {', '.join(COLUMNS)}")
    if frame.empty:
        raise DataError(f"{source}: the table has no rows; babble at least one step")
    numeric = [*COLUMNS[1:], *path_columns(frame.columns)]
    for column in numeric:
        _check_numbers(frame[column], column, source)
    row = _first(frame["distance"].to_numpy(dtype=float) < 0)
    if row is not None:
        raise DataError(f"{source}: row {row}: distance is {frame['distance'].iloc[row]}; expected metres >= 0")
    _check_gaits(frame["gait"], gaits, source)


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
    """
    # Factorising first compares names once per gait, not once per row: 8 times faster on 1e6 rows.
    seen, names = pd.factorize(frame["gait"])
    position = {name: index for index, name in enumerate(gaits.names)}
    if (seen < 0).any() or any(name not in position for name in names):
        validate(frame, gaits.names)
    codes = np.array([position[name] for name in names], dtype=np.int64)[seen]
    indices = [axis.index(frame[axis.name.lower()].to_numpy(dtype=float)) for axis in axes]
    return np.column_stack([codes, *indices])


def save(frame: pd.DataFrame, path: str | os.PathLike[str], provenance: dict[str, Any] | None = None) -> None:
    """Write a babbling table as Parquet with its provenance inside; the file is replaced atomically.

    provenance: settings, seed and versions; by default ``frame.attrs["bayeshunt"]``.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    record = provenance if provenance is not None else frame.attrs.get(PROVENANCE_KEY, {})
    plain = frame.copy(deep=False)
    plain.attrs = {}
    table = pa.Table.from_pandas(plain, preserve_index=False)
    metadata = {PROVENANCE_KEY.encode(): json.dumps(record, sort_keys=True).encode()}
    table = table.replace_schema_metadata(metadata)
    with replace_atomically(path) as temporary:
        pq.write_table(table, temporary, compression="zstd")


def load(path: str | os.PathLike[str]) -> pd.DataFrame:
    """Read and validate a babbling table written by :func:`save`; provenance in ``frame.attrs``.

    Raises DataError if the file is missing, is not Parquet, is damaged or is not a babbling table.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    name = os.fspath(path)
    if not Path(path).is_file():
        raise DataError(f"{name}: no such file; make one with: bayeshunt babble --out {name}")
    try:
        table = pq.read_table(path, memory_map=False, partitioning=None)
        metadata = (table.schema.metadata or {}).get(PROVENANCE_KEY.encode(), b"{}")
        frame = table.to_pandas()
        provenance = json.loads(metadata)
    except (pa.ArrowException, OSError, ValueError, KeyError) as error:
        raise DataError(
            f"{name}: not a readable Parquet file ({_first_line(error)}); expected one made by bayeshunt babble"
        ) from None
    validate(frame, source=name)
    frame.attrs[PROVENANCE_KEY] = provenance
    return frame


def _check_numbers(values: pd.Series, column: str, source: str) -> None:
    try:
        numbers = values.to_numpy(dtype=float, na_value=np.nan)
    except (TypeError, ValueError):
        raise DataError(f"{source}: column {column!r} holds {values.dtype}; expected numbers") from None
    row = _first(~np.isfinite(numbers))
    if row is not None:
        raise DataError(f"{source}: row {row}: {column} is {values.iloc[row]}; expected a finite number")


def _check_gaits(values: pd.Series, gaits: Iterable[str] | None, source: str) -> None:
    row = _first(values.isna().to_numpy())
    if row is not None:
        raise DataError(f"{source}: row {row}: gait is empty; expected a gait name")
    if gaits is None:
        return
    known = list(gaits)
    row = _first(~values.isin(known).to_numpy())
    if row is not None:
        stranger = values.iloc[row]
        raise DataError(
            f"{source}: row {row}: gait {stranger!r} is not in the repertoire; expected one of {', '.join(known)}"
        )


def _first(flags: np.ndarray) -> int | None:
    """Index of the first True, or None."""
    hits = np.flatnonzero(flags)
    return int(hits[0]) if hits.size else None


def _first_line(error: BaseException) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0][:120]
