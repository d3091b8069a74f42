"""Commands that go beyond the paper, as a user types them: sweep, tradeoff, reference, remember, --set."""

import json
import re

import pytest

from bayeshunt.experiments.studies.babbling import babble_to_file

SMALL = ["--set", "protocol.thetas=[3.0]", "--set", "model.babbling_steps=300", "--jobs", "1", "--quiet"]


def test_sweep(bayeshunt, tmp_path):
    (tmp_path / "grid.toml").write_text('gaits = [3, 10]\n[prey]\nbehaviour = ["straight"]\n')
    out, _ = bayeshunt("sweep", "--grid", "grid.toml", "--planner", "prediction", "--planner", "kinematic_limit",
                       "--arena", "open", "--runs", "1", "--out", "s", "--json", *SMALL)  # fmt: skip
    facts = json.loads(out)
    assert facts["axes"] == ["gaits", "prey.behaviour"]
    assert len(facts["rows"]) == 4
    assert {"gaits", "prey.behaviour", "planner", "success", "ci_low", "mean_time_s"} <= set(facts["rows"][0])
    assert sorted(p.name for p in (tmp_path / "s").iterdir() if p.is_file()) == [
        "sweep.csv", "sweep.json", "sweep.png", "sweep.svg"
    ]  # fmt: skip
    out, _ = bayeshunt("sweep", "--axis", "speed_ratio=0.5", "--planner", "prediction", "--arena", "open",
                       "--runs", "1", *SMALL)  # fmt: skip
    assert "speed_ratio" in out
    assert "95 % Wilson" in out


def test_tradeoff(bayeshunt, tmp_path):
    out, _ = bayeshunt("tradeoff", "--vary", "transitions=0,5", "--runs", "1", "--out", "t", "--json", *SMALL)
    facts = json.loads(out)
    assert [row["planner"] for row in facts["rows"]] == ["prediction", "planning", "frugal", "frugal"]
    assert facts["rows"][0]["value"] is None
    assert (tmp_path / "t" / "tradeoff.png").stat().st_size > 1000
    out, _ = bayeshunt("tradeoff", "--vary", "transitions=1", "--runs", "1", *SMALL)
    assert "transitions 1" in out
    assert re.search(r"frugal .*\b[01]/1 +\d+\.\d-\d+\.\d", out)
    assert "95 %: Wilson" in out


def test_reference_and_memory_to_evaluation(bayeshunt):
    small = SMALL[:4]
    out, _ = bayeshunt("reference", "--out", "ref.npz", "--samples", "2", "--angles", "8", *small, "--json")
    assert json.loads(out)["states"] > 0
    out, _ = bayeshunt("remember", "--out", "mem.json", "--runs", "1", "--arena", "open", *small, "--json")
    assert json.loads(out)["transitions"] > 0
    out, _ = bayeshunt(
        "evaluate", "--planner", "reference", "--planner", "memory_place", "--planner", "prediction", "--arena", "open",
        "--runs", "1", "--set", "planner.reference.table=ref.npz", "--set", "planner.memory_place.tables=mem.json",
        "--out", "r", "--json", *SMALL,
    )  # fmt: skip
    facts = json.loads(out)
    assert facts["not_ab_initio"] == ["memory_place", "reference"]
    out, _ = bayeshunt("evaluate", "--planner", "kinematic_limit", "--runs", "1", *SMALL)
    assert "kinematic_limit *" in out
    assert "Not ab initio" in " ".join(out.split())


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["sweep", "--out", "s"], "stopped; the hunts that ended are kept in s; give the same line again to go on"),
        (["sweep"], "stopped; nothing is kept without --out"),
        (["evaluate"], "stopped; nothing is kept without --out"),
        (["tradeoff"], "stopped"),
        (["hunt"], "stopped"),
        (["figures", "--out", "f"], "stopped"),
    ],
)
def test_ctrl_c_says_so(bayeshunt, monkeypatch, arguments, says):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("bayeshunt.experiments.protocol.learn_model", interrupted)
    for module in ("run.runner", "studies.sweep", "studies.tradeoff"):
        monkeypatch.setattr(f"bayeshunt.experiments.{module}.evaluate", interrupted)
    monkeypatch.setattr("bayeshunt.experiments.studies.tradeoff.learn_model", interrupted)
    out, err = bayeshunt(*arguments, status=130)
    assert (out, err.strip()) == ("", f"bayeshunt: {says}")


