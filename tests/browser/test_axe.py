"""axe-core finds nothing on any page, card and widget: light and dark, 390 and 1400 px wide."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import bayeshunt as bh
from bayeshunt.views.pages.replay import write_replay

pytestmark = pytest.mark.slow
BARE = '<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
WIDGET = """<script>const state = {state};
const model = {{ get: (k) => state[k], set() {{}}, on() {{}}, off() {{}}, save_changes() {{}} }};
{script}
explorer.render({{ model, el: document.getElementById("place") }});</script>"""


def page_of_cards(things) -> str:
    cards = "".join(thing._repr_html_() for thing in things)
    return f"{BARE}<title>cards</title><body><main><h1>cards</h1>{cards}</main></body></html>"


def page_of_explorer(model) -> str:
    explorer = bh.Explorer(model)
    state = {name: getattr(explorer, name) for name in ("distance", "angle", "_scene", "_answer")}
    script = explorer._esm.replace("export default", "const explorer =")
    place = f"<title>x</title><style>{explorer._css}</style><body><main><h1>x</h1><div id=place></div></main>"
    return f"{BARE}{place}{WIDGET.format(state=json.dumps(state), script=script)}</body></html>"


@pytest.fixture(scope="session")
def pages(tmp_path_factory, settings, model, episodes) -> dict[str, Path]:
    pytest.importorskip("anywidget", reason="anywidget is not installed (extra: notebook)")
    folder = tmp_path_factory.mktemp("pages")
    table = bh.babble("khepera", 300, 5)
    robot = bh.load_robot("khepera")
    other, learning = bh.ForwardModel.fit(table, robot.gaits, 0.1), bh.Learning(table, robot.gaits)
    answer, plan = bh.InverseModel(model).posterior(0.16, -0.3), episodes["planning"].plans[1]
    things = [
        model, bh.InverseModel(model), answer, model.table("Angle"), plan, episodes["reactive"], bh.trace(answer),
        bh.trace(model, cell=("Angle", 0.0, "straight")), bh.trace(plan, model=model), bh.Network(model), learning,
        bh.compare(model, other), robot, settings, bh.make_planner("planning", model),
    ]  # fmt: skip
    bh.Network(model).save(folder / "network.html")
    learning.save(folder / "learning.html")
    bh.compare(model, other).save(folder / "compare.html")
    for name in ("reactive", "planning"):
        write_replay(episodes[name], folder / f"{name}.html", model=model)
    write_replay([episodes["reactive"], episodes["planning"]], folder / "two.html", model=model)
    bh.write_report(bh.evaluate(settings, runs=1, seed=0, jobs=1, model=model), folder / "report.html", model=model)
    (folder / "cards.html").write_text(page_of_cards(things), encoding="utf-8")
    (folder / "explorer.html").write_text(page_of_explorer(model), encoding="utf-8")
    return {path.stem: path for path in folder.glob("*.html")}


NAMES = ("network", "learning", "compare", "reactive", "planning", "two", "report", "cards", "explorer")


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [390, 1400])
@pytest.mark.parametrize("name", NAMES)
def test_axe_finds_nothing(open_page, axe, pages, name, width, scheme):
    view = {"viewport": {"width": width, "height": 900}, "color_scheme": scheme, "bypass_csp": True}
    page, _ = open_page(pages[name], **view)
    page.wait_for_timeout(200)
    page.evaluate(axe)
    opened = page.locator("tr.chosen button, tr.best button")
    for opens in (False, True) if opened.count() else (False,):
        if opens:
            opened.first.click()
        found = page.evaluate("axe.run(document, { resultTypes: ['violations'] })")
        assert [(v["id"], v["nodes"][0]["html"][:200]) for v in found["violations"]] == []
