"""The inspector of a replay: every alternative, lanes over time, hunts in step, links to a moment."""

from __future__ import annotations

import json
import re

import pytest

import bayeshunt as bh
from bayeshunt.core.units import bounds
from bayeshunt.views.pages.replay import write_replay


@pytest.fixture(scope="module")
def planned(settings, model):
    return bh.hunt(settings, bh.make_planner("planning", model), arena="open", theta=4.0, seed=0)


@pytest.fixture
def page_of(open_page, tmp_path, model):
    def opened(episodes, link="", **settings):
        write_replay(episodes, tmp_path / "hunt.html", model=model)
        return open_page((tmp_path / "hunt.html").as_uri() + link, **settings)

    return opened


def test_every_node_of_every_plan_is_in_the_page(page_of, planned):
    page, watch = page_of(planned)
    data = json.loads(page.locator("[data-hunt-data]").text_content())
    for step, plan in zip(data["steps"], planned.plans, strict=True):
        nodes, trace = step["considered"], plan.trace
        assert [nodes["names"][i] for i in nodes["gait"]] == trace["gait"].tolist()
        assert nodes["parent"] == trace["parent"].tolist()
        assert nodes["value"] == pytest.approx((1000 * trace["value_m"]).tolist(), rel=1e-4)
        assert nodes["chosen"] == trace.index[trace["chosen"]].tolist()
        ends = trace[["hunter_forward", "hunter_right", "hunter_heading"]].to_numpy().ravel()
        assert nodes["end"] == pytest.approx((1e4 * ends).tolist(), abs=0.51)
    assert watch.errors == []


def test_a_node_that_is_pointed_at_shows_its_path_and_worth(page_of, planned):
    page, watch = page_of(planned, "#d=3")
    before = page.locator("canvas").evaluate("canvas => canvas.toDataURL()")
    box = page.locator("[data-part=icicle-words]")
    trace = planned.plans[2].trace
    assert box.inner_text().startswith(f"{len(trace)} alternatives")
    page.locator("[data-part=icicle]").hover(position={"x": 4, "y": 30})  # the first child of the root
    first = trace.iloc[1]
    gait, value = re.match(r"(.+): ([\d.]+) mm", box.inner_text()).groups()
    assert (gait, float(value)) == (first["gait"], pytest.approx(1000 * first["value_m"], rel=1e-3))
    assert page.locator("canvas").evaluate("canvas => canvas.toDataURL()") != before
    assert watch.errors == []


def test_arrow_keys_walk_through_the_alternatives(page_of, planned):
    page, _ = page_of(planned, "#d=3")
    page.get_by_role("group", name="Alternatives considered").focus()
    box = page.locator("[data-part=icicle-words]")
    page.keyboard.press("Home")
    while "now" not in box.inner_text().split(":")[0]:
        page.keyboard.press("ArrowUp")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowRight")
    trace = planned.plans[2].trace
    assert box.inner_text().startswith(f"{trace.iloc[2]['gait']}: ")
    assert page.locator("[data-player]").get_attribute("data-step") == "2"  # the hunt stays where it is
    page.keyboard.press("Escape")
    assert "alternatives" in box.inner_text()


def test_a_link_leads_to_a_decision_and_follows_the_hunt(page_of, planned):
    page, _ = page_of(planned, "#d=4")
    assert page.locator("[data-part=heading]").inner_text().startswith("Decision 4:")
    page.keyboard.press("ArrowRight")
    assert page.evaluate("location.hash") == "#d=5"
    page.evaluate("location.hash = '#d=2'")
    page.wait_for_timeout(50)
    assert page.locator("[data-part=heading]").inner_text().startswith("Decision 2:")
    page.evaluate("location.hash = '#d=400'")
    page.wait_for_timeout(50)
    assert page.locator("[data-part=heading]").inner_text().startswith("Decision 2:")


def test_two_hunts_go_in_step(page_of, planned, episodes):
    other = episodes["reactive"]
    page, watch = page_of([planned, other])
    longer = max((planned, other), key=lambda episode: episode.trail["time"].iloc[-1])
    leader = page.locator("[data-player]:not(.follower)")
    assert page.get_by_role("heading", level=1).inner_text() == "2 hunts in step"
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    assert [node.get_attribute("data-step") for node in page.locator("[data-player]").all()] == ["2", "2"]
    page.keyboard.press("End")
    assert f"of {longer.trail['time'].iloc[-1]:.2f} s" in leader.locator("[data-part=clock]").inner_text()
    ends = [int(node.get_attribute("data-step")) for node in page.locator("[data-player]").all()]
    assert ends == [len(planned.frame) - 1, len(other.frame) - 1]
    assert watch.errors == []


