"""Lengths that people read are millimetres, in the hunt's table, in print and in notebooks alike."""

import math
import re

import pytest

import bayeshunt as bh
from bayeshunt.views import units
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
    assert (units.millimetres(math.nan), units.millimetres(0.0571), units.degrees(-0.001)) == ("", "57 mm", "0°")


def test_the_value_of_a_plan_is_that_of_its_tree(khepera_model):
    planner = bh.make_planner("planning", khepera_model)
    plan = bh.hunt("paper", planner, arena="open", theta=1.0, seed=0).plans[3]
    text = str(plan)
    assert f"value     {1000 * plan.value:.4g}, " in text
    last = [line for line in text.splitlines() if line.strip().startswith("*")][-1]
    assert last.endswith(f"{1000 * plan.value:.2f} mm")
