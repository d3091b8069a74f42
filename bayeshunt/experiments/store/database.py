"""The running experiment on disk: one SQLite file in which every hunt is committed as it ends.

Write-ahead logging (WAL) lets workers commit and others read at the same time, and a process that is
killed leaves either a whole hunt or none. SQLite does not notice a flipped bit: every row carries a
checksum, and so does the description of the experiment.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import platform
import sqlite3
import time
import zlib
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from bayeshunt.core.errors import BayesHuntError, ResultsError
from bayeshunt.episodes.loop import Result
from bayeshunt.experiments.protocol import HuntTask
from bayeshunt.experiments.store.identity import Identity

__all__ = ["DATABASE_FILE", "FORMAT", "KIND", "HuntDatabase", "Numbered", "Session", "Sink", "Writer"]

DATABASE_FILE = "hunts.sqlite"
KIND = "bayeshunt hunts"
FORMAT = 2
_OLDER = ("1",)  # without energy and falls

_SCHEMA = {
    "about": "CREATE TABLE about (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID",
    "hunts": (
        "CREATE TABLE hunts (number INTEGER PRIMARY KEY, planner TEXT, arena TEXT, theta REAL, run INTEGER, "
        "seed INTEGER, caught INTEGER, time REAL, decisions INTEGER, transitions INTEGER, distance REAL, "
        "energy REAL, falls INTEGER, ended REAL, checksum INTEGER)"
    ),
    "sessions": "CREATE TABLE sessions (started REAL, process INTEGER, host TEXT)",
}
_INSERT = "INSERT OR IGNORE INTO hunts VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)"
_WAIT = 60.0  # seconds to wait for another writer; a commit takes well under a millisecond

#: What the operating system or another process is in the way of; anything else is damage.
_OBSTACLES = {
    sqlite3.SQLITE_FULL, sqlite3.SQLITE_READONLY, sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_IOERR,
    sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED, sqlite3.SQLITE_PERM,
}  # fmt: skip


class _OlderFormatError(Exception):
    """A sound database of an earlier version."""


class Numbered(NamedTuple):
    """A hunt and its place in the protocol's list, which is its key in the database."""

    number: int
    task: HuntTask


class Sink(NamedTuple):
    """Where a worker commits its hunts: the database file, and the salt of its rows' checksums.

    path: as it was given, for messages. place: absolute, as a worker may stand in another folder.
    """

    path: str
    salt: int
    place: str

    @contextlib.contextmanager
    def opened(self) -> Iterator[Writer]:
        """Yield a writer on a connection of its own; BayesHuntError if the file is gone or cannot be written."""
        with _reporting(self.path):
            connection = _connect(self.place)
        # Outside of the reporting: what the work in the block raises is no damage to the database.
        with contextlib.closing(connection):
            yield Writer(connection, self)


class Writer:
    """Commits hunts, each in a transaction of its own."""

    def __init__(self, connection: sqlite3.Connection, sink: Sink) -> None:
        self._connection, self._sink = connection, sink

    def add(self, hunt: Numbered, result: Result) -> None:
        """Commit one hunt. One that is there already stays as it is: the same hunt has the same result."""
        with _reporting(self._sink.path):
            self._connection.execute(_INSERT, _row(hunt, result, self._sink.salt))

    def add_all(self, pairs: Iterable[tuple[Numbered, Result]]) -> None:
        """Commit several hunts at once."""
        with _reporting(self._sink.path):
            self._connection.execute("BEGIN IMMEDIATE")
            self._connection.executemany(_INSERT, [_row(hunt, result, self._sink.salt) for hunt, result in pairs])
            self._connection.execute("COMMIT")


