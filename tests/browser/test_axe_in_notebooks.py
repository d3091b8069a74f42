"""axe-core finds nothing in our own elements inside JupyterLab and marimo: both themes, 390 and 1400 px wide.

Where one of the two is not installed (extras notebook, marimo), its half is skipped.
"""

from __future__ import annotations

import pytest
from notebook_programs import jupyterlab, marimo
from waiting import wait_until

pytest.importorskip("anywidget", reason="anywidget is not installed (extra: notebook)")
pytestmark = pytest.mark.slow

SETUP = """import math
import bayeshunt as bh
model = bh.ForwardModel.load("model.json")
robot, settings, inverse = bh.load_robot("khepera"), bh.load_experiment("paper"), bh.InverseModel(model)
table = bh.babble("khepera", 300, 5)
answer = inverse.posterior(0.168, math.radians(-20))
hunts = [bh.hunt(settings, bh.make_planner(name, model), arena="open", seed=0) for name in ("reactive", "planning")]"""
CARDS = (
    "model", "inverse", "answer", 'model.table("Angle")', "hunts[0].plans[1]", "hunts[1].plans[1]", "hunts[1]",
    "bh.trace(answer)", 'bh.trace(model, cell=("Angle", 0.0, "straight"))', "bh.trace(hunts[1].plans[1], model=model)",
    "hunts[0].situations[-1].prey_model",
    "bh.compare(model, bh.ForwardModel.fit(table, robot.gaits, 0.1))", "robot", "settings",
    'bh.make_planner("planning", model)', "bh.assess(table)",
)  # fmt: skip
WIDGETS = {
    "bh-explorer": "bh.Explorer(model)", "bh-network": "bh.Network(model)",
    "bh-learning": "bh.Learning(table, robot.gaits)",
}  # fmt: skip
CELLS = (SETUP, *CARDS, *WIDGETS.values())
SIZES = ({"width": 1400, "height": 900}, {"width": 390, "height": 844})
BRIGHTNESS = "e => getComputedStyle(e).backgroundColor.match(/[0-9]+/g).slice(0, 3).reduce((a, b) => a + +b, 0)"


def found(page, axe: str, where: str) -> list[tuple[str, str]]:
    """What axe-core says of the elements chosen by ``where``, all folds open."""
    page.evaluate("document.querySelectorAll('.bh details').forEach((fold) => { fold.open = true; })")
    if not page.evaluate("'axe' in window"):
        page.evaluate(axe)
    said = page.evaluate(f"axe.run({{ include: [{where}] }}, {{ resultTypes: ['violations'] }})")
    return [(violation["id"], violation["nodes"][0]["html"][:200]) for violation in said["violations"]]


def ground_is_dark(page) -> set[bool]:
    """Whether the grounds of cards and widgets are dark."""
    every = page.locator(".bh, .bh-explorer, .bh-network, .bh-learning section")  # playwright looks into shadow roots
    return {every.nth(i).evaluate(BRIGHTNESS) < 300 for i in range(every.count())}


def complete(page) -> bool:
    return page.locator(".bh").count() == len(CARDS) and all(page.locator(f".{name}").count() for name in WIDGETS)


def test_inside_jupyterlab(open_page, axe, model, tmp_path):
    pytest.importorskip("jupyterlab", reason="jupyterlab is not installed (extra: notebook)")
    (tmp_path / "work").mkdir()
    model.save(tmp_path / "work" / "model.json")
    with jupyterlab(tmp_path, CELLS) as address:
        page, _ = open_page(address, bypass_csp=True, viewport=SIZES[0])
        page.wait_for_selector(".jp-Notebook .jp-CodeCell", timeout=60_000)
        wait_until(lambda: "| Idle" in page.locator("#jp-main-statusbar").inner_text(), seconds=60)
        page.evaluate("jupyterapp.shell.collapseLeft(); jupyterapp.shell.collapseRight()")  # room on a phone
        page.evaluate("jupyterapp.commands.execute('notebook:run-all-cells')")
        wait_until(lambda: complete(page), seconds=120)
        for dark in (False, True):
            theme = "JupyterLab Dark" if dark else "JupyterLab Light"
            page.evaluate(f"jupyterapp.commands.execute('apputils:change-theme', {{ theme: '{theme}' }})")
            page.wait_for_selector(f"body[data-jp-theme-light='{str(not dark).lower()}']", state="attached")
            assert ground_is_dark(page) == {dark}
            for size in SIZES:
                page.set_viewport_size(size)
                page.wait_for_timeout(500)
                assert found(page, axe, ", ".join(f"['.{name}']" for name in ("bh", *WIDGETS))) == []


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_inside_marimo(open_page, axe, model, tmp_path, theme):
    pytest.importorskip("marimo", reason="marimo is not installed (extra: marimo)")
    (tmp_path / "work").mkdir()
    model.save(tmp_path / "work" / "model.json")
    system = "dark" if theme == "light" else "light"  # the program's own theme wins
    with marimo(tmp_path, CELLS, theme) as address:
        page, _ = open_page(address, bypass_csp=True, viewport=SIZES[0], color_scheme=system)
        wait_until(lambda: complete(page), seconds=120)
        assert ground_is_dark(page) == {theme == "dark"}
        for size in SIZES:
            page.set_viewport_size(size)
            page.wait_for_timeout(500)
            within = ", ".join(f"{{ fromShadowDom: ['marimo-anywidget', '.{name}'] }}" for name in WIDGETS)
            assert found(page, axe, f"['.bh'], {within}") == []
