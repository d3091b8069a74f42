"""Notebook displays in a real browser: hover, switch, folds, both themes; no errors, no requests."""

from __future__ import annotations

from pathlib import Path

import pytest

import bayeshunt as bh
from bayeshunt.core.units import bounds

PAGE = "<!doctype html><meta charset=utf-8><meta name=viewport content='width=device-width'><title>x</title><body {}>{}"


@pytest.fixture
def show(open_page, tmp_path: Path):
    """Return a function that shows a thing in a page, as a notebook would, and gives the page and its watch."""

    def shown(thing, body: str = "", **settings):
        path = tmp_path / "page.html"
        path.write_text(PAGE.format(body, thing._repr_html_()), encoding="utf-8")
        return open_page(path, **settings)

    return shown


def only_itself(watch) -> None:
    """The page complained of nothing and asked for nothing but itself."""
    assert watch.errors == []
    assert all(url.endswith("page.html") for url in watch.requests)


def test_hovering_a_cell_tells_its_count_and_interval(show, model) -> None:
    page, watch = show(model.table("Angle"))
    cell = page.locator("td").nth(185)
    cell.scroll_into_view_if_needed()
    cell.hover()
    said = cell.evaluate("e => getComputedStyle(e, '::after').content")
    assert said == f'"{cell.get_attribute("title")}"'
    assert "rows" in said
    # The words stand in the card, below the scrolling table, where nothing cuts them off.
    place = cell.evaluate("e => getComputedStyle(e, '::after').position")
    assert place == "absolute"
    assert cell.evaluate("e => getComputedStyle(e).position") == "static"
    only_itself(watch)


def test_a_click_keeps_the_words_and_arrow_keys_go_on(show, model) -> None:
    table = model.table("Angle")
    page, watch = show(table)
    full = page.locator("td:has(input)")
    page.mouse.move(0, 0)
    words = "all => all.map(e => getComputedStyle(e, '::after').content).filter(c => c != 'none')"
    assert page.locator("td").evaluate_all(words) == []
    full.nth(3).click()
    page.mouse.move(0, 0)
    assert page.locator("td").evaluate_all(words) == [f'"{full.nth(3).get_attribute("title")}"']
    page.keyboard.press("ArrowRight")
    assert page.locator("td").evaluate_all(words) == [f'"{full.nth(4).get_attribute("title")}"']
    page.keyboard.press("Tab")  # one stop for the whole table
    assert page.evaluate("document.activeElement.type") != "radio"
    only_itself(watch)


def test_a_bar_opens_down_to_its_rows_and_back(show, model) -> None:
    """By Enter: the formula, the cells with their counts, the rows; back by the breadcrumb; Esc closes."""
    answer = bh.InverseModel(model).posterior(0.15, 0.4)
    page, watch = show(answer)
    opened = page.locator(".bh-side:popover-open")
    page.locator("th button", has_text=answer.best).focus()
    page.keyboard.press("Enter")
    found = bh.trace(answer)
    formula, within = opened.locator("p").all_inner_texts()
    assert formula.endswith(f"= {found.factors.loc[found.gait, 'posterior']:.4g}")
    assert within == f"95 % interval {bounds(*answer.interval().loc[answer.best, ['low', 'high']])}"
    counts = opened.locator("td button").all_inner_texts()
    assert [int(text.split()[0]) for text in counts] == found.cells["count"].tolist()
    opened.locator("td button").last.click()
    rows = opened.last.locator("tbody th").all_inner_texts()
    assert rows == [str(label) for label in found.rows("Angle").index[: len(rows)]]
    opened.last.locator(".bh-crumbs button").click()
    assert opened.count() == 1
    page.keyboard.press("Escape")
    assert opened.count() == 0
    only_itself(watch)


@pytest.mark.slow
@pytest.mark.parametrize("touch", [False, True])
def test_a_cell_of_a_table_opens_its_rows(show, model, touch) -> None:
    """By its edge at once, by a second click or tap, and by Enter; Esc and the breadcrumb close it."""
    page, watch = show(model, has_touch=touch, viewport={"width": 390 if touch else 1400, "height": 900})
    opened = page.locator(".bh-side:popover-open")
    cell = page.locator("td:has(.bh-cell)").nth(4)
    cell.scroll_into_view_if_needed()
    if touch:
        cell.tap()
        assert opened.count() == 0
        cell.tap()
    else:
        box = cell.bounding_box()
        cell.click(position={"x": box["width"] - 5, "y": box["height"] / 2})
    assert cell.get_attribute("title").split(" rows")[0].split(", ")[-1] in opened.inner_text()
    page.keyboard.press("Escape")
    assert opened.count() == 0
    page.locator("td input[type=radio]").first.focus()
    page.keyboard.press("Space")
    page.keyboard.press("ArrowRight")
    picked = page.locator("td:has(input:checked)")
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    assert picked.get_attribute("title").split(" = ")[1].split(" |")[0].split()[0] in opened.inner_text()
    opened.locator(".bh-crumbs button").click()
    assert opened.count() == 0
    only_itself(watch)


