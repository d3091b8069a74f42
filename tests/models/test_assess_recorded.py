"""assess on recordings: densities that compare over bins, warnings, bins chosen by the data."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh

HUSKY = Path(__file__).parents[2] / "data" / "husky_windows.csv"


def husky(gaits: int) -> pd.DataFrame:
    rows = pd.read_csv(HUSKY)
    command, pose = ("cmd_left_rad_s", "cmd_right_rad_s"), ("x_forward_m", "y_left_m", "yaw_ccw_rad")
    return bh.gaits_from_windows(rows, command, pose, time_step=2.0, gaits=gaits)


def quick(frame: pd.DataFrame, **how) -> bh.Assessment:
    return bh.assess(frame, sorted(set(frame["gait"])), structures=[], permutations=1, **how)


def test_default_bins_are_warned_of_on_a_real_robot_and_chosen_ones_a_nat_better() -> None:
    table = husky(25)
    default, auto = quick(table, axes=bh.EffectAxes.standard(0.5)), quick(table, axes="auto")
    assert default.notes[0].startswith("Distance is foreseen WORSE than ignoring the gait: 3.95 nats a row against 3.5")
    assert "Other bins foresee a row by 1." in default.notes[1]
    assert "WORSE" in str(default)
    assert not [note for note in auto.notes if "WORSE" in note]
    assert auto.structures.loc["naive", "density"] < default.structures.loc["naive", "density"] - 1
    assert auto.variables["density"].sum() == pytest.approx(auto.structures.loc["naive", "density"])


def test_a_density_does_not_change_where_bins_hold_no_more() -> None:
    """Uniform places: halving the bins costs log 2 nats a row, and no density."""
    rng = np.random.default_rng(0)
    frame = pd.DataFrame({"gait": rng.choice(["a", "b"], 4000), "distance": rng.uniform(0, 1, 4000),
                          "angle": rng.uniform(-3.1, 3.1, 4000), "heading": 0.0})  # fmt: skip
    wide, narrow = (quick(frame, axes=bh.EffectAxes.standard(1.0, distance_bin=w)) for w in (0.25, 0.125))
    one, two = (found.variables.loc["Distance"] for found in (wide, narrow))
    assert two["log_loss"] - one["log_loss"] == pytest.approx(math.log(2), abs=0.005)
    assert two["density"] == pytest.approx(one["density"], abs=0.005) == pytest.approx(0.0, abs=0.01)
    assert not [note for note in wide.notes if "WORSE" in note]  # the gait says nothing, which costs nothing


def test_gaits_that_mean_nothing_are_worse_than_none() -> None:
    rng = np.random.default_rng(1)
    frame = pd.DataFrame({"gait": rng.integers(40, size=300).astype(str), "distance": rng.uniform(0, 1, 300),
                          "angle": rng.uniform(-3.1, 3.1, 300), "heading": rng.uniform(-3.1, 3.1, 300)})  # fmt: skip
    found = quick(frame, axes=bh.EffectAxes.standard(1.0))
    assert found.notes[0].startswith("The model is WORSE than ignoring the gait: ")
    assert "do not use it with these bins" in found.notes[0]
    assert "foreseen WORSE" in found.notes[1]
    assert "WORSE" in found._repr_html_()


def test_a_model_of_residuals_is_assessed_by_them() -> None:
    table = husky(9)
    model = bh.ForwardModel.fit(table, sorted(set(table["gait"])), 0.03, residual_of="unicycle")
    found = bh.assess(table, model=model, structures=[], permutations=1)
    assert any("what the fitted unicycle misses" in note for note in found.notes)
    assert found.settings["bins"]["Angle"] == model.axes.angle.bins
    assert found.given["same_rows"]
