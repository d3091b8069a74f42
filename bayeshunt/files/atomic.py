"""Files: none is ever half-written, and none is asked for that is not there."""

from __future__ import annotations

import contextlib
import os
import secrets
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from bayeshunt.core.errors import BayesHuntError, InputError, shown

__all__ = ["check_path", "check_source", "check_target", "replace_atomically", "write_text"]


@contextlib.contextmanager
def replace_atomically(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield a temporary path beside ``path``; on success it replaces ``path`` in one step.

    If the block raises, ``path`` is left as it was and the temporary file is removed. A symbolic link
    stays one: the file that it leads to is replaced.
    Raises BayesHuntError in one line if the folder is missing, read-only or full, or as :func:`check_target`.
    """
    target = check_target(path)
    temporary = target.with_name(f".{target.name}.{secrets.token_hex(6)}.tmp")
    try:
        # The kernel applies the process's umask; asking for it would change it for a moment, for every thread.
        os.close(os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
    except OSError as error:
        raise BayesHuntError(f"{target}: cannot write here ({error.strerror or error})") from None
    try:
        yield temporary
        with temporary.open("rb") as written:
            os.fsync(written.fileno())
        temporary.replace(target)
    except OSError as error:
        raise BayesHuntError(f"{target}: cannot be written ({error.strerror or error})") from None
    finally:
        temporary.unlink(missing_ok=True)


def check_target(path: str | os.PathLike[str]) -> Path:
    """Return the file to write for ``path``, symbolic links followed.

    Raises InputError unless it is a regular file or not there yet: a device, a pipe or a folder would be
    lost; BayesHuntError if that cannot be found out.
    """
    target = Path(os.path.realpath(check_path(path, "the name of a file to write", InputError)))
    try:
        folder = target.is_dir()
        regular = target.is_file() or not (target.exists() or target.is_symlink())
    except OSError as error:  # a name too long, a folder that may not be entered
        raise BayesHuntError(f"{path}: cannot be written ({error.strerror or error})") from None
    if folder:
        raise InputError(f"{path}: is a folder; expected a file name")
    if not regular:
        raise InputError(f"{path}: is not a regular file and is left as it is; choose another name")
    return target


def check_path(path: Any, expected: str, error: type[InputError]) -> str:
    """Return the text of a path; raise ``error`` if it is none. ``expected`` says in words what would be.

    A dash alone is none: to other programs it is standard input or output, and a file of that name is nobody's wish.
    """
    if not isinstance(path, (str, os.PathLike)):  # a setting may hold anything, and a number is an open file
        raise error(f"expected {expected}; got {shown(path)}")
    if os.fspath(path) == "-":
        raise error(f"expected {expected}; got '-', which is not taken for standard input or output here")
    return os.fspath(path)


def check_source(path: str | os.PathLike[str], command: str, error: type[InputError]) -> str:
    """Return the name of a file that can be read; raise ``error`` in one line if ``path`` is none.

    command: the one that makes such files with ``--out``; it is suggested with this name only if
    there is nothing that it would overwrite.
    """
    name = check_path(path, f"the name of a file made by: {command}", error)
    if not os.path.lexists(path):
        raise error(f"{name}: no such file; make one with: {command} --out {shlex.quote(name)}")
    if not Path(path).is_file():
        kind = "is a folder" if Path(path).is_dir() else "is not a regular file"
        raise error(f"{name}: {kind}; give a file made by: {command}")
    return name


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write ``text`` as UTF-8, replacing ``path`` atomically."""
    with replace_atomically(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
