"""Every planner with every command either works or is refused in one line before any work."""

from __future__ import annotations

import json
import sys

import pytest

from bayeshunt import cli

MEANT = "bayeshunt: unknown planner 'planing'; did you mean 'planning'?"
FAST = ["--set", "protocol.thetas=[0.0]", "--set", "model.babbling_steps=300", "--preset", "paper"]


@pytest.fixture
def run(monkeypatch, capfd, tmp_path):
    monkeypatch.chdir(tmp_path)

    def run(*words):
        monkeypatch.setattr(sys, "argv", ["bayeshunt", *words])
        with pytest.raises(SystemExit) as stopped:
            cli.main()
        out, err = capfd.readouterr()
        return stopped.value.code, out, err.strip()

    return run


@pytest.fixture
def no_work(monkeypatch):
    def babbles(*_, **__):
        raise AssertionError("work began")

    monkeypatch.setattr("bayeshunt.experiments.protocol.babble", babbles)
    monkeypatch.setattr("bayeshunt.experiments.studies.references.babble", babbles)


COMMANDS = {
    "hunt": ["hunt"],
    "evaluate": ["evaluate", "--runs", "1"],
    "sweep": ["sweep", "--axis", "prey.speed=0.04", "--runs", "1"],
    "tradeoff": ["tradeoff", "--runs", "1"],
    "figures": ["figures", "--out", "figures", "--runs", "1"],
    "remember": ["remember", "--out", "memory.json", "--runs", "1"],
    "reference": ["reference", "--out", "table.npz"],
    "explore": ["explore", "--out", "room.json"],
}


@pytest.mark.parametrize("command", COMMANDS)
def test_a_misspelt_section_is_refused_by_every_command(command, run, no_work):
    code, _, err = run(*COMMANDS[command], "--preset", "paper", "--set", "planner.planing.depth=2")
    assert (code, err) == (2, MEANT)


@pytest.mark.parametrize("command", COMMANDS)
def test_a_misspelt_section_of_a_file_is_refused(command, run, no_work, tmp_path):
    (tmp_path / "mine.toml").write_text('base = "paper"\n\n[planner.planing]\ndepth = 2\n')
    code, _, err = run(*COMMANDS[command], "--config", "mine.toml")
    assert (code, err) == (2, MEANT)


def test_a_misspelt_axis_is_refused(run, no_work):
    code, _, err = run("sweep", "--preset", "paper", "--runs", "1", "--axis", "planner.planing.depth=1,5")
    assert (code, err) == (2, MEANT)


@pytest.mark.parametrize("command", ["hunt", "remember"])
def test_a_bound_is_refused_by_what_hunts(command, run, no_work):
    code, _, err = run(*COMMANDS[command], "--preset", "paper", "--planner", "kinematic_limit")
    assert code == 2
    assert err == ("bayeshunt: kinematic_limit is a bound that no gaits reach: it can be evaluated, not hunted with")


@pytest.mark.parametrize("name", ["reference", "memory", "memory_place", "memory_previous"])
@pytest.mark.parametrize("command", ["hunt", "evaluate", "sweep", "tradeoff", "remember"])
def test_a_planner_without_its_file_is_refused(command, name, run, no_work):
    code, _, err = run(*COMMANDS[command], "--preset", "paper", "--planner", name)
    assert code == 2
    assert err.startswith(f"bayeshunt: {name}: needs the setting table")
    assert "\n" not in err


def test_a_bound_is_weighed_beside(run):
    code, out, err = run("tradeoff", "--vary", "transitions=0", "--runs", "1", "--planner", "kinematic_limit", *FAST,
                         "--json", "--jobs", "1")  # fmt: skip
    assert code == 0, err
    assert [row["planner"] for row in json.loads(out)["rows"]] == ["kinematic_limit", "frugal"]


def test_a_report_of_a_bound_says_that_there_is_nothing_to_play(run, tmp_path):
    code, _, err = run("evaluate", "--runs", "1", "--planner", "kinematic_limit", "--arena", "open", *FAST, "--jobs",
                       "1", "--out", "results", "--quiet")  # fmt: skip
    assert code == 0, err
    code, _, err = run("report", "results", "--out", "report.html", "--quiet")
    assert code == 0, err
    assert "kinematic_limit is a bound" in (tmp_path / "report.html").read_text()
