"""What the commands of the benchmarks share: their help, ``--json``, and the figures as text or as JSON."""

from __future__ import annotations

import argparse
import json
import logging
import warnings
from collections.abc import Callable
from typing import Any

__all__ = ["command", "quiet_pgmpy", "show"]


def command(doc: str | None) -> argparse.ArgumentParser:
    """Return a parser whose help is the module's ``doc``, with ``--json``."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", action="store_true", help="print the figures as JSON")
    return parser


def show(facts: dict[str, Any], report: Callable[[dict[str, Any]], str], options: argparse.Namespace) -> None:
    """Print the figures as ``options`` of :func:`command` ask."""
    print(json.dumps(facts) if options.json else report(facts))


def quiet_pgmpy() -> None:
    """Keep pgmpy, which warns of its own deprecations when imported, from writing among the figures."""
    warnings.simplefilter("ignore")
    logging.getLogger("pgmpy").setLevel(logging.ERROR)
