"""Any policy is a planner, and gives as one the numbers that it gives in the environment."""

import gymnasium
import numpy as np
import pytest
from planner_cases import situations

import bayeshunt
from bayeshunt.core.errors import InputError
from bayeshunt.episodes.pursuit import Pursuit
from bayeshunt.planners.conformance import check_planner
from bayeshunt.planners.policy import observation, planner_policy, policy_planner
from bayeshunt.planners.registry import make_planner

WEIGHTS = np.random.default_rng(0).normal(size=(10, 28))

PLUGIN = """
import bayeshunt
import numpy as np

WEIGHTS = np.random.default_rng(0).normal(size=(10, 28))


def predict(observation):
    return np.argmax(WEIGHTS @ observation), None


bayeshunt.register_planner("ppo", bayeshunt.policy_planner(predict, name="ppo"))
"""


def predict(seen):
    """A policy of numpy alone, which answers as learning libraries do."""
    return np.argmax(WEIGHTS @ seen), None


@pytest.mark.parametrize("arena", ["open", "walled"])
def test_a_policy_as_planner_gives_its_environments_numbers(arena):
    planner = policy_planner(predict, "khepera")
    env = gymnasium.make("bayeshunt.envs:Hunt-v0", preset="paper", arena=arena)
    for seed in range(4):
        seen, info = env.reset(options={"theta": float(seed), "hunt_seed": seed})
        ended = [False]
        while not any(ended):
            seen, _, *ended, info = env.step(predict(seen)[0])
        whole = bayeshunt.hunt("paper", planner, arena=arena, theta=float(seed), seed=seed)
        assert (whole.caught, whole.time, len(whole.frame)) == (info["is_success"], info["time"], info["gaits"])


def test_a_plugins_policy_in_the_evaluation(bayeshunt, folder):
    (folder / "policy.py").write_text(PLUGIN, encoding="utf-8")
    line = ["--plugin", "policy.py", "evaluate", "--planner", "ppo", "--arena", "open", "--runs", "1", "--jobs", "1"]
    out, _ = bayeshunt(*line, "--set", "protocol.thetas=[1.0, 4.0]", "--quiet")
    assert "ppo" in out


def test_a_registered_policy_is_made_for_a_model(khepera_model):
    bayeshunt.register_planner("learned", policy_planner(predict, name="learned"))
    planner = make_planner("learned", khepera_model)
    assert planner.hunter == khepera_model.gaits
    assert planner.name == "learned"
    assert not planner.ab_initio
    check_planner(planner, khepera_model.gaits.names, situations(4), seed=1)


@pytest.mark.parametrize(
    ("policy", "robot", "said"),
    [
        (lambda seen: 10, "khepera", "0 to 9"),
        (lambda seen: 1 / 0, "khepera", "ZeroDivisionError"),
        (lambda seen: 0, None, "which robot"),
    ],
)
def test_a_policy_that_cannot_decide(policy, robot, said):
    with pytest.raises(InputError, match=said):
        bayeshunt.hunt("paper", policy_planner(policy, robot), arena="open", theta=0.0, seed=0)


def test_what_is_no_policy_and_no_environment(khepera_model):
    with pytest.raises(InputError, match="predict"):
        policy_planner("ppo")
    with pytest.raises(InputError, match="env"):
        planner_policy(make_planner("reactive", khepera_model), None)


def test_what_is_not_known_is_zero(khepera_model):
    situation = bayeshunt.Situation(prey=bayeshunt.Polar(0.3, 0.5, 1.0), prey_model=bayeshunt.PreyModel())
    seen = observation(situation, khepera_model.gaits)
    assert seen[7:16].tolist() == [0.0] * 9
    assert seen[16:18].tolist() == [1.0, 1.0]


def test_demonstrations_for_a_learner(khepera_model):
    env = gymnasium.make("bayeshunt.envs:Hunt-v0", preset="paper", arena="walled")
    policy = planner_policy(make_planner("planning", khepera_model), env)
    seen, _ = env.reset(seed=0)
    action, state = policy.predict(seen, deterministic=True)
    assert state is None
    assert env.action_space.contains(action)
    assert policy(seen) == action  # asked twice, it has decided once


def test_a_pursuit_says_what_it_cannot_do():
    pursuit = Pursuit("paper", "open", 0.0, 0)
    for gait in (-1, 10, 1.5, "crawl", False):
        with pytest.raises(InputError, match="gait"):
            pursuit.step(gait)
    while not pursuit.done:
        pursuit.step("straight" if "straight" in pursuit.gaits else 0)
    with pytest.raises(InputError, match="over"):
        pursuit.step(0)
