"""The command line: thin commands over the library, one module per group, in the order of --help."""

from __future__ import annotations

import sys
from typing import Any

import typer

from bayeshunt.cli import learning  # noqa: F401  isort: skip
from bayeshunt.cli import assess  # noqa: F401  isort: skip
from bayeshunt.cli import hunts  # noqa: F401  isort: skip
from bayeshunt.cli import experiments  # noqa: F401  isort: skip
from bayeshunt.cli import report  # noqa: F401  isort: skip
from bayeshunt.cli import figures  # noqa: F401  isort: skip
from bayeshunt.cli import sweeps  # noqa: F401  isort: skip
from bayeshunt.cli import prepared  # noqa: F401  isort: skip
from bayeshunt.cli import catalogue  # noqa: F401  isort: skip
from bayeshunt.cli import settings  # noqa: F401  isort: skip
from bayeshunt.cli.app import app
from bayeshunt.cli.stopping import StoppedError
from bayeshunt.errors import BayesHuntError, InputError


def main() -> None:
    """Run the command line; exit 2 for wrong input, 1 for failed work, each with one line on stderr."""
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
    except BrokenPipeError:
        sys.stderr.close()
        sys.exit(0)
    except Exception as error:
        if not hasattr(error, "format_message"):  # not a usage error: a defect, which deserves its traceback
            raise
        _fail(error.format_message().splitlines()[0] + " (see --help)", 2)
    if status == 130:  # what typer makes of Ctrl-C
        _fail("stopped", 130)
    sys.exit(status if isinstance(status, int) else 0)


def _fail(message: Any, status: int) -> None:
    line = " ".join(str(message).split())
    print(f"bayeshunt: {line}", file=sys.stderr)
    sys.exit(status)
