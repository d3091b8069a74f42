"""The replay page in a browser: it plays, scrubs, answers the keyboard, and shows what the episode holds."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from waiting import wait_until

import bayeshunt as bh
from bayeshunt.core.units import length, objective
from bayeshunt.views.pages.replay import write_replay

PLANNERS = ("reactive", "prediction", "planning")


def numbers(text):
    return [float(part.replace("−", "-")) for part in re.findall(r"[-−]?\d+(?:\.\d+)?", text)]


def fact(page, name):
    return page.locator(f"[data-fact='{name}']").inner_text()


def clock(page):
    return numbers(page.locator("[data-part=clock]").inner_text())[0]


def table(text):
    return [row.split("\t") for row in text.splitlines() if row.strip()]


def degrees(angle):
    return math.degrees(angle)


def assert_polar(text, row, name):
    _, angle, *heading = numbers(text)
    assert text.startswith(f"{length(row[f'{name}_distance'])} at ")
    assert angle == pytest.approx(degrees(row[f"{name}_angle"]), abs=0.51)
    if heading:
        assert heading[0] == pytest.approx(degrees(row[f"{name}_heading"]), abs=0.51)


#: All that the side panels show, in one answer of the browser: text by part and by fact, and the rows of the lists.
SHOWN = """() => {
    const texts = (key) => Object.fromEntries([...document.querySelectorAll(`[data-${key}]`)].map(
        element => [element.dataset[key], element.innerText]));
    const all = (at) => [...document.querySelectorAll(at)];
    return {
        step: document.querySelector("[data-player]").dataset.step,
        part: texts("part"), fact: texts("fact"),
        sequence: all("[data-part=sequence] li").map(li => li.innerText),
        bars: all("[data-part=bars] tr").map(tr => [tr.querySelector("th").innerText,
            tr.querySelector("td:last-child").innerText, tr.hasAttribute("aria-current")]),
        news: all("[data-part=prey] tr.new").length,
    };
}"""


def assert_panels_show(shown, row, gaits):
    """Every side panel, as SHOWN has it, against one row of ``episode.frame``."""
    facts = shown["fact"]
    assert shown["part"]["heading"] == f"Decision {row['step'] + 1}: {row['gait']}"
    assert numbers(facts["time"])[0] == pytest.approx(row["time"], abs=5.1e-4)
    assert_polar(facts["seen"], row, "seen")
    assert_polar(facts["target"], row, "target")
    assert (facts["known"] == "used") == row["prey_known"]
    assert numbers(facts["value"])[0] == pytest.approx(objective(row["value"], row["objective"])[0], rel=5.1e-4)
    assert facts["objective"] == objective(0.0, row["objective"])[1]
    assert numbers(facts["nodes"]) == [row["nodes"]]
    sequence = [text.split(" × ") for text in shown["sequence"]]
    unrolled = [gait for gait, *times in sequence for _ in range(int(times[0]) if times else 1)]
    assert unrolled == list(row["planned_gaits"])
    assert_bars_show(shown, row, gaits)
    assert_prey_table_shows(shown, row)


def assert_bars_show(shown, row, gaits):
    caption = shown["part"]["bars-caption"]
    if row["posterior"] is not None:
        assert shown["part"]["bars-title"] == "Posterior over gaits"
        expected = dict(zip(gaits, row["posterior"], strict=True))
        assert f"support {row['support']} babbling" in caption
        assert f"{row['evidence_probability']:.3g}" in caption
    else:
        assert shown["part"]["bars-title"] == "Values of the first gaits"
        expected = dict(zip(row["alternative_gaits"], row["alternative_values"], strict=True))
        assert objective(0.0, row["objective"])[1] in caption
        assert min(expected.values()) == pytest.approx(row["value"])
        expected = {gait: objective(value, row["objective"])[0] for gait, value in expected.items()}
    assert [name for name, *_ in shown["bars"]] == list(expected)
    values = [float(value) for _, value, _ in shown["bars"]]
    assert values == pytest.approx(list(expected.values()), abs=5.1e-4, rel=5.1e-4)
    assert [name for name, _, current in shown["bars"] if current] == [row["gait"]]


def assert_prey_table_shows(shown, row):
    cells = list(row["prey_table"])
    assert sum(cell[3] for cell in cells) == row["prey_observations"]
    lines = table(shown["part"]["prey"]) if cells else []
    assert len(lines) == len(cells)
    for line, cell in zip(lines, cells, strict=True):
        distance, angle, heading, count, share = (np.mean(numbers(text)) for text in line)
        assert distance == pytest.approx(1000 * cell[0], abs=0.51)  # a range of whole millimetres around it
        assert (angle, heading) == (
            pytest.approx(degrees(cell[1]), abs=0.51),
            pytest.approx(degrees(cell[2]), abs=0.51),
        )
        assert count == cell[3]
        assert share == pytest.approx(100 * cell[3] / row["prey_observations"], abs=0.051)
    if row["prey_observations"]:
        assert shown["news"] == 1


@pytest.mark.parametrize("planner", PLANNERS)
def test_the_panels_show_the_episode_at_every_step(open_page, replays, episodes, settings, planner):
    page, watch = open_page(replays[planner])
    frame = episodes[planner].frame
    for k, row in enumerate(frame.to_dict("records")):
        shown = page.evaluate(SHOWN)
        assert shown["step"] == str(k)
        assert_panels_show(shown, row, settings.robot.gaits.names)
        page.keyboard.press("ArrowRight")
    assert clock(page) == pytest.approx(episodes[planner].trail["time"].iloc[-1], abs=0.006)
    assert not watch.errors
    assert watch.requests == [replays[planner].as_uri()]


def test_an_episode_from_a_file_replays_the_same(open_page, episodes, settings, tmp_path):
    episodes["planning"].save(tmp_path / "hunt.parquet")
    loaded = bh.Episode.load(tmp_path / "hunt.parquet")
    write_replay(loaded, tmp_path / "loaded.html")
    write_replay(episodes["planning"], tmp_path / "live.html")
    assert (tmp_path / "loaded.html").read_bytes() == (tmp_path / "live.html").read_bytes()


def test_it_plays_pauses_and_plays_again_from_the_start(open_page, replays, episodes):
    page, watch = open_page(replays["prediction"])
    page.locator("[data-part=speed]").select_option("1")  # so slow that no machine is too late to press Pause
    page.get_by_role("button", name="Play", exact=True).click()
    wait_until(lambda: int(page.locator("[data-part=scrub]").input_value()) > 20)
    page.get_by_role("button", name="Pause", exact=True).click()
    stopped = clock(page)
    page.wait_for_timeout(200)
    assert clock(page) == stopped > 0
    page.keyboard.press("End")
    assert clock(page) == pytest.approx(episodes["prediction"].trail["time"].iloc[-1], abs=0.006)
    page.locator("[data-part=speed]").select_option("0.5")
    page.get_by_role("button", name="Play", exact=True).click()
    wait_until(lambda: int(page.locator("[data-player]").get_attribute("data-step")) < 3)
    assert not watch.errors


def test_the_scrubber_moves_through_the_hunt(open_page, replays, episodes):
    page, _ = open_page(replays["planning"])
    episode = episodes["planning"]
    scrub = page.locator("[data-part=scrub]")
    last = int(scrub.get_attribute("max"))
    assert last == len(episode.trail)  # the start stands before the recorded moments
    for position in (last // 3, last // 2, last):
        scrub.fill(str(position))
        time = episode.trail["time"].iloc[position - 1]
        assert clock(page) == pytest.approx(time, abs=0.006)
        step = int((episode.frame["time"] <= time + 1e-9).sum()) - 1
        assert page.locator("[data-player]").get_attribute("data-step") == str(step)
        assert f"decision {step + 1} of {len(episode.frame)}" in scrub.get_attribute("aria-valuetext")
    scrub.focus()
    page.keyboard.press("ArrowLeft")  # on the scrubber an arrow is one frame, not one decision
    assert int(scrub.input_value()) == last - 1


def test_every_key_acts(open_page, replays, episodes):
    page, watch = open_page(replays["planning"])
    step = lambda: int(page.locator("[data-player]").get_attribute("data-step"))  # noqa: E731
    frame = lambda: int(page.locator("[data-part=scrub]").input_value())  # noqa: E731
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    assert step() == 2
    page.keyboard.press("ArrowLeft")
    assert step() == 1
    before = frame()
    page.keyboard.press(".")
    assert frame() == before + 1
    page.keyboard.press(",")
    page.keyboard.press(",")
    assert frame() == before - 1
    page.keyboard.press("End")
    assert step() == len(episodes["planning"].frame) - 1
    page.keyboard.press("Home")
    assert (step(), clock(page)) == (0, 0)
    page.keyboard.press("+")
    assert page.locator("[data-part=speed]").input_value() == "8"
    page.keyboard.press("-")
    page.keyboard.press("-")
    assert page.locator("[data-part=speed]").input_value() == "2"
    for key, part in (("p", "show-plan"), ("o", "show-predicted"), ("f", "follow")):
        was = page.locator(f"[data-part={part}]").is_checked()
        page.keyboard.press(key)
        assert page.locator(f"[data-part={part}]").is_checked() != was
    page.keyboard.press("Space")
    wait_until(lambda: page.locator("[data-player]").get_attribute("data-playing") == "true")
    page.keyboard.press("Space")
    assert page.locator("[data-part=play]").inner_text() == "Play"
    assert not watch.errors


def test_screen_readers_are_told_what_happens(open_page, replays, episodes):
    page, _ = open_page(replays["prediction"])
    page.keyboard.press("ArrowRight")
    row = episodes["prediction"].frame.iloc[1]
    assert page.get_by_role("status").inner_text().startswith(f"Decision 2 at {row['time']:.1f} s: prey ")
    assert f"gait {row['gait']}." in page.get_by_role("img").get_attribute("aria-label")
    names = page.locator("button, select, input, canvas").evaluate_all(
        "nodes => nodes.map(n => n.getAttribute('aria-label') || n.labels?.[0]?.textContent || n.textContent)"
    )
    assert all(name.strip() for name in names)


def test_the_canvas_draws_robots_trails_and_plan(open_page, replays):
    """Layers switched off change the picture; every frame differs from the one before."""
    page, _ = open_page(replays["planning"])
    picture = lambda: page.locator("canvas").evaluate("canvas => canvas.toDataURL()")  # noqa: E731
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    seen = [picture()]
    for key in ("p", "o", "f", "."):
        page.keyboard.press(key)
        seen.append(picture())
    assert len(set(seen)) == len(seen)


def test_it_fits_the_screen_in_both_themes(open_page, replays):
    page, watch = open_page(replays["prediction"])
    grounds = []
    for theme in ("light", "dark"):
        page.emulate_media(color_scheme=theme)
        grounds.append(page.evaluate("getComputedStyle(document.body).backgroundColor"))
        for width in (360, 768, 1280):
            page.set_viewport_size({"width": width, "height": 800})
            over = page.evaluate(
                "[...document.querySelectorAll('body *')].filter(n => n.getBoundingClientRect().right > innerWidth + 1"
                " && !n.closest('.prey-rows, .hidden-text')).map(n => n.outerHTML.slice(0, 80))"
            )
            assert over == []
    assert grounds[0] != grounds[1]
    assert not watch.errors


def test_names_from_outside_stay_text(open_page, episodes, tmp_path):
    nasty = '</script><img src=x onerror="document.title=1"><b>'
    episode = episodes["planning"]
    frame = episode.frame.assign(gait=nasty, planned_gaits=[[nasty]] * len(episode.frame), objective=nasty)
    record = {**episode.provenance["settings"], "note": nasty}
    provenance = {**episode.provenance, "planner": nasty, "settings": record}
    write_replay(replace(episode, frame=frame, provenance=provenance), tmp_path / "nasty.html")
    page, watch = open_page(tmp_path / "nasty.html")
    assert page.locator("[data-part=heading]").inner_text() == f"Decision 1: {nasty}"
    assert page.locator("h1").inner_text().startswith(nasty)
    assert page.title().startswith(nasty)
    assert page.locator("img, b").count() == 0
    assert not watch.errors
    assert len(watch.requests) == 1


def test_a_value_that_is_not_finite_stops_nothing(open_page, episodes, tmp_path):
    episode = episodes["planning"]
    write_replay(replace(episode, frame=episode.frame.assign(value=math.inf)), tmp_path / "endless.html")
    page, watch = open_page(tmp_path / "endless.html")
    page.keyboard.press("ArrowRight")
    assert fact(page, "value") == "not finite"
    assert page.locator("[data-part=heading]").inner_text().startswith("Decision 2")
    assert not watch.errors
