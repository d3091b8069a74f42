"""The explorer's picture with a stand-in for its Python side: what the keyboard does and what is spoken."""

from __future__ import annotations

import json

import pytest

import bayeshunt as bh
from bayeshunt.core.units import bounds

pytest.importorskip("anywidget", reason="anywidget is not installed (extra: notebook)")

PAGE = """<!doctype html><meta charset=utf-8><meta name=viewport content="width=device-width"><title>x</title>
<body><div id=place></div><script>const state = {state}, told = [];
const model = {{get: (k) => state[k], set: (k, v) => {{ state[k] = v; }}, on() {{}}, off() {{}},
  save_changes: () => told.push([state.distance, state.angle])}};
{script}
explorer.render({{model, el: document.getElementById("place")}});</script>"""


@pytest.fixture
def page(open_page, model, tmp_path):
    explorer = bh.Explorer(model, distance=0.1, angle=0.5)
    state = {name: getattr(explorer, name) for name in ("distance", "angle", "_scene", "_answer")}
    script = explorer._esm.replace("export default", "const explorer =")
    text = PAGE.format(state=json.dumps(state), script=script) + f"<style>{explorer._css}</style>"
    (tmp_path / "page.html").write_text(text, encoding="utf-8")
    page, watch = open_page(tmp_path / "page.html", viewport={"width": 360, "height": 800})
    yield page
    assert watch.errors == []


def test_one_line_is_spoken_and_not_the_whole_panel(page, model):
    answer = bh.InverseModel(model).posterior(0.1, 0.5)
    assert page.get_by_role("status").inner_text().startswith(f"Most probable gait {answer.best}; support ")
    assert page.locator("[aria-live]").count() == 0
    label = page.get_by_role("application").get_attribute("aria-label")
    assert label.startswith("Target 100 mm at 29°")


def test_arrow_keys_tell_python_where_the_target_is(page, model):
    page.get_by_role("application").focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_function("told.length === 1")
    distance, angle = page.evaluate("told[0]")
    moved = bh.Polar(distance, angle, 0.0)
    before = bh.Polar(0.1, 0.5, 0.0)
    assert moved.right - before.right == pytest.approx(model.axes.distance.width)
    assert moved.forward == pytest.approx(before.forward)


def test_it_fits_a_phone(page):
    assert page.evaluate("document.documentElement.scrollWidth") <= 360


def test_a_number_opens_at_the_side(page, model):
    answer = bh.InverseModel(model).posterior(0.1, 0.5)
    found, within = bh.trace(answer), bounds(*answer.interval().loc[answer.best, ["low", "high"]])
    page.get_by_role("button", name=found.gait, exact=True).focus()
    page.keyboard.press("Enter")
    panel = page.get_by_role("region", name="Where a number comes from")
    assert panel.locator(".formula").inner_text().endswith(f"= {found.factors.loc[found.gait, 'posterior']:.6g}")
    assert panel.get_by_text(f"95 % interval {within}", exact=True).count() == 1
    page.keyboard.press("Escape")
    assert panel.count() == 0


@pytest.mark.slow
def test_nothing_hides_the_cell_the_paths_or_their_names(page, model):
    """The cell that answers is an outline, the grip a ring around the target, the body below the paths, each named."""
    look = lambda part: page.locator(f"svg[role=application] .{part}").first.evaluate(  # noqa: E731
        "e => (s => [s.fill, Number(s.fillOpacity), s.stroke, parseFloat(s.strokeWidth)])(getComputedStyle(e))"
    )
    fill, _, stroke, width = look("cell")
    assert (fill, stroke != "none", width > 0) == ("none", True, True)
    _, opacity, stroke, width = look("target-grip")
    assert (opacity, stroke != "none", width > 0) == (0, True, True)  # seen through, and still to be grasped
    inside = page.locator("svg[role=application]").evaluate(
        """svg => {
          const cell = svg.querySelector(".cell").getBBox(), grip = svg.querySelector(".target-grip");
          return [Number(grip.getAttribute("r")), cell.width, cell.height];
        }"""
    )
    assert inside[0] > min(inside[1:]) / 2  # offset: around the cell's middle, not upon it
    order = page.locator("svg[role=application] .body, svg[role=application] .path").evaluate_all(
        "all => all.map(e => e.classList[0])"
    )
    assert order == ["body", *["path"] * len(model.gaits)]
    names = page.locator("svg[role=application] .gait-name")
    assert names.all_text_contents() == list(model.gaits.names)
    boxes = [name.bounding_box() for name in names.all()]
    for i, one in enumerate(boxes):
        for other in boxes[:i]:
            apart = abs(one["y"] - other["y"]) >= 0.7 * one["height"]
            beside = one["x"] + one["width"] <= other["x"] or other["x"] + other["width"] <= one["x"]
            assert apart or beside
    best = bh.InverseModel(model).posterior(0.1, 0.5).best
    assert page.locator("svg[role=application] .gait-name.best").all_text_contents() == [best]
