"""Which way a prey goes: by its body or by its last step; and how much of its futures is drawn whole."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.data import tracks as tracks_file
from bayeshunt.data.transitions import motion_frame

DATA = Path(__file__).parents[2] / "data"
BOTH = {"given": "speed", "residual_of": "constant_velocity"}


def crab(rows: int, seed: int, off: float = 0.6) -> pd.DataFrame:
    """Walks with a slowly changing direction; its body is turned by ``off`` and shakes."""
    rng = np.random.default_rng(seed)
    going = np.cumsum(rng.normal(scale=0.1, size=rows))
    place = np.cumsum(np.exp(1j * going))
    body = going + off + rng.normal(scale=0.3, size=rows)
    return pd.DataFrame({"id": str(seed), "time": np.arange(rows) * 0.5, "x": place.real, "y": place.imag,
                         "heading": np.angle(np.exp(1j * body)), "confidence": np.nan, "scene": "s"})  # fmt: skip


def test_beside_the_last_step_by_hand() -> None:
    """It came along x, was turned 0.3 to the left of that, and goes on along x: straight on by its motion."""
    row = {"distance": 1.0, "angle": 0.3, "heading": 0.1, "past_01_forward": -math.cos(0.3),
           "past_01_right": -math.sin(0.3), "past_02_forward": np.nan, "past_02_right": np.nan}  # fmt: skip
    stood = {**row, "past_01_forward": 0.0, "past_01_right": 0.0}
    angle, heading = motion_frame(pd.DataFrame([row, stood, {**row, "distance": 0.0}]), 0.1)
    assert angle == pytest.approx([0.0, 0.3, 0.0])
    assert heading == pytest.approx([0.0, 0.3, 0.0])


def test_the_rows_say_which_of_both_tells() -> None:
    assert bh.transitions(crab(300, 0))["by_motion"].all()
    assert not bh.transitions(crab(300, 0).assign(heading=np.nan))["by_motion"].any()  # they are by motion already
    true = crab(300, 1, off=0.0)
    straight = true.assign(heading=np.angle(np.gradient(true["x"]) + 1j * np.gradient(true["y"])))
    assert not bh.transitions(straight)["by_motion"].any()
    locusts, guppies = (tracks_file.load(DATA / f"{name}.parquet") for name in ("locusts", "guppies"))
    assert bh.transitions(locusts, 0.6)["by_motion"].all()
    assert not bh.transitions(guppies.iloc[:4000], 0.48)["by_motion"].any()


def test_a_body_that_says_little_does_not_lead_astray(tmp_path) -> None:
    rows = bh.transitions(pd.concat([crab(300, seed) for seed in range(4)], ignore_index=True))
    model = bh.PreyModel.fit(rows, given="speed")
    by_body = bh.PreyModel.fit(rows.assign(by_motion=False), given="speed")
    test = crab(200, 9)
    scores = bh.score_prey(test, {"motion": model, "body": by_body}, steps=6, most=100).set_index("model")
    assert scores.loc["motion", "ade"] < 0.9 * scores.loc["body", "ade"]
    assert model.log_likelihood(rows) > by_body.log_likelihood(rows)
    model.save(tmp_path / "prey.json")
    back = bh.PreyModel.load(tmp_path / "prey.json")
    assert back == model
    assert back.conditions.by_motion
    assert back != by_body


def test_wandering_is_counted_exactly_in_any_order_and_split(tmp_path) -> None:
    rows = bh.transitions(pd.concat([crab(80, seed) for seed in range(5)], ignore_index=True))
    model = bh.PreyModel.fit(rows, **BOTH)
    parts = np.array_split(np.random.default_rng(0).permutation(len(rows)), 3)
    pieces = bh.PreyModel.fit(rows.iloc[parts[0]], **BOTH).update(rows.iloc[parts[1]]).update(rows.iloc[parts[2]])
    assert pieces.conditions.residual.wandered == model.conditions.residual.wandered
    assert pieces == model
    merged = bh.PreyModel.fit(rows.iloc[parts[0]], **BOTH).merge(
        bh.PreyModel.fit(rows.drop(rows.index[parts[0]]), **BOTH)
    )
    assert merged.conditions.residual.wandered == model.conditions.residual.wandered
    model.save(tmp_path / "prey.json")
    assert (
        bh.PreyModel.load(tmp_path / "prey.json").conditions.residual.wandering == model.conditions.residual.wandering
    )


def test_straight_walkers_do_not_wander() -> None:
    assert repr(bh.PreyModel.fit(bh.transitions(crab(40, 0)))).startswith("<PreyModel: 39 transitions")
    time = np.arange(40) * 0.4
    walk = pd.DataFrame({"id": "1", "time": time, "x": 0.5 * time, "y": 0.0, "heading": np.nan, "confidence": np.nan,
                         "scene": "s"})  # fmt: skip
    model = bh.PreyModel.fit(bh.transitions(walk), **BOTH)
    assert model.conditions.residual.wandering == pytest.approx(0.0, abs=0.02)
    assert bh.PreyModel.fit(bh.transitions(crab(300, 0, 0.0)), **BOTH).conditions.residual.wandering > 0.15


def test_few_individuals_are_resampled_in_blocks_of_time() -> None:
    """Of one animal alone there is still an interval, wider where its moods last."""
    one = bh.score_prey(crab(600, 3), ["stands", "constant_velocity"], seen=3, steps=2, split="time").set_index("model")
    assert set(one["resampled"]) == {"blocks of time"}
    assert (one["ade_low"] < one["ade"]).all()
    assert (one["ade"] < one["ade_high"]).all()
    many = pd.concat([crab(60, seed) for seed in range(5)], ignore_index=True)
    assert set(bh.score_prey(many, ["stands"], seen=3, steps=2)["resampled"]) == {"individuals"}
