"""The hunt: one seed, one episode; what the record says is what happened."""

import json
from dataclasses import replace

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from bayeshunt.config.loading import load_experiment
from bayeshunt.core.errors import DataError, InputError
from bayeshunt.core.geometry import Polar, Pose
from bayeshunt.episodes.episode import Episode
from bayeshunt.episodes.loop import hunt, run_hunt
from bayeshunt.experiments.protocol import learn_model
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.planners.conformance import same_plan
from bayeshunt.planners.registry import make_planner

PAPER = load_experiment("paper")


@pytest.fixture(scope="module")
def planners(khepera_model):
    return {name: make_planner(name, khepera_model) for name in ("reactive", "prediction", "planning")}


@pytest.mark.parametrize("arena", ["walled", "open"])
@pytest.mark.parametrize("name", ["reactive", "prediction", "planning"])
def test_same_seed_same_episode(planners, name, arena):
    one = hunt("paper", planners[name], arena=arena, theta=2.0, seed=5)
    two = hunt("paper", planners[name], arena=arena, theta=2.0, seed=5)
    assert one.frame.equals(two.frame)
    assert one.trail.equals(two.trail)
    assert not one.trail.equals(hunt("paper", planners[name], arena=arena, theta=2.0, seed=6).trail)


def test_the_record_is_the_hunt_that_evaluate_runs(planners):
    for seed in range(5):
        episode = hunt("paper", planners["planning"], arena="walled", theta=4.0, seed=seed)
        result = run_hunt(PAPER, planners["planning"], "walled", 4.0, seed)
        assert (episode.caught, episode.time, len(episode.frame)) == (result.caught, result.time, result.decisions)


def test_planners_meet_the_same_prey(planners):
    # in the open the prey senses nobody: its track depends on the seed alone
    tracks = [
        hunt("paper", planners[name], arena="open", theta=0.0, seed=9).trail[["prey_x", "prey_y"]].to_numpy()
        for name in ("reactive", "planning")
    ]
    shared = min(map(len, tracks)) - 1  # the interval of a catch is cut short
    np.testing.assert_array_equal(tracks[0][:shared], tracks[1][:shared])


def test_the_frame_agrees_with_itself(planners):
    episode = hunt("paper", planners["prediction"], arena="open", theta=1.0, seed=0)
    frame = episode.frame
    hunter = Pose(*frame[["hunter_x", "hunter_y", "hunter_theta"]].to_numpy().T)
    prey = Pose(*frame[["prey_x", "prey_y", "prey_theta"]].to_numpy().T)
    seen = hunter.relative(prey)
    for name in Polar._fields:
        np.testing.assert_allclose(frame[f"seen_{name}"], getattr(seen, name), atol=1e-12)
    # what was observed at step k is the prey's move from k - 1 to k
    moved = Pose(*(v[:-1] for v in prey)).relative(Pose(*(v[1:] for v in prey)))
    np.testing.assert_allclose(frame["observed_distance"][1:], moved.distance, atol=1e-12)
    assert np.isnan(frame["observed_distance"][0])
    assert frame["prey_observations"].tolist() == list(range(len(frame)))
    assert frame["prey_known"].tolist() == [False] + [True] * (len(frame) - 1)
    np.testing.assert_allclose(frame["time"], np.arange(len(frame)) * 3.328, atol=1e-9)
    for posterior, gait in zip(frame["posterior"], frame["gait"], strict=True):
        assert PAPER.robot.gaits.names[int(np.argmax(posterior))] == gait


def test_a_miss_lasts_to_the_limit_and_not_longer(planners):
    episode = hunt("paper", planners["reactive"], arena="open", theta=0.0, seed=1)
    assert not episode.caught
    assert episode.time == 60.0
    assert len(episode.frame) == 19  # 18 whole steps of 3.328 s and the rest
    assert episode.trail["time"].iloc[-1] == pytest.approx(60.0)


@pytest.mark.parametrize(("limit", "decisions"), [(50.0, 16), (9.999, 3), (0.01, 1)])
def test_a_limit_between_two_physics_steps_is_not_outlasted(planners, limit, decisions):
    settings = load_experiment("paper", {"protocol.time_limit": limit})
    episode = hunt(settings, planners["reactive"], arena="open", theta=0.0, seed=1)
    assert (episode.caught, episode.time, len(episode.frame)) == (False, limit, decisions)
    end = episode.trail["time"].iloc[-1]
    assert max(limit, 0.032) - 0.032 < end <= max(limit, 0.032)


def test_saved_episodes_come_back(planners, tmp_path):
    episode = hunt("paper", planners["planning"], arena="walled", theta=3.0, seed=2)
    episode.save(tmp_path / "e.parquet")
    again = Episode.load(tmp_path / "e.parquet")
    assert (again.caught, again.time) == (episode.caught, episode.time)
    assert again.frame["gait"].tolist() == episode.frame["gait"].tolist()
    assert again.trail.equals(episode.trail)
    assert again.provenance == episode.provenance
    with pytest.raises(DataError, match="no such file"):
        Episode.load(tmp_path / "nowhere.parquet")


