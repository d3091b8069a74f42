"""The experiment on legs: which structure the model has is one word, and says itself in the results."""

import json

import pytest

import bayeshunt as bh
from bayeshunt.experiments.protocol import learn_model
from bayeshunt.experiments.store.export import summary
from bayeshunt.views.pages.replay import replay_html

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


def test_energy_and_falls_are_counted_kept_and_the_same_after_an_interruption(tmp_path):
    settings = bh.load_experiment("legs", {**FEW, "protocol.thetas": [0.5, 1.0]})
    model = learn_model(settings, 3)
    asked = {"planners": ["intercept"], "arenas": ["open"], "model": model, "jobs": 1}
    straight, kept = bh.evaluate(settings, **asked), bh.evaluate(settings, **asked, out=tmp_path / "out")
    assert (straight["energy"] > 1.0).all()
    assert (straight["falls"] >= 0).all()
    again = bh.evaluate(settings, **asked, out=tmp_path / "out")
    assert straight["energy"].tolist() == kept["energy"].tolist() == again["energy"].tolist()
    assert "| energy [J] |" in (tmp_path / "out" / "summary.md").read_text()
    row = straight.iloc[0]
    episode = bh.hunt(settings, bh.make_planner("intercept", model), arena="open", theta=0.5, seed=int(row["seed"]))
    assert [episode.provenance[name] for name in ("changes", "energy", "falls")] == [
        row["transitions"], row["energy"], row["falls"]
    ]  # fmt: skip
    spent = [*episode.frame["energy"], row["energy"]]
    assert spent[0] == 0.0
    assert sorted(spent) == spent
    episode.save(tmp_path / "hunt.parquet")
    page = replay_html(bh.Episode.load(tmp_path / "hunt.parquet"))
    spent = f"{row['energy']:.1f} J, {row['transitions']} changes of gait, {row['falls']} falls"
    assert f"decisions · {spent} · seed" in page  # in its head, for people


def test_evaluate_and_hunt_say_what_was_spent(bayeshunt):
    few = [f"--set={key}={value}" for key, value in FEW.items()]
    line = ["--preset", "legs", *few, "--planner", "intercept", "--arena", "open"]
    out, _ = bayeshunt("evaluate", *line, "--quiet", "--jobs", "1", "--json")
    total = next(row for row in json.loads(out)["rows"] if row["theta"] is None)
    assert total["energy_low"] < total["mean_energy_j"] < total["energy_high"]
    out, _ = bayeshunt("hunt", *line)
    assert " J, " in out
    assert " falls" in out


def test_a_robot_on_wheels_does_not_know_what_it_spends(khepera_model):
    few = {"runs": 1, "planners": ["reactive"], "arenas": ["open"], "model": khepera_model, "jobs": 1}
    frame = bh.evaluate("paper", **few)
    assert not {"energy", "falls"} & set(frame)
    assert "mean_energy_j" not in summary(frame, bh.load_experiment("paper"), 0)["rows"][0]
