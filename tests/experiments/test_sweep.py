"""Sweeps and trade-offs: the point is the settings, the rows are the evaluation's."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest

from bayeshunt.config.loading import load_experiment
from bayeshunt.core.errors import InputError
from bayeshunt.episodes.loop import run_hunt
from bayeshunt.experiments.protocol import hunt_seed
from bayeshunt.experiments.run.runner import evaluate
from bayeshunt.experiments.scores import mean_interval, summarise
from bayeshunt.experiments.studies.memories import remember, training_seed
from bayeshunt.experiments.studies.references import reference
from bayeshunt.experiments.studies.sweep import AXES, COLUMNS, at_point, combinations, sweep
from bayeshunt.experiments.studies.tradeoff import tradeoff
from bayeshunt.planners.bounds.kinematic_limit import KinematicLimit
from bayeshunt.planners.registry import is_ab_initio

SMALL = {"model.babbling_steps": 300, "protocol.thetas": [2.0, 3.0]}


@pytest.fixture(scope="module")
def settings():
    return load_experiment("paper", SMALL)


@pytest.mark.parametrize(
    ("axis", "value", "key", "expected"),
    [
        ("speed_ratio", 0.5, lambda s: s.prey.speed, 0.0288),
        ("gait_duration", 1.664, lambda s: s.robot.gait_duration, 1.664),
        ("noise", 0.5, lambda s: (s.robot.noise.slip, s.prey.noise.drift_sd), (0.05, 0.0125)),
        ("slip", 0.05, lambda s: (s.robot.noise.slip, s.prey.noise.slip, s.prey.noise.drift_sd), (0.05, 0.05, 0.025)),
        ("speed_ratio", "+25%", lambda s: s.prey.speed, 0.06),
        ("gait_duration", "-50%", lambda s: s.robot.gait_duration, 1.664),
        ("noise", "-50%", lambda s: (s.robot.noise.slip, s.prey.noise.drift_sd), (0.05, 0.0125)),
        ("babbling_steps", "+1.5%", lambda s: s.model.babbling_steps, 304),
        ("arenas.walled.width", "+5%", lambda s: (s.arenas["walled"].width, s.arenas["walled"].height), (1.26, 1.2)),
        ("protocol.catch_distance", "+0%", lambda s: s.protocol.catch_distance, 1.02),
        ("babbling_steps", 50, lambda s: s.model.babbling_steps, 50),
        ("gaits", 3, lambda s: s.robot.gaits.names, ("straight", "wide right", "wide left")),
        ("max_transitions", 2, lambda s: s.planner["planning"]["max_transitions"], 2),
        ("prey.sensor_range", 0.1, lambda s: s.prey.sensor_range, 0.1),
        ("robot", "car", lambda s: s.robot.name, "car"),
        ("planner.planning.depth", 4, lambda s: s.planner["planning"], None),
    ],
)
def test_an_axis_changes_what_it_names(settings, axis, value, key, expected):
    point = at_point(settings, {axis: value})
    if expected is None:  # one key of a group: the others stay
        assert key(point) == {**settings.planner["planning"], "depth": value}
    else:
        assert key(point) == pytest.approx(expected) if not isinstance(expected, tuple) else key(point) == expected


@pytest.mark.parametrize("axis", ["prey.behaviour", "prey.senses_hunter", "gaits", "protocol.thetas", "prey.sped"])
def test_a_change_of_what_is_no_number(settings, axis):
    with pytest.raises(InputError, match="changes a number, and there is none"):
        at_point(settings, {axis: "+5%"})


def test_every_named_axis_has_values_that_work(settings):
    for axis, (meaning, values) in AXES.items():
        assert meaning
        for value in values:
            at_point(settings, {axis: value})


@pytest.mark.parametrize(
    ("grid", "message"),
    [
        ({"speed": [1]}, "unknown axis 'speed'"),
        ({"prey.speed": []}, "needs a list of values"),
        ({"prey.speed": "0.1"}, "needs a list of values"),
        ({}, "no axis"),
        ({"prey.speed": [-1.0]}, "prey.speed"),
        ({"prey.sped": [1.0]}, "did you mean 'speed'"),
        ({"gaits": [11]}, "from 1 to 10"),
        ({"noise": [-1]}, "at least 0"),
    ],
)
def test_wrong_grids_are_refused_before_any_work(settings, grid, message):
    with pytest.raises(InputError, match=message):
        sweep(settings, grid, runs=1)


@pytest.mark.parametrize(
    ("grid", "planner", "message"),
    [
        ({"max_transitions": [0, 1, -1]}, "planning", "max_transitions must be"),
        ({"prey.speed": [0.03, 0.04]}, "kinematic_limt", "unknown planner"),
    ],
)
def test_planners_are_checked_at_every_point_before_any_hunt(settings, tmp_path, grid, planner, message):
    with pytest.raises(InputError, match=message):
        sweep(settings, grid, runs=1, planners=[planner], arenas=["open"], out=tmp_path)
    assert not list(tmp_path.iterdir())


def test_combinations_keep_the_order():
    assert combinations({"a.b": [1, 2], "c.d": ["x"]}) == [{"a.b": 1, "c.d": "x"}, {"a.b": 2, "c.d": "x"}]


def test_the_rows_are_those_of_an_evaluation(settings):
    frame = sweep(settings, {"prey.speed": [0.03, 0.048]}, runs=2, planners=["reactive", "prediction"], arenas=["open"])
    assert list(frame.columns) == ["prey.speed", *COLUMNS]
    assert len(frame) == 4
    point = load_experiment(settings, {"prey.speed": 0.03, "protocol.runs": 2})
    alone = evaluate(point, planners=["reactive", "prediction"], arenas=["open"])
    totals = [row for row in summarise(alone, point) if row["theta"] is None]
    for row, total in zip(frame.to_dict("records")[:2], totals, strict=True):
        shared = [name for name in COLUMNS if not name.startswith("mean_time_s_")]
        assert {name: row[name] for name in shared} == {name: total[name] for name in shared}
        hunts = alone[alone["planner"] == row["planner"]]["time"]
        assert (row["mean_time_s_low"], row["mean_time_s_high"]) == mean_interval(hunts)


def test_a_sweep_goes_on_where_it_stopped(settings, tmp_path):
    grid, ended = {"speed_ratio": [0.5, 0.8]}, []
    again = {"runs": 2, "planners": ["prediction"], "arenas": ["open"], "out": tmp_path}
    first = sweep(settings, grid, **again)
    second = sweep(settings, grid, **again, progress=ended.append)
    pd.testing.assert_frame_equal(first, second)
    assert sum(ended) == 8


def test_the_kinematic_limit_is_a_row_like_any_other(settings, khepera_model):
    """Every run of a bearing has the same time; faster prey, longer limits; beyond reach, a miss at the limit."""
    away = load_experiment(settings, {"protocol.thetas": [0.0, 6.0]})
    frame = sweep(away, {"speed_ratio": [0.5, 0.9, 1.5]}, runs=2, planners=["kinematic_limit"], arenas=["open"])
    assert frame["mean_time_s"].is_monotonic_increasing
    assert frame["success"].tolist() == [1.0, 1.0, 0.0]
    ahead = load_experiment(settings, {"prey.speed": 0.2, "protocol.thetas": [0.0]})
    result = run_hunt(ahead, KinematicLimit(khepera_model), "open", 0.0, 5)
    assert (result.caught, result.time) == (False, 60.0)


@pytest.mark.parametrize(("theta", "seconds"), [(0.0, 23.6), (2.0, 3.6), (5.0, 9.3)])
def test_the_kinematic_limit_of_the_preset(theta, seconds, khepera_model):
    result = run_hunt(load_experiment("paper"), KinematicLimit(khepera_model), "open", theta, 1)
    assert result.time == pytest.approx(seconds, abs=0.15)  # the prey of the arena starts from rest


# --- costs -----------------------------------------------------------------------------------------


def test_a_tradeoff_adds_up(settings):
    changed = load_experiment(settings, {"planner.frugal": {"time": 1.0, "transitions": 2.0, "distance": 3.0}})
    frame = tradeoff(changed, {"transitions": [0.0, 50.0]}, runs=2, planners=["prediction"])
    assert frame["planner"].tolist() == ["prediction", "frugal", "frugal"]
    for row in frame.to_dict("records"):
        cost = row["mean_time_s"] + 3.0 * row["mean_distance_m"] + 2.0 * row["mean_transitions"]
        assert row["cost"] == pytest.approx(cost)
        assert row["planning_ms"] > 0
    free, dear = frame["mean_transitions"].tolist()[1:]
    assert dear <= free
    with pytest.raises(InputError, match="unknown weight 'speed'"):
        tradeoff(settings, {"speed": [1.0]}, runs=1)


# --- tables made beforehand --------------------------------------------------------------------------


def test_training_seeds_are_never_those_of_an_evaluation():
    training = {training_seed(s, t, r) for s in range(4) for t in range(7) for r in range(40)}
    testing = {hunt_seed(s, t, r) for s in range(4) for t in range(7) for r in range(40)}
    assert len(training) == len(testing) == 4 * 7 * 40
    assert not training & testing


def test_a_memory_is_what_the_prey_did(settings, khepera_model):
    memory = remember(settings, arenas=["walled"], runs=1, seed=4, model=khepera_model)
    again = remember(settings, arenas=["walled"], runs=1, seed=4, model=khepera_model)
    assert memory._record() == again._record()
    assert memory.provenance["arenas"] == ["walled"]
    table = memory.tables["walled"]["all"].cpt()
    assert table["count"].sum() == memory.observations > 10
    # in one step of 3.328 s at 48 mm/s it goes at most 16 cm, and noise
    assert table["distance"].max() < 0.18
    turns = memory.tables["walled"]["previous"]
    firsts = len(settings.protocol.thetas)  # one hunt per bearing: its first transition has no previous one
    assert sum(turns.total(context) for context in turns.counts) == memory.observations - firsts


@pytest.mark.parametrize(("arenas", "message"), [(["open", "open"], "given twice"), (["moon"], "unknown arena 'moon'")])
def test_no_arena_is_remembered_twice(settings, khepera_model, arenas, message):
    with pytest.raises(InputError, match=message):
        remember(settings, arenas=arenas, runs=1, model=khepera_model)


def test_memory_rows_are_marked():
    marked = ["memory", "memory_place", "memory_previous", "omniscient", "reference", "kinematic_limit"]
    assert not any(map(is_ab_initio, marked))
    assert all(map(is_ab_initio, ("reactive", "planning", "frugal", "constant_velocity")))


def test_a_reference_is_kept_and_found_again(settings, tmp_path):
    calls = []
    small = {"seed": 1, "samples": 2, "angles": 8, "headings": 8, "cache": tmp_path}
    first = reference(settings, **small, progress=calls.append)
    spent = len(calls)
    second = reference(settings, **small, progress=calls.append)
    assert spent == len(calls) > 10
    assert np.array_equal(first.values, second.values)
    assert len(list(tmp_path.iterdir())) == 1
    reference(load_experiment(settings, {"prey.speed": 0.03}), **small)
    assert len(list(tmp_path.iterdir())) == 2
    assert first.facts["digest"] == second.facts["digest"]
    with pytest.raises(InputError, match="samples"):
        reference(settings, samples=0)
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="file: cannot be used as an output folder"):
        reference(settings, **{**small, "cache": tmp_path / "file"})
    assert math.isfinite(float(first.values.max()))


@pytest.mark.slow
def test_bounds_bound_and_baselines_are_beaten(tmp_path, capsys):
    """Seed 0, 10 runs per bearing: the limit, the omniscient hunter, the reference and the best baseline, in order."""
    table = tmp_path / "reference.npz"
    reference("paper", seed=0).save(table)
    point = load_experiment("paper", {"planner.reference.table": str(table), "protocol.runs": 10})
    planners = ["kinematic_limit", "omniscient", "reference", "constant_velocity", "planning"]
    rows = {
        (r["planner"], r["arena"]): r
        for r in summarise(evaluate(point, planners=planners), point)
        if r["theta"] is None
    }
    with capsys.disabled():
        for (name, arena), row in rows.items():
            print(f"{name} {arena}: {row['caught']}/{row['runs']}, {row['mean_time_s']:.2f} s")
    for arena in ("walled", "open"):
        times = [rows[name, arena]["mean_time_s"] for name in ("kinematic_limit", "omniscient", "constant_velocity")]
        assert times == sorted(times)
        assert rows["omniscient", arena]["success"] >= 0.97
        assert rows["omniscient", arena]["mean_time_s"] < rows["planning", arena]["mean_time_s"] - 5
    assert rows["reference", "open"]["success"] >= 0.95
    assert rows["reference", "open"]["mean_time_s"] == pytest.approx(18.9, abs=1.5)
    assert rows["kinematic_limit", "open"]["mean_time_s"] == pytest.approx(11.1, abs=0.2)
