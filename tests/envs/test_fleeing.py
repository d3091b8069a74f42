"""Prey that learned to flee: their weights hunt without a learner, and a hunter that knows them catches them."""

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.core.errors import InputError
from bayeshunt.envs import hunt_v0

ROOT = Path(__file__).parents[2]


@pytest.fixture
def fleeing(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT))  # benchmarks are no part of the installed package
    return importlib.import_module("benchmarks.fleeing.cells")


def test_a_network_by_hand(fleeing, tmp_path):
    layers = [
        (np.array([[1.0, -1.0], [0.5, 0.0]], dtype=np.float32), np.array([0.0, 1.0], dtype=np.float32)),
        (np.array([[2.0, 0.0], [0.0, 1.0]], dtype=np.float32), np.array([0.0, 0.5], dtype=np.float32)),
    ]
    policy = fleeing.PreyPolicy(layers)
    assert policy.values(np.array([3.0, 1.0])).tolist() == [4.0, 3.0]
    assert policy.values(np.array([[3.0, 1.0], [1.0, 3.0]])).tolist() == [[4.0, 3.0], [0.0, 2.0]]
    assert [policy.act(np.array(seen)) for seen in ([3.0, 1.0], [1.0, 3.0])] == [0, 1]
    policy.save(tmp_path / "prey.npz")
    again = fleeing.PreyPolicy.load(tmp_path / "prey.npz")
    assert again.values(np.array([3.0, 1.0])).tolist() == [4.0, 3.0]
    (tmp_path / "no.npz").write_bytes(b"nothing")
    with pytest.raises(InputError, match="expected the weights of a prey"):
        fleeing.PreyPolicy.load(tmp_path / "no.npz")


def test_the_preys_side_of_a_hunt(fleeing, khepera_model):
    env = fleeing.PreyEnv(bh.make_planner("planning", khepera_model), "open", 7, preset="paper")
    assert env.hunt.pursuit is None
    for seed in (7, 8):
        seen, info = env.reset()
        assert info["hunt_seed"] == seed
        assert env.observation_space.contains(seen)
    seen, reward, ended, late, info = env.step(2)
    assert reward == pytest.approx(env.hunt.pursuit.time / 60.0)  # the prey earns the time that it lives
    assert (ended, late, info["gaits"]) == (False, False, 1)


def test_a_planner_plays_the_hunter_of_hunt_v0(khepera_model):
    """Against a prey that is steered straight ahead it takes the gaits that it takes in a hunt of a straight prey."""
    planner = bh.make_planner("intercept", khepera_model)
    env = hunt_v0.parallel_env(preset="paper", arena="open")
    choose = bh.planner_policy(planner, env)
    env.reset(options={"theta": 1.0, "hunt_seed": 3})
    gaits = []
    while env.agents:
        gaits.append(env.pursuit.gaits.names[choose()])
        env.step({"hunter_0": gaits[-1], "prey_0": 2})
    settings = bh.load_experiment("paper", {"prey.behaviour": "straight"})
    episode = bh.hunt(settings, planner, arena="open", theta=1.0, seed=3)
    assert gaits == episode.frame["gait"].tolist()
    assert env.pursuit.time == episode.time


def test_a_prey_that_learned_gets_away_from_a_hunter_that_does_not_know_it(fleeing, khepera_model, monkeypatch):
    for learner in ("torch", "stable_baselines3"):
        monkeypatch.setitem(sys.modules, learner, None)  # importing it is an error, where it is installed too
    prey = next(one for one in fleeing.PREYS if one.name == "intercept_walled_0")
    policy, settings = fleeing.weights(prey), prey.settings
    knowing = fleeing.Knowing(khepera_model, policy, settings, prey.arena)
    ends = {}
    for planner in (bh.make_planner("intercept", khepera_model), knowing):
        env = fleeing.PreyEnv(planner, prey.arena, preset="paper")
        knowing.hunt = env.hunt
        ends[planner.name] = [fleeing.hunt(env, policy, theta, 1000) for theta in settings.protocol.thetas[:4]]
    assert sum(caught for _, caught in ends["intercept"]) <= 1
    assert sum(caught for _, caught in ends[knowing.name]) >= 3


def test_rows_are_made_once(fleeing, tmp_path, monkeypatch):
    prey = next(one for one in fleeing.PREYS if one.name == "paper_open")
    asked, table = [], tmp_path / "table.csv"
    ends = [[(1.0, True), (60.0, False)] + [(2.0, True)] * 5]  # of seven bearings
    monkeypatch.setattr(fleeing, "_hunted", lambda *given: asked.append(given[-1]) or ends * len(given[-1]))
    row = fleeing.cell(prey, "planning", 0, 2, table)
    assert (row.prey, row.learned_from, row.hunts, row.caught, row.time_s, row.square_s2) == (
        "paper_open", "", 14, 12, 142.0, 7242.0,
    )  # fmt: skip
    assert fleeing.cell(prey, "planning", 0, 1, table) == fleeing.cell(prey, "planning", 0, 2, table) == row
    assert fleeing.cell(prey, "planning", 0, 3, table).hunts == 21  # more than there were
    other = fleeing.cell(prey, "intercept", 1, 1, table)
    assert asked == [range(2), range(3), range(1)]
    assert fleeing.read(table)[1] == other
    assert [one.hunts for one in fleeing.read(table)] == [21, 7]
    assert fleeing.cell(prey, fleeing.KNOWING, 0, 3, table) is None  # who has learned nothing has no policy


def test_the_table_is_of_prey_that_there_are(fleeing):
    """Every row is of a prey that is listed, and every prey that learned and has a row ships."""
    known = {prey.name: prey for prey in fleeing.PREYS}
    rows = fleeing.read(ROOT / "benchmarks" / "results" / "fleeing.csv")
    assert rows
    for row in rows:
        prey = known[row.prey]
        assert (row.arena, row.learned_from, row.training_seed) == (prey.arena, prey.hunter, prey.seed)
        assert not prey.hunter or prey.file.exists()


@pytest.mark.slow
@pytest.mark.parametrize("arena", ["open", "walled"])
def test_prey_learn_in_the_hunt_that_they_flee_in(monkeypatch, arena):
    """The compiled hunt tells the prey what hunt_v0 tells it, gait by gait, with the noise left out."""
    pytest.importorskip("numba")
    monkeypatch.syspath_prepend(str(ROOT))
    quiet = {f"{who}.noise.{kind}": 0.0 for who in ("robot", "prey") for kind in ("slip", "drift_sd")}
    batch = importlib.import_module("benchmarks.race.twin").Batch(arena, 1, 0, changes=quiet, reward="time", side=1)
    env = hunt_v0.parallel_env(preset="paper", arena=arena, overrides=quiet)
    settings = bh.load_experiment("paper")
    wheels = np.array([gait.command for gait in hunt_v0.prey_gaits(settings.prey)])
    rng = np.random.default_rng(0)
    for seed in range(10):
        env.reset(options={"theta": float(seed % 7), "hunt_seed": seed})
        batch.begin(0, seed % 7)
        while env.agents:
            hunter, prey = int(rng.integers(10)), int(rng.integers(5))
            seen, reward, ended, late, _ = env.step({"hunter_0": hunter, "prey_0": prey})
            _, rewards, caught, up, told = batch.step(np.array([hunter]), wheels[[prey]])
            assert (bool(caught[0]), bool(up[0])) == (ended["prey_0"], late["prey_0"])
            assert rewards[0] == pytest.approx(reward["prey_0"], abs=1e-3)
            if env.agents:
                np.testing.assert_allclose(told[0], seen["prey_0"], atol=5e-3)
