"""The source of planners and prey that do not ship: their files, and what those import from their own folder."""

from __future__ import annotations

import ast
import contextlib
import hashlib
import inspect
import sysconfig
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

__all__ = ["imported_files", "source_hashes"]


def source_hashes(used: dict[str, Any]) -> dict[str, str]:
    """Return the SHA-256 of the source of each class or function in ``used``, by its name there.

    Beside each stand the modules that its file imports from its own folder or package, and those that they
    import, as "helper.py of NAME". They are found by reading the ``import`` lines, wherever in a file they
    stand. Not covered are names that are only known at run time (``importlib.import_module(name)``), data
    that the code reads, and packages installed elsewhere. Left out is whatever Python knows no source of.
    """
    found: dict[str, str] = {}
    for name, thing in used.items():
        file = _file_of(thing)
        source = _typed_source(thing) if file is None else file.read_bytes()
        if source:
            found[name] = hashlib.sha256(source).hexdigest()
        helpers = [] if file is None else [(path, path.relative_to(_top(file))) for path in imported_files(file)]
        for path, shown in helpers:
            key = f"{shown.as_posix()} of {name.removeprefix('with ')}"
            found[key] = hashlib.sha256(path.read_bytes()).hexdigest()
    return found


def imported_files(file: Path) -> list[Path]:
    """Return the modules that a Python file imports from its own folder or package, and so on, in order of path.

    The file itself is not among them.
    """
    top, own = _top(file), _first(file, _top(file))
    shared = top in _installed()  # then everything else that is installed lies beside it
    seen, left = {file}, [file]
    while left:
        for found in _imports(left.pop(), {file.parent, top}):
            first = _first(found, top)
            if found not in seen and first not in ("", "bayeshunt") and (first == own or not shared):
                seen.add(found)
                left.append(found)
    return sorted(seen - {file})


def _imports(file: Path, folders: set[Path]) -> Iterator[Path]:
    """The files of the modules that a file names in its ``import`` lines, as far as they lie in ``folders``."""
    for folder in file.relative_to(_top(file)).parents:
        yield from _modules([_top(file)], [*folder.parts])
    with contextlib.suppress(SyntaxError, ValueError, OSError, IndexError):
        for node in ast.walk(ast.parse(file.read_bytes())):
            if isinstance(node, ast.Import):
                for alias in node.names:
                    yield from _modules(folders, alias.name.split("."))
            elif isinstance(node, ast.ImportFrom):
                within = [file.parents[node.level - 1]] if node.level else folders
                parts = node.module.split(".") if node.module else []
                for alias in node.names:  # a module, or a thing in one
                    yield from _modules(within, [*parts, alias.name])


def _modules(folders: Iterable[Path], parts: list[str]) -> Iterator[Path]:
    """The files that importing ``a.b.c`` from one of the folders runs: those of a, of a.b and of a.b.c."""
    for folder in folders:
        for depth in range(1, len(parts) + 1):
            place = folder.joinpath(*parts[:depth])
            found = next((f for f in (place / "__init__.py", place.with_name(f"{place.name}.py")) if f.is_file()), None)
            if found is not None:
                yield found
            elif not place.is_dir():
                break


def _first(file: Path, top: Path) -> str:
    """The name by which a file, or the package it stands in, is imported from ``top``; "" if it is not there."""
    return Path(file.relative_to(top).parts[0]).stem if file.is_relative_to(top) else ""


def _top(file: Path) -> Path:
    """The folder that a file's imports start from: the one that holds its package, or its own."""
    return next(folder for folder in file.parents if not (folder / "__init__.py").is_file())


def _installed() -> set[Path]:
    return {Path(sysconfig.get_path(name)).resolve() for name in ("stdlib", "purelib", "platlib")}


def _file_of(thing: Any) -> Path | None:
    """The file that a class or function stands in, if it stands in one."""
    with contextlib.suppress(TypeError, OSError):
        file = Path(inspect.getsourcefile(thing) or "").resolve()
        return file if file.is_file() else None
    return None


def _typed_source(thing: Any) -> bytes:
    """The methods of a class typed into a notebook; else nothing."""
    texts = []
    for part in (thing, *vars(thing).values()) if hasattr(thing, "__dict__") else ():
        with contextlib.suppress(TypeError, OSError):
            texts.append(inspect.getsource(part))
    return "\n".join(texts).encode()
