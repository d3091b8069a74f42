"""The explorer widget inside a real JupyterLab."""

from __future__ import annotations

import re
from math import atan2, cos, sin

import pytest
from notebook_programs import jupyterlab
from waiting import eventually, wait_until

import bayeshunt as bh
from bayeshunt.core import units

pytest.importorskip("anywidget", reason="anywidget is not installed (extra: notebook)")
pytest.importorskip("jupyterlab", reason="jupyterlab is not installed (extra: notebook)")
pytestmark = pytest.mark.slow

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
    (folder / "work").mkdir()
    model.save(folder / "work" / "model.json")
    with jupyterlab(folder, CELLS) as address:
        yield address


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
