"""HDF5 files without PyTables: opened with h5py, nothing in them is ever executed."""

from __future__ import annotations

import contextlib
import io
import pickle
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from bayeshunt.core.errors import DataError, InputError

__all__ = ["MAGIC", "opened", "plain_values"]

#: How every HDF5 file begins.
MAGIC = b"\x89HDF\r\n\x1a\n"


@contextlib.contextmanager
def opened(path: Path, what: str) -> Iterator[Any]:
    """Yield the open file; whatever a damaged one provokes becomes one DataError. ``what`` it should be, in words."""
    try:
        import h5py
    except ImportError:
        raise InputError(f'{path}: HDF5 files need h5py: pip install ".[h5]" in the folder of bayeshunt') from None
    try:
        with h5py.File(path, "r") as file:
            yield file
    except (DataError, InputError):
        raise
    except Exception as error:  # h5py raises nearly every kind
        reason = (str(error).splitlines() or [""])[0][:120] or type(error).__name__
        raise DataError(f"{path}: cannot be read as {what} ({reason})") from None


class _Plain(pickle.Unpickler):
    """Lists, tuples, texts and numbers only: names of columns are written so by PyTables."""

    def find_class(self, module: str, name: str) -> Any:
        raise ValueError(f"it holds an object of {module}.{name}, which is not read")


def plain_values(data: bytes) -> Any:
    """Return lists, tuples, texts and numbers that PyTables has written; ValueError if there is anything else."""
    return _Plain(io.BytesIO(bytes(data))).load()
