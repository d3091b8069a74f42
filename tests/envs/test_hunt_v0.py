"""hunt_v0 passes PettingZoo's own checks, and its prey goes where its actions say."""

import copy
from functools import partial
from types import SimpleNamespace

import numpy as np
import pettingzoo
import pytest
from pettingzoo.test import api_test, max_cycles_test, parallel_api_test, parallel_seed_test, render_test, seed_test

from bayeshunt.core.errors import InputError
from bayeshunt.envs import hunt_v0
from bayeshunt.worlds.prey.behaviours import behaviours

pytestmark = pytest.mark.filterwarnings("error")


@pytest.mark.parametrize("arena", ["open", "walled"])
def test_pettingzoos_own_checks(arena, capsys):
    def make(**more):
        return hunt_v0.parallel_env(arena=arena, **more)

    parallel_api_test(make(), num_cycles=40)
    parallel_seed_test(make, num_cycles=20)
    api_test(hunt_v0.env(arena=arena), num_cycles=40)
    seed_test(lambda: hunt_v0.env(arena=arena), num_cycles=20)
    assert "Passed" in capsys.readouterr().out


def test_pettingzoos_checks_of_cycles_and_frames():
    far = {"arena": "open", "overrides": {"protocol.prey_distance": 50.0}}  # no catch ends what cycles are to end
    max_cycles_test(SimpleNamespace(env=partial(hunt_v0.env, **far), parallel_env=partial(hunt_v0.parallel_env, **far)))
    render_test(lambda render_mode: hunt_v0.env(render_mode=render_mode, overrides={"robot.gait_duration": 0.064}))


def test_names_and_spaces():
    env = hunt_v0.parallel_env()
    assert env.metadata["name"] == "hunt_v0"
    assert env.metadata["is_parallelizable"]
    seen, infos = env.reset(seed=0, options={"unknown": 1})
    assert env.agents == list(seen) == list(infos) == ["hunter_0", "prey_0"]
    assert env.state_space.contains(env.state())
    for agent in env.agents:
        assert env.observation_space(agent) is env.observation_space(agent)
        assert env.observation_space(agent).contains(seen[agent])


def run(env, action, steps=3, seed=0, theta=0.0):
    env.reset(options={"theta": theta, "hunt_seed": seed})
    for _ in range(steps):
        _, rewards, *_ = env.step({"hunter_0": 0, "prey_0": action})
    return env.state(), rewards


def test_the_prey_goes_where_its_actions_say():
    known = behaviours()
    env = hunt_v0.parallel_env(preset="paper", arena="open", overrides={"prey.noise.slip": 0.0})
    ends = [run(env, action, steps=1)[0] for action in range(5)]
    turned = [np.arctan2(end[7], end[6]) for end in ends]
    assert turned == sorted(turned, reverse=True)  # from hard left to hard right
    assert turned[2] == pytest.approx(0.0, abs=0.1)
    assert behaviours() == known  # nothing was registered on the way


def test_what_one_gains_the_other_loses_and_nobody_stays():
    env = hunt_v0.parallel_env(arena="open", overrides={"protocol.time_limit": 7.0})
    env.reset(seed=1)
    total = 0.0
    while env.agents:
        _, rewards, caught, late, _ = env.step({"hunter_0": 0, "prey_0": 2})
        assert rewards["hunter_0"] == -rewards["prey_0"]
        total += rewards["hunter_0"]
    assert late == {"hunter_0": True, "prey_0": True}
    assert not any(caught.values())
    assert total == pytest.approx(-1.0)
    with pytest.raises(InputError, match="reset"):
        env.step({"hunter_0": 0, "prey_0": 2})


def test_two_environments_share_nothing():
    one, other = hunt_v0.parallel_env(), hunt_v0.parallel_env()
    alone, _ = run(one, 1)
    one.reset(options={"theta": 0.0, "hunt_seed": 0})
    other.reset(options={"theta": 3.0, "hunt_seed": 9})
    for _ in range(3):
        one.step({"hunter_0": 0, "prey_0": 1})
        other.step({"hunter_0": 4, "prey_0": 3})
    np.testing.assert_array_equal(one.state(), alone)
    np.testing.assert_array_equal(run(copy.deepcopy(other), 1)[0], alone)


@pytest.mark.parametrize("actions", [{}, {"hunter_0": 0}, {"hunter_0": 0, "prey_0": 5}, {"hunter_0": 10, "prey_0": 0}])
def test_actions_that_are_none(actions):
    env = hunt_v0.parallel_env()
    env.reset(seed=0)
    with pytest.raises(InputError, match=r"expected"):
        env.step(actions)


@pytest.mark.parametrize("cycles", [0, 2.5, "x"])
def test_cycles_that_are_none(cycles):
    with pytest.raises(InputError, match="max_cycles: expected"):
        hunt_v0.parallel_env(max_cycles=cycles)


@pytest.mark.skipif(not hasattr(pettingzoo, "make"), reason="PettingZoo before 1.27 has no registry")
def test_pettingzoos_registry_knows_both():
    both = pettingzoo.make("parallel", "bayeshunt/hunt-v0", arena="open", max_cycles=2)
    assert (both.unwrapped.max_cycles, both.possible_agents) == (2, ["hunter_0", "prey_0"])
    assert pettingzoo.make("aec", "bayeshunt/hunt_v0").possible_agents == both.possible_agents
