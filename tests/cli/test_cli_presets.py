"""Which experiment runs: the default, and the one whose robot a given model is of."""

import inspect
import json

import pytest

import bayeshunt as bh
from bayeshunt.config.loading import DEFAULT_PRESET

FEW = ["--planner", "reactive", "--set", "protocol.thetas=[3.0]", "--set", "model.babbling_steps=200"]
EVALUATE = ["evaluate", "--runs", "1", "--jobs", "1", "--arena", "walled", *FEW, "--json"]


@pytest.mark.parametrize("name", ["evaluate", "sweep", "tradeoff", "reference", "remember", "learn_room"])
def test_one_default_for_all_in_python(name):
    assert inspect.signature(getattr(bh, name)).parameters["experiment"].default == DEFAULT_PRESET == "oses2010"


def test_the_default_and_the_testbed_by_their_names(bayeshunt):
    assert json.loads(bayeshunt(*EVALUATE)[0])["experiment"] == "oses2010"
    assert json.loads(bayeshunt(*EVALUATE, "--preset", "paper")[0])["experiment"] == "paper"
    assert json.loads(bayeshunt("hunt", *FEW, "--json")[0])["experiment"] == "oses2010"


@pytest.mark.parametrize(("robot", "preset"), [("khepera", "paper"), ("khepera_oses2010", "oses2010")])
def test_a_model_brings_the_preset_of_its_robot(bayeshunt, robot, preset):
    bayeshunt("babble", "--robot", robot, "--steps", "200", "--out", "b.parquet", "--quiet")
    bayeshunt("fit", "b.parquet", "--out", "m.json", "--xmlbif", "m.xmlbif")
    assert json.loads(bayeshunt(*EVALUATE, "--model", "m.json")[0])["experiment"] == preset
    for model in ("m.json", "m.xmlbif"):
        assert json.loads(bayeshunt("hunt", "--model", model, *FEW, "--json")[0])["experiment"] == preset
        said = " ".join(bayeshunt("hunt", "--model", model, *FEW)[0].split())
        assert f"Preset '{preset}', because {model} is a model of its robot, '{robot}'." in said
    assert "because" not in bayeshunt("hunt", "--model", "m.json", "--preset", preset, *FEW)[0]


def test_a_model_that_no_preset_knows(bayeshunt):
    bayeshunt("babble", "--robot", "car", "--steps", "100", "--out", "b.parquet", "--quiet")
    bayeshunt("fit", "b.parquet", "--out", "car.json")
    for command in (["hunt"], ["evaluate"], ["figures", "--out", "figures"]):
        _, err = bayeshunt(*command, "--model", "car.json", status=2)
        assert err.startswith("bayeshunt: car.json: no preset has the robot that this model is of (gaits ")
        assert ", as robot car has: --set robot=car); " in err
        assert err.endswith("; say the experiment with --preset or --config\n")
        assert err.count("\n") == 1
    # a change that makes it the model's robot is enough
    assert json.loads(bayeshunt("hunt", "--model", "car.json", "--set", "robot=car", *FEW, "--json")[0])["gaits"]


def test_what_comes_next_names_the_experiment(bayeshunt):
    """A room, a table or a memory is of one experiment; the line that follows must not run another."""
    few = ["--steps", "20", "--set", "model.babbling_steps=200", "--out", "room.json"]
    assert "next: bayeshunt evaluate --planner intercept_walls" in bayeshunt("explore", *few)[0]
    assert "next: bayeshunt evaluate --preset paper --planner" in bayeshunt("explore", "--preset", "paper", *few)[0]
    assert "next: bayeshunt evaluate --set robot=car --planner" in bayeshunt("explore", "--set", "robot=car", *few)[0]
