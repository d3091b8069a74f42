"""The benchmark of worlds: what names a world, paired scores, and a cache that only fills what is missing."""

import importlib
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture
def worlds(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT))  # benchmarks are no part of the installed package
    return importlib.import_module("benchmarks.worlds")


@pytest.fixture
def hunted(worlds, monkeypatch):
    """The bearings that were hunted, in order; every hunt takes 1 s per radian, and the last bearing is missed."""
    bearings = []

    def hunt(settings, planner, arena, theta, seed):
        bearings.append(theta)
        return SimpleNamespace(time=theta, caught=theta < 6.0)

    monkeypatch.setattr(worlds, "run_hunt", hunt)
    monkeypatch.setattr(worlds, "code", lambda: "same")  # reading all of it takes a second
    monkeypatch.setattr(worlds, "prepared", lambda *given: (None, [0.002]))
    return bearings


def test_a_world_is_a_name_or_a_preset_with_settings(worlds):
    assert worlds.World.read("slippery").bound == "reference"
    mine = worlds.World.read("paper,prey.behaviour=straight,robot.gait_duration=1.664")
    assert (mine.settings.prey.behaviour, mine.settings.robot.gait_duration) == ("straight", 1.664)
    with pytest.raises(SystemExit, match="did you mean 'evader'"):
        worlds.World.read("evadr")


def test_only_what_is_missing_is_hunted(worlds, hunted, tmp_path, monkeypatch):
    def cell(seed=0):
        return worlds.Cell.of(worlds.World.read("paper"), worlds.Row("planning"), "open", seed, tmp_path)

    first = cell()
    first.hunt(2)
    assert hunted == [*range(7)] * 2
    cell().hunt(2)
    assert cell().ends == first.ends
    cell().hunt(3)
    assert len(hunted) == 7 * 3
    cell(seed=1).hunt(1)
    assert len(hunted) == 7 * 4


def test_results_of_earlier_code_are_kept_if_the_first_run_ends_alike(worlds, hunted, tmp_path, monkeypatch):
    one = worlds.Cell.of(worlds.World.read("paper"), worlds.Row("planning"), "open", 0, tmp_path)
    one.hunt(3)
    monkeypatch.setattr(worlds, "code", lambda: "changed")
    assert one.is_old
    one.hunt(3)
    assert not one.is_old
    assert len(hunted) == 7 * 4
    monkeypatch.setattr(worlds, "code", lambda: "changed again")
    one.ends = {run: [(time + 0.1, caught) for time, caught in ends] for run, ends in one.ends.items()}
    one.hunt(3)
    assert len(hunted) == 7 * 7
    assert [time for time, _ in one.ends[2]] == [*range(7)]


def test_rows_of_earlier_code_are_marked_and_hunted_first(worlds, hunted, tmp_path, monkeypatch, capsys):
    def run(*words):
        monkeypatch.setattr(
            sys, "argv", ["x", "--runs", "1", "--cache", str(tmp_path), "--planner", "planning", *words]
        )
        worlds.main()
        return capsys.readouterr().out

    run("evader")
    monkeypatch.setattr(worlds, "code", lambda: "changed")
    shown = run("--show", "straight prey", "evader")
    assert "| evader | walled | planning+ | 6/7 |" in shown
    assert "straight prey" not in shown
    assert len(hunted) == 7
    order = []
    monkeypatch.setattr(worlds, "prepared", lambda settings, *given: (order.append(settings.prey.behaviour), ())[::-1])
    assert "planning |" in run("straight prey", "evader")
    assert order == ["evader", "straight"]


def test_the_table_is_paired_and_the_figure_drawn(worlds, hunted, tmp_path, monkeypatch, capsys):
    command = ["x", "evader", "--runs", "1", "--cache", str(tmp_path), "--figure", str(tmp_path / "f.svg")]
    monkeypatch.setattr(sys, "argv", command)
    worlds.main()
    lines = [line for line in capsys.readouterr().out.splitlines() if "| intercept_walls |" in line]
    assert len(lines) == 1
    assert "| 6/7 | 85.7% |" in lines[0]
    assert "| 3.00 | +0.00 ± 0.00 | +0.00 ± 0.00 | 2.00 |" in lines[0]
    assert (tmp_path / "f.svg").stat().st_size > 1000


def test_differences_are_of_the_same_hunts(worlds):
    one, other = (
        worlds.Score("paper", "open", worlds.Row("planning"), np.array(times), 3, 1.0)
        for times in ([5.0, 7.0, 9.0], [4.0, 6.0, 8.0])
    )
    assert one.against(other) == (1.0, 0.0)
