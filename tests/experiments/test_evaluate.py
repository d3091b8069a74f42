"""The evaluation: common random numbers, one result for one seed, the paper's totals."""

import hashlib
import json
import os
import subprocess
import sys

import pytest

from bayeshunt.config.loading import load_experiment
from bayeshunt.core.errors import InputError
from bayeshunt.episodes.loop import run_hunt
from bayeshunt.experiments.protocol import hunt_seed
from bayeshunt.experiments.run.runner import evaluate
from bayeshunt.experiments.scores import summarise
from bayeshunt.experiments.store.export import load_results, summary
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.registry import make_planner

PAPER = load_experiment("paper")


def test_one_row_per_hunt_under_common_random_numbers(khepera_model):
    frame = evaluate("paper", runs=2, seed=4, model=khepera_model)
    assert len(frame) == 3 * 2 * 7 * 2
    assert not frame.duplicated(["planner", "arena", "theta", "run"]).any()
    assert (frame.groupby(["theta", "run"])["seed"].nunique() == 1).all()
    assert frame["seed"].nunique() == 14
    assert (frame.loc[~frame["caught"], "time"] == 60.0).all()
    assert (frame.loc[frame["caught"], "time"] < 60.0).all()


def test_any_row_can_be_run_again(khepera_model):
    frame = evaluate("paper", runs=1, seed=4, model=khepera_model, planners=["planning"], arenas=["open"])
    planner = make_planner("planning", khepera_model, **PAPER.planner["planning"])
    for row in frame.itertuples():
        result = run_hunt(PAPER, planner, row.arena, row.theta, row.seed)
        assert (result.caught, result.time) == (row.caught, row.time)


def test_more_runs_keep_the_runs_there_were(khepera_model):
    few = evaluate("paper", runs=1, seed=0, model=khepera_model, planners=["reactive"], arenas=["walled"])
    more = evaluate("paper", runs=2, seed=0, model=khepera_model, planners=["reactive"], arenas=["walled"])
    assert few.equals(more[more["run"] == 0].reset_index(drop=True))


def test_one_name_will_do(khepera_model):
    frame = evaluate("paper", runs=1, model=khepera_model, planners="reactive", arenas="open")
    assert set(frame["planner"]) == {"reactive"}
    assert len(frame) == 7


def test_hunt_seeds_differ():
    seeds = {hunt_seed(s, t, r) for s in range(3) for t in range(7) for r in range(50)}
    assert len(seeds) == 3 * 7 * 50
    assert max(seeds) < 2**63


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"planners": ["clever"]}, "unknown planner 'clever'"),
        ({"planners": ["reactive", "reactive"]}, "given twice"),
        ({"arenas": ["pond"]}, "unknown arena 'pond'"),
        ({"runs": 0}, r"protocol\.runs"),
        ({"jobs": 0}, "jobs: expected"),
        ({"seed": -3}, "seed: expected"),
        ({"experiment": load_experiment("paper", {"planner.planning.dept": 3})}, "did you mean 'depth'"),
    ],
)
def test_nonsense_is_refused_before_any_work(khepera_model, change, message):
    with pytest.raises(InputError, match=message):
        evaluate(**{"experiment": "paper", "runs": 1, "model": khepera_model, **change})


def test_a_model_of_another_robot_is_refused(khepera_model):
    from bayeshunt.config.loading import load_robot

    car = load_experiment("paper", {"robot": load_robot("car").model_dump()})
    with pytest.raises(InputError, match="not those of robot 'car'"):
        evaluate(car, runs=1, model=khepera_model)


def run_cli(folder, *arguments, hash_seed="0"):
    environment = {**os.environ, "PYTHONHASHSEED": hash_seed}
    command = [sys.executable, "-m", "bayeshunt", "evaluate", "--runs", "1", "--seed", "1", "--json"]
    run = subprocess.run(
        [*command, "--out", str(folder), *arguments], env=environment, capture_output=True, check=True, text=True
    )
    files = sorted(p for p in folder.iterdir() if p.suffix in (".parquet", ".json", ".md"))
    assert [p.name for p in files] == ["hunts.parquet", "summary.json", "summary.md"]
    return run, [hashlib.sha256(p.read_bytes()).hexdigest() for p in files]


def test_same_bytes_at_any_number_of_workers_and_any_hash_seed(tmp_path):
    one, hashes = run_cli(tmp_path / "one", "--jobs", "1")
    other, others = run_cli(tmp_path / "other", "--jobs", "2", hash_seed="123")
    assert others == hashes
    assert json.loads(other.stdout) == json.loads(one.stdout)
    assert one.stderr == ""
    keys = {
        "planner", "arena", "theta", "runs", "caught", "success", "ci_low", "ci_high", "mean_time_s", "paper_success",
    }  # fmt: skip
    assert set(json.loads(one.stdout)["rows"][0]) == keys


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_papers_totals(seed):
    rows = summarise(evaluate("paper", seed=seed, jobs=-1), PAPER)
    total = {(row["planner"], row["arena"]): row["success"] for row in rows if row["theta"] is None}
    for arena in ("walled", "open"):
        assert total["reactive", arena] < total["prediction", arena] < total["planning", arena]
    if seed == 0:
        for planner, published in PAPER.published.items():
            for arena, success in published.items():
                assert total[planner, arena] == pytest.approx(success, abs=0.05)
        assert total["planning", "walled"] >= 0.96


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"planner": ["reactive"]}, "evaluate: unknown argument planner; did you mean planners\\?"),
        ({"zzz": 1}, "evaluate: unknown argument zzz$"),
        ({"planners": 3}, "planners: expected a name or a list of names, got 3"),
        ({"arenas": 3}, "arenas: expected a name or a list of names, got 3"),
    ],
)
def test_arguments_of_another_name_or_kind_are_refused(given, said):
    with pytest.raises(InputError, match=said):
        evaluate("paper", runs=1, **given)


def test_the_table_says_that_a_model_of_another_structure_hunted(tmp_path, khepera_frame):
    model = ForwardModel.fit(khepera_frame, PAPER.robot.gaits, structure="previous_gait")
    given = {"runs": 1, "planners": "reactive", "arenas": "open", "model": model, "out": tmp_path}
    for _ in range(2):  # and when it is read again
        results = evaluate("paper", **given)
        facts = summary(results, PAPER, 0)
        assert facts["structure"] == results.attrs["structure"] == "previous_gait"
        assert "structure previous_gait" in facts["note"]
    assert "structure previous_gait" in (tmp_path / "summary.md").read_text()
    assert load_results(tmp_path).attrs["structure"] == "previous_gait"
