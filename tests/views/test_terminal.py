"""Tables in a terminal: none loses a number, however narrow it is."""

from __future__ import annotations

import re

import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.experiments.scores import wilson_interval
from bayeshunt.experiments.store.export import summary
from bayeshunt.views.terminal import terminal

WIDTHS = (20, 40, 60, 80, 200)
each_width = pytest.mark.parametrize("width", WIDTHS)


@pytest.fixture
def lines(monkeypatch, capsys, width):
    """A function that draws in a terminal of ``width`` and returns what stands there, line by line."""
    monkeypatch.setattr(terminal.out, "width", width)

    def drawn(draw, *arguments):
        draw(*arguments)
        return capsys.readouterr().out.splitlines()

    return drawn


def assert_stand_in_one_line(lines, *texts):
    """All texts stand in one line, in this order: nothing is cut, and no number is folded."""
    pattern = r"\s+".join(map(re.escape, texts))
    assert any(re.search(pattern, line) for line in lines), (texts, lines)


@each_width
def test_an_evaluation_is_whole(lines, khepera_model):
    settings = bh.load_experiment("paper", {"protocol.thetas": [3.0], "protocol.runs": 1})
    hunts = bh.evaluate(settings, planners=["reactive", "proportional_navigation"], model=khepera_model)
    facts = summary(hunts, settings, 0)
    shown = lines(terminal.success_table, facts)
    for row in facts["rows"]:
        if row["theta"] is None:
            low, high = (f"{100 * row[name]:.1f}" for name in ("ci_low", "ci_high"))
            share, mean = f"{100 * row['success']:.1f}", f"{row['mean_time_s']:.1f}"
            assert_stand_in_one_line(shown, row["arena"], f"{row['caught']}/1", share, f"{low} to {high}", mean)


@each_width
def test_a_sweep_over_two_axes_is_whole(lines):
    low, high = wilson_interval(7, 140)
    frame = pd.DataFrame(
        [{"noise": 0.5, "gait_duration": 3.328, "planner": "kinematic_limit", "arena": "walled", "runs": 140,
          "caught": 7, "success": 0.05, "ci_low": low, "ci_high": high, "mean_time_s": 57.25}]
    )  # fmt: skip
    frame.attrs = {"axes": ["noise", "gait_duration"], "experiment": "paper", "seed": 0, "note": ""}
    shown = lines(terminal.sweep_table, frame)
    frame.attrs["scaled"] = "Arenas and prey are drawn to mine."
    drawn = lines(terminal.sweep_table, frame)
    assert " ".join(drawn[: len(drawn) - len(shown)]).split() == frame.attrs["scaled"].split()
    assert drawn[len(drawn) - len(shown) :] == shown
    assert_stand_in_one_line(shown, "0.5", "3.328")
    assert_stand_in_one_line(shown, "7/140", "5.0", f"{100 * low:.1f} to {100 * high:.1f}", "57.2")


@each_width
def test_a_hunt_is_whole(lines, khepera_model):
    episode = bh.hunt("paper", bh.make_planner("reactive", khepera_model), arena="walled", theta=3.0, seed=0)
    shown = lines(terminal.episode_table, episode)
    for row in episode.frame.to_dict("records"):
        assert_stand_in_one_line(shown, str(row["step"]), f"{row['time']:.1f} s")
        assert any(row["gait"] in line for line in shown)


@pytest.mark.parametrize("width", [80])
def test_what_fits_is_as_wide_as_it_need_be(lines):
    frame = pd.DataFrame(
        [{"noise": 0.5, "planner": "planning", "arena": "open", "runs": 7, "caught": 4, "success": 0.5, "ci_low": 0.3,
          "ci_high": 0.7, "mean_time_s": 30.0}]
    )  # fmt: skip
    frame.attrs = {"axes": ["noise"], "experiment": "paper", "seed": 0, "note": ""}
    assert max(map(len, lines(terminal.sweep_table, frame))) <= 80
