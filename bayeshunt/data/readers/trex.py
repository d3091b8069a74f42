"""TRex: one NPZ file per individual; arrays only, pickled ones are refused."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.errors import DataError, InputError
from bayeshunt.data.readers.registry import Found

__all__ = ["TRexReader"]

_WHAT = "a TRex file"
#: Where the animal is, the first pair that the file has.
_PLACES = (("X#wcentroid", "Y#wcentroid"), ("X", "Y"), ("X#pcentroid", "Y#pcentroid"))


class TRexReader:
    """Weighted centroid and body axis of one animal, frame by frame."""

    name = "trex"

    def accepts(self, path: Path, head: bytes) -> bool:
        """Return whether the file is an NPZ file (a zip archive of that name)."""
        return path.suffix.lower() == ".npz"

    def read(self, path: Path, *, columns: Mapping[str, str], keypoint: str | None) -> Found:
        """Read the file; see :class:`bayeshunt.data.readers.registry.TrackReader`."""
        for given, name in ((columns, "columns"), (keypoint, "keypoint")):
            if given:
                raise InputError(f"{path}: {_WHAT} names its own columns; leave out {name}={given!r}")
        try:
            with np.load(path, allow_pickle=False) as file:
                return _found(file, path)
        except (DataError, InputError):
            raise
        except Exception as error:  # zip, zlib, NumPy and the system each raise their own
            pickled = "pickle" in str(error).lower() and zipfile.is_zipfile(path)
            reason = "it holds pickled objects, which are not read" if pickled else type(error).__name__
            raise DataError(f"{path}: cannot be read as {_WHAT} ({reason})") from None


def _found(file: Any, path: Path) -> Found:
    pair = next((p for p in _PLACES if p[0] in file and p[1] in file), None)
    if pair is None:
        raise DataError(f"{path}: cannot be read as {_WHAT} (no arrays X#wcentroid and Y#wcentroid, nor X and Y)")
    x, y = (_numbers(file, name, path) for name in pair)
    frames = _numbers(file, "frame", path) if "frame" in file else np.arange(len(x), dtype=float)
    heading = _numbers(file, "ANGLE", path) if "ANGLE" in file else np.full(len(x), np.nan)
    if not len(x) == len(y) == len(frames) == len(heading):
        raise DataError(f"{path}: cannot be read as {_WHAT} (its arrays have different lengths)")
    missing = _numbers(file, "missing", path) > 0 if "missing" in file else np.zeros(len(x), dtype=bool)
    if len(missing) == len(x):
        x, y = np.where(missing, np.nan, x), np.where(missing, np.nan, y)
    frame = pd.DataFrame({"id": _identity(file, path), "frame": frames, "x": x, "y": y, "heading": heading})
    claims = {}
    for key, name in (("frame_rate", "rate"), ("cm_per_pixel", "cm_per_pixel")):
        if key in file and file[key].size == 1:
            claims[name] = float(file[key].ravel()[0])
    notes = (f"the place is {pair[0]}, {pair[1]}" + (", the heading the body axis ANGLE" if "ANGLE" in file else ""),)
    return Found(frame, claims, notes, y="down")


def _numbers(file: Any, name: str, path: Path) -> np.ndarray:
    values = file[name]
    if values.ndim != 1 or not np.issubdtype(values.dtype, np.number):
        raise DataError(f"{path}: array {name!r} is {values.dtype} of {values.ndim} dimensions; expected numbers")
    return np.asarray(values, dtype=float)


def _identity(file: Any, path: Path) -> str:
    """Which animal it is: the end of the name ("..._id3.npz"), else the array "id"."""
    named = re.search(r"(?:id|fish|bird|animal)[_-]?(\d+)$", path.stem)
    if named:
        return named.group(1)
    stored = file.get("id")
    return str(stored.ravel()[0]) if stored is not None and stored.size == 1 else "0"