class HuntDatabase(Writer):
    """The database of one experiment; use it as a context manager.

    identity: what is being evaluated. model: text of the model file used.
    """

    def __init__(self, path: Path, connection: sqlite3.Connection, about: dict[str, str]) -> None:
        self.path = path
        self.identity = Identity.from_dict(json.loads(about["identity"]))
        self.model = about["model"]
        super().__init__(connection, Sink(os.fspath(path), int(self.identity.hash[:8], 16), str(path.absolute())))
        self._inode = path.stat().st_ino

    # --- opening ------------------------------------------------------------------------------

    @classmethod
    def create(cls, folder: Path, identity: Identity, model: str) -> HuntDatabase:
        """Make the database of an experiment, all or nothing. ``model``: text of its model file."""
        path = folder / DATABASE_FILE
        about = {"kind": KIND, "format": str(FORMAT), "model": model}
        about["identity"] = json.dumps(identity.to_dict(), sort_keys=True)
        about["checksum"] = _checksum(about)
        with _reporting(path):
            connection = _connect(path, create=True)
            connection.execute("PRAGMA journal_mode = WAL")
            connection.execute("BEGIN IMMEDIATE")
            for statement in _SCHEMA.values():
                connection.execute(statement)
            connection.executemany("INSERT INTO about VALUES (?, ?)", sorted(about.items()))
            connection.execute("COMMIT")
            return cls(path, connection, about)

    @classmethod
    def open(cls, folder: Path, *, read_only: bool = False) -> HuntDatabase | None:
        """Open the database in ``folder``; None if there is none, or none was ever finished making.

        Raises ResultsError in one line if it is damaged, of another kind or of a newer format.
        """
        path = folder / DATABASE_FILE
        if not path.is_file():
            return None
        with _reporting(path):
            connection = _connect(path, read_only=read_only)
            try:
                if not connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]:
                    connection.close()
                    return None
                return cls(path, connection, _checked_about(connection))
            except BaseException:
                connection.close()
                raise

    def __enter__(self) -> HuntDatabase:
        return self

    def __exit__(self, *unused: Any) -> None:
        self._connection.close()

    # --- reading ------------------------------------------------------------------------------

    def results(self) -> tuple[dict[int, Result], list[int]]:
        """Return the hunts that have ended, by number, and the numbers of rows that are damaged."""
        good: dict[int, Result] = {}
        damaged = []
        with _reporting(self.path):
            for row in self._connection.execute("SELECT * FROM hunts ORDER BY number"):
                if row[-1] == _row_checksum(row[:-1], self._sink.salt):
                    caught, *rest = row[6:-2]
                    good[row[0]] = Result(bool(caught), *rest)
                else:
                    damaged.append(row[0])
        return good, damaged

    def drop(self, numbers: Sequence[int]) -> None:
        """Delete rows, so that their hunts are run again."""
        with _reporting(self.path):
            self._connection.executemany("DELETE FROM hunts WHERE number = ?", [(n,) for n in numbers])

    def counts(self) -> list[tuple[str, str, int, int]]:
        """Return (planner, arena, hunts ended, caught) in the order of the protocol."""
        query = "SELECT planner, arena, count(*), sum(caught) FROM hunts GROUP BY planner, arena ORDER BY min(number)"
        with _reporting(self.path):
            return self._connection.execute(query).fetchall()

    def recent(self, count: int) -> list[float]:
        """Return when the last ``count`` hunts of the present session ended, seconds since 1970, oldest first."""
        query = "SELECT ended FROM hunts WHERE ended >= ? ORDER BY ended DESC LIMIT ?"
        session = self.session()
        with _reporting(self.path):
            rows = self._connection.execute(query, (session.started if session else 0.0, count)).fetchall()
        return [row[0] for row in reversed(rows)]

    def session(self) -> Session | None:
        """Return who worked here last."""
        with _reporting(self.path):
            row = self._connection.execute("SELECT * FROM sessions ORDER BY rowid DESC LIMIT 1").fetchone()
        return None if row is None else Session(*row)

    # --- writing ------------------------------------------------------------------------------

    @property
    def sink(self) -> Sink:
        """What a worker on this machine needs in order to commit here."""
        return self._sink

    def begin_session(self) -> None:
        """Note that this process is now at work."""
        row = (time.time(), os.getpid(), platform.node())
        with _reporting(self.path):
            self._connection.execute("INSERT INTO sessions VALUES (?, ?, ?)", row)

    def check_in_place(self) -> None:
        """Raise ResultsError if the file has been removed or replaced under the running experiment."""
        if not self.path.is_file() or self.path.stat().st_ino != self._inode:
            raise ResultsError(f"{self.path}: was removed or replaced while hunts were running; give the command again")

    def fold(self) -> None:
        """Move the write-ahead log into the database file."""
        with _reporting(self.path):
            self._connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")


