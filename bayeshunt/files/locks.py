"""One process per results folder: a lock that the operating system drops when its holder dies."""

from __future__ import annotations

import sqlite3
from pathlib import Path
from typing import Any

from bayeshunt.core.errors import BayesHuntError, FolderInUseError

__all__ = ["LOCK_FILE", "FolderLock", "is_locked"]

LOCK_FILE = ".hunts.lock"


class FolderLock:
    """Exclusive use of a folder while the ``with`` block runs.

    SQLite's own file locks, on an empty file: they work on every system, and a killed holder's lock
    is gone at once.
    """

    def __init__(self, folder: Path, hint: str = "wait until it has ended") -> None:
        """``hint``: what the error advises the one who comes second."""
        self._folder, self._hint = folder, hint
        self._connection: sqlite3.Connection | None = None

    def __enter__(self) -> FolderLock:
        """Take the lock; raises FolderInUseError if another process has it."""
        try:
            self._connection = sqlite3.connect(self._folder / LOCK_FILE, timeout=1.0, isolation_level=None)
            self._connection.execute("BEGIN EXCLUSIVE")
        except sqlite3.Error as error:
            self.__exit__()
            if getattr(error, "sqlite_errorcode", None) == sqlite3.SQLITE_BUSY:
                raise FolderInUseError(
                    f"{self._folder}: another process is at work in this folder; {self._hint}"
                ) from None
            raise BayesHuntError(f"{self._folder}: cannot be locked ({error})") from None
        return self

    def __exit__(self, *unused: Any) -> None:
        if self._connection is not None:
            self._connection.close()
            self._connection = None


def is_locked(folder: Path) -> bool:
    """Return whether a process is working in ``folder``."""
    path = folder / LOCK_FILE
    if not path.is_file():
        return False
    try:
        connection = sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro", uri=True, timeout=0.0)
        try:
            connection.execute("SELECT count(*) FROM sqlite_master")
        finally:
            connection.close()
    except sqlite3.Error as error:
        return getattr(error, "sqlite_errorcode", None) == sqlite3.SQLITE_BUSY
    return False