#: What JupyterLab 4 says of tables in an output, in its own words.
JUPYTER = """
.jp-RenderedHTMLCommon table{border-collapse:collapse;border-spacing:0;border:none;font-size:13px;table-layout:fixed;
 margin-left:auto;margin-right:auto;margin-bottom:1em;color:rgb(200,0,0)}
.jp-RenderedHTMLCommon thead{border-bottom:1px solid red;vertical-align:bottom}
.jp-RenderedHTMLCommon td,.jp-RenderedHTMLCommon th,.jp-RenderedHTMLCommon tr{vertical-align:middle;padding:0.5em;
 line-height:normal;white-space:normal;max-width:none;border:none}
:not(.jp-RenderedMarkdown).jp-RenderedHTMLCommon td,:not(.jp-RenderedMarkdown).jp-RenderedHTMLCommon th{max-width:none}
:not(.jp-RenderedMarkdown).jp-RenderedHTMLCommon td,:not(.jp-RenderedMarkdown).jp-RenderedHTMLCommon th,
:not(.jp-RenderedMarkdown).jp-RenderedHTMLCommon tr{text-align:right}
.jp-RenderedHTMLCommon tbody tr:nth-child(odd){background:rgb(255,0,0)}
.jp-RenderedHTMLCommon tbody tr:hover{background:rgb(0,255,0)}
"""


def test_tables_look_the_same_under_the_style_sheet_of_jupyter(show, model) -> None:
    """No striped rows, names to the left, whichever sheet comes last."""
    look = (
        "all => all.map(e => (s => e.tagName === 'TR' ? [s.backgroundColor] : "
        "[s.textAlign, s.backgroundColor, s.padding, s.whiteSpace, s.color, s.borderTopWidth])(getComputedStyle(e)))"
    )
    page, _ = show(bh.InverseModel(model).posterior(0.15, 0.4), "class='jp-RenderedHTMLCommon'")
    parts = page.locator(".bh tr, .bh th, .bh td")
    plain = parts.evaluate_all(look)
    page.add_style_tag(content=JUPYTER)
    assert parts.evaluate_all(look) == plain
    assert page.locator(".bh tbody th").first.evaluate("e => getComputedStyle(e).textAlign") == "left"


def test_the_switch_turns_probabilities_into_counts(show, model) -> None:
    page, _ = show(model.table("Angle"))
    table = model.table("Angle")
    place = int(table.count.to_numpy().ravel().argmax())
    cell = page.locator("td").nth(place)
    assert cell.inner_text() == f"{table.probability.to_numpy().ravel()[place]:.3f}".lstrip("0")
    page.locator(".bh-switch").click()
    assert cell.inner_text() == str(table.count.to_numpy().max())
    page.keyboard.press("Space")  # the switch has the focus: back by keyboard
    assert cell.inner_text() != str(table.count.to_numpy().max())


def test_intervals_can_be_had_without_a_mouse(show, model) -> None:
    page, watch = show(model.table("Angle"))
    interval = page.locator("td .bh-i").nth(185)
    assert not interval.is_visible()
    page.locator(".bh-limits input").focus()
    page.keyboard.press("Space")
    assert interval.is_visible()
    assert " to " in interval.inner_text()
    only_itself(watch)


def test_the_head_stays_while_a_long_table_scrolls(show, model) -> None:
    page, _ = show(model.table("Angle"))
    page.get_by_label("show intervals").check()  # bins that nothing fell into are folded: only so is it long
    box = page.locator(".bh-scroll")
    before = page.locator("thead th").nth(1).bounding_box()
    box.focus()
    page.keyboard.press("End")
    page.wait_for_function("document.querySelector('.bh-scroll').scrollTop > 100")
    assert page.locator("thead th").nth(1).bounding_box() == before


def test_a_plan_can_be_walked(show, episodes) -> None:
    plan = episodes["planning"].plans[1]
    page, watch = show(plan)
    lit = page.locator(".bh-tree .bh-lit")
    assert lit.count() == plan.trace["chosen"].sum()
    assert all(lit.nth(i).is_visible() for i in range(lit.count()))
    unfolded = page.locator(".bh-tree details[open]").count()
    page.locator(".bh-tree details:not([open]) > summary").first.click()
    assert page.locator(".bh-tree details[open]").count() == unfolded + 1
    only_itself(watch)


@pytest.mark.parametrize("jupyter", [None, "true", "false"])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_themes(show, model, scheme: str, jupyter: str | None) -> None:
    body = "" if jupyter is None else f'data-jp-theme-light="{jupyter}"'
    page, watch = show(bh.InverseModel(model).posterior(0.15, 0.4), body, color_scheme=scheme)
    dark = scheme == "dark" if jupyter is None else jupyter == "false"
    ink, paper = (
        page.locator(".bh").evaluate(f"e => getComputedStyle(e).{name}") for name in ("color", "backgroundColor")
    )
    brightness = {name: sum(map(int, value[4:-1].split(","))) for name, value in (("ink", ink), ("paper", paper))}
    assert (brightness["ink"] > brightness["paper"]) == dark
    assert abs(brightness["ink"] - brightness["paper"]) > 500
    only_itself(watch)


def test_a_phone_needs_no_sideways_scrolling(show, model, episodes) -> None:
    for thing in (model, episodes["planning"], episodes["planning"].plans[1], bh.InverseModel(model)):
        page, watch = show(thing, viewport={"width": 380, "height": 800})
        assert page.evaluate("document.documentElement.scrollWidth") <= 380
        only_itself(watch)


def test_facts_keep_their_words_under_the_style_sheet_of_jupyter(show, model) -> None:
    jupyter = "dl{width:100%} .jp-OutputArea-output dt{float:left;width:20%} .jp-OutputArea-output dd{width:80%}"
    answer = bh.InverseModel(model).posterior(0.15, 0.4)
    page, _ = show(answer, "class='jp-OutputArea-output'")
    plain = page.locator(".bh-facts dt, .bh-facts dd").evaluate_all("all => all.map(e => e.clientWidth)")
    page.add_style_tag(content=jupyter)
    styled = page.locator(".bh-facts dt, .bh-facts dd").evaluate_all("all => all.map(e => e.clientWidth)")
    assert styled == plain
