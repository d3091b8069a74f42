"""The commands on a page: run as they stand, they make the same thing again."""

from __future__ import annotations

import shlex
import tomllib

import pytest

import bayeshunt as bh
from bayeshunt.cli import main
from bayeshunt.settings import load_experiment
from bayeshunt.views.commands import evaluate_command, hunt_command, preset_of, to_toml

PAPER = load_experiment("paper")
OTHER = load_experiment(
    "paper", {"prey.speed": 0.04, "name": 'my "own"\n\\ pays\u00e9', "planner.planning.expansions": None}
)


@pytest.mark.parametrize("settings", [PAPER, OTHER], ids=["paper", "other"])
def test_settings_written_as_toml_read_back_equal(settings, tmp_path):
    path = tmp_path / "settings.toml"
    path.write_text(to_toml(settings), encoding="utf-8")
    read = load_experiment(path)
    expected = settings.model_dump()
    expected["planner"] = {k: {a: b for a, b in v.items() if b is not None} for k, v in expected["planner"].items()}
    assert read.model_dump() == expected
    tomllib.loads(to_toml(settings))


def test_the_preset_is_named_only_where_it_is_one():
    assert preset_of(PAPER) == "paper"
    assert preset_of(load_experiment("paper", {"protocol.runs": 3})) == "paper"
    assert preset_of(OTHER) is None


def test_an_evaluation_names_only_what_differs():
    everything = evaluate_command(PAPER, PAPER.planners, tuple(PAPER.arenas), 7)
    assert everything == "bayeshunt evaluate --preset paper --runs 100 --seed 7 --out results"
    some = evaluate_command(OTHER, ["planning"], ["open"], 0, model="a model.json")
    assert some == (
        "bayeshunt evaluate --config settings.toml --planner planning --arena open --runs 100 --seed 0 "
        "--model 'a model.json' --out results"
    )


def test_the_hunt_command_makes_the_same_page(monkeypatch, tmp_path, khepera_model):
    khepera_model.save(tmp_path / "model.json")
    monkeypatch.chdir(tmp_path)
    episode = bh.hunt(PAPER, bh.make_planner("prediction", khepera_model), arena="walled", theta=3.0, seed=12)
    source = ["--model", "model.json"]
    bh.write_replay(episode, "first.html", model=khepera_model, source=source)
    command = hunt_command(PAPER, "prediction", "walled", 3.0, 12, source=source)
    assert command in (tmp_path / "first.html").read_text()
    monkeypatch.setattr("sys.argv", shlex.split(command))
    with pytest.raises(SystemExit) as stopped:
        main()
    assert stopped.value.code == 0
    assert (tmp_path / "hunt.html").read_bytes() == (tmp_path / "first.html").read_bytes()