def test_the_lanes_say_what_now_is_and_lead_there(page_of, planned):
    page, watch = page_of(planned)
    lanes = page.locator("[data-part=lanes]")
    box = lanes.bounding_box()
    lanes.click(position={"x": 86 + 0.5 * (box["width"] - 178), "y": 40})
    clock = float(re.match(r"[\d.]+", page.locator("[data-part=clock]").inner_text()).group())
    assert clock == pytest.approx(planned.trail["time"].iloc[-1] / 2, rel=0.02)
    assert watch.errors == []


def test_whiskers_stand_on_the_bars_of_a_posterior(page_of, episodes, model):
    page, _ = page_of(episodes["reactive"])
    row = episodes["reactive"].frame.iloc[0]
    answer = bh.InverseModel(model).posterior(row["target_distance"], row["target_angle"])
    low, high = answer.interval().loc[row["gait"], ["low", "high"]]
    whisker = page.locator("[data-part=bars] tr.chosen .whisker")
    track = page.locator("[data-part=bars] tr.chosen td.bar")
    width = track.bounding_box()["width"]
    assert whisker.bounding_box()["width"] == pytest.approx(max((high - low) * width, 2), abs=1.5)
    beside = page.locator("[data-part=bars] tr.chosen td").last.evaluate("e => getComputedStyle(e, '::after').content")
    assert bounds(low, high) in beside
    assert f"95 % interval of {row['gait']}: " in page.locator("[data-part=bars-caption]").inner_text()


@pytest.mark.parametrize(("width", "height"), [(1400, 900), (390, 844)])
def test_a_decision_is_seen_at_once(page_of, planned, width, height):
    page, _ = page_of(planned, viewport={"width": width, "height": height})
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    parts = ["canvas", "lanes", "play", "bars", "icicle", "prey-summary"] if width > 1000 else ["canvas", "play"]
    for part in parts:
        box = page.locator(f"[data-part={part}]").bounding_box()
        assert box["y"] + box["height"] <= height, part
    if width < 1000:  # the field stays in view while the panels pass below
        page.keyboard.press("End")  # most rows of prey
        page.locator("[data-part=prey-box]").scroll_into_view_if_needed()
        assert page.locator("[data-part=canvas]").bounding_box()["y"] >= -1
        box = page.locator("[data-part=play]").bounding_box()  # and the buttons
        assert box["y"] + box["height"] <= height
        rows = page.locator("[data-part=prey-box]")
        assert rows.locator("tbody tr").count() > 0
        assert rows.evaluate("node => node.scrollWidth <= node.clientWidth")


@pytest.mark.slow
def test_decisions_of_two_hunts_are_seen_at_once(page_of, planned, episodes):
    page, watch = page_of([episodes["reactive"], planned], viewport={"width": 1400, "height": 900})
    for key in ("Home", "ArrowRight", "ArrowRight", "End"):
        page.keyboard.press(key)
        for card in page.locator(".panels .card:visible").all():
            box = card.bounding_box()
            assert box["y"] + box["height"] <= 900, card.get_attribute("aria-label")
            assert card.evaluate("e => e.scrollWidth <= e.clientWidth")
    assert watch.errors == []


def test_a_probability_opens_down_to_its_rows(page_of, settings, model):
    """From the bar by the keyboard: factors, their cells' counts, the rows; back by the breadcrumb; Esc closes."""
    episode = bh.hunt(settings, bh.make_planner("reactive", model), arena="open", theta=1.0, seed=0)
    page, watch = page_of(episode)
    plan = episode.plans[0]
    found = bh.trace(plan)
    page.locator("[data-part=bars] tr.chosen button").focus()
    page.keyboard.press("Enter")
    panel = page.get_by_role("region", name="Where a number comes from")
    assert panel.locator(".formula").inner_text() == found.formula.replace(" x ", " × ").replace(
        " e)", " Distance, Angle)"
    )
    within = bounds(*plan.answer.interval().loc[plan.gait, ["low", "high"]])
    assert panel.get_by_text(f"95 % interval {within}", exact=True).count() == 1
    cells = found.cells.set_index("variable")
    lines = panel.locator("table").first.locator("tbody tr").all()
    assert [int(line.locator("td").last.inner_text()) for line in lines] == cells["count"].tolist()
    panel.get_by_role("button", name=re.compile(r"P\(Distance")).click()
    rows = found.rows("Distance")
    table = panel.locator("tbody tr")
    assert table.count() == min(len(rows), 30)
    assert table.first.locator("th").inner_text() == str(rows.index[0])
    crumbs = panel.locator("nav li").all_inner_texts()
    assert crumbs == ["Decision 1", f"P({plan.gait})", crumbs[-1]]
    assert crumbs[-1].startswith("Distance ")
    panel.get_by_role("button", name=f"P({plan.gait})", exact=True).click()
    assert panel.locator(".formula").inner_text().startswith(f"P({plan.gait} |")
    page.keyboard.press("Escape")
    assert panel.count() == 0
    assert page.locator("[data-part=bars] tr.chosen button").evaluate("node => node === document.activeElement")
    assert watch.errors == []


