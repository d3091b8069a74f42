"""The exercises of the lecture: a right and a wrong answer of each, and both notebooks as they stand."""

import re
import sys
from pathlib import Path

import nbformat
import numpy as np
import pytest

FOLDER = Path(__file__).parents[2] / "notebooks" / "teaching"
sys.path.insert(0, str(FOLDER))
checks = pytest.importorskip("checks")

WRONG = {
    1: (lambda counts: counts / counts.to_numpy().sum(), "Divide every column by its own sum"),
    2: (lambda table, p_gait: table.mean(axis=1), "weigh each column"),
    3: (lambda table, p_gait, seen: table.loc[seen] / table.loc[seen].sum(), "equally probable"),
    4: (lambda p, d, a: (d + a) / (d + a).sum(), "Independent evidence multiplies"),
    5: (lambda counts, prior: (counts + prior) / counts.sum(), "once for every cell"),
    6: (lambda table: np.float64("nan"), "0 log 0"),
    7: (lambda p: np.log(p).mean(), "mind the sign"),
}


def answers(name: str) -> dict[int, str]:
    """The code of each exercise in a notebook."""
    cells = nbformat.read(FOLDER / f"{name}.ipynb", as_version=4).cells
    found = [
        (re.search(r"check\((\d), \w+\)$", cell.source), cell.source) for cell in cells if cell.cell_type == "code"
    ]
    return {int(place[1]): code for place, code in found if place}


def verdict(code: str, number: int):
    names = {"check": checks.check}
    exec(code, names)
    return eval(code.splitlines()[-1], names)


@pytest.mark.parametrize("number", range(1, 8))
def test_the_solution_is_right(number):
    assert verdict(answers("solutions")[number], number).right


@pytest.mark.parametrize("number", range(1, 8))
def test_an_open_exercise_says_so(number):
    said = verdict(answers("exercises")[number], number)
    assert not said.right
    assert "returned nothing" in repr(said)


@pytest.mark.parametrize("number", range(1, 8))
def test_a_wrong_answer_is_told_what_is_wrong(number):
    wrong, hint = WRONG[number]
    said = checks.check(number, wrong)
    assert not said.right
    assert hint in said.said


@pytest.mark.parametrize("number", range(1, 8))
def test_a_broken_answer_does_not_stop_the_notebook(number):
    def broken(*_):
        raise KeyError("typo")

    assert "KeyError" in repr(checks.check(number, broken))
    assert "shape" in checks.check(number, lambda *_: np.zeros((2, 3))).said


@pytest.mark.parametrize("number", [8, 0, "1", None, [1]])
def test_an_exercise_that_there_is_not_is_named(number):
    said = checks.check(number, lambda *_: 1.0)
    assert not said.right
    assert repr(said) == f"Exercise {number!r}: not yet. there is no such exercise; they are the numbers 1 to 7."


@pytest.mark.parametrize("number", range(1, 6))
def test_percent_is_told_from_a_share(number):
    names = {"check": lambda _, answer: answer}
    exec(answers("solutions")[number], names)
    answer = eval(answers("solutions")[number].splitlines()[-1], names)
    said = checks.check(number, lambda *given: 100 * answer(*given))
    assert not said.right
    assert "percent" in said.said


@pytest.mark.parametrize("name", ["exercises", "solutions"])
def test_the_notebooks_are_clean_and_teach(name):
    notebook = nbformat.read(FOLDER / f"{name}.ipynb", as_version=4)
    nbformat.validate(notebook)
    assert all(not cell.outputs and cell.execution_count is None for cell in notebook.cells if "outputs" in cell)
    assert len(answers(name)) == 7
    assert re.search(r"\*\*[^*]+\?\*\*", notebook.cells[0].source)
    assert notebook.cells[-1].source.count("*Expect*") == 3


@pytest.mark.slow
@pytest.mark.parametrize("name", ["exercises", "solutions"])
def test_the_notebook_runs_from_start_to_end(name):
    from nbclient import NotebookClient

    notebook = nbformat.read(FOLDER / f"{name}.ipynb", as_version=4)
    NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(FOLDER)}}).execute()
    right = str(notebook).count("right. ")
    assert right == (7 if name == "solutions" else 0)


@pytest.mark.parametrize("name", ["exercises", "solutions"])
def test_a_notebook_without_its_checks_says_where_they_are(name, monkeypatch):
    cell = next(c for c in nbformat.read(FOLDER / f"{name}.ipynb", as_version=4).cells if c.cell_type == "code")
    lines = cell.source.splitlines()
    first = lines.index("try:")
    monkeypatch.setitem(sys.modules, "checks", None)
    with pytest.raises(ModuleNotFoundError, match="must lie beside this notebook; copy it from notebooks/teaching"):
        exec("\n".join(lines[first : first + 4]), {})


def test_the_sliders_show_what_is_drawn(monkeypatch):
    interaction = pytest.importorskip("ipywidgets.widgets.interaction", reason="ipywidgets is not installed")
    shown: list[object] = []
    monkeypatch.setattr(interaction, "display", shown.append)
    knobs = checks.sliders(lambda prior, bins, structure: (prior, bins, structure))
    assert shown == [(0.03, 36, "naive")]
    knobs.children[0].value = 1.0
    knobs.children[2].value = "tan"
    assert shown[1:] == [(1.0, 36, "naive"), (1.0, 36, "tan")]
