"""Who imports whom, read from the source: every import counts, those for type checking and inside functions too."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "bayeshunt"


def modules(folder: Path = PACKAGE) -> dict[str, str]:
    """Return the source of every module below ``folder`` by its dotted name; a package goes by its folder's."""
    found = {}
    for path in sorted(folder.rglob("*.py")):
        parts = path.relative_to(folder.parent).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path.read_text(encoding="utf-8")
    return found


@cache
def names_imported(source: str) -> tuple[str, ...]:
    """Return every name that a module imports, in full: "bayeshunt.core.bins.Axis", "numpy"; read once."""
    found: list[str] = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found += (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            found += (f"{node.module}.{alias.name}" for alias in node.names)
    return tuple(found)


def imports(sources: Mapping[str, str]) -> dict[str, set[str]]:
    """Return the modules among ``sources`` that each of them imports."""
    return {name: set(_known(names_imported(text), sources)) - {name} for name, text in sources.items()}


def circle(graph: Mapping[str, set[str]]) -> list[str]:
    """Return the modules of one circle of imports in order, none if there is no circle."""
    try:
        tuple(TopologicalSorter(graph).static_order())
    except CycleError as error:
        return list(error.args[1])
    return []


def _known(names: Iterable[str], sources: Mapping[str, str]) -> Iterator[str]:
    for name in names:
        if name in sources:
            yield name
        elif name.rpartition(".")[0] in sources:
            yield name.rpartition(".")[0]