def test_a_babbling_that_was_stopped_says_what_is_kept_and_goes_on(bayeshunt, folder, monkeypatch):
    line = ["babble", "--steps", "130", "--jobs", "1", "--out", "b.parquet"]
    stop_after, ended = 1, []

    def progress(rows):
        ended.append(rows)
        if len(ended) == stop_after:
            raise KeyboardInterrupt

    def in_small_shards(*arguments, **options):
        return babble_to_file(*arguments, **{**options, "shard_rows": 50, "progress": progress})

    monkeypatch.setattr("bayeshunt.experiments.studies.babbling.babble_to_file", in_small_shards)
    _, err = bayeshunt(*line, status=130)
    assert err == (
        "bayeshunt: stopped; 50 of 130 rows are kept in b.parquet.shards; give the same line again to go on\n"
    )
    stop_after = 0
    made = (folder / "b.parquet.shards" / "000000.parquet").stat().st_mtime_ns
    seen = []
    monkeypatch.setattr(
        "bayeshunt.experiments.studies.babbling._join",
        lambda shards, *_: seen.extend(shard.path.stat().st_mtime_ns for shard in shards),
    )
    assert "130 rows" in bayeshunt(*line)[0]
    assert len(seen) == 3
    assert seen[0] == made  # the first shard is the one from before


def test_a_small_babbling_that_was_stopped_keeps_nothing(bayeshunt, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("bayeshunt.experiments.studies.babbling.babble", interrupted)
    _, err = bayeshunt("babble", "--out", "b.parquet", status=130)
    assert err.startswith("bayeshunt: stopped; nothing is kept yet")


def test_one_hunt_with_changed_settings(bayeshunt):
    small = ["--preset", "paper", *SMALL[2:4]]
    out, _ = bayeshunt("hunt", "--theta", "3", "--set", "protocol.time_limit=3.328", *small, "--json")
    assert json.loads(out)["decisions"] == 1
    out, _ = bayeshunt("hunt", "--theta", "3", *small, "--json")
    assert json.loads(out)["decisions"] > 1


def test_the_table_of_a_hunt_explains_its_columns(bayeshunt):
    out, _ = bayeshunt("hunt", "--planner", "prediction", *SMALL[2:4])
    assert "aims at: distance of the place it makes for" in " ".join(out.split())


def test_sweep_says_what_it_varies_by_default(bayeshunt):
    assert "default: speed_ratio" in " ".join(bayeshunt("sweep", "--help")[0].split())


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["sweep", "--axis", "speed"], "--axis speed: expected one of speed_ratio"),
        (["sweep", "--axis", "noise=loud"], "noise: expected a number"),
        (["sweep", "--grid", "none.toml"], "none.toml: cannot be read"),
        (["sweep", "--planner", "nobody"], "unknown planner 'nobody'"),
        (["sweep", "--axis", "prey.sped=1"], "did you mean 'speed'"),
        (["tradeoff", "--vary", "speed"], "--vary speed: expected one of distance"),
        (["tradeoff", "--vary", "transitions=-1"], "transitions must be a number of at least 0"),
        (["tradeoff", "--vary", "transitions=few"], "'few' is not a number"),
        (["reference", "--out", "no/where.npz"], "the folder no does not exist"),
        (["reference", "--out", "r.npz", "--samples", "0"], "samples: expected a whole number"),
        (["remember", "--out", "m.json", "--runs", "0"], "runs: expected a whole number"),
        (["evaluate", "--set", "prey.speed"], "expected KEY=VALUE"),
        (["evaluate", "--set", "prey.speed=fast"], "prey.speed"),
        (["evaluate", "--planner", "memory"], "memory: needs the setting tables"),
        (["evaluate", "--planner", "reference"], "reference: needs the setting table"),
        (["hunt", "--set", "prey.sped=1"], "did you mean 'speed'"),
        (["figures", "--out", "f", "--results", "r", "--set", "prey.speed=1"], "--results brings its own settings"),
        (["hunt", "--planner", "kinematic_limit"], "can be evaluated, not hunted with"),
    ],
)
def test_one_line_and_status_2(bayeshunt, arguments, says):
    quick = ["--set", "model.babbling_steps=200"] if arguments[0] != "hunt" else []
    out, err = bayeshunt(*arguments, *quick, status=2)
    assert out == ""
    assert err.startswith("bayeshunt: ")
    assert err.count("\n") == 1
    assert says in err


def test_next_lines_can_be_pasted_whatever_the_name(bayeshunt):
    out, _ = bayeshunt("babble", "--out", "my table.parquet", "--steps", "20", "--quiet")
    assert "next: bayeshunt fit 'my table.parquet' --out model.json" in out
    out, _ = bayeshunt("remember", "--out", "my memory.json", "--runs", "1", "--arena", "open", *SMALL[:4])
    assert "--set 'planner.memory_place.tables=my memory.json'" in out
    out, _ = bayeshunt("explore", "--out", "my room.json", "--steps", "300", *SMALL[:4])
    assert "--set 'planner.intercept_walls.room=my room.json'" in out


def test_stopped_before_the_first_hunt_it_says_that_nothing_is_there(bayeshunt, tmp_path, monkeypatch):
    def stopped(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("bayeshunt.experiments.run.runner.evaluate", stopped)
    _, err = bayeshunt("evaluate", "--runs", "1", "--out", "far", "--quiet", status=130)
    assert "bayeshunt: stopped; nothing is in far yet; give the same line again to start anew" in " ".join(err.split())
