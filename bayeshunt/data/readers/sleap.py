"""SLEAP analysis files: HDF5 with one array of all tracks."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from bayeshunt.core.errors import DataError, InputError
from bayeshunt.data.readers.hdf5 import MAGIC, opened
from bayeshunt.data.readers.keypoints import one_point
from bayeshunt.data.readers.registry import Found

__all__ = ["SleapReader"]

_WHAT = "a SLEAP analysis file"


class SleapReader:
    """``tracks`` [individuals, 2, keypoints, frames] with scores and names."""

    name = "sleap"

    def accepts(self, path: Path, head: bytes) -> bool:
        """Return whether the file is HDF5 with a dataset "tracks"."""
        if path.suffix.lower() == ".slp":
            raise DataError(f"{path}: a SLEAP project; export it first: sleap-convert --format analysis")
        if not head.startswith(MAGIC):
            return False
        with opened(path, _WHAT) as file:
            return "tracks" in file

    def read(self, path: Path, *, columns: Mapping[str, str], keypoint: str | None) -> Found:
        """Read the file; see :class:`bayeshunt.data.readers.registry.TrackReader`."""
        if columns:
            raise InputError(f"{path}: {_WHAT} names its own columns; leave out columns={dict(columns)!r}")
        with opened(path, _WHAT) as file:
            tracks = np.asarray(file["tracks"][()], dtype=float)  # [I, 2, K, N]
            if tracks.ndim != 4 or tracks.shape[1] != 2:
                raise ValueError(f"tracks have the shape {tracks.shape}; expected individuals, 2, keypoints, frames")
            individuals, _, keypoints, frames = tracks.shape
            ids, names = _texts(file, "track_names", individuals, ""), _texts(file, "node_names", keypoints, "node_")
            scores = np.asarray(file["point_scores"][()], dtype=float) if "point_scores" in file else None
            places = tracks.transpose(0, 3, 2, 1)
            sure = None if scores is None else scores.reshape(individuals, keypoints, frames).transpose(0, 2, 1)
            points, note = one_point(places, sure, names, ids, np.arange(frames), keypoint)
        return Found(points, {"keypoints": names}, (note,), y="down")


def _texts(file: Any, key: str, count: int, prefix: str) -> list[str]:
    found = [t.decode() if isinstance(t, bytes) else str(t) for t in file[key][()]] if key in file else []
    return found if len(found) == count else [f"{prefix}{i}" for i in range(count)]
