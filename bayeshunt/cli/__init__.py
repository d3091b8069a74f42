"""The command line: thin commands over the library, one module per group, in the order of --help."""

from __future__ import annotations

import contextlib
import re
import sys
import warnings
from typing import Any, NoReturn

import typer

from bayeshunt.cli import learning  # noqa: F401  isort: skip
from bayeshunt.cli import ingest  # noqa: F401  isort: skip
from bayeshunt.cli import assess  # noqa: F401  isort: skip
from bayeshunt.cli import hunts  # noqa: F401  isort: skip
from bayeshunt.cli import experiments  # noqa: F401  isort: skip
from bayeshunt.cli import report  # noqa: F401  isort: skip
from bayeshunt.cli import figures  # noqa: F401  isort: skip
from bayeshunt.cli import sweeps  # noqa: F401  isort: skip
from bayeshunt.cli import prepared  # noqa: F401  isort: skip
from bayeshunt.cli import prey  # noqa: F401  isort: skip
from bayeshunt.cli import catalogue  # noqa: F401  isort: skip
from bayeshunt.cli import doctor  # noqa: F401  isort: skip
from bayeshunt.cli.app import app
from bayeshunt.cli.outputs import remembered_output
from bayeshunt.cli.stopping import StoppedError
from bayeshunt.core.errors import BayesHuntError, DataWarning, DeprecatedNameWarning, InputError

__all__ = ["main"]

#: The warnings that this command has printed.
_SAID: set[str] = set()


def main() -> None:
    """Run the command line; exit 2 for wrong input, 1 for failed work, each with one line on stderr."""
    warnings.showwarning = _show_warning  # type: ignore[assignment]  # the places are of no use here
    warnings.simplefilter("always", DataWarning)
    warnings.simplefilter("always", DeprecatedNameWarning)
    _SAID.clear()
    with remembered_output() as output:
        try:
            status = _run()
        except (SystemExit, OSError):
            if output is None or output.failure is None:
                raise
            status = 0  # typer and rich leave by SystemExit when a pipe is closed
        failure = None if output is None else output.give_up()
    if failure is not None and not isinstance(failure, BrokenPipeError):  # who closes a pipe wants no more of it
        _fail(f"the output cannot be written ({failure.strerror or failure})", 1)
    sys.exit(status)


def _run() -> int:
    """Run the command that was typed; return its exit status, or leave with one line."""
    command = typer.main.get_command(app)
    try:
        status = command.main(sys.argv[1:] or ["--help"], prog_name="bayeshunt", standalone_mode=False)
    except InputError as error:
        _fail(error, 2)
    except BayesHuntError as error:
        _fail(error, 1)
    except StoppedError as stopped:
        _fail(stopped, 130)
    except (KeyboardInterrupt, typer.Abort):
        _fail("stopped", 130)
    except Exception as error:
        if not hasattr(error, "format_message"):  # not a usage error: a defect, which deserves its traceback
            raise
        _fail(_usage(error), 2)
    if status == 130:  # what typer makes of Ctrl-C
        _fail("stopped", 130)
    return status if isinstance(status, int) else 0


def _usage(error: Any) -> str:
    """What is wrong with the words of a command, in one line; of options that may be meant, the nearest."""
    near = getattr(error, "possibilities", None) if hasattr(error, "option_name") else None
    said = f"{error.message}; did you mean {near[0]!r}?" if near else error.format_message().splitlines()[0]
    return f"{said} (see --help)"


def _as_typed(message: Any) -> str:
    """A message on one line in which what is said both ways, "unit='cm' (--unit cm)", is said as it is typed here."""
    line = " ".join(str(message).split())
    return re.sub(r"\b\w+=(?:\([^)]*\)|[^\s()]*) \((--[^)]+)\)", r"\1", line)


def _show_warning(message: Warning | str, category: type[Warning], *where: Any) -> None:
    """A warning about the input, or of a name that is to go, is one line, said once; others are not for users."""
    told = issubclass(category, (DataWarning, DeprecatedNameWarning))
    if told and sys.stderr is not None and str(message) not in _SAID:
        _SAID.add(str(message))
        with contextlib.suppress(OSError):
            print(f"bayeshunt: warning: {_as_typed(message)}", file=sys.stderr, flush=True)


def _fail(message: Any, status: int) -> NoReturn:
    line = _as_typed(message)
    with contextlib.suppress(OSError):  # nobody can be told
        if sys.stderr is not None:
            print(f"bayeshunt: {line}", file=sys.stderr, flush=True)
    sys.exit(status)
