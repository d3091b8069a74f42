"""The layers: imports go down only, in no circle; heavy libraries have one home; modules and folders stay small."""

import ast
import re
import subprocess
import sys
from collections import Counter
from functools import cache

import pytest
from layers import PACKAGE, circle, imports, modules, names_imported

#: Layer -> its level. Imports go to a lower level; layers of one level do not see each other, but that
#: those after ``data`` may read its tables.
LEVELS = {
    "core": 0,
    "files": 1,
    "config": 2,
    "data": 3,
    "models": 4,
    "worlds": 4,
    "perception": 5,
    "planners": 6,
    "episodes": 7,
    "experiments": 8,
    "views": 9,
    "envs": 9,
    "cli": 10,
}
#: Pairs that must not meet although one stands below the other: a planner knows nothing of physics.
STRANGERS = {("planners", "worlds")}
#: Library -> the only layers that may import it.
HOMES = {
    "Box2D": ("worlds",),
    "mujoco": ("worlds",),
    "pgmpy": ("models",),
    "matplotlib": ("views",),
    "jinja2": ("views",),
    "typer": ("cli",),
    "gymnasium": ("envs",),
    "pettingzoo": ("envs",),
    "pygame": ("envs",),
}
#: The doors of the package: they name the public things of every layer.
DOORS = ("bayeshunt", "bayeshunt.__main__", "bayeshunt.protocols")

SOURCES = {name: text for name, text in modules().items() if name not in DOORS}


def layer_of(module):
    return module.split(".")[1]


def allowed(importer, imported):
    """Whether a module of one layer may import from another."""
    if importer == imported:
        return True
    return LEVELS[imported] < LEVELS[importer] and (importer, imported) not in STRANGERS


def wrong_imports(sources):
    return [
        f"{name} imports {other}"
        for name, others in imports(sources).items()
        for other in sorted(others - set(DOORS))
        if not allowed(layer_of(name), layer_of(other))
    ]


def test_every_layer_has_its_level():
    assert {layer_of(name) for name in SOURCES} <= set(LEVELS), (
        "a new layer: give it a level here and in CONTRIBUTING.md"
    )


def test_imports_go_down():
    assert wrong_imports(SOURCES) == []


@pytest.mark.parametrize(
    ("module", "line"),
    [
        ("bayeshunt.core.bins", "from bayeshunt.files import atomic"),
        ("bayeshunt.models.body.forward", "import bayeshunt.worlds.babbling"),
        ("bayeshunt.planners.api", "def f():\n    from bayeshunt.worlds.babbling import babble"),
        ("bayeshunt.worlds.babbling", "if TYPE_CHECKING:\n    from bayeshunt.models.body.forward import ForwardModel"),
    ],
)
def test_one_import_that_goes_up_is_found(module, line):
    changed = {**SOURCES, module: f"{SOURCES[module]}\n{line}\n"}
    assert [text.split()[0] for text in wrong_imports(changed)] == [module]


def test_no_circle_of_imports():
    assert circle(imports(SOURCES)) == []


@pytest.mark.parametrize(
    "line",
    [
        "from bayeshunt.core.gaits import Gait",
        "if TYPE_CHECKING:\n    from bayeshunt.core.gaits import Gait",
        "def late():\n    from bayeshunt.core import gaits",
        "def late():\n    import bayeshunt.core.gaits",
    ],
)
def test_a_circle_that_is_put_in_is_found(line):
    changed = {**SOURCES, "bayeshunt.core.errors": f"{SOURCES['bayeshunt.core.errors']}\n{line}\n"}
    found = circle(imports(changed))
    assert {"bayeshunt.core.errors", "bayeshunt.core.gaits"} <= set(found)


def test_a_heavy_library_is_imported_in_its_home_only():
    strangers = [
        f"{name} imports {library}"
        for name, text in SOURCES.items()
        for library in {imported.partition(".")[0] for imported in names_imported(text)} & set(HOMES)
        if layer_of(name) not in HOMES[library]
    ]
    assert strangers == []


def test_modules_stay_readable():
    long = {name: lines for name, text in SOURCES.items() if (lines := len(text.splitlines())) > 400}
    assert not long, "two reasons to exist? split it by meaning"


def test_folders_stay_small():
    counts = Counter(path.parent.relative_to(PACKAGE) for path in PACKAGE.rglob("*.py") if path.name != "__init__.py")
    assert not {str(folder): count for folder, count in counts.items() if count > 16}


@cache
def statements(text):
    """What stands at the top of a module: read once for all tests of it."""
    return ast.parse(text).body


def unlisted(sources):
    """Public functions and classes of modules that ``__all__`` does not name."""
    for name, text in sources.items():
        body = statements(text)
        named = [
            node.value for node in body if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__"
        ]
        listed = {word.value for word in ast.walk(*named) if isinstance(word, ast.Constant)} if named else set()
        public = [node.name for node in body if isinstance(node, (ast.FunctionDef, ast.ClassDef))]
        yield from (f"{name}.{one}" for one in public if not one.startswith("_") and one not in listed)


def test_every_module_says_what_is_public():
    assert list(unlisted(SOURCES)) == []
    text = '__all__ = ["one"]\n\ndef one():\n    pass\n\ndef two():\n    pass\n\ndef _own():\n    pass\n'
    assert list(unlisted({"bayeshunt.core.put_in": text})) == ["bayeshunt.core.put_in.two"]


def unused(sources):
    """Functions and classes of modules that nothing names but their own definition and ``__all__``."""
    named = Counter(word for text in sources.values() for word in re.findall(r"\w+", text))
    return [
        f"{name}.{node.name}"
        for name, text in sources.items()
        for node in statements(text)
        if isinstance(node, (ast.FunctionDef, ast.ClassDef))
        and not any(isinstance(mark, ast.Call) for mark in node.decorator_list)  # commands
        and named[node.name] <= (2 if f'"{node.name}"' in text else 1)
    ]


#: What only readers of the manual call.
FOR_READERS = ["bayeshunt.experiments.studies.active.compare_babbling"]


def test_nothing_is_there_for_nobody():
    sources = modules()
    assert [name for name in unused(sources) if not name.endswith((".__dir__", ".__getattr__"))] == FOR_READERS
    put_in = {**sources, "bayeshunt.core.spare": '__all__ = ["for_nobody"]\n\ndef for_nobody():\n    return 1\n'}
    assert "bayeshunt.core.spare.for_nobody" in unused(put_in)


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
