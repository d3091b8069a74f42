"""What a command writes: options whose file or folder is looked at before any work; an output that may fail."""

from __future__ import annotations

import contextlib
import os
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import typer

from bayeshunt.errors import InputError
from bayeshunt.files import check_target


def out_file(help_text: str, *, within_out: bool = False) -> Any:
    """Return an option that names a file to write; a name that cannot be written is refused before any work.

    within_out: it may stand in the folder of ``--out``, which the command makes itself.
    """
    return typer.Option(help=help_text, callback=_checked_file_within if within_out else _checked_file)


def out_folder(help_text: str) -> Any:
    """Return an option that names a folder to write into, made if need be; refused before any work if that fails."""
    return typer.Option(help=help_text, callback=_checked_folder, is_eager=True)  # before the files within it


def _checked_file(context: typer.Context, path: Path | None) -> Path | None:
    if path is not None and not context.resilient_parsing:
        check_target(path)
        if not path.parent.is_dir():
            raise InputError(f"{path}: the folder {path.parent} does not exist; make it first")
        _check_writable(path, Path(os.path.realpath(path)).parent)
    return path


def _checked_file_within(context: typer.Context, path: Path | None) -> Path | None:
    folder = context.params.get("out")
    if path is not None and folder is not None and path.parent.resolve() == Path(folder).resolve():
        return path  # the folder itself has been looked at
    return _checked_file(context, path)


def _checked_folder(context: typer.Context, path: Path | None) -> Path | None:
    if path is not None and not context.resilient_parsing:
        nearest = next(folder for folder in (path, *path.absolute().parents) if os.path.lexists(folder))
        if not nearest.is_dir():
            raise InputError(f"{path}: cannot be used as an output folder ({nearest} is not a folder)")
        _check_writable(path, nearest)
    return path


def _check_writable(path: Path, folder: Path) -> None:
    """Raise InputError unless a file can be made in ``folder``: tried, as permissions do not tell all."""
    try:
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        raise InputError(f"{path}: cannot write in {folder} ({error.strerror or error})") from None


class Output:
    """Standard output that remembers why it failed: an OSError of its own is told from one of the work.

    Characters that its encoding lacks come out as "?", rather than end the command.
    """

    def __init__(self, stream: Any) -> None:
        self.stream = stream
        self.failure: OSError | None = None
        if getattr(stream, "errors", None) == "strict" and hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stream, name)

    def write(self, text: str) -> int:
        """Write, and remember a failure."""
        with self._remembering():
            return int(self.stream.write(text))

    def flush(self) -> None:
        """Write what waits, and remember a failure."""
        with self._remembering():
            self.stream.flush()

    def give_up(self) -> OSError | None:
        """Return why nothing more can be written, and let go of what waits; None if all is written."""
        with contextlib.suppress(OSError):
            self.flush()
        if self.failure is not None:
            with contextlib.suppress(OSError, ValueError):  # else Python fails once more when it ends
                os.dup2(os.open(os.devnull, os.O_WRONLY), self.stream.fileno())
        return self.failure

    @contextlib.contextmanager
    def _remembering(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            self.failure = error
            raise


@contextlib.contextmanager
def remembered_output() -> Iterator[Output | None]:
    """Let standard output be an :class:`Output` within the block; None if the command was started without one."""
    before, output = sys.stdout, None if sys.stdout is None else Output(sys.stdout)
    sys.stdout = output  # type: ignore[assignment]
    try:
        yield output
    finally:
        sys.stdout = before
