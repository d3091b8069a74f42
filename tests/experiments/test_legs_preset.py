"""The experiment on legs: which structure the model has is one word, and says itself in the results."""

import json

import pytest

import bayeshunt as bh
from bayeshunt.experiments.protocol import learn_model

FEW = {"model.babbling_steps": 150, "protocol.runs": 1, "protocol.time_limit": 4.5}


@pytest.mark.parametrize(("structure", "backoff"), [("naive", None), ("previous_gait", 5.0)])
def test_the_structure_of_the_settings_is_learned(structure, backoff):
    model = learn_model(bh.load_experiment("legs", {**FEW, "model.structure": structure}), 3)
    assert model.structure.name == structure
    assert getattr(model, "backoff", None) == backoff


def test_evaluate_takes_a_structure(bayeshunt, tmp_path):
    few = [f"--set={key}={value}" for key, value in FEW.items()]
    line = ["evaluate", "--preset", "legs", *few, "--planner", "intercept", "--arena", "open", "--jobs", "1", "--quiet"]
    out, _ = bayeshunt(*line, "--structure", "previous_gait", "--json")
    assert "given model" not in json.loads(out)["note"]
    _, err = bayeshunt(*line, "--structure", "tree", status=2)
    assert "model.structure" in err
    model = tmp_path / "model.json"
    learn_model(bh.load_experiment("legs", FEW), 3).save(model)
    _, err = bayeshunt(*line, "--structure", "naive", "--model", str(model), status=2)
    assert "--model has its own" in err
