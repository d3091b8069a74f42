"""Hunt-v0 is the hunt that ``bayeshunt.hunt`` runs, to the last bit, whoever decides."""

import numpy as np
import pytest
from episodes import episode, make
from replaying import ARENAS, CASES, PLANNERS, replay

import bayeshunt.envs
from bayeshunt.episodes.loop import hunt
from bayeshunt.planners.policy import planner_policy, policy_planner
from bayeshunt.planners.registry import make_planner

pytestmark = [pytest.mark.filterwarnings("error"), pytest.mark.filterwarnings("ignore:planner .* is deprecated")]


@pytest.mark.parametrize("name", ["planning", "intercept", "prediction"])
@pytest.mark.parametrize("arena", ["open", "walled"])
def test_an_environment_is_the_hunt(khepera_model, name, arena):
    planner = make_planner(name, khepera_model)
    env = make(arena=arena)
    for seed in range(3):
        theta = float(2 * seed)
        whole = hunt("paper", planner, arena=arena, theta=theta, seed=seed)
        policy = planner_policy(planner, env)
        moments, rewards, ended = [], [], (False, False)
        seen, info = env.reset(options={"theta": theta, "hunt_seed": seed})
        while not any(ended):
            seen, reward, *ended, info = env.step(policy(seen))
            rewards.append(reward)
            moments.extend((m.time, *m.poses["hunter"], *m.poses["prey"]) for m in env.unwrapped.moments)
        assert (info["is_success"], info["time"], info["gaits"]) == (whole.caught, whole.time, len(whole.frame))
        np.testing.assert_array_equal(np.array(moments), whole.trail.to_numpy())
        assert tuple(ended) == (whole.caught, not whole.caught)
        assert sum(rewards) == pytest.approx(-whole.time / 60.0, abs=1e-12)
        assert (info["theta"], info["hunt_seed"]) == (theta, seed)


def test_an_episode_that_was_drawn_can_be_hunted_again(khepera_model):
    planner = make_planner("intercept", khepera_model)
    env = make(arena="open")
    env.reset(seed=11)
    infos, _, _ = episode(env, planner_policy(planner, env))
    again = hunt("paper", planner, arena="open", theta=infos[0]["theta"], seed=infos[0]["hunt_seed"])
    assert (again.caught, again.time) == (infos[-1]["is_success"], infos[-1]["time"])


def test_a_policy_sees_in_a_film_what_it_sees_without(khepera_model):
    planner = make_planner("planning", khepera_model)
    plain = make(arena="walled")
    film = bayeshunt.envs.Film(make(arena="walled"))
    one = episode(plain, planner_policy(planner, plain), theta=4.0, hunt_seed=1)
    two = episode(film, planner_policy(planner, film), theta=4.0, hunt_seed=1)
    assert one[0][-1] == two[0][-1]


@pytest.mark.slow
@pytest.mark.parametrize("arena", ARENAS)
@pytest.mark.parametrize("robot", list(CASES))
def test_replayed_hunts_are_the_hunts(robot, arena):
    for name in PLANNERS:
        seeds = range(1) if CASES[robot].legs else range(50 if name in ("reactive", "intercept") else 5)
        assert list(replay(robot, arena, name, seeds)) == list(seeds)


@pytest.mark.parametrize("arena", ARENAS)
def test_a_policy_as_planner_gives_its_environments_numbers(arena):
    readout = np.random.default_rng(5).normal(size=(28, 10))
    policy = lambda seen: int(np.argmax(seen @ readout))  # noqa: E731
    planner = policy_planner(policy, robot="khepera")
    env = make(arena=arena)
    for seed in range(4):
        whole = hunt("paper", planner, arena=arena, theta=float(seed), seed=seed)
        infos, _, _ = episode(env, policy, theta=float(seed), hunt_seed=seed)
        end = infos[-1]
        assert (end["is_success"], end["time"], end["gaits"]) == (whole.caught, whole.time, len(whole.frame))
