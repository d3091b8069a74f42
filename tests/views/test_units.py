"""Lengths that people read are millimetres, in the hunt's table, in print and in notebooks alike."""

import math
import re

import pytest

import bayeshunt as bh
from bayeshunt.core import units
from bayeshunt.views.terminal import terminal


@pytest.fixture(scope="module", params=["planning", "pure_pursuit", "reactive"])
def episode(request, khepera_model):
    planner = bh.make_planner(request.param, khepera_model)
    return bh.hunt("paper", planner, arena="walled", theta=3.0, seed=2)


def test_one_hunt_says_the_same_everywhere(episode, monkeypatch):
    monkeypatch.setenv("COLUMNS", "120")
    with terminal.out.capture() as captured:
        terminal.episode_table(episode)
    printed, text, page = captured.get(), str(episode), episode._repr_html_()
    first = episode.frame.iloc[0]
    seen = f"{1000 * first['seen_distance']:.0f}"
    assert f"{seen} mm" in printed
    assert f" {seen} " in text
    assert f">{seen}<" in page
    assert f"{units.degrees(first['seen_angle'])}" in printed
    for shown in (printed, text, page, str(episode.plans[0]), episode.plans[0]._repr_html_()):
        assert "[m]" not in shown
        assert not re.search(r"\d (m|bodies)\b", shown.replace("px", ""))


def test_values_in_metres_become_millimetres_and_others_stay():
    assert units.objective(0.0123, "mean distance [m]") == (pytest.approx(12.3), "mean distance [mm]")
    assert units.objective(3.2, "expected time to capture [s]") == (3.2, "expected time to capture [s]")
    assert (units.length(math.nan), units.length(0.0571), units.degrees(-0.001)) == ("", "57 mm", "0°")


def test_the_value_of_a_plan_is_that_of_its_tree(khepera_model):
    planner = bh.make_planner("planning", khepera_model)
    plan = bh.hunt("paper", planner, arena="open", theta=1.0, seed=0).plans[3]
    text = str(plan)
    assert f"value     {1000 * plan.value:.4g}, " in text
    last = [line for line in text.splitlines() if line.strip().startswith("*")][-1]
    assert last.endswith(f"{1000 * plan.value:.2f} mm")


# --- no stray units, wherever a person reads -------------------------------------------------------

#: A number with a unit that people do not read here, or such a unit named; a metre and more may be metres.
STRAYS = re.compile(
    r"[\d.]+ ?(?:deg|rad|cm)\b|\[(?:m|rad|deg)\b|(?<![\d.])0?\.\d+ m\b|\d{4,} mm\b(?!/)|"
    r"\b(?:degrees|radians|metres|nats)\b"
)


def strays(text):
    return sorted(set(STRAYS.findall(text)))


def visible(html):
    """What can be read of a page: its text, and what it says on hover or aloud."""
    said = re.findall(r'(?:title|aria-label|data-hint)="([^"]*)"', html)
    return " ".join([re.sub(r"<(style|script).*?</\1>|<[^>]+>", " ", html, flags=re.S), *said])


def test_the_pattern_finds_strays_and_nothing_else():
    for text in ("-10 deg", "1.5 rad", "20 cm", "value [m]", "0.16 m", "1200 mm", "travelled in metres", "0.3 nats"):
        assert strays(text), text
    for text in ("-10°", "160 mm", "1.2 m", "0.1 bodies", "3.328 s", "0.0576 mm/s", "16 m away", "a degree"):
        assert not strays(text), text


def test_what_shows_itself_has_no_stray_units(thing):
    for text in (str(thing), visible(thing._repr_html_())):
        assert strays(text) == []


@pytest.mark.parametrize("name", ["khepera", "car"])
def test_settings_have_no_stray_units(name):
    robot = bh.load_robot(name)
    for shown in (robot, robot.gaits, bh.load_experiment("paper")):
        assert strays(f"{shown} {visible(shown._repr_html_())}") == []


def test_pages_have_no_stray_units(episode, khepera_model):
    from bayeshunt.views.pages.replay import replay_data, replay_html

    assert strays(visible(replay_html(episode, model=khepera_model))) == []
    data = replay_data(episode, model=khepera_model)
    texts = [data["title"], data["outcome"], *(part for s in data["steps"] for part in (s["objective"], *_words(s)))]
    assert strays(" ".join(texts)) == []


def _words(step):
    return step["bars"]["title"], step["bars"]["caption"]


def test_a_value_in_a_replay_is_that_of_the_plan_in_millimetres(khepera_model):
    from bayeshunt.views.pages.replay import replay_data

    hunt = bh.hunt("paper", bh.make_planner("planning", khepera_model), arena="open", theta=1.0, seed=0)
    for step, plan in zip(replay_data(hunt)["steps"], hunt.plans, strict=True):
        assert step["value"] == pytest.approx(1000 * plan.value, rel=1e-5)
        assert step["objective"].endswith("[mm]")
        assert min(step["bars"]["values"]) == pytest.approx(1000 * plan.value, rel=1e-5)


def test_pages_and_the_explorer_read_units_as_texts_do():
    """The same numbers through the formatter of the scripts."""
    import json
    import shutil
    import subprocess

    from bayeshunt.views.pages.page import asset

    node = shutil.which("node")
    if node is None:
        pytest.skip("no node on this machine")
    lengths, angles = [0.0, 0.0057, 0.0571, 0.16, 0.9994, 0.9996, 1.2, 15.84], [0.0, 0.5, -0.5, 3.14159, -0.001]
    code = asset("units.js") + f"console.log(JSON.stringify([{lengths}.map(length), {angles}.map(degrees)]))"
    said = json.loads(subprocess.run([node, "-e", code], capture_output=True, check=True, text=True).stdout)
    assert said == [list(map(units.length, lengths)), [units.true_minus(units.degrees(a)) for a in angles]]