class Session(NamedTuple):
    """One process's work on a database: started [s since 1970], process id, host."""

    started: float
    process: int
    host: str


def _connect(path: str | os.PathLike[str], *, create: bool = False, read_only: bool = False) -> sqlite3.Connection:
    mode = "ro" if read_only else "rwc" if create else "rw"
    uri = f"{Path(path).absolute().as_uri()}?mode={mode}"
    if read_only and not Path(f"{os.fspath(path)}-wal").exists():
        uri += "&immutable=1"  # nobody is at work: a folder that cannot be written can still be read
    connection = sqlite3.connect(uri, uri=True, timeout=_WAIT, isolation_level=None)
    connection.text_factory = lambda raw: raw.decode("utf-8", "surrogateescape")  # damage is for the checksums to find
    connection.execute("PRAGMA trusted_schema = OFF")
    # With WAL, NORMAL keeps every commit through a kill; only a power cut may cost the last few hunts.
    connection.execute("PRAGMA synchronous = NORMAL")
    return connection


def _checked_about(connection: sqlite3.Connection) -> dict[str, str]:
    """Return the description of the experiment; ValueError or sqlite3's errors if anything is amiss."""
    schema = dict(connection.execute("SELECT name, sql FROM sqlite_master").fetchall())
    about = dict(connection.execute("SELECT key, value FROM about").fetchall()) if "about" in schema else {}
    if about.get("kind") != KIND:
        raise ValueError("not a database of hunts")
    if about.get("format") in _OLDER:
        raise _OlderFormatError
    if about.get("format") != str(FORMAT):
        raise ValueError(f"format {about.get('format')!r}, this version reads {FORMAT}")
    if schema != _SCHEMA or about.pop("checksum", None) != _checksum(about):
        raise ValueError("its description does not match its checksum")
    problem = connection.execute("PRAGMA integrity_check(1)").fetchone()[0]
    if problem != "ok":
        raise ValueError(str(problem).splitlines()[-1])
    return about


def _row(hunt: Numbered, result: Result, salt: int) -> tuple[Any, ...]:
    values = (hunt.number, *hunt.task, int(result.caught), *result[1:], time.time())
    return (*values, _row_checksum(values, salt))


def _row_checksum(values: Sequence[Any], salt: int) -> int:
    return zlib.crc32(repr(tuple(values)).encode(), salt)


def _checksum(about: dict[str, str]) -> str:
    return hashlib.sha256(json.dumps(about, sort_keys=True).encode()).hexdigest()


@contextlib.contextmanager
def _reporting(path: str | os.PathLike[str]) -> Iterator[None]:
    """Turn what SQLite and damaged content provoke into one line."""
    try:
        yield
    except BayesHuntError:
        raise
    except _OlderFormatError:
        raise ResultsError(
            f"{os.fspath(path)}: hunts of an earlier version, which kept no energy and falls; go on with that version "
            f"of bayeshunt, or use another folder (what has ended is readable in hunts.parquet)"
        ) from None
    except (sqlite3.Error, ValueError, KeyError, TypeError, OverflowError) as error:
        reason = (str(error).splitlines() or [""])[0][:120] or type(error).__name__
        code = getattr(error, "sqlite_errorcode", None)
        if code is not None and (code & 0xFF) in _OBSTACLES:
            line = f"{os.fspath(path)}: cannot be used ({reason}); every hunt that has ended is kept; give the command"
            raise BayesHuntError(f"{line} again when the folder is there, writable and has room") from None
        line = f"{os.fspath(path)}: damaged, or not a database of hunts ({reason})"
        raise ResultsError(f"{line}; move it away and give the command again, or use another folder") from None
