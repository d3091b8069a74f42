"""What a command writes: options whose file or folder is looked at before any work; an output that may fail."""

from __future__ import annotations

import codecs
import contextlib
import os
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated, Any

import typer

from bayeshunt.core.errors import InputError
from bayeshunt.files.atomic import check_path, check_target
from bayeshunt.files.endings import check_ending

__all__ = [
    "Output",
    "Video",
    "out_figure",
    "out_file",
    "out_film",
    "out_folder",
    "out_map",
    "remembered_output",
    "say_written",
    "write_film",
]


def say_written(*places: Path | None) -> None:
    """Name the files and folders that were written, if any."""
    written = [str(place) for place in places if place is not None]
    if written:
        typer.echo(f"written: {', '.join(written)}")


def out_file(help_text: str, what: str, ending: str, *, within_out: bool = False) -> Any:
    """Return an option that names a file to write; a name that cannot be written is refused before any work.

    what, ending: what such files hold ("models") and how their names end (".json"); a name that ends as another
    kind of file is refused, any other ending is taken. within_out: it may stand in the folder of ``--out``, which
    the command makes itself.
    """

    def checked(context: typer.Context, path: Path | None) -> Path | None:
        if path is not None and not context.resilient_parsing:
            if not (within_out and _is_within_out(context, path)):
                _check_file(path)
            check_ending(path, what, ending)
        return path

    return typer.Option(help=help_text, callback=checked)


def out_figure(help_text: str) -> Any:
    """Return an option that names a figure to write: its ending says of which kind, and is needed."""
    return typer.Option(help=help_text, callback=_of_kinds(".png", ".svg"))


def out_map(help_text: str) -> Any:
    """Return an option, ``--map``, that names a page or a figure to write."""
    return typer.Option("--map", help=help_text, callback=_of_kinds(".html", ".png", ".svg"))


def out_film(help_text: str) -> Any:
    """Return an option that names a film to write: its ending says of which kind, and is needed."""
    return typer.Option(help=help_text, callback=_of_kinds(".gif", ".mp4"))


def _of_kinds(*endings: str) -> Callable[[typer.Context, Path | None], Path | None]:
    """A check of a file to write whose name ends in one of these."""
    *others, last = endings

    def checked(context: typer.Context, path: Path | None) -> Path | None:
        if path is not None and not context.resilient_parsing:
            _check_file(path)
            if path.suffix.lower() not in endings:
                raise InputError(f"{path}: expected a file name that ends in {', '.join(others)} or {last}")
        return path

    return checked


Video = Annotated[
    Path | None, out_film("Also write a film of the (first) hunt: .gif, or .mp4 where ffmpeg is installed.")
]


def write_film(episode: Any, path: Path) -> str:
    """Write the film of an episode; return a line that says so."""
    from bayeshunt.views.figures.film import SPEED, film

    film(episode, path)
    return f"{path}: {path.stat().st_size / 1e6:.1f} MB, {SPEED:g} times as fast as it was"


def out_folder(help_text: str) -> Any:
    """Return an option that names a folder to write into, made if need be; refused before any work if that fails."""
    return typer.Option(help=help_text, callback=_checked_folder, is_eager=True)  # before the files within it


def _check_file(path: Path) -> None:
    check_target(path)
    if not path.parent.is_dir():
        raise InputError(f"{path}: the folder {path.parent} does not exist; make it first")
    _check_writable(path, Path(os.path.realpath(path)).parent)


def _is_within_out(context: typer.Context, path: Path) -> bool:
    """Whether a file is to stand in the folder of ``--out``, which has been looked at."""
    folder = context.params.get("out")
    return folder is not None and path.parent.resolve() == Path(folder).resolve()


def _checked_folder(context: typer.Context, path: Path | None) -> Path | None:
    if path is not None and not context.resilient_parsing:
        check_path(path, "the name of a folder to write into", InputError)
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


_PLAINLY = "bayeshunt-plainly"
#: What units and numbers are written with where an encoding lacks them; anything else is a "?".
_PLAIN = {"°": " deg", "−": "-", "²": "2", "±": "+-"}


def _plainly(error: UnicodeError) -> tuple[str, int]:
    """An error handler of an encoding: the characters that it lacks, in those that it has."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(_PLAIN.get(c, "?") for c in error.object[error.start : error.end]), error.end


codecs.register_error(_PLAINLY, _plainly)


class Output:
    """Standard output that remembers why it failed: an OSError of its own is told from one of the work.

    Characters that its encoding lacks come out in plain words or as "?", rather than end the command.
    """

    def __init__(self, stream: Any) -> None:
        self.stream = stream
        self.failure: OSError | None = None
        if getattr(stream, "errors", None) in ("strict", "surrogateescape") and hasattr(stream, "reconfigure"):
            stream.reconfigure(errors=_PLAINLY)

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
    sys.stdout = output
    try:
        yield output
    finally:
        sys.stdout = before
