"""Prey and planners of one's own reach the command line and the workers."""

import json

import pytest

from bayeshunt.errors import InputError
from bayeshunt.experiments.plugins import load_plugin

PLUGIN = """
import bayeshunt as bh
from bayeshunt.planners.reactive import ReactivePlanner

class Circle:
    def __init__(self, context):
        self.context = context

    def act(self, x, y, theta, hunter_x, hunter_y):
        return self.context.wheels(0.02, 0.5)

class Mine(ReactivePlanner):
    pass

bh.register_prey("circle_of_{jobs}", Circle)
bh.register_planner("mine_of_{jobs}", Mine)
"""


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_a_plugin_reaches_the_workers(bayeshunt, folder, jobs):
    (folder / "own.py").write_text(PLUGIN.format(jobs=jobs))
    small = ["--set", "model.babbling_steps=200", "--set", "protocol.thetas=[1.0, 2.0]", "--runs", "15", "--quiet"]
    out, _ = bayeshunt(
        "--plugin", "own.py", "evaluate", "--planner", f"mine_of_{jobs}", "--arena", "open", "--jobs", jobs,
        "--set", f'prey.behaviour="circle_of_{jobs}"', "--json", *small,
    )  # fmt: skip
    total = json.loads(out)["rows"][-1]
    assert total["runs"] == 30
    assert total["caught"] > 20  # a slow prey that goes round in circles


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (None, "no such file"),
        ("import nonsense_that_is_not_there", "ModuleNotFoundError: No module named"),
        ("import bayeshunt as bh; bh.register_prey('evader', object)", "ships already; choose another name"),
    ],
)
def test_a_wrong_plugin_is_one_line(tmp_path, text, message):
    path = tmp_path / "own.py"
    if text is not None:
        path.write_text(text)
    with pytest.raises(InputError, match=message):
        load_plugin(path)
