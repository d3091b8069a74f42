"""The recordings that ship: small, attributed, and foreseen better by our models than by simple ones."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.core.errors import InputError
from bayeshunt.data import tracks as tracks_file
from bayeshunt.models.counting.auto_axes import density_losses

DATA = Path(__file__).parents[2] / "data"


def test_all_files_are_named_with_their_licence_and_small() -> None:
    told = (DATA / "README.md").read_text(encoding="utf-8")
    files = [path for path in DATA.iterdir() if path.name != "README.md"]
    assert all(path.name in told for path in files)
    assert sum(path.stat().st_size for path in files) < 4_000_000
    assert all(name in told for name in ("BSD-3-Clause", "CC BY 4.0", "2309.10718", "Carlesso"))


def test_a_real_robot_that_babbled() -> None:
    """Held out by command, 25 gaits: tables of what the fitted unicycle misses are better than either alone."""
    rows = pd.read_csv(DATA / "husky_windows.csv")
    command, pose = ("cmd_left_rad_s", "cmd_right_rad_s"), ("x_forward_m", "y_left_m", "yaw_ccw_rad")
    table = bh.gaits_from_windows(rows, command, pose, time_step=2.0)
    assert len(table) == len(rows) == 603
    scores = bh.score_forward(table, 25, folds_by="calib_step", seed=0).set_index("model")
    assert scores.loc["unicycle", "position_m"] == pytest.approx(0.339, abs=0.01)
    assert scores.loc["residual", "position_m"] <= 0.31
    assert scores.loc["residual", "heading_deg"] <= 22
    assert scores.loc["previous_gait", "position_m"] <= 0.38


def test_bins_chosen_by_the_data_are_better_than_the_default_by_a_nat() -> None:
    rows = pd.read_csv(DATA / "husky_windows.csv")
    command, pose = ("cmd_left_rad_s", "cmd_right_rad_s"), ("x_forward_m", "y_left_m", "yaw_ccw_rad")
    table = bh.gaits_from_windows(rows, command, pose, time_step=2.0)
    gaits = sorted(set(table["gait"]))
    auto, default = (bh.ForwardModel.fit(table, gaits, 0.03, axes=axes) for axes in ("auto", None))
    codes = table["gait"].map({gait: i for i, gait in enumerate(gaits)}).to_numpy()
    one, two = (
        sum(density_losses(table[axis.name.lower()].to_numpy(), codes, axis) for axis in model.axes)
        for model in (auto, default)
    )
    assert one < two - 1
    with pytest.raises(InputError, match="'auto'"):
        bh.ForwardModel.fit(table, gaits, axes="best")


def test_locusts_stand_and_walk() -> None:
    """Four are learned from, the fifth is foreseen 12 steps of 3 frames ahead."""
    animals = tracks_file.load(DATA / "locusts.parquet")
    learned = bh.transitions(animals[animals["id"] != 4], time_step=0.6)
    model = bh.PreyModel.fit(learned, given="speed", residual_of="constant_velocity")
    fifth = animals[animals["id"] == 4]
    scores = bh.score_prey(
        fifth, {"stands": "stands", "cv": "constant_velocity", "ours": model}, time_step=0.6, most=400
    )
    by = scores.set_index("model")
    assert by.loc["ours", "ade"] < by.loc["stands", "ade"]
    assert by.loc["ours", "ade"] < by.loc["cv", "ade"]
    assert by.loc["ours", "energy"] < 0.75 * by.loc["cv", "energy"]


@pytest.mark.slow
@pytest.mark.parametrize("step", [0.2, 0.48])
def test_guppies(step: float) -> None:
    scores = bh.score_prey(tracks_file.load(DATA / "guppies.parquet"), time_step=step, most=600).set_index("model")
    assert scores.loc["speed", "ade"] < 0.95 * scores.loc["constant_velocity", "ade"]
    assert scores.loc["conditioned", "energy"] < 0.75 * scores.loc["constant_velocity", "energy"]
