"""A prey that is followed: its own steps are what a conditioned model and constant velocity go by."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.core.errors import BayesHuntError
from bayeshunt.core.geometry import Pose
from bayeshunt.core.statistics import spatial_median
from bayeshunt.models.target.following import ConstantVelocity, places_of


def test_transitions_put_together_are_the_path() -> None:
    poses = [Pose(*numbers) for numbers in np.random.default_rng(0).normal(size=(6, 3))]
    steps = [one.relative(two) for one, two in pairwise(poses)]
    seen = [poses[-1].relative(pose) for pose in poses]
    np.testing.assert_allclose(places_of(steps), [p.forward - 1j * p.right for p in seen], atol=1e-12)


def test_constant_velocity_by_hand() -> None:
    model = ConstantVelocity()
    assert model.is_empty
    assert model.predict_path(2).distance.tolist() == [0, 0, 0]
    model.observe(bh.Polar(0.5, 0.2, 0.3))  # it now faces 0.1 to the right of where it went
    path = model.predict_path(3)
    assert path.distance.tolist() == pytest.approx([0, 0.5, 1.0, 1.5])
    assert path.angle.tolist() == pytest.approx([0, -0.1, -0.1, -0.1])
    bh.check_prey_model("constant_velocity")


def test_the_median_is_not_drawn_by_what_is_far() -> None:
    draws = np.array([[0j], [1e-3], [1j * 1e-3], [50.0]])
    assert abs(spatial_median(draws, axis=0, rounds=200)[0]) < 2e-3


def walkers(count: int) -> pd.DataFrame:
    """Straight walkers, half of them at 0.6 m/s, half at 1.4 m/s, a little unsteady."""
    rng, parts = np.random.default_rng(1), []
    for number in range(count):
        time = np.arange(30) * 0.4
        speed = (0.6, 1.4)[number % 2]
        place = np.cumsum(np.full(30, speed * 0.4) * np.exp(1j * rng.normal(scale=0.05, size=30)))
        parts.append(pd.DataFrame({"id": str(number), "time": time, "x": place.real, "y": place.imag, "heading": np.nan,
                                   "confidence": np.nan, "scene": "s"}))  # fmt: skip
    return pd.concat(parts, ignore_index=True)


def test_a_model_of_many_foresees_the_one_that_is_followed() -> None:
    rows = bh.transitions(walkers(30), 0.8)
    model = bh.PreyModel.fit(rows, given="speed", residual_of="constant_velocity")
    before = model.predict_path(3)  # nobody is followed yet: the mean of all
    assert before.distance[1] == pytest.approx(0.8, abs=0.08)
    for speed in (0.6, 1.4):
        followed = model.copy()
        for _ in range(4):
            followed.observe(bh.Polar(speed * 0.8, 0.0, 0.0))
        path = followed.predict_path(20)  # farther than the model's own 12 steps
        assert path.distance[[1, 10, 20]] == pytest.approx(np.array([1, 10, 20]) * speed * 0.8, rel=0.05)
        assert np.abs(path.angle).max() < math.radians(8)
        np.testing.assert_array_equal(followed.predict_path(20), path)
        assert followed.predict(10).distance == path.distance[10]
    np.testing.assert_array_equal(model.predict_path(3), before)  # a copy goes its own way


def test_copies_share_tables_until_one_learns() -> None:
    rows = bh.transitions(walkers(6), 0.8)
    model = bh.PreyModel.fit(rows, given="speed", residual_of="constant_velocity")
    twin = model.copy()
    twin.update(rows)
    assert model == bh.PreyModel.fit(rows, given="speed", residual_of="constant_velocity")
    assert twin != model
    assert twin.conditions.speed.counts != model.conditions.speed.counts


def test_a_file_is_a_prey_model_by_name(tmp_path) -> None:
    from bayeshunt.models.target.registry import make_prey_model

    rows = bh.transitions(walkers(6), 0.8)
    model = bh.PreyModel.fit(rows, given="speed")
    model.save(tmp_path / "prey.json")
    made = make_prey_model(str(tmp_path / "prey.json"), bh.EffectAxes.standard(0.5))
    assert made == model
    with pytest.raises(BayesHuntError, match="no such file"):
        make_prey_model(str(tmp_path / "none.json"), bh.EffectAxes.standard(0.5))
