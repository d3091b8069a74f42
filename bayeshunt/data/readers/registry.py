"""The registry of readers: what a reader of tracks promises, and which one takes a file."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol

import pandas as pd

from bayeshunt.core.arguments import checked_but
from bayeshunt.core.errors import DataError, InputError, did_you_mean
from bayeshunt.data.text_tables import read_bytes

__all__ = ["Found", "TrackReader", "find_reader", "reader_names", "register_reader"]


@dataclass(frozen=True)
class Found:
    """What a reader found in a file, in the file's own units.

    frame: columns id, x, y; ``frame`` (whole numbers) or ``time`` [s] or both; heading [rad, in the file's own axes]
        and confidence [0 to 1] where the file has them. NaN marks what is missing.
    claims: what the file says of itself, by name ("rate", "unit", "scale", "y", "time_unit"): shown, not believed.
    notes: sentences that tell a user what was chosen for him.
    y: "down" if the format counts y downwards as images do, else "up".
    ingested: what is known of a file that bayeshunt itself has written: "unit", "sources" and perhaps "licence" and
        "citation"; then frame has a column scene. None for every other file.
    """

    frame: pd.DataFrame
    claims: Mapping[str, Any] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    y: str = "up"
    ingested: Mapping[str, Any] | None = None


class TrackReader(Protocol):
    """Reads one format; ``name`` is what users call it."""

    name: str

    def accepts(self, path: Path, head: bytes) -> bool:
        """Return whether the file at ``path``, which begins with ``head``, is of this format."""

    def read(self, path: Path, *, columns: Mapping[str, str], keypoint: str | None) -> Found:
        """Read it; DataError in one line if it is damaged.

        columns: the user's names of columns, by what they mean ("x", "y", "id", "time", "frame", "heading",
        "confidence"). keypoint: the body part to follow; None: the centroid weighted by confidence.
        """


#: Name -> (module, class) of those that ship, or a factory; in the order in which they are asked.
_READERS: dict[str, tuple[str, str] | Callable[[], TrackReader]] = {
    "trex": ("bayeshunt.data.readers.trex", "TRexReader"),
    "sleap": ("bayeshunt.data.readers.sleap", "SleapReader"),
    "deeplabcut": ("bayeshunt.data.readers.deeplabcut", "DeepLabCutReader"),
    "trajnet": ("bayeshunt.data.readers.trajnet", "TrajNetReader"),
    "parquet": ("bayeshunt.data.readers.tables", "ParquetReader"),
    "text": ("bayeshunt.data.readers.tables", "TextReader"),
}


@checked_but("factory")
def register_reader(name: str, factory: Callable[[], TrackReader]) -> None:
    """Let :func:`bayeshunt.read_tracks` read one more format; a later one is asked before those that ship.

    factory: makes a :class:`TrackReader`, usually its class. Raises InputError if it is no callable or has no name.
    """
    if not (isinstance(name, str) and name):
        raise InputError(f"reader: expected a name, got {name!r}")
    if not callable(factory):
        raise InputError(f"reader {name!r}: expected a class or function that makes a reader, got {factory!r}")
    _READERS.pop(name, None)
    kept = dict(_READERS)
    _READERS.clear()
    _READERS.update({name: factory, **kept})


def reader_names() -> list[str]:
    """Return the names of the formats that can be read, in the order in which they are asked."""
    return list(_READERS)


def find_reader(path: str | os.PathLike[str], name: str | None = None) -> TrackReader:
    """Return the reader called ``name``, or the first that accepts the file; DataError if none does."""
    if name is not None:
        if name not in _READERS:
            raise InputError(f"unknown reader {name!r}{did_you_mean(name, reader_names())}")
        return _made(name)
    head = read_bytes(path, "a file of tracks")[:4096]
    for known in reader_names():
        reader = _made(known)
        if reader.accepts(Path(path), head):
            return reader
    raise DataError(f"{os.fspath(path)}: no reader takes this file; expected one of {', '.join(reader_names())}")


def _made(name: str) -> TrackReader:
    factory = _READERS[name]
    if isinstance(factory, tuple):
        module, attribute = factory
        factory = getattr(import_module(module), attribute)
    reader: TrackReader = factory()
    return reader
