"""What the intervention on the noise believes before it has seen a prey."""

from __future__ import annotations

import importlib
from pathlib import Path

import numpy as np
import pytest

import bayeshunt as bh


def test_a_prey_is_believed_to_move_as_the_fastest_straight_gait_does(monkeypatch):
    monkeypatch.syspath_prepend(str(Path(__file__).parents[1]))  # benchmarks are no part of the installed package
    missing = importlib.import_module("benchmarks.missing")
    robot = bh.load_robot("khepera")
    model = bh.ForwardModel.fit(bh.babble(robot, steps=300, seed=0), robot.gaits)
    chase = missing.believed(model, 0.058, samples=200)
    assert chase.hunter.shape == (10, 200, 13, 3)
    straight = robot.gaits.names.index("straight")
    ran = np.hypot(*chase.hunter[straight, :, -1, :2].T).mean()
    assert np.hypot(*chase.prey[:, -1, :2].T).mean() == pytest.approx(0.9 * ran, rel=0.01)
    assert chase.closing == pytest.approx(0.1 * ran / 3.328, rel=0.01)
    assert abs(chase.prey[:, -1, 2].mean()) < 0.05
