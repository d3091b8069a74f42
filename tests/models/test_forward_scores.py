"""Held-out errors of the pose after a gait: the command's own motion, tables, and what the motion misses."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.core.errors import DataError, InputError
from bayeshunt.data.command_gaits import best_number
from bayeshunt.models.motion.unicycle import Unicycle


def windows(rows: int, seed: int, slip: float = 0.0) -> pd.DataFrame:
    """A skid-steer robot: arcs of the wheels' speeds; ``slip`` is lost where the wheels go opposite ways."""
    rng = np.random.default_rng(seed)
    left, right = np.repeat(rng.uniform(-1, 1, size=(2, rows // 3)), 3, axis=1)
    length, turn = 0.5 * (left + right), 1.2 * (right - left) * (1 - slip * (left * right < 0))
    half = turn / 2
    chord = length * np.sinc(half / np.pi)
    noise = rng.normal(scale=0.02, size=(3, len(left)))
    return pd.DataFrame({
        "cmd_left": left, "cmd_right": right, "x": chord * np.cos(half) + noise[0],
        "y": chord * np.sin(half) + noise[1], "yaw": turn + noise[2], "hold": np.arange(len(left)) // 3,
    })  # fmt: skip


def test_unicycle_is_found_again_even_with_turns_beyond_half() -> None:
    table = bh.gaits_from_windows(windows(300, 0).assign(yaw=lambda d: d.yaw), time_step=1.0, gaits=9)
    outcomes = bh.Polar(*(table[name].to_numpy() for name in ("distance", "angle", "heading")))
    motion = Unicycle.fit(table[["command_0", "command_1"]].to_numpy(), outcomes)
    assert motion.forward == pytest.approx((0.5, 0.5), abs=0.01)
    assert motion.left == pytest.approx((-1.2, 1.2), abs=0.01)
    ahead = motion.predict(np.array([[1.0, 1.0], [-1.0, 1.0]]))
    assert ahead.forward == pytest.approx([1.0, 0.0], abs=0.01)
    assert ahead.heading[1] == pytest.approx(-2.4, abs=0.02)  # to the left is anticlockwise
    with pytest.raises(DataError, match="3 rows"):
        Unicycle.fit(np.ones((3, 2)), bh.Polar(*np.ones((3, 3))))


def test_residuals_find_what_slips() -> None:
    table = bh.gaits_from_windows(windows(600, 1, slip=0.5), time_step=1.0, gaits=16)
    scores = bh.score_forward(table, 16, folds_by="hold", seed=2).set_index("model")
    assert list(scores.index) == ["stays", "unicycle", "table", "previous_gait", "residual"]
    assert scores.loc["residual", "heading_deg"] < 0.8 * scores.loc["unicycle", "heading_deg"]
    assert scores.loc["residual", "position_m"] < scores.loc["table", "position_m"]
    assert (scores["position_low"] <= scores["position_m"]).all()
    assert scores["n"].tolist() == [600] * 5
    again = bh.score_forward(table, 16, folds_by="hold", seed=2).set_index("model")
    pd.testing.assert_frame_equal(scores, again)


def test_a_perfect_table_by_hand() -> None:
    frame = pd.DataFrame({"gait": ["go", "turn"] * 6, "distance": [0.3, 0.0] * 6, "angle": 0.0,
                          "heading": [0.0, math.radians(90)] * 6})  # fmt: skip
    scores = bh.score_forward(frame, ["go", "turn"], models=("stays", "table"), folds=3).set_index("model")
    assert scores.loc["stays", ["position_m", "heading_deg"]].tolist() == pytest.approx([0.15, 45])
    # two or more of three rows are one's own: backed off by 3 rows of the whole, whose median lies between
    assert scores.loc["table", "position_m"] < 0.15
    for wrong, problem in (
        ({"models": ("tabel",)}, "did you mean 'table'"), ({"folds_by": "day"}, "column 'day'"),
        ({"folds": 50}, "fewer"), ({"gaits": 3}, "command_0"), ({"models": ("unicycle",)}, "command_0"),
    ):  # fmt: skip
        with pytest.raises((InputError, DataError), match=problem):
            bh.score_forward(frame, **{"gaits": ["go", "turn"], "folds": 3, "models": ("table",), **wrong})


def test_a_lag_is_scored_where_the_command_before_is_known() -> None:
    frame = windows(300, 4)
    speeds = np.column_stack([frame["cmd_left"], frame["cmd_right"]])
    felt = 0.6 * speeds + 0.4 * np.concatenate([speeds[:1], speeds[:-1]])
    length, turn = felt.mean(axis=1), 1.2 * (felt[:, 1] - felt[:, 0])
    chord = length * np.sinc(turn / 2 / np.pi)
    frame = frame.assign(x=chord * np.cos(turn / 2), y=chord * np.sin(turn / 2), yaw=turn)
    table = bh.gaits_from_windows(frame, time_step=1.0, gaits=9)
    asked = ("unicycle", "unicycle_lag", "residual")
    scores = bh.score_forward(table, "auto", asked, folds_by="hold").set_index("model")
    assert scores.loc["unicycle_lag", "heading_deg"] < 0.3 * scores.loc["unicycle", "heading_deg"]
    assert scores.loc["residual", "heading_deg"] < 0.5 * scores.loc["unicycle", "heading_deg"]
    apart = bh.score_forward(table.assign(previous_gait=None), 9, asked, folds_by="hold").set_index("model")
    assert apart.loc["unicycle_lag", "n"] == 0
    assert apart.loc["unicycle", "heading_deg"] == scores.loc["unicycle", "heading_deg"]


def test_the_number_of_gaits_is_chosen_by_rows_not_counted() -> None:
    rng = np.random.default_rng(0)
    four = np.array([[0.2, 0.2], [0.1, 0.3], [0.3, 0.1], [-0.2, 0.2]])
    gait = rng.integers(4, size=200)
    told = four[gait]
    moved = np.column_stack([told.mean(axis=1), np.zeros(200), 4 * (told[:, 1] - told[:, 0])])
    moved += rng.normal(scale=0.02, size=(200, 3))
    assert best_number(told, moved, seed=0) == 4  # few commands that recur
    spread = rng.uniform(-0.3, 0.3, size=(400, 2))
    moved = np.column_stack([spread.mean(axis=1), np.zeros(400), 4 * (spread[:, 1] - spread[:, 0])])
    assert best_number(spread, moved, seed=0) >= 40  # the finer, the better
    blind = rng.normal(size=(400, 3))
    assert best_number(spread, blind, seed=0) <= 4  # commands tell nothing
    frame = pd.DataFrame({"cmd_left": told[:, 0], "cmd_right": told[:, 1], "x": told.mean(axis=1), "y": 0.0,
                          "yaw": 4 * (told[:, 1] - told[:, 0])})  # fmt: skip
    assert bh.gaits_from_windows(frame, time_step=1.0, gaits="auto")["gait"].nunique() == 4
