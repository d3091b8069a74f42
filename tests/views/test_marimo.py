"""A notebook of marimo run without a browser: it takes our widgets and cards."""

import json
import re
import subprocess
import sys

import pytest

pytest.importorskip("marimo", reason="marimo is not installed (extra: marimo)")
pytest.importorskip("anywidget", reason="anywidget is not installed (extra: notebook)")
pytestmark = pytest.mark.slow

NOTEBOOK = """import marimo

app = marimo.App()


@app.cell
def _():
    import bayeshunt as bh

    robot = bh.load_robot("khepera")
    table = bh.babble(robot, 60, seed=0)
    model = bh.ForwardModel.fit(table, robot.gaits)
    return bh, model, robot, table


@app.cell
def _(bh, model):
    bh.Network(model)
    return


@app.cell
def _(bh, robot, table):
    bh.Learning(table, robot.gaits)
    return


@app.cell
def _(model):
    model.table("Angle")
    return
"""


def test_widgets_and_cards_are_what_marimo_takes(tmp_path):
    (tmp_path / "shown.py").write_text(NOTEBOOK)
    command = [sys.executable, "-m", "marimo", "export", "html", "shown.py", "-o", "shown.html"]
    ran = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert ran.returncode == 0, ran.stderr
    page = (tmp_path / "shown.html").read_text(encoding="utf-8")
    cells = [json.JSONDecoder().raw_decode(page, place.end() - 1)[0] for place in re.finditer(r'"data": ?\{', page)]
    pages = [cell["text/html"] for cell in cells if "text/html" in cell]
    taken = [("<marimo-anywidget" in page, 'class="bh"' in page) for page in pages]
    assert taken == [(True, False), (True, False), (False, True)]
