"""Checksummed records: JSON that anyone can open, and that notices when it was edited or damaged.

A record file holds ``{"kind": ..., "format": ..., "checksum": "sha256:...", "content": ...}``. The checksum
is over the content in canonical form: layout and the order of keys do not matter, values do.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from bayeshunt.core.errors import DataError, ModelFileError
from bayeshunt.files.atomic import check_source, write_text

__all__ = ["RecordKind", "checksum", "digest", "digest_of_file", "plain_record"]


def checksum(content: Any) -> str:
    """Return "sha256:" and the SHA-256 of ``content`` as JSON with sorted keys and no blanks."""
    canonical = json.dumps(content, sort_keys=True, separators=(",", ":"))
    return "sha256:" + hashlib.sha256(canonical.encode()).hexdigest()


def digest(content: Any) -> str:
    """Return the bare SHA-256 of ``content`` as JSON with sorted keys: the checksum inside Parquet and memory files."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def digest_of_file(path: str | os.PathLike[str]) -> str:
    """Return the SHA-256 of a file; of a folder (a rosbag2) that of its files, one after the other by name."""
    total = hashlib.sha256()
    for file in sorted(Path(path).iterdir()) if Path(path).is_dir() else [Path(path)]:
        if file.is_file():
            total.update(file.read_bytes())
    return total.hexdigest()


def plain_record(record: Mapping[str, Any], what: str) -> dict[str, Any]:
    """Return a copy of ``record`` that JSON can hold: NumPy's numbers and arrays, sets and paths as plain ones.

    Raises DataError that starts with ``what`` and names the key whose value cannot be stored.
    """
    for key, value in record.items():
        try:
            json.dumps({key: value}, default=_plain, sort_keys=True)
        except (TypeError, ValueError, RecursionError):
            raise DataError(f"{what}: {key!r} holds what JSON cannot; give text, numbers, lists and dicts") from None
    copy: dict[str, Any] = json.loads(json.dumps(dict(record), default=_plain))
    return copy


def _plain(value: Any) -> Any:
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, (set, frozenset)):
        return sorted(value)
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, Mapping):
        return dict(value)
    raise TypeError


@dataclass(frozen=True)
class RecordKind:
    """A kind of record file: what its files say they are, and how they are written and read.

    name: what the file says it is. maker: the command that makes one. versions: layouts of the content that
    can be read, the newest last.
    """

    name: str
    maker: str
    versions: tuple[int, ...] = (1,)

    def dumps(self, content: Any) -> str:
        """Return the text of a file in the newest format: the same content gives the same bytes."""
        head = {"kind": self.name, "format": self.versions[-1], "checksum": checksum(content)}
        return json.dumps({**head, "content": content}, indent=1, sort_keys=True) + "\n"

    def save(self, content: Any, path: str | os.PathLike[str]) -> None:
        """Write a file in the newest format, replaced atomically; BayesHuntError if it cannot be written."""
        write_text(path, self.dumps(content))

    def load(self, path: str | os.PathLike[str]) -> tuple[int, Any]:
        """Return the format and the content of a file; ModelFileError in one line, as :meth:`loads`."""
        return self.loads(self.read_text(path), os.fspath(path))

    def read_text(self, path: str | os.PathLike[str]) -> str:
        """Return the text of a file; ModelFileError in one line if it is missing, unreadable or no text."""
        name = check_source(path, self.maker, ModelFileError)
        try:
            return Path(path).read_text(encoding="utf-8")
        except OSError as error:
            raise ModelFileError(f"{name}: cannot be read ({error.strerror or error})") from None
        except UnicodeDecodeError:
            raise self.stranger(name, " (not a text file)") from None

    def loads(self, text: str, name: str) -> tuple[int, Any]:
        """Return the format and the content of the record in ``text``; ``name`` is what errors call it.

        Raises ModelFileError in one line: not JSON, another kind of file, a newer format, edited (checksum).
        """
        record = self.parse(text, name)
        if record.get("kind") != self.name:
            raise self.stranger(name)
        version, content = self.check_version(record.get("format"), name), record.get("content")
        self.check_sum(record.get("checksum"), checksum(content), name)
        return version, content

    def parse(self, text: str, name: str) -> dict[str, Any]:
        """Return the JSON object in ``text``; ModelFileError if it is none."""
        try:
            record = json.loads(text, parse_constant=_refuse)
        except (ValueError, RecursionError) as error:
            reason = str(error).splitlines()[0]
            raise ModelFileError(f"{name}: not JSON, damaged or cut short ({reason}); {self._fix}") from None
        if not isinstance(record, dict):
            raise self.stranger(name)
        return record

    def check_version(self, version: Any, name: str) -> int:
        """Return the stated format; ModelFileError unless it is one that can be read."""
        newest = self.versions[-1]
        if isinstance(version, int) and version > newest:
            raise ModelFileError(f"{name}: format {version} is newer than {newest}, the newest known here; upgrade")
        if isinstance(version, bool) or version not in self.versions:
            known = " or ".join(map(str, self.versions))
            raise ModelFileError(f"{name}: format is {version!r}; expected {known}; {self._fix}")
        return int(version)

    def check_sum(self, stated: Any, computed: str, name: str) -> None:
        """Raise ModelFileError unless both checksums are the same."""
        if stated != computed:
            raise ModelFileError(f"{name}: the checksum does not match: the file was edited or damaged; {self._fix}")

    def malformed(self, name: str, error: Exception) -> ModelFileError:
        """Return the error for content that is sound but makes no sense."""
        reason = (str(error).splitlines() or [""])[0][:120]
        return ModelFileError(f"{name}: malformed content ({type(error).__name__}: {reason}); {self._fix}")

    @property
    def _fix(self) -> str:
        return f"give a file made by: {self.maker}"

    def stranger(self, name: str, why: str = "") -> ModelFileError:
        """Return the error for a file of another kind."""
        return ModelFileError(f"{name}: not a {self.name}{why}; {self._fix}")


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is not a number")
