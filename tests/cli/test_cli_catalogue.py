"""planners, robots, prey, presets: what there is to choose from, as typed; and its completion."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from bayeshunt.config.loading import load_experiment, load_robot
from bayeshunt.planners.registry import planner_names
from bayeshunt.views.terminal import terminal
from bayeshunt.worlds.prey.behaviours import prey_names

PLUGIN = '''
import bayeshunt as bh
from bayeshunt.worlds.prey.behaviours import Straight

class Mine:
    """Does as it pleases."""
    name = "mine"
    def __init__(self, model, *, mood: float = 1.0): ...
    def plan(self, situation, *, rng): ...

class Hare(Straight):
    """Runs like a hare."""

bh.register_planner("mine", Mine)
bh.register_prey("hare", Hare)
'''


def test_planners_are_listed(bayeshunt, folder):
    out, _ = bayeshunt("planners")
    for name in planner_names():
        assert f" {name} " in out
    assert " reference * " in out
    assert " intercept * " not in out
    facts = {f["name"]: f for f in json.loads(bayeshunt("planners", "--json")[0])}
    assert list(facts) == list(planner_names())
    assert facts["memory"]["needs"] == {"tables": "bayeshunt remember"}
    assert not facts["memory"]["ab_initio"]


def test_one_planner_and_how_to_set_it(bayeshunt):
    out, _ = bayeshunt("planners", "planning")
    assert "bank_seed" in out
    assert "--set planner.planning.depth=10" in out
    assert "[planner.planning]\n  depth = 10" in out
    assert "HAIS 2010" in out
    facts = json.loads(bayeshunt("planners", "planning", "--json")[0])
    assert facts["settings"][0] == {
        "name": "depth", "kind": "whole number", "range": ">= 1", "default": 10,
        "meaning": "longest gait sequence, time-steps",
    }  # fmt: skip
    assert "It has no settings" in bayeshunt("planners", "reactive")[0]
    _, err = bayeshunt("planners", "plannin", status=2)
    assert "did you mean 'planning'?" in err


def test_what_is_said_to_set_a_planner_sets_it(bayeshunt, folder):
    out, _ = bayeshunt("planners", "frugal")
    lines = out.splitlines()
    start = lines.index('  base = "paper"')
    toml = "\n".join(line.strip() for line in lines[start:]).replace("time = 1", "time = 2")
    (folder / "mine.toml").write_text(toml)
    assert load_experiment(folder / "mine.toml").planner["frugal"]["time"] == 2
    command = next(line for line in lines if line.startswith("Change one:")).split("bayeshunt ")[1].split()
    quick = ["--runs", "1", "--arena", "open", "--set", "protocol.thetas=[0.0]", "--set", "model.babbling_steps=200"]
    assert json.loads(bayeshunt(*command, *quick, "--jobs", "1", "--json")[0])["rows"][0]["planner"] == "frugal"


@pytest.mark.slow
def test_ones_own_are_listed_too(folder):
    (folder / "mine.py").write_text(PLUGIN)
    ours = Path(sys.executable).parent / "bayeshunt"

    def run(*words):
        done = subprocess.run([ours, "--plugin", "mine.py", *words], capture_output=True, text=True, cwd=folder)
        assert done.returncode == 0, done.stderr
        return done.stdout

    facts = json.loads(run("planners", "mine", "--json"))
    assert (facts["shipped"], facts["summary"]) == (False, "Does as it pleases")
    assert facts["settings"][0]["default"] == 1.0
    assert "Runs like a hare." in run("prey")
    assert "bayeshunt --plugin FILE.py evaluate --planner mine --set planner.mine.mood=1" in run("planners", "mine")


def test_robots_prey_and_presets(bayeshunt, folder):
    out, _ = bayeshunt("robots")
    assert "khepera" in out
    assert "Car-like robot" in out
    names = ["car", "follower", "hexapod", "hexapod_mixed", "khepera", "khepera_oses2010", "puppy", "quadruped"]
    assert [r["robot"] for r in json.loads(bayeshunt("robots", "--json")[0])] == names
    assert "tight right" in bayeshunt("robots", "khepera")[0]
    assert json.loads(bayeshunt("robots", "car", "--json")[0])["name"] == "car"
    (folder / "mine.toml").write_text(bayeshunt("robots", "car", "--toml")[0])
    assert load_robot(folder / "mine.toml") == load_robot("car")
    listed = json.loads(bayeshunt("prey", "--json")[0])
    assert sorted(row["behaviour"] for row in listed) == prey_names()
    assert all(len(row["description"]) > 20 for row in listed)
    assert "paper" in bayeshunt("presets")[0]
    (folder / "exp.toml").write_text(bayeshunt("presets", "paper", "--toml")[0])
    assert load_experiment(folder / "exp.toml") == load_experiment("paper")
    _, err = bayeshunt("robots", "car", "--toml", "--json", status=2)
    assert "choose one" in err


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("bayeshunt hunt --planner intercept_", {"intercept_evader", "intercept_room", "intercept_walls"}),
        ("bayeshunt planners mem", {"memory", "memory_place", "memory_previous"}),
        ("bayeshunt babble --robot kh", {"khepera", "khepera_oses2010"}),
    ],
)
def test_names_complete_in_the_shell(line, found):
    words = {"_BAYESHUNT_COMPLETE": "complete_bash", "COMP_WORDS": line, "COMP_CWORD": str(len(line.split()) - 1)}
    ours = Path(sys.executable).parent / "bayeshunt"
    done = subprocess.run([ours], capture_output=True, text=True, env={**os.environ, **words})
    assert set(done.stdout.split()) == found


def test_defaults_are_said_as_a_settings_file_says_them(bayeshunt, monkeypatch):
    monkeypatch.setattr(terminal.out, "width", 200)  # or long keys fold what stands beside them
    out, _ = bayeshunt("settings")
    assert re.search(r"^prey\.senses_hunter +true or false +false ", out, re.MULTILINE)
    assert re.search(r"^robot\.gait\[\]\.left +number or none +none ", out, re.MULTILINE)
    said = " ".join(out.split())
    assert not re.search(r"\b(None|True|False|string|boolean|integer|array)\b", said)
    assert "Ornstein-Uhlenbeck" in out


def test_a_deprecated_planner_is_one_line_on_stderr(bayeshunt, folder):
    words = ("hunt", "--preset", "paper", "--planner", "intercept_room", "--arena", "open")
    said = 'is deprecated: write "intercept", the same hunter; it goes in 0.3'
    warned = f"bayeshunt: warning: planner 'intercept_room' {said}"
    assert [line for line in bayeshunt(*words)[1].splitlines() if "deprecated" in line] == [warned]
