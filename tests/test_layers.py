"""The house: imports go down only, heavy libraries live in one room each, the package is small inside."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parent.parent / "bayeshunt"

#: Layer -> (level, place on the level). Imports go to a lower level or to an earlier place on the same one.
ROOMS = {
    "core": (0, 0),
    "files": (1, 0),
    "config": (2, 0),
    "data": (3, 0),
    "models": (3, 1),
    "worlds": (3, 1),
    "perception": (4, 0),
    "planners": (5, 0),
    "episodes": (6, 0),
    "experiments": (7, 0),
    "views": (8, 0),
    "envs": (8, 0),
    "cli": (9, 0),
}
#: Layers that must not see each other.
STRANGERS = {("worlds", "models"), ("models", "worlds"), ("planners", "worlds"), ("views", "envs"), ("envs", "views")}
#: Library -> the only room that may import it.
HOMES = {"Box2D": "worlds", "pgmpy": "models", "matplotlib": "views", "jinja2": "views", "typer": "cli"}

MODULES = sorted(PACKAGE.rglob("*.py"))


def room_of(path):
    return path.relative_to(PACKAGE).with_suffix("").parts[0]


def imports_of(path):
    """Every module imported anywhere in the file, except for type checking only."""
    tree = ast.parse(path.read_text())
    typing_only = {
        id(inner)
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)
        for inner in ast.walk(node)
    }
    for node in ast.walk(tree):
        if id(node) in typing_only:
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_imports_go_down(path):
    room = room_of(path)
    if room in ("__init__", "__main__"):  # the doors
        return
    assert room in ROOMS, f"{room} has no floor: give it one here and in CONTRIBUTING.md"
    for name in imports_of(path):
        parts = name.split(".")
        if parts[0] in HOMES:
            assert room == HOMES[parts[0]], f"{path.name} imports {parts[0]}, which lives in {HOMES[parts[0]]}/"
        if parts[0] != "bayeshunt" or len(parts) < 2 or parts[1] == room:
            continue
        if parts[1] not in ROOMS:
            continue
        assert (room, parts[1]) not in STRANGERS, f"{path.name}: {room}/ must not see {parts[1]}/"
        assert ROOMS[parts[1]] < ROOMS[room], f"{path.name}: {room} (floor {ROOMS[room]}) imports {parts[1]}"


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_modules_stay_readable(path):
    assert len(path.read_text().splitlines()) <= 400, "two reasons to exist? split it by meaning"


def test_help_and_import_leave_the_heavy_libraries_alone():
    code = (
        "import sys, bayeshunt, bayeshunt.cli\n"
        "heavy = {'pgmpy', 'numpy', 'pandas', 'matplotlib', 'Box2D', 'scipy', 'sklearn', 'joblib'} & set(sys.modules)\n"
        "assert not heavy, heavy"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_every_public_name_is_there():
    import bayeshunt

    for name in bayeshunt.__all__:
        assert getattr(bayeshunt, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        bayeshunt.nonsense  # noqa: B018
