"""The race's compiled hunt is the environment's, and its tables say what its rows say."""

import importlib
from pathlib import Path

import gymnasium
import numpy as np
import pytest

ROOT = Path(__file__).parents[1]
QUIET = {
    "robot.noise.slip": 0.0, "robot.noise.drift_sd": 0.0, "prey.noise.slip": 0.0, "prey.noise.drift_sd": 0.0,
    "prey.sensor_noise": 0.0,
}  # fmt: skip


@pytest.fixture
def race(monkeypatch):
    """A module of it by name."""
    monkeypatch.syspath_prepend(str(ROOT))  # benchmarks are no part of the installed package
    return lambda name: importlib.import_module(f"benchmarks.race.{name}")


def test_every_job_is_named_once_and_its_experiment_can_be_loaded(race):
    jobs = race("jobs")
    names = [job.name for job in jobs.JOBS]
    assert len(set(names)) == len(names)
    for world in (*jobs.WORLDS, *jobs.ELSEWHERE):
        settings = jobs._settings(jobs.Job("intercept", "walled", 20, world=world))
        assert settings.model.babbling_steps == 20


def test_a_job_is_run_once_and_read_back(race, tmp_path, monkeypatch):
    jobs = race("jobs")
    job = jobs.Job("planning", "walled", 50, runs=1)
    row, times = jobs.run(job, tmp_path)
    assert (row.hunts, row.gaits, len(times)) == (7, 50, 7)
    assert row.caught == sum(time < 60 for time in times)
    monkeypatch.setattr(jobs, "run_hunt", None)
    assert jobs.run(job, tmp_path) == (row, times)


def test_a_network_is_kept_as_plain_arrays(race, tmp_path):
    network = race("learners").Network(((np.array([[1.0, -1.0], [0.0, 2.0]]), np.array([0.0, 0.5])),), tanh=False)
    network.save(tmp_path / "n.npz")
    again = race("learners").Network.load(tmp_path / "n.npz")
    assert [again.predict(np.array(seen)) for seen in ([3.0, 1.0], [3.0, 2.0])] == [1, 1]
    assert [again.predict(np.array(seen)) for seen in ([3.0, 0.0], [0.0, 0.0])] == [0, 1]


def test_rows_become_tables(race):
    row = race("jobs").Row("PPO", "shaped", True, "open", "paper", 0, 1024, 0.95, 700, 691, 0.97, 0.99, 20.0, 0.5, 1.0)
    ours = race("jobs").Row("intercept", "", False, "open", "paper", 0, 20, 0.018, 700, 700, 0.99, 1.0, 19.0, 0.5, 0.1)
    text = race("report").markdown([(row, [20.0] * 700), (ours, [19.0] * 699 + [26.0])])
    assert "| PPO, tuned, shaped | 0 | 1,024 | 57 min | 691/700 | 98.7% |" in text
    assert "| PPO, 1,024 gaits | open | `intercept` | +0.99 ± 0.01 |" in text


@pytest.mark.slow
@pytest.mark.parametrize("arena", ["open", "walled"])
def test_the_compiled_hunt_is_the_environment_without_noise(race, arena):
    pytest.importorskip("numba")
    env = gymnasium.make("bayeshunt.envs:Hunt-v0", preset="paper", arena=arena, overrides=QUIET, reward="shaped")
    batch = race("twin").Batch(arena, 1, 0, changes=QUIET)
    rng = np.random.default_rng(0)
    for seed in range(20):
        env.reset(options={"theta": float(seed % 7), "hunt_seed": seed})
        batch.begin(0, seed % 7)
        ended = False
        while not ended:
            gait = int(rng.integers(10))
            seen, reward, *ends, _ = env.step(gait)
            _, rewards, caught, late, told = batch.step(np.array([gait]))
            assert [bool(caught[0]), bool(late[0])] == ends
            assert rewards[0] == pytest.approx(reward, abs=1e-3)
            ended = any(ends)
            if not ended:  # the transition of a gait that was cut short is not told
                np.testing.assert_allclose(told[0], seen, atol=5e-3)  # a share of ten bodies: 3 mm
