"""DeepLabCut: CSV with three or four header rows, and the HDF5 that pandas writes of the same table."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.errors import DataError, InputError
from bayeshunt.data.readers.hdf5 import MAGIC, opened, plain_values
from bayeshunt.data.readers.keypoints import one_point
from bayeshunt.data.readers.registry import Found
from bayeshunt.data.text_tables import read_text

__all__ = ["DeepLabCutReader"]

_WHAT = "a DeepLabCut file"


class DeepLabCutReader:
    """Body parts with a likelihood each, of one animal or several."""

    name = "deeplabcut"

    def accepts(self, path: Path, head: bytes) -> bool:
        """Return whether the file is HDF5 that pandas wrote, or a CSV that begins with "scorer"."""
        if head.startswith(MAGIC):
            with opened(path, _WHAT) as file:
                return any("pandas_type" in file[key].attrs for key in file)
        return head.lstrip(b"\xef\xbb\xbf").lower().startswith(b"scorer")

    def read(self, path: Path, *, columns: Mapping[str, str], keypoint: str | None) -> Found:
        """Read the file; see :class:`bayeshunt.data.readers.registry.TrackReader`."""
        if columns:
            raise InputError(f"{path}: {_WHAT} names its own columns; leave out columns={dict(columns)!r}")
        table = _from_hdf(path) if path.read_bytes()[:8] == MAGIC else _from_csv(path)
        return _found(table, path, keypoint)


def _from_csv(path: Path) -> pd.DataFrame:
    text = read_text(path, _WHAT)
    second = text.splitlines()[1:2]
    levels = 4 if second and second[0].lower().startswith("individuals") else 3
    try:
        table = pd.read_csv(io.StringIO(text), header=list(range(levels)), index_col=0)
        table = table.astype(float)
        table.index = table.index.astype(int)
    except (ValueError, TypeError, IndexError, OverflowError, pd.errors.ParserError) as error:
        reason = (str(error).splitlines() or [""])[0][:120]
        raise DataError(f"{path}: cannot be read as {_WHAT} ({reason})") from None
    return table


def _from_hdf(path: Path) -> pd.DataFrame:
    with opened(path, _WHAT) as file:
        key = next((k for k in file if "pandas_type" in file[k].attrs), None)
        if key is None:
            raise DataError(f"{path}: cannot be read as {_WHAT} (no table of pandas inside)")
        group = file[key]
        return _appendable(group["table"]) if "table" in group else _fixed(group)


def _appendable(table: Any) -> pd.DataFrame:
    """A table written by ``to_hdf(format="table")``: blocks of values, each with the names of its columns."""
    rows, names, blocks = table[()], [], []
    for field in table.dtype.names:
        if not field.startswith("values_block_"):
            continue
        names += [tuple(str(part) for part in name) for name in plain_values(bytes(table.attrs[f"{field}_kind"]))]
        blocks.append(np.asarray(rows[field], dtype=float).reshape(len(rows), -1))
    columns = pd.MultiIndex.from_tuples(names)
    return pd.DataFrame(np.hstack(blocks), index=np.asarray(rows["index"], dtype=np.int64), columns=columns)


def _fixed(group: Any) -> pd.DataFrame:
    """A table written by ``to_hdf(format="fixed")``: levels and codes of the columns beside one block."""
    levels: list[np.ndarray] = []
    while f"axis0_level{len(levels)}" in group:
        number = len(levels)
        words = [text.decode() for text in group[f"axis0_level{number}"][()]]
        levels.append(np.asarray(words, dtype=object)[group[f"axis0_label{number}"][()]])
    columns, values = pd.MultiIndex.from_arrays(levels), group["block0_values"][()]
    return pd.DataFrame(np.asarray(values, dtype=float), index=group["axis1"][()], columns=columns)


def _found(table: pd.DataFrame, path: Path, keypoint: str | None) -> Found:
    if table.columns.nlevels not in (3, 4) or table.empty:
        raise DataError(f"{path}: cannot be read as {_WHAT} (expected scorer, body parts and coordinates)")
    single = table.columns.nlevels == 3
    flat = table.droplevel(0, axis=1)
    if single:
        flat.columns = pd.MultiIndex.from_tuples([("0", *name) for name in flat.columns])
    ids = list(dict.fromkeys(flat.columns.get_level_values(0)))
    names = list(dict.fromkeys(flat.columns.get_level_values(1)))
    places = np.stack([[_values(flat, i, n, c) for n in names for c in ("x", "y")] for i in ids])
    places = places.reshape(len(ids), len(names), 2, -1).transpose(0, 3, 1, 2)
    sure = np.stack([[_values(flat, i, n, "likelihood") for n in names] for i in ids]).transpose(0, 2, 1)
    if not np.isfinite(places).any():
        raise DataError(f"{path}: cannot be read as {_WHAT} (no column x and y holds numbers)")
    points, note = one_point(
        places, None if np.isnan(sure).all() else sure, names, ids, table.index.to_numpy(), keypoint
    )
    return Found(points, {"keypoints": names}, (note,), y="down")


def _values(flat: pd.DataFrame, individual: str, name: str, coordinate: str) -> np.ndarray:
    key = (individual, name, coordinate)
    return flat[key].to_numpy(dtype=float) if key in flat.columns else np.full(len(flat), np.nan)
