"""What the benchmark of legs measures: held-out gains are those of the models themselves."""

import importlib
from pathlib import Path

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.core.bins import EffectAxes
from bayeshunt.models.counting.previous import PreviousCounts

ROOT = Path(__file__).parents[1]


def test_held_out_losses_are_the_models_own(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT))  # benchmarks are no part of the installed package
    tables = importlib.import_module("benchmarks.legs_tables")
    robot = bh.load_robot("hexapod_mixed")
    frame = bh.babble(robot, 120, seed=0)
    axes = EffectAxes.standard(robot.gaits.body_length)
    naive, one, two = tables.losses(frame, robot.gaits.names, axes, 5.0)
    used = frame.iloc[2:].reset_index(drop=True)
    fold = np.random.default_rng(0).integers(tables.FOLDS, size=len(used))
    axes = axes.extended(int(axes.distance.index(float(used["distance"].max()))) + 1)
    seen = PreviousCounts.of(used[fold != 1], robot.gaits, axes)
    model = bh.ForwardModel(seen, 0.03, backoff=5.0)
    pooled = bh.ForwardModel(seen.joint, 0.03)
    for row in np.flatnonzero(fold == 1)[:6]:
        rows, gait = used.iloc[[row]], np.log(1 / len(robot.gaits))
        assert naive[row] == pytest.approx(pooled.log_likelihood(rows) - gait)
        assert one[row] == pytest.approx(model.log_likelihood(rows) - gait)
    assert np.isfinite(two).all()