@pytest.mark.parametrize("name", ["planning", "reactive"])
def test_an_episode_changed_on_disk_is_refused(planners, tmp_path, name):
    path = tmp_path / "e.parquet"
    episode = hunt("paper", planners[name], arena="walled", theta=3.0, seed=2)
    episode.save(path)
    table = pq.read_table(path)  # a value changed by a program that keeps the file's own record of it
    changed = table.set_column(table.column_names.index("value"), "value", pa.array([0.5] * table.num_rows))
    pq.write_table(changed.replace_schema_metadata(table.schema.metadata), path)
    with pytest.raises(DataError, match="does not match its checksum"):
        Episode.load(path)
    record = {key: value.replace(b'"seed": 2', b'"seed": 3') for key, value in table.schema.metadata.items()}
    pq.write_table(table.replace_schema_metadata(record), path)
    with pytest.raises(DataError, match=r"e\.parquet: cannot be read as an episode .*; give a file made by"):
        Episode.load(path)


def test_episodes_of_versions_without_checksums_come_back(planners, tmp_path):
    episode = hunt("paper", planners["planning"], arena="walled", theta=3.0, seed=2)
    record = {**episode.provenance, "trail": {c: episode.trail[c].tolist() for c in episode.trail}}
    table = pa.Table.from_pandas(episode.frame, preserve_index=False)
    table = table.replace_schema_metadata({b"bayeshunt": json.dumps(record).encode()})
    pq.write_table(table, tmp_path / "old.parquet")
    again = Episode.load(tmp_path / "old.parquet")
    assert again.provenance == episode.provenance
    assert again.trail.equals(episode.trail)
    assert again.frame["value"].tolist() == episode.frame["value"].tolist()


def test_numbers_of_numpy_are_numbers(planners, tmp_path):
    theta, seed = np.float32(1.0), np.int64(3)
    episode = hunt("paper", planners["reactive"], arena="open", theta=theta, seed=seed)
    assert episode.frame.equals(hunt("paper", planners["reactive"], arena="open", theta=1.0, seed=3).frame)
    episode.save(tmp_path / "e.parquet")
    assert Episode.load(tmp_path / "e.parquet").provenance["seed"] == 3


def test_a_recorded_situation_is_what_was_known_then(planners):
    planner = planners["prediction"]
    episode = hunt("paper", planner, arena="walled", theta=1.0, seed=0)
    assert [s.prey_model.observations for s in episode.situations] == list(range(len(episode.frame)))
    for situation, plan in zip(episode.situations, episode.plans, strict=True):
        assert same_plan(planner.plan(situation, rng=np.random.default_rng(0)), plan)


def test_the_situations_of_a_hunt_are_those_that_the_constructor_checks(planners):
    for situation in hunt("paper", planners["prediction"], theta=1.0, seed=0).situations:
        assert replace(situation) == situation
        assert len(situation.approaches) == len(situation.transitions)
        assert situation.approaches[1:] == tuple(situation.approaches)[1:]


def test_prior_knowledge_of_the_prey_is_copied(planners):
    known = PreyModel()
    known.observe(Polar(0.16, 0.0, 0.0))
    episode = hunt("paper", planners["prediction"], arena="open", theta=1.0, seed=0, prey_model=known)
    assert known.observations == 1
    assert bool(episode.frame["prey_known"].iloc[0])


def test_the_prey_starts_clockwise_at_theta():
    hunter, prey = PAPER.starting_poses(1.0)
    seen = hunter.relative(prey)
    assert seen.distance == pytest.approx(5 * 0.057)
    assert seen.angle == pytest.approx(1.0)
    assert seen.heading == 0.0
    assert prey.y < 0  # clockwise of x


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"arena": "pond"}, "unknown arena 'pond'; expected one of walled, open"),
        ({"seed": -1}, "seed: expected a whole number"),
        ({"seed": 1.5}, "seed: expected a whole number"),
        ({"theta": float("nan")}, "theta: expected a finite number"),
        ({"theta": None}, "theta: expected a finite number"),
        ({"theta": "1"}, "theta: expected a finite number"),
    ],
)
def test_nonsense_is_refused(planners, change, message):
    with pytest.raises(InputError, match=message):
        hunt("paper", planners["reactive"], **change)


@pytest.mark.parametrize("prey", ["straight", "random_walk", "evader"])
@pytest.mark.parametrize("robot", ["khepera", "car"])
def test_any_robot_hunts_any_prey(robot, prey):
    settings = load_experiment("paper", {"robot": robot_settings(robot), "prey.behaviour": prey, "prey.speed": 0.02})
    settings = settings.model_copy(update={"model": settings.model.model_copy(update={"babbling_steps": 200})})
    model = learn_model(settings, 0)
    caught = [run_hunt(settings, make_planner("planning", model), "walled", 3.0, seed).caught for seed in range(6)]
    assert sum(caught) >= 4  # a prey of a third of the hunter's speed


def robot_settings(name):
    from bayeshunt.config.loading import load_robot

    return load_robot(name).model_dump()


def test_a_name_is_no_planner():
    with pytest.raises(InputError, match=r'make_planner\("planning", model\), got \'planning\''):
        hunt("paper", "planning")
