"""The explorer widget inside a real JupyterLab."""

from __future__ import annotations

import json
import os
import re
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from math import atan2, cos, sin

import pytest
from waiting import eventually, wait_until

import bayeshunt as bh
from bayeshunt.core import units

pytest.importorskip("anywidget", reason="anywidget is not installed (extra: notebook)")
pytest.importorskip("jupyterlab", reason="jupyterlab is not installed (extra: notebook)")
pytestmark = pytest.mark.slow

TOKEN = "only-for-this-test"
CELLS = (
    "import bayeshunt as bh\n"
    "explorer = bh.Explorer(bh.ForwardModel.load('model.json'), distance=0.1, angle=0.5)\n"
    "explorer",
    "print(f'{explorer.distance!r} {explorer.angle!r} {explorer.answer.best}')",
    "explorer.distance, explorer.angle = 0.05, -1.0",
    "explorer.inverse.model.table('Angle')",
)


@pytest.fixture(scope="module")
def notebook(model, tmp_path_factory):
    """The address of a notebook that shows the explorer, in a JupyterLab on the loopback interface."""
    folder = tmp_path_factory.mktemp("lab")
    work = folder / "work"
    work.mkdir()
    model.save(work / "model.json")
    write_notebook(work / "explorer.ipynb")
    port = free_port()
    log = (folder / "log.txt").open("w")
    command = [
        sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root", "--ServerApp.ip=127.0.0.1",
        f"--ServerApp.port={port}", "--ServerApp.port_retries=0", f"--ServerApp.root_dir={work}",
        f"--IdentityProvider.token={TOKEN}",
    ]  # fmt: skip
    server = subprocess.Popen(command, env=isolated(folder), cwd=work, stdout=log, stderr=log)
    try:
        wait_for(f"http://127.0.0.1:{port}/api?token={TOKEN}", server, folder / "log.txt")
        yield f"http://127.0.0.1:{port}/lab/tree/explorer.ipynb?token={TOKEN}"
    finally:
        server.terminate()
        try:
            server.wait(20)
        except subprocess.TimeoutExpired:
            server.kill()
        log.close()


def write_notebook(path):
    cells = [
        {"cell_type": "code", "id": f"cell-{i}", "source": code, "metadata": {}, "outputs": [], "execution_count": None}
        for i, code in enumerate(CELLS)
    ]
    kernel = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    path.write_text(json.dumps({"cells": cells, "metadata": kernel, "nbformat": 4, "nbformat_minor": 5}))


def isolated(folder):
    """An environment in which Jupyter reads and writes nothing outside ``folder``."""
    kernel = folder / "data" / "kernels" / "python3"
    kernel.mkdir(parents=True)
    command = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
    spec = {"argv": command, "display_name": "Python 3", "language": "python"}
    (kernel / "kernel.json").write_text(json.dumps(spec))
    quiet = folder / "config" / "labconfig" / "page_config.json"
    quiet.parent.mkdir(parents=True)
    quiet.write_text(json.dumps({"disabledExtensions": {"@jupyterlab/apputils-extension:announcements": True}}))
    places = {
        "JUPYTER_CONFIG_DIR": "config", "JUPYTER_DATA_DIR": "data", "JUPYTER_RUNTIME_DIR": "runtime",
        "JUPYTERLAB_SETTINGS_DIR": "settings", "JUPYTERLAB_WORKSPACES_DIR": "workspaces", "IPYTHONDIR": "ipython",
    }  # fmt: skip
    return {**os.environ, **{name: str(folder / place) for name, place in places.items()}}


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def wait_for(address, server, log):
    end = time.monotonic() + 90
    while time.monotonic() < end:
        assert server.poll() is None, f"JupyterLab stopped:\n{log.read_text()[-2000:]}"
        try:
            urllib.request.urlopen(address, timeout=5).close()
            return
        except (urllib.error.URLError, OSError):
            time.sleep(0.3)
    raise AssertionError(f"JupyterLab did not answer:\n{log.read_text()[-2000:]}")


def run_cell(page, number):
    """Run a cell, wait until the kernel is done with it, and return it."""
    cell = page.locator(".jp-Notebook .jp-CodeCell").nth(number)
    prompt = cell.locator(".jp-InputPrompt")
    before = prompt.inner_text()
    # JupyterLab drops, or asks about, what is run before its kernel is connected.
    wait_until(lambda: "| Idle" in page.locator("#jp-main-statusbar").inner_text(), seconds=60)
    for _ in range(30):
        cell.locator(".cm-content").click()
        page.keyboard.press("Control+Enter")
        page.wait_for_timeout(1000)
        wait_until(lambda: "*" not in prompt.inner_text(), seconds=60)
        if re.search(r"\[\d+\]", prompt.inner_text()) and prompt.inner_text() != before:
            return cell
    raise AssertionError("the kernel did not run the cell")


