"""The pages about the environments show code that runs, and say what is true of them."""

import inspect
import re
from pathlib import Path

import gymnasium
import numpy as np
import pytest

import bayeshunt
from bayeshunt.envs import HuntEnv, hunt_v0

DOCS = Path(__file__).parents[2] / "docs"
#: A page for each: what gymnasium.make makes, what PettingZoo takes, and how policies and planners become each other.
PAGE, BOTH, POLICIES = (
    (DOCS / name).read_text(encoding="utf-8") for name in ("environments.md", "hunt_v0.md", "policies.md")
)
HEADINGS = (
    "Description", "Action Space", "Observation Space", "Rewards", "Starting State", "Episode End", "Arguments",
    "Version History",
)  # fmt: skip


def blocks(page):
    return re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)


def run(block, **names):
    """Run a block of a page; what it has named."""
    exec(block, names)  # a page of our own
    return names


@pytest.fixture
def environments():
    """What the first block of the page has made, some ten lines above the others."""
    return run(blocks(PAGE)[0])


@pytest.mark.parametrize("page", [PAGE, BOTH])
def test_it_has_the_headings_that_users_of_gymnasium_look_for(page):
    assert [name for name in re.findall(r"^##+ (.*)$", page, flags=re.MULTILINE) if name in HEADINGS] == list(HEADINGS)


def test_its_blocks_run_in_their_order(environments, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    _, learner, plugin, film = blocks(PAGE)
    assert "stable_baselines3" in learner
    assert "stable_baselines3" in plugin
    run(film, gymnasium=environments["gymnasium"])["env"].close()
    run(blocks(BOTH)[0])


def few(block):
    """The same with a few hunts, and a babbling that is done soon."""
    return block.replace("range(1000, 1200)", "range(1000, 1004)").replace("runs=10", "runs=1").replace("2000", "300")


def run_policies(change):
    names = {}
    for block in blocks(POLICIES):
        names = run(change(block), **names)
    return names


def test_policies_and_planners_become_each_other():
    names = run_policies(few)
    assert {"again", "imitator"} <= set(bayeshunt.planner_names())
    assert len(names["table"]) == 14
    assert all(names["env"].action_space.contains(action) for action in names["chosen"])


@pytest.mark.slow
def test_an_imitator_catches_as_often_as_the_page_says():
    names = run_policies(str)
    told = re.search(r"(\d+) of 70 .*?; `intercept` itself (\d+)", POLICIES, flags=re.DOTALL)
    assert told is not None
    # the least squares differ in their last bits between processors, and so may a hunt or two
    assert abs(int(names["caught"]["imitator"]) - int(told[1])) <= 2
    assert int(names["caught"]["intercept"]) == int(told[2])


def test_its_table_has_the_numbers_of_an_observation(environments):
    space = environments["env"].observation_space
    assert space.shape == (28,)
    for row in re.findall(r"^\| (\d+)(?:, (\d+))?(?: \.\.\.)? \| .*? \| (-?\d+) \| (\d+) \|", PAGE, flags=re.MULTILINE):
        for number in filter(None, row[:2]):
            assert (space.low[int(number)], space.high[int(number)]) == (float(row[2]), float(row[3]))


def told(page):
    """Defaults by argument, as a page's table has them."""
    table = page[page.index("| Argument |") :]
    return dict(re.findall(r"^\| `(\w+)` \| `(.*?)` \|", table[: table.index("\n\n")], flags=re.MULTILINE))


def test_its_arguments_are_those_of_the_environment():
    known = inspect.signature(HuntEnv).parameters
    assert told(PAGE) == {name: repr(one.default).replace("'", '"') for name, one in known.items()}
    both = inspect.signature(hunt_v0.HuntParallelEnv).parameters
    assert {**told(PAGE), **told(BOTH)} == {name: repr(one.default).replace("'", '"') for name, one in both.items()}


def test_spaces_of_both_are_as_told():
    env = hunt_v0.parallel_env()
    assert isinstance(env.action_space("prey_0"), gymnasium.spaces.Discrete)
    assert f"`Discrete({env.action_space('prey_0').n})`" in BOTH
    assert f"{env.state_space.shape[0]} numbers" in BOTH
    seen, _ = env.reset(seed=0)
    assert np.count_nonzero(seen["prey_0"][17:]) == 0
