"""The notebooks: clean files (fast), and every cell run from start to end (slow)."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import nbformat
import pytest

FOLDER = Path(__file__).parent.parent / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
#: What a reader of a notebook has installed with .[notebook], and may have to know.
ALLOWED = {"bayeshunt", "numpy", "pandas", "matplotlib", "IPython"}

each_notebook = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem[:2])


def code_of(notebook: nbformat.NotebookNode) -> str:
    """All code cells as one Python module, without magics."""
    cells = [cell.source for cell in notebook.cells if cell.cell_type == "code"]
    return "\n".join(line for cell in cells for line in cell.splitlines() if not line.startswith("%"))


def test_all_are_there() -> None:
    assert [path.stem[:2] for path in NOTEBOOKS] == [f"{n:02d}" for n in range(1, 13)]


@each_notebook
def test_files_are_clean(path: Path) -> None:
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    ids = [cell.id for cell in notebook.cells]
    assert len(set(ids)) == len(ids)
    for cell in notebook.cells:
        assert cell.source.strip(), f"{cell.id} is empty"
        if cell.cell_type == "code":
            assert not cell.outputs, f"{cell.id}: strip the outputs"
            assert cell.execution_count is None, f"{cell.id}: strip the execution count"
    assert not re.search(r"/home/|/root|/tmp/|C:\\\\Users", path.read_text()), "a path of somebody's machine"


@each_notebook
def test_opens_with_a_question_and_a_figure(path: Path) -> None:
    notebook = nbformat.read(path, as_version=4)
    first, second = notebook.cells[:2]
    assert first.cell_type == "markdown"
    assert first.source.startswith(f"# {int(path.stem[:2])}. ")
    assert re.search(r"\*\*[^*]+\?\*\*", first.source), "the question, in bold"
    assert second.cell_type == "code"
    assert "figures." in second.source or "plt." in second.source


@each_notebook
def test_ends_with_three_tries_and_what_to_expect(path: Path) -> None:
    last = nbformat.read(path, as_version=4).cells[-1].source.split("## Try")[1]
    assert last.count("\n* ") == 3
    assert last.count("*Expect*") == 3
    assert "**Next:** notebook" in last


@each_notebook
def test_uses_the_public_interface_only(path: Path) -> None:
    import bayeshunt

    tree = ast.parse(code_of(nbformat.read(path, as_version=4)))
    for node in ast.walk(tree):
        names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
        names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
        for name in names:
            room = name.split(".")
            assert room[0] in ALLOWED | set(sys.stdlib_module_names), name
            assert room[0] != "bayeshunt" or room[1:] in ([], ["views"]), f"{name}: only bayeshunt and bayeshunt.views"
        if isinstance(node, ast.Attribute):
            assert not node.attr.startswith("_") or node.attr == "_fields", f"private: {node.attr}"
            if isinstance(node.value, ast.Name) and node.value.id == "bh":
                assert node.attr in bayeshunt.__all__, f"bh.{node.attr} is not public"


@each_notebook
def test_every_figure_has_words_for_those_who_cannot_see_it(path: Path) -> None:
    """A cell that draws ends in figures.described(figure, "what it shows"): no picture without its alternative text."""
    drawing = {"plt", "figures", "assess_figure"}
    for cell in nbformat.read(path, as_version=4).cells:
        if cell.cell_type != "code":
            continue
        tree = ast.parse(code_of(nbformat.v4.new_notebook(cells=[cell])))
        used = {n.value.id for n in ast.walk(tree) if isinstance(n, ast.Attribute) and isinstance(n.value, ast.Name)}
        last = tree.body[-1] if tree.body else None
        if not used & drawing:
            continue
        shown = isinstance(last, ast.Expr) and isinstance(last.value, ast.Call)
        assert shown, f"{cell.id} draws, and does not show it with its words"
        assert ast.unparse(last.value.func) == "figures.described", cell.id  # type: ignore[attr-defined]
        assert len(ast.literal_eval(last.value.args[1])) > 40, cell.id  # type: ignore[attr-defined]


@each_notebook
def test_gaits_have_their_colours_from_the_theme(path: Path) -> None:
    palettes = re.findall(r"\[(?:\s*\"#[0-9a-fA-F]{6}\",?){3,}", code_of(nbformat.read(path, as_version=4)))
    assert not palettes, "a palette of its own: use bayeshunt.views.theme"


@pytest.mark.slow
@each_notebook
def test_runs_from_start_to_end(path: Path, tmp_path: Path) -> None:
    """With nbmake, each cell with time enough on a slow machine."""
    command = [sys.executable, "-m", "pytest", "-q", "--nbmake", "--nbmake-timeout=600", "-p", "no:cacheprovider",
               "-o", "addopts=", str(path)]  # fmt: skip
    ran = subprocess.run(command, capture_output=True, text=True, cwd=FOLDER.parent, check=False)
    assert ran.returncode == 0, ran.stdout[-3000:]
    assert "1 passed" in ran.stdout


def test_the_first_notebook_serves_another_robot_as_its_exercise_says(monkeypatch) -> None:
    """Replaced by "car", every plot still has its dots."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    code = code_of(nbformat.read(NOTEBOOKS[0], as_version=4))
    assert 'bh.load_robot("khepera")' in code
    drawn: list[Any] = []
    monkeypatch.setattr("bayeshunt.views.figures.described", lambda figure, alt: drawn.append((figure, alt)))
    exec(code.replace('"khepera"', '"car"').replace("steps=2000", "steps=200"), {})
    pyplot.close("all")
    assert len(drawn) == 3
    for figure, alt in drawn:
        points = [line.get_xdata() for axes in figure.axes for line in axes.lines]
        assert sum(len(x) for x in points) > 20, alt
    assert "spin" not in drawn[1][1]
