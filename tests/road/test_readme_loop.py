"""The loop that the README shows, with nothing of our world in it, catches its prey; with gaps and jitter too."""

import re
from pathlib import Path

import pytest

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
LOOP = README.split("<!-- own-loop -->")[1].split("```python\n")[1].split("```")[0]

SHOWN, START = "hunter.step(own, prey)", "bh.Pose(2.0, 1.0, 0.5), bh.Pose(2.25, 1.1, 1.2)"
CHANGES = {
    "as shown": {},
    "missing": {SHOWN: "hunter.step(own, None if next(chance) < 0.1 else prey)"},  # one sighting in ten
    "jittered": {SHOWN: "hunter.step(own, prey, time := time + 3.328 * (0.95 + 0.1 * next(chance)))"},
    "another frame": {START: "turned(2.0, 1.0, 0.5), turned(2.25, 1.1, 1.2)"},
}
HELPERS = """
import numpy as np
chance, time = iter(np.random.default_rng(4).random(100).tolist()), 0.0
def turned(x, y, theta):
    return bh.Pose(math.cos(2.0) * x - math.sin(2.0) * y - 7.0, math.sin(2.0) * x + math.cos(2.0) * y, theta + 2.0)
"""


def run(changes):
    code = LOOP.replace("own, prey = bh", HELPERS + "\nown, prey = bh", 1)
    for old, new in changes.items():
        assert old in code
        code = code.replace(old, new)
    names = {}
    exec(code, names)  # it is what a reader would type
    return names


def test_it_has_at_most_25_lines():
    assert len([line for line in LOOP.splitlines() if line.strip()]) <= 25


@pytest.mark.parametrize("what", CHANGES)
def test_it_catches_its_prey(what, capsys):
    names = run(CHANGES[what])
    gap = names["math"].dist(names["own"][:2], names["prey"][:2])
    assert gap < 0.058
    assert re.search(r"intercept chose '[a-z ]+'", capsys.readouterr().out)
