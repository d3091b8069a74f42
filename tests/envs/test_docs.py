"""The page about the environments shows code that runs."""

import re
from pathlib import Path

import numpy as np
import pytest

import bayeshunt

PAGE = Path(__file__).parents[2].joinpath("docs", "environments.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)


def run(block, **names):
    """Run a block of the page; what it has named."""
    exec(block, names)  # a page of our own
    return names


@pytest.fixture
def environments():
    """What the first block of the page has made, some ten lines above the others."""
    return run(BLOCKS[0])


def test_its_blocks_run_in_their_order(environments, khepera_model, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    first, learner, film, planner, plugin, policy, parallel = BLOCKS
    assert "stable_baselines3" in learner
    made = run(film, gymnasium=environments["gymnasium"])
    made["env"].close()

    class Model:
        def predict(self, seen, deterministic):
            return np.argmax(seen[18:28]), None

    run(planner, model=Model())
    run(plugin, bh=bayeshunt, predict=Model().predict)
    assert "ppo" in bayeshunt.planner_names()
    env = environments["gymnasium"].make("bayeshunt.envs:Hunt-v0", preset="paper")
    demonstrations = run(policy, bh=bayeshunt, env=env, forward_model=khepera_model)["demonstrations"]
    assert all(env.action_space.contains(action) for _, action in demonstrations)
    run(parallel)
    assert first


def test_its_table_has_the_numbers_of_an_observation(environments):
    space = environments["env"].observation_space
    assert space.shape == (28,)
    for row in re.findall(r"^\| (\d+)(?:, (\d+))?(?: \.\.\.)? \| .*? \| (-?\d+) \| (\d+) \|", PAGE, flags=re.MULTILINE):
        for number in filter(None, row[:2]):
            assert (space.low[int(number)], space.high[int(number)]) == (float(row[2]), float(row[3]))


def test_its_arguments_are_those_of_the_environment():
    import inspect

    from bayeshunt.envs import HuntEnv

    table = PAGE[PAGE.index("| Argument |") : PAGE.index("All are plain values")]
    told = dict(re.findall(r"^\| `(\w+)` \| `(.*?)` \|", table, flags=re.MULTILINE))
    known = inspect.signature(HuntEnv).parameters
    assert told == {name: repr(one.default).replace("'", '"') for name, one in known.items()}
