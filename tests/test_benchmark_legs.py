"""What the benchmark of legs measures: held-out gains are those of the models themselves; hunts are made once."""

import importlib
from pathlib import Path

import numpy as np
import pandas as pd
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


def test_hunts_are_made_once_and_paired_by_seed_bearing_and_run(monkeypatch, tmp_path):
    monkeypatch.syspath_prepend(str(ROOT))
    kept, legs = importlib.import_module("benchmarks.legs_hunts"), importlib.import_module("benchmarks.legs")
    made = []

    def hunts(row, runs, seed):
        made.append((row.planner, runs, seed))
        index = pd.MultiIndex.from_product([range(kept.BEARINGS), range(runs)], names=["bearing", "run"])
        late = 1.5 * seed + index.get_level_values("run") + (row.planner == "planning")
        columns = {"caught": late < 3.0, "time": late * 1.0, "energy": 2.0 * late, "transitions": 1, "falls": 0}
        return pd.DataFrame(columns, index=index)

    monkeypatch.setattr(kept, "_made", hunts)
    rows = [kept.Row("planning"), kept.Row("intercept")]
    first = [kept.Hunts((0, 1), tmp_path / "legs.csv").of(row, 3) for row in rows]
    again = [kept.Hunts((0, 1), tmp_path / "legs.csv").of(row, 3) for row in rows]
    assert len(made) == 4  # each row and seed once, though asked for by another run
    for one, other in zip(first, again, strict=True):
        pd.testing.assert_frame_equal(one, other, check_dtype=False, check_names=False)
    fewer = kept.Hunts((0, 1), tmp_path / "legs.csv").of(rows[0], 2)
    assert len(fewer) == 2 * kept.BEARINGS * 2
    assert legs.caught(first[0]) == "21 of 42 = 50.0 % (35.5 to 64.5)"
    assert legs.paired(first[1], fewer) == ["7 / 0, 0.016", "-1.00 ±0.00 s", "-2.00 ±0.00 J"]


def test_a_section_takes_the_place_of_its_former_self(monkeypatch, tmp_path):
    monkeypatch.syspath_prepend(str(ROOT))
    legs, page = importlib.import_module("benchmarks.legs"), tmp_path / "legs.md"
    for name, text in (("physics", "| old |"), ("main", "| a |"), ("physics", "| new |\n\n| more |")):
        legs.publish(page, name, text)
    said = page.read_text()
    assert said.index("## main") < said.index("| a |") < said.index("## physics") < said.index("| new |\n\n| more |")
    assert "old" not in said
