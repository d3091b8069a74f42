"""What a babbling table must hold: every fault is one line that names the column or the row, and the fix."""

from __future__ import annotations

import re
from collections.abc import Iterable

import numpy as np
import pandas as pd

from bayeshunt.core.checks import FULL_TURN
from bayeshunt.core.errors import DataError, shown
from bayeshunt.data.gait_labels import distinct, name_of, positions

__all__ = ["COLUMNS", "check_gaits", "path_column_names", "path_columns", "validate"]

#: The columns every babbling table has.
COLUMNS = ("gait", "distance", "angle", "heading")

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
    numeric = [*COLUMNS[1:], *part_way, *(["energy"] if "energy" in frame else [])]
    for column in numeric:
        _check_numbers(frame[column], column, source, first_row)
    row = _first(frame["distance"].to_numpy(dtype=float) < 0)
    if row is not None:
        raise DataError(
            f"{source}: row {first_row + row}: distance is {frame['distance'].iloc[row]}; expected metres >= 0"
        )
    for column in ("angle", "heading"):
        _check_radians(frame[column], column, source, first_row)
    check_gaits(frame["gait"], gaits, source, first_row)


def path_columns(columns: Iterable[str]) -> list[str]:
    """Return the names of the part-way pose columns, ordered by interval: forward, right, heading."""
    found = {c: m for c in columns if (m := _PATH_COLUMN.match(str(c)))}
    order = {"forward": 0, "right": 1, "heading": 2}
    return sorted(found, key=lambda c: (int(found[c].group(1)), order[found[c].group(2)]))


def path_column_names(points: int) -> list[str]:
    """Return the part-way pose columns of ``points`` intermediate poses, in table order."""
    return [f"path_{i:02d}_{part}" for i in range(1, points + 1) for part in ("forward", "right", "heading")]


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


#: Kinds of Python values (by pandas' names) that are numbers.
_NUMBERS = {"floating", "integer", "mixed-integer-float", "decimal", "empty"}


def _check_numbers(values: pd.Series, column: str, source: str, first_row: int) -> None:
    types, dtype = pd.api.types, values.dtype
    if isinstance(dtype, pd.CategoricalDtype):
        dtype = dtype.categories.dtype
    found = types.infer_dtype(values, skipna=True) if types.is_object_dtype(dtype) else str(dtype)
    numeric = types.is_numeric_dtype(dtype) and not types.is_bool_dtype(dtype) and not types.is_complex_dtype(dtype)
    if not (numeric or found in _NUMBERS):
        fix = f"; convert it: frame[{column!r}].astype(float)" if found in ("string", "str", "object") else ""
        raise DataError(f"{source}: column {column!r} holds {found}; expected numbers{fix}")
    numbers = values.to_numpy(dtype=float, na_value=np.nan)
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


def check_gaits(values: pd.Series, gaits: Iterable[str] | None, source: str, first_row: int) -> None:
    """Raise DataError unless every value is the name of a gait, and one of ``gaits`` (None: any)."""
    row = _first(values.isna().to_numpy())
    if row is not None:
        raise DataError(f"{source}: row {first_row + row}: gait is empty; expected a gait name")
    places, names = distinct(values)
    row = _first(np.array([name is None for name in names], dtype=bool)[places])
    if row is not None:
        raise DataError(
            f"{source}: row {first_row + row}: gait is {shown(values.iloc[row])}; expected a gait name; "
            "if gaits are numbered, name them: frame['gait'].astype(str)"
        )
    if gaits is None:
        return
    known = list(gaits)
    row = _first(positions(values, known) < 0)
    if row is not None:
        raise DataError(
            f"{source}: row {first_row + row}: gait {name_of(values.iloc[row])!r} is not in the repertoire; "
            f"expected one of {', '.join(known)}"
        )


def _first(flags: np.ndarray) -> int | None:
    """Index of the first True, or None."""
    hits = np.flatnonzero(flags)
    return int(hits[0]) if hits.size else None