@pytest.mark.slow
def test_values_of_first_gaits_are_dots_from_the_best_and_say_how_much_worse(page_of, planned):
    """No bar that is longer where it is worse: the best stands at 0, the worst at the far end, the spread as a line."""
    page, watch = page_of(planned, "#d=3")
    row, trace = planned.frame.iloc[2], planned.plans[2].trace
    least = dict(zip(row["alternative_gaits"], row["alternative_values"], strict=True))
    low, wide = min(least.values()), max(least.values()) - min(least.values())
    first = trace["gaits"].str.replace(r" x\d+.*", "", regex=True)
    most = trace[trace["T"] > 0].groupby(first)["value_m"].max()
    assert page.locator("[data-part=bars] td.bar").count() == 0
    lines = page.locator("[data-part=bars] tr")
    assert lines.count() == len(least)
    for line, (gait, value) in zip(lines.all(), least.items(), strict=True):
        assert line.locator("th").inner_text() == gait
        dots = line.locator("td.dots")
        at = float(dots.locator("i").evaluate("e => e.style.left").removesuffix("%"))
        assert at == pytest.approx(100 * (value - low) / wide, abs=0.1)
        spread = dots.locator(".spread").evaluate("e => [parseFloat(e.style.left), parseFloat(e.style.width)]")
        end = min(100.0, 100 * (most[gait] - low) / wide)
        assert (spread[0], sum(spread)) == (pytest.approx(at, abs=0.1), pytest.approx(end, abs=0.1))
        said = line.locator("td.worse").inner_text()
        if value == low:
            assert (said, gait) == ("best", row["gait"])
        else:
            assert re.fullmatch(r"\+[\d.]+ mm worse", said)
            assert float(said[1:].split()[0]) == pytest.approx(1000 * (value - low), rel=6e-3)
    assert watch.errors == []


@pytest.mark.slow
def test_a_row_of_the_prey_table_opens_to_the_steps_that_it_counts(page_of, planned):
    page, watch = page_of(planned, f"#d={len(planned.frame)}")
    cells = list(planned.frame["prey_table"].iloc[-1])
    button = page.locator("[data-part=prey] tr button").first
    name, count = button.inner_text(), int(cells[0][3])
    button.focus()
    page.keyboard.press("Enter")
    panel = page.get_by_role("region", name="Where a number comes from")
    assert panel.locator(".formula").inner_text().startswith(f"{count} of {len(planned.frame) - 1} = ")
    assert panel.locator("tbody tr").count() == count
    assert panel.locator("nav li").last.inner_text().startswith(name)
    before = int(panel.locator("tbody th").first.inner_text().split()[1])
    panel.locator("tbody button").first.click()
    assert page.locator("[data-player]").get_attribute("data-step") == str(before - 1)
    assert watch.errors == []


def test_a_value_opens_to_the_sequences_under_its_gait(page_of, planned):
    page, _ = page_of(planned)
    page.locator("[data-part=bars] tr.chosen button").click()
    panel = page.get_by_role("region", name="Where a number comes from")
    best = float(panel.locator("tbody tr").first.locator("td").inner_text())
    assert best == pytest.approx(1000 * planned.plans[0].value, rel=1e-3)


def test_a_decision_without_alternatives_leaves_no_path_of_the_one_before(page_of, planned):
    page, watch = page_of(planned, "#d=3")
    told = page.evaluate(
        """() => {
          const [box, picture, readout] = ["icicle-box", "icicle", "icicle-words"].map((name) => document.querySelector(`[data-part=${name}]`));
          const told = [], icicle = new Icicle({ box, picture, readout }, (...heard) => told.push(heard));
          icicle.load(null, () => "");
          return told;
        }"""  # noqa: E501
    )
    assert told == [[[], 0]]
    assert watch.errors == []