def shown(widget):
    """Gait -> probability as displayed, and the facts."""
    rows = widget.locator("table.gaits tr")
    bars = {
        rows.nth(i).locator("th").inner_text(): float(rows.nth(i).locator(".value").inner_text())
        for i in range(rows.count())
    }
    facts = {
        name: widget.locator(f"[data-fact='{name}']").inner_text()
        for name in ("learned cell", "P(evidence)", "support")
    }
    return bars, facts


def assert_shows(widget, answer):
    bars, facts = shown(widget)
    assert list(bars) == list(answer.probabilities.index)
    for gait, probability in answer.probabilities.items():
        assert bars[gait] == pytest.approx(probability, abs=5.01e-4)
    labels = answer.cell.distance_label, answer.cell.angle_label
    assert facts["learned cell"].startswith(", ".join(units.true_minus(units.label(label)) for label in labels))
    assert float(facts["P(evidence)"]) == pytest.approx(answer.evidence_probability, rel=1e-3)
    assert facts["support"].split()[0] == str(answer.support)


def python_side(page):
    """What the kernel holds: distance, angle and best gait."""
    output = run_cell(page, 1).locator(".jp-OutputArea-output")
    wait_until(lambda: output.count() == 1)
    distance, angle, best = output.inner_text().strip().split(maxsplit=2)
    return float(distance), float(angle), best


def test_the_explorer_works_in_jupyterlab(open_page, notebook, model):
    page, watch = open_page(notebook)
    page.wait_for_selector(".jp-Notebook .jp-CodeCell", timeout=60_000)
    widget = run_cell(page, 0).locator(".bh-explorer")
    widget.wait_for(timeout=60_000)
    inverse = bh.InverseModel(model)
    assert_shows(widget, inverse.posterior(0.1, 0.5))

    # Dragged to the right of the robot, the target moves and Python answers.
    picture = widget.locator("svg[role=application]")
    box = picture.bounding_box()
    grip = widget.locator("circle.target-grip[r='13']").bounding_box()
    page.mouse.move(grip["x"] + grip["width"] / 2, grip["y"] + grip["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.7 * box["width"], box["y"] + 0.42 * box["height"], steps=8)
    page.mouse.up()

    def dragged():
        distance, angle, best = python_side(page)
        # 0.2 to the right and 0.08 up of the middle of the picture, whatever its scale.
        assert angle == pytest.approx(atan2(0.2, 0.08), abs=0.02)
        assert inverse.posterior(distance, angle).best == best
        assert_shows(widget, inverse.posterior(distance, angle))
        return distance, angle

    distance, angle = eventually(dragged)
    outline = widget.locator("path.cell").get_attribute("d")
    assert widget.locator("path.outcome").count() > 0

    # Six presses of an arrow key move it by six distance bins.
    picture.focus()
    for _ in range(6):
        page.keyboard.press("ArrowDown")

    def pressed():
        moved = python_side(page)
        ahead = distance * cos(angle) - 6 * model.axes.distance.width
        assert moved[0] * cos(moved[1]) == pytest.approx(ahead, abs=1e-9)
        assert moved[0] * sin(moved[1]) == pytest.approx(distance * sin(angle), abs=1e-9)
        assert_shows(widget, inverse.posterior(*moved[:2]))

    eventually(pressed)
    assert widget.locator("path.cell").get_attribute("d") != outline

    # Set from Python, the picture follows.
    run_cell(page, 2)
    eventually(lambda: assert_shows(widget, inverse.posterior(0.05, -1.0)))
    assert widget.locator("[data-fact='target']").inner_text() == "50 mm at −57°"

    # A card keeps its own look inside JupyterLab: names to the left, rows not striped.
    table = run_cell(page, 3).locator(".bh table.bh-heat")
    table.wait_for()
    assert table.locator("tbody th").first.evaluate("e => getComputedStyle(e).textAlign") == "left"
    grounds = table.locator("tbody tr").evaluate_all("all => all.map(e => getComputedStyle(e).backgroundColor)")
    assert len(grounds) > 2
    assert len(set(grounds)) == 1

    host = re.match(r"https?://[^/]+", notebook).group()
    assert not [url for url in watch.requests if not url.startswith((host, "data:", "blob:"))]
    assert not [text for text in watch.errors if "explorer" in text.lower() or "anywidget" in text.lower()]
