"""Prey models with conditions: exact in any order and split, stored, scored beside the baselines."""

from __future__ import annotations

import json

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.core.errors import DataError, InputError, ModelFileError
from bayeshunt.core.statistics import spatial_median
from bayeshunt.models.assessment.sampled_scores import sampled_scores
from bayeshunt.models.target.residual_table import KEPT
from bayeshunt.models.target.speed_table import OwnSteps

BOTH = {"given": "speed", "residual_of": "constant_velocity"}


def walkers(people: int, rows: int, seed: int) -> pd.DataFrame:
    """People who walk at their own speed, and slow down or speed up for a while now and then."""
    rng = np.random.default_rng(seed)
    parts = []
    for person in range(people):
        own = rng.uniform(0.3, 0.7)
        speed = own * np.repeat(rng.choice([0.2, 1.0, 1.0, 1.3], size=-(-rows // 8)), 8)[:rows]
        turn = np.cumsum(rng.normal(scale=0.08, size=rows)) + rng.uniform(-3, 3)
        place = np.cumsum(speed * np.exp(1j * turn))
        parts.append(pd.DataFrame({"id": person, "time": 0.4 * np.arange(rows), "x": place.real, "y": place.imag}))
    return pd.concat(parts, ignore_index=True).assign(scene="street")


@pytest.fixture(scope="module")
def rows() -> pd.DataFrame:
    return bh.transitions(walkers(12, 60, 0), seen=4, steps=5)


@pytest.mark.parametrize("kind", [BOTH, {"given": "speed"}, {"residual_of": "constant_velocity"}, {}])
def test_any_order_and_split_is_the_batch_fit(kind: dict[str, str], rows: pd.DataFrame) -> None:
    whole = bh.PreyModel.fit(rows, **kind)
    mixed = rows.sample(frac=1, random_state=3)
    part = bh.PreyModel.fit(mixed.iloc[:1], **kind)
    for start, stop in ((1, 2), (2, 90), (90, 400), (400, len(rows))):
        part.update(mixed.iloc[start:stop])
    one, two = (bh.PreyModel.fit(half, **kind) for half in (mixed.iloc[:300], mixed.iloc[300:]))
    seen = np.cumsum(np.ones((3, 4)), axis=1) * (0.5 + 0.1j)
    drawn = whole.futures(seen, 5, 8, rng=np.random.default_rng(0))
    for other in (part, one.merge(two), whole.copy()):
        assert other == whole
        assert np.array_equal(other.futures(seen, 5, 8, rng=np.random.default_rng(0)), drawn)
    assert part.update(mixed.iloc[:1]) != whole
    assert whole.observations == len(rows)


@pytest.mark.parametrize("kind", [BOTH, {}])
def test_saved_and_loaded_it_is_equal(kind: dict[str, str], rows: pd.DataFrame, tmp_path) -> None:
    model = bh.PreyModel.fit(rows, **kind)
    model.save(tmp_path / "prey.json")
    back = bh.PreyModel.load(tmp_path / "prey.json")
    assert back == model
    assert back.log_likelihood(rows) == model.log_likelihood(rows)
    record = json.loads((tmp_path / "prey.json").read_text())
    assert record["format"] == 2
    record["content"]["counts"][0][3] += 1
    (tmp_path / "prey.json").write_text(json.dumps(record))
    with pytest.raises(ModelFileError, match="checksum"):
        bh.PreyModel.load(tmp_path / "prey.json")


def test_a_class_keeps_a_bounded_number_of_paths_and_counts_all(rows: pd.DataFrame) -> None:
    straight = rows.iloc[[10] * 500].copy().reset_index(drop=True)
    ahead = [name for name in straight if name.startswith("future") and name.endswith("right")]
    straight[ahead] = np.random.default_rng(0).uniform(0.1, 1.0, size=(500, len(ahead)))
    table = bh.PreyModel.fit(straight, residual_of="constant_velocity").conditions.residual
    (count,) = table.counts.values()
    (kept,) = table.kept.values()
    assert (count, len(kept)) == (500, KEPT)


def test_shares_are_dirichlet_means_by_hand(rows: pd.DataFrame) -> None:
    table = bh.PreyModel.fit(rows, **BOTH).conditions.residual
    key = max(table.counts, key=table.counts.get)
    shares = table.shares(key)
    assert sum(shares.values()) == pytest.approx(1)
    own = table.counts[key] / (table.counts[key] + table.backoff)
    assert shares[key] > own
    mixing = bh.PreyModel.fit(rows, **BOTH).conditions.speed.mixing()
    assert mixing.sum(axis=1) == pytest.approx(1)


def test_the_speed_that_it_had_tells_the_next(rows: pd.DataFrame) -> None:
    plain, given = (bh.PreyModel.fit(rows, axes=bh.PreyModel.fit(rows, **BOTH).axes, **kind) for kind in ({}, BOTH))
    fresh = bh.transitions(walkers(6, 60, 9), seen=4, steps=5)
    fresh["scale"] = rows["scale"].iloc[0]
    assert given.log_likelihood(fresh) > plain.log_likelihood(fresh) + 0.2 * len(fresh)


def test_wrong_requests_are_one_line(rows: pd.DataFrame) -> None:
    with pytest.raises(InputError, match="did you mean 'constant_velocity'"):
        bh.PreyModel.fit(rows, residual_of="constant_velocty")
    with pytest.raises(InputError, match="two places or more"):
        bh.PreyModel.fit(rows, **BOTH).futures(np.zeros((3, 1)) + 0j, 5, 8, rng=np.random.default_rng(0))
    with pytest.raises(InputError, match="'speed'"):
        bh.PreyModel.fit(rows, given="mood")
    with pytest.raises(DataError, match="column 'speed' is missing"):
        bh.PreyModel.fit(rows.drop(columns="speed"), given="speed")
    with pytest.raises(DataError, match=r"this model's is 0\.4 s"):
        bh.PreyModel.fit(rows, **BOTH).update(rows.assign(time_step=0.8))
    with pytest.raises(InputError, match="conditions"):
        bh.PreyModel.fit(rows, **BOTH).merge(bh.PreyModel.fit(rows, given="speed"))


def test_spatial_median_and_scores_by_hand() -> None:
    samples = np.array([0, 0, 0, 10 + 0j])[None, :, None] * np.ones((1, 4, 2))
    assert np.abs(spatial_median(samples, axis=1, rounds=30)) == pytest.approx(0, abs=1e-3)
    came = np.array([[1j, 3j]])
    point = sampled_scores(samples[:, :1], came, floor=0.1, area=100)[0]
    assert point[:5].tolist() == pytest.approx([2, 3, 2, 3, 2])
    assert np.isnan(point[5:]).all()
    rng = np.random.default_rng(0)
    cloud = (rng.normal(size=(2, 400, 200, 1)) * np.array([1, 1j]).reshape(2, 1, 1, 1)).sum(axis=0)
    truth = (rng.normal(size=(2, 400, 1)) * np.array([1, 1j]).reshape(2, 1, 1)).sum(axis=0)
    scores = sampled_scores(cloud, truth, floor=0.01, area=1e4).mean(axis=0)
    assert scores[5] == pytest.approx(np.log(2 * np.pi) + 1, abs=0.15)  # entropy of the normal in the plane
    assert scores[6:].tolist() == pytest.approx([0.5, 0.9], abs=0.07)


@pytest.mark.slow
def test_score_prey_is_held_out_and_repeats() -> None:
    tracks = pd.concat([walkers(8, 60, 1), walkers(8, 60, 2).assign(scene="square")], ignore_index=True)
    names = ["stands", "constant_velocity", "constant_velocity_noise", "autoregression", "conditioned"]
    for split in ("individual", "scene", "time"):
        one, two = (bh.score_prey(tracks, names, seen=4, steps=5, split=split, seed=4, most=150) for _ in range(2))
        pd.testing.assert_frame_equal(one, two)
        by = one.set_index("model")
        assert by.loc["conditioned", "energy"] < by.loc["constant_velocity", "energy"]
        assert by.loc["stands", "ade"] > by.loc["conditioned", "ade"]
        assert (by["ade_low"] <= by["ade"]).all()
        assert (by["ade"] <= by["ade_high"]).all()
    with pytest.raises(InputError, match="did you mean 'stands'"):
        bh.score_prey(tracks, ["stand"])
    with pytest.raises(InputError, match="unknown split"):
        bh.score_prey(tracks, ["table"], split="day")
    with pytest.raises(DataError, match="100 places"):
        bh.score_prey(tracks, ["stands"], seen=50, steps=50)


def test_a_fitted_model_is_scored_as_it_is(bayeshunt, tmp_path) -> None:
    from bayeshunt.data import tracks as tracks_file

    tracks_file.save(walkers(6, 50, 1), tmp_path / "a.parquet")
    tracks_file.save(walkers(1, 80, 2), tmp_path / "b.parquet")
    fit = ("prey", "fit", "a.parquet", "--seen", "4", "--steps", "5", "--csv", "cells.csv", "--out", "prey.json")
    out, _ = bayeshunt(*fit)
    assert "transitions of 0.4 s" in out
    cells = pd.read_csv(tmp_path / "cells.csv")
    assert cells["count"].sum() == bh.PreyModel.load(tmp_path / "prey.json").observations
    assert (cells["low"] < cells["probability"]).all()
    out, _ = bayeshunt("prey", "score", "prey.json", "--on", "b.parquet", "--seen", "4", "--steps", "5", "--json")
    table = pd.DataFrame(json.loads(out))
    assert table["model"].tolist() == ["stands", "constant_velocity", "prey.json"]
    bayeshunt("prey", "score", "prey.json", status=2)
    shown, _ = bayeshunt("prey")
    assert "braitenberg" in shown


@pytest.mark.slow
def test_many_transitions_in_bounded_memory(rows: pd.DataFrame) -> None:
    """A million transitions, part by part: tables grow with what is new, not with what is counted."""
    model = bh.PreyModel.fit(rows, **BOTH)
    stored = len(model.conditions.speed.counts), sum(map(len, model.conditions.residual.kept.values()))
    many = pd.concat([rows] * 50, ignore_index=True)
    for _ in range(1_000_000 // len(many)):
        model.update(many)
    assert model.observations > 950_000
    assert (len(model.conditions.speed.counts), sum(map(len, model.conditions.residual.kept.values()))) == stored


def test_a_pause_is_not_a_rest() -> None:
    """Who stands for one step goes on as he went; who has stood for six turns back: one class would mix both."""
    there = [1.0] * 5 + [0.0] + [1.0] * 5 + [0.0] * 6
    places = np.cumsum([step * (-1) ** number for number in range(60) for step in there])
    tracks = pd.DataFrame({"id": 0, "time": np.arange(len(places)) * 0.4, "x": places, "y": 0.0})
    model = bh.PreyModel.fit(bh.transitions(tracks), given="speed")
    paused, rested = [-7, -6, -5, -4, -3, -2, -1, 0, 0], [-2, -1, 0, 0, 0, 0, 0, 0, 0]
    ahead = model.futures(np.array([paused, rested]) + 0j, 1, 400, rng=np.random.default_rng(0))[:, :, 0].real
    assert (ahead[0] > 0.5).mean() > 0.3  # half of the first steps of standing end there
    assert (ahead[0] < -0.5).mean() < 0.05
    assert (ahead[1] < -0.5).mean() > 0.7


def test_classes_of_standing_by_how_long() -> None:
    table = bh.PreyModel.fit(bh.transitions(walkers(3, 30, 2), seen=4, steps=5), given="speed").conditions.speed
    width = 3 * table.axes.distance.width
    assert table.classes([0, 0, 0, 0, 0, 1.5 * width], [1, 2, 3, 5, 9, 0]).tolist() == [0, 40, 41, 42, 43, 1]
    assert table.stood(np.array([[0, 0, 0], [width, 0, 0], [0, np.nan, 0], [0, 0, 2 * width]])).tolist() == [3, 2, 1, 0]


def test_the_few_steps_of_the_prey_itself_count_beside_the_table() -> None:
    """A table of people who all walk straight on, and one who turns by 0.5 every step: six of his and ten of theirs."""
    straight = pd.DataFrame({"id": 0, "time": 0.4 * np.arange(80), "x": 0.505 * np.arange(80), "y": 0.0})
    model = bh.PreyModel.fit(bh.transitions(straight), given="speed")
    turning = np.cumsum(0.505 * np.exp(0.5j * np.arange(8)))[None]
    ahead = model.futures(turning, 1, 40_000, rng=np.random.default_rng(0))[0, :, 0] - turning[0, -1]
    turned = np.angle(ahead * np.exp(-3.5j))
    assert (np.abs(turned - 0.5) < 1e-9).mean() == pytest.approx(6 / 16, abs=0.01)
    assert (np.abs(turned) < 0.03).mean() == pytest.approx(10 / 16, abs=0.01)
    drawn = tuple(np.full(3, value) for value in (0.5, 0.1, 0.1))
    which = np.zeros(3, dtype=np.int64)
    for seen in (turning[:, -2:], turning[:, -1:] * np.ones((1, 8))):  # one step shows no transition, none no direction
        own = OwnSteps(seen, model.conditions.speed, 0.05)
        kept = own.instead(which, which, tuple(part.copy() for part in drawn), rng=np.random.default_rng(0))
        np.testing.assert_array_equal(kept, drawn)


def test_steps_that_were_made_up_are_not_its_own() -> None:
    """Of a prey seen for one step a path is made up that goes straight: that tells nothing of how it goes."""
    rows = bh.transitions(walkers(6, 60, 1), seen=4, steps=5)
    conditions = bh.PreyModel.fit(rows, given="speed").conditions
    path = np.array([[-1.5, -1.0, -0.5, 0.0]]) + 0j
    straight = []
    for made_up in (0, 2):
        drawn = conditions.futures(path, 3, 2000, rng=np.random.default_rng(0), headings=None, made_up=made_up)
        straight.append((np.abs(drawn[0, :, 0] - 0.5) < 1e-9).sum())
    assert straight[0] > 50
    assert straight[1] == 0


def test_who_has_not_moved_faces_where_its_body_does() -> None:
    tracks = walkers(4, 60, 5)
    rows = bh.transitions(tracks, seen=4, steps=5)
    model = bh.PreyModel.fit(rows, **BOTH)
    rest = np.zeros((1, 4), dtype=complex)
    along, up = (
        model.futures(rest, 5, 16, rng=np.random.default_rng(0), headings=np.array([way])) for way in (0.0, np.pi / 2)
    )
    np.testing.assert_allclose(up, 1j * along, atol=1e-12)
    unknown = model.futures(rest, 5, 16, rng=np.random.default_rng(0), headings=np.array([np.nan]))
    np.testing.assert_array_equal(unknown, along)  # the tracks' own x, for want of anything
    assert np.abs(along).max() > 0.1
