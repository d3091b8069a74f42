"""The report in a browser: its gallery opens and plays the very hunts that were recorded."""

from __future__ import annotations

import pytest
from waiting import wait_until

import bayeshunt as bh
from bayeshunt.views.pages.report import write_report


@pytest.fixture(scope="module")
def results(settings, model):
    return bh.evaluate(settings, runs=2, seed=4, model=model, planners=["reactive", "prediction"])


@pytest.fixture(scope="module")
def report(results, model, tmp_path_factory):
    path = tmp_path_factory.mktemp("report") / "report.html"
    assert write_report(results, path, model=model, model_path="model.json") == []
    return path


def test_the_gallery_opens_plays_and_closes(open_page, report, results):
    page, watch = open_page(report)
    buttons = page.locator("button[data-hunt]")
    groups = results.groupby(["planner", "arena"], sort=False)["caught"]
    assert buttons.count() == sum(int(some.any()) + int((~some).any()) for _, some in groups)
    for k in range(buttons.count()):
        name = buttons.nth(k).get_attribute("aria-label")
        buttons.nth(k).focus()
        page.keyboard.press("Enter")
        dialog = page.get_by_role("dialog")
        assert name.split(", ")[-1] in dialog.locator("[data-title]").inner_text()
        page.keyboard.press("ArrowRight")
        assert dialog.locator("[data-player]").get_attribute("data-step") in ("0", "1")
        for _ in range(3):
            page.keyboard.press("-")  # so slow that it still plays when it is looked at
        page.keyboard.press("Space")
        wait_until(lambda: page.locator("[data-player]").get_attribute("data-playing") == "true")
        page.keyboard.press("Escape")
        assert not dialog.is_visible()
        wait_until(lambda: page.locator("[data-playing]").count() == 0)
        assert buttons.nth(k).evaluate("node => node === document.activeElement")
    assert not watch.errors
    assert watch.requests == [report.as_uri()]


def test_the_replayed_hunts_end_as_recorded(open_page, report, results):
    page, _ = open_page(report)
    for k in range(page.locator("button[data-hunt]").count()):
        page.locator("button[data-hunt]").nth(k).click()
        seed = page.evaluate(f"JSON.parse(document.getElementById('hunt-{k}').textContent).seed")
        planner, arena = page.evaluate(
            f"(h => [h.planner, h.arena])(JSON.parse(document.getElementById('hunt-{k}').textContent))"
        )
        page.keyboard.press("End")
        row = results[(results["seed"] == int(seed)) & (results["planner"] == planner) & (results["arena"] == arena)]
        expected = f"caught after {row['time'].item():.2f} s" if row["caught"].item() else "not caught in 60 s"
        assert page.locator("[data-part=status]").inner_text().endswith(f"{expected}.")
        assert f"--seed {seed} --model model.json" in page.locator("[data-command]").inner_text()
        page.locator("[data-close]").click()


def test_it_fits_the_screen_in_both_themes(open_page, report):
    page, watch = open_page(report)
    for theme in ("light", "dark"):
        page.emulate_media(color_scheme=theme)
        for width in (360, 1280):
            page.set_viewport_size({"width": width, "height": 800})
            assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.locator("svg.chart").count() == 4
    assert not watch.errors
