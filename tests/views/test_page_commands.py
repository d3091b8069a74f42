"""replay and report as typed: they write their page, say so, and refuse wrong input in one line."""

from __future__ import annotations

import json

import pytest

import bayeshunt as bh


def test_a_recorded_hunt_becomes_a_page(bayeshunt, tmp_path, khepera_model):
    khepera_model.save(tmp_path / "model.json")
    options = ("--planner", "prediction", "--arena", "walled", "--seed", "2", "--model", "model.json")
    out, _ = bayeshunt("hunt", *options, "--out", "hunt.parquet", "--replay", "live.html", "--json")
    assert json.loads(out)["replay"] == "live.html"
    out, _ = bayeshunt("replay", "hunt.parquet", "--out", "stored.html", "--model", "model.json", "--json")
    size = (tmp_path / "stored.html").stat().st_size
    assert json.loads(out) == {"out": "stored.html", "bytes": size, "warnings": []}
    assert (tmp_path / "stored.html").read_bytes() == (tmp_path / "live.html").read_bytes()


def test_an_evaluation_becomes_a_page(bayeshunt, tmp_path, khepera_model):
    khepera_model.save(tmp_path / "model.json")
    options = ("--planner", "prediction", "--arena", "open", "--runs", "1", "--jobs", "1", "--model", "model.json")
    bayeshunt("evaluate", *options, "--out", "results", "--quiet")
    out, _ = bayeshunt("report", "results", "--out", "report.html", "--model", "model.json", "--json")
    facts = json.loads(out)
    assert (facts["out"], facts["hunts"], facts["warnings"]) == ("report.html", 7, [])
    html = (tmp_path / "report.html").read_text()
    assert "bayeshunt evaluate --preset paper --planner prediction --arena open --runs 1" in html
    assert bh.load_experiment("paper").note in html


@pytest.mark.parametrize(
    ("arguments", "status", "message"),
    [
        (("replay", "none.parquet", "--out", "a.html"), 2, "none.parquet: no such file"),
        (("replay", "text.parquet", "--out", "a.html"), 2, "text.parquet"),
        (("report", "none", "--out", "a.html"), 2, "none: no hunts.parquet here"),
        (("report", "none", "--out", "nowhere/a.html"), 2, "the folder nowhere does not exist"),
        (("hunt", "--replay", "nowhere/a.html"), 2, "the folder nowhere does not exist"),
    ],
)
def test_wrong_input_is_one_line(bayeshunt, tmp_path, arguments, status, message):
    (tmp_path / "text.parquet").write_text("not an episode")
    _, err = bayeshunt(*arguments, status=status)
    assert message in err
    assert len(err.strip().splitlines()) == 1
    assert not list(tmp_path.glob("*.html"))


def test_a_replay_says_that_it_was_given_another_model(bayeshunt, folder, khepera_model, khepera_frame):
    khepera_model.save(folder / "its.json")
    bh.ForwardModel.fit(khepera_frame, khepera_model.gaits, prior=1.0).save(folder / "other.json")
    bayeshunt("hunt", "--planner", "reactive", "--model", "its.json", "--out", "hunt.parquet")
    _, err = bayeshunt("replay", "hunt.parquet", "--out", "hunt.html", "--model", "other.json")
    assert err.startswith("warning: the hunt was made with a model of fingerprint ")
    assert err.count("\n") == 1
    out, _ = bayeshunt("replay", "hunt.parquet", "--out", "hunt.html", "--model", "other.json", "--json")
    assert [f"warning: {line}\n" for line in json.loads(out)["warnings"]] == [err]
    for given in (["--model", "its.json"], []):
        assert bayeshunt("replay", "hunt.parquet", "--out", "hunt.html", *given)[1] == ""
