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


def test_a_prey_that_learned_gets_away_from_a_hunter_that_does_not_know_it(fleeing, khepera_model):
    prey = next(one for one in fleeing.PREYS if one.name == "planning_open")
    policy, settings = fleeing.weights(prey), prey.settings
    knowing = fleeing.Knowing(khepera_model, policy, settings, prey.arena)
    ends = {}
    for planner in (bh.make_planner("intercept", khepera_model), knowing):
        env = fleeing.PreyEnv(planner, prey.arena, preset="paper")
        knowing.hunt = env.hunt
        ends[planner.name] = [fleeing.hunt(env, policy, theta, 1000) for theta in settings.protocol.thetas[:4]]
    assert sum(caught for _, caught in ends["intercept"]) <= 1
    assert sum(caught for _, caught in ends[knowing.name]) >= 3
    assert "torch" not in sys.modules


def test_hunts_are_kept(fleeing, tmp_path, monkeypatch):
    prey = next(one for one in fleeing.PREYS if one.name == "paper_open")
    asked = []
    monkeypatch.setattr(fleeing, "_hunted", lambda *given: asked.append(given[-1]) or [[(1.0, True)]] * len(given[-1]))
    assert fleeing.cell(prey, "planning", 0, 2, tmp_path) == [(1.0, True)] * 2
    assert len(fleeing.cell(prey, "planning", 0, 3, tmp_path)) == 3
    assert asked == [range(2), range(2, 3)]
    assert fleeing.cell(prey, fleeing.KNOWING, 0, 3, tmp_path) is None  # who has learned nothing has no policy
