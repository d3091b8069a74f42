"""Back-off: tables given the gait before lean on the gait's own, by hand, in any order, finite, and better."""

from __future__ import annotations

import json
from fractions import Fraction

import numpy as np
import pandas as pd
import pytest
from previous_cases import AXES, GAITS, momentum

import bayeshunt as bh
from bayeshunt.core.bins import EFFECTS
from bayeshunt.models.formats.model_file import dumps

FRAME = momentum(200, 3)


def fit(frame: pd.DataFrame, **settings: object) -> bh.ForwardModel:
    return bh.ForwardModel.fit(frame, GAITS, axes=AXES, structure="previous_gait", **{"backoff": 5.0, **settings})


def by_hand(frame: pd.DataFrame, effect: str, label: int, gait: str, before: str, prior: Fraction) -> Fraction:
    """(N(v, g, p) + s P(v | g)) / (N(g, p) + s), P(v | g) = (N(v, g) + a) / (N(g) + K a), as fractions."""
    known = frame[frame["previous_gait"].notna()]
    axis = AXES.extended(4)[effect]
    bins = axis.index(known[effect.lower()].to_numpy())
    own, pair = (known["gait"] == gait).to_numpy(), (known["previous_gait"] == before).to_numpy()
    table = (int((own & (bins == label)).sum()) + prior) / (int(own.sum()) + axis.bins * prior)
    return (int((own & pair & (bins == label)).sum()) + 5 * table) / (int((own & pair).sum()) + 5)


@pytest.mark.parametrize("prior", [Fraction(0), Fraction(3, 100), Fraction(1, 2)])
def test_tables_are_the_fractions(prior: Fraction) -> None:
    model = fit(FRAME, prior=float(prior))
    for before in GAITS:
        part = model.given({"PreviousGait": before})
        for effect in EFFECTS:
            table = part.probabilities(effect)
            expected = [
                [float(by_hand(FRAME, effect, k, gait, before, prior)) for gait in GAITS] for k in range(len(table))
            ]
            np.testing.assert_allclose(table, expected, rtol=1e-13)
            column = model.local_tables[effect][:, :, GAITS.index(before)]
            np.testing.assert_array_equal(column, table)


def test_where_nothing_followed_the_gait_s_own_table_and_pose_stand() -> None:
    frame = FRAME[~((FRAME["previous_gait"] == "b") & (FRAME["gait"] == "c"))]
    model = fit(frame)
    naive = bh.ForwardModel.fit(frame[frame["previous_gait"].notna()], GAITS, 0.03, axes=AXES)
    for effect in EFFECTS:
        np.testing.assert_allclose(
            model.after("b").probabilities(effect)[:, 2], naive.probabilities(effect)[:, 2], rtol=1e-13
        )
    assert model.after("b").predict("c") == model.predict("c")
    assert model.after("b").counts("Angle")["c"].sum() == 0


def test_poses_lean_likewise() -> None:
    model, plain = fit(FRAME), fit(FRAME, backoff=None, prior=0.03)
    pairs = plain.by_previous.pairs
    for p, before in enumerate(GAITS):
        for g, gait in enumerate(GAITS):
            pair, own, n = plain.after(before).predict(gait), plain.predict(gait), pairs[p, g]
            pose = model.after(before).predict(gait)
            for part in ("forward", "right"):
                expected = (n * getattr(pair, part) + 5 * getattr(own, part)) / (n + 5)
                assert getattr(pose, part) == pytest.approx(expected, rel=1e-9)
    assert model.predict("a") == plain.predict("a")


@pytest.mark.parametrize("size", [1, 7, 50])
def test_any_order_and_split_count_alike(size: int) -> None:
    whole = fit(FRAME)
    parts = bh.ForwardModel.from_counts(whole.by_previous, structure="previous_gait", backoff=5.0)
    assert (parts, hash(parts), dumps(parts)) == (whole, hash(whole), dumps(parts))
    first, *others = [FRAME[start : start + size] for start in range(100, len(FRAME), size)]
    grown = fit(FRAME[:100])
    for part in reversed([first, *others]):
        grown = grown.update(part)
    assert grown == whole
    assert dumps(grown) == dumps(whole)
    assert fit(FRAME.sample(frac=1.0, random_state=1)) == whole


def test_the_file_holds_it(tmp_path, worker) -> None:
    model = fit(FRAME, gait_prior="empirical")
    model.save(tmp_path / "m.json")
    assert json.loads((tmp_path / "m.json").read_text())["format"] == 4
    for back in (bh.ForwardModel.load(tmp_path / "m.json"), worker(model)):
        assert back == model
        assert back.backoff == 5.0
        assert back.after("b") == model.after("b")
        np.testing.assert_array_equal(back.after("b").probabilities("Angle"), model.after("b").probabilities("Angle"))
    assert worker(model.after("b")) == model.after("b")
    assert model != fit(FRAME, backoff=6.0, gait_prior="empirical")
    assert json.loads(dumps(fit(FRAME, backoff=None, prior=0.03)))["format"] == 3


def test_intervals_hold_the_probability_and_texts_say_where_it_comes_from() -> None:
    part = fit(FRAME).after("b")
    shown = part.table("Angle")
    assert (shown.low <= shown.probability).to_numpy().all()
    assert (shown.probability <= shown.high).to_numpy().all()
    answer = bh.InverseModel(part).posterior(0.07, 0.0)
    assert "the rest from each gait's own table" in str(answer)
    assert "back-off 5" in repr(fit(FRAME))


def test_held_out_it_beats_both_structures() -> None:
    """The car's momentum carries over: at 2,000 rows each pair of gaits has too few of its own."""
    car = bh.load_robot("car")
    train, test = bh.babble(car, 2000, 0), bh.babble(car, 1000, 1).iloc[1:]
    grid = bh.ForwardModel.fit(pd.concat([train, test]), car.gaits).axes  # they hold every row of both
    score = {}
    for name, settings in {
        "naive": {"prior": 0.03},
        "previous": {"prior": 0.03, "structure": "previous_gait", "backoff": None},
        "backoff": {"structure": "previous_gait"},
    }.items():
        model = bh.ForwardModel.fit(train, car.gaits, axes=grid, **settings)
        score[name] = model.log_likelihood(test) / len(test)
    assert np.isfinite(list(score.values())).all()
    assert score["backoff"] > score["previous"] > score["naive"]
    assert score["backoff"] - score["naive"] > 0.9


@pytest.mark.parametrize("strength", [0, -1, np.nan, np.inf, True, "5", 1e300, 1e-200])
def test_a_strength_that_is_none_is_refused(strength: object) -> None:
    with pytest.raises(bh.InputError, match=r"^backoff is "):
        fit(FRAME, backoff=strength)


def test_only_this_structure_has_a_context() -> None:
    with pytest.raises(bh.InputError, match=r"^backoff is for structure 'previous_gait'"):
        bh.ForwardModel.fit(FRAME, GAITS, axes=AXES, backoff=5.0)


@pytest.mark.parametrize("planner", ["reactive", "prediction", "planning", "intercept"])
def test_planners_hunt_with_it(planner: str) -> None:
    khepera = bh.load_robot("khepera")
    frame = bh.babble(khepera, 300, 0)
    model = bh.ForwardModel.fit(frame, khepera.gaits, structure="previous_gait", backoff=5.0)
    assert len(bh.hunt("paper", bh.make_planner(planner, model), arena="open").frame)


def test_fit_takes_it(tmp_path, bayeshunt) -> None:
    bh.save_dataset(bh.babble("khepera", 300, 0), tmp_path / "b.parquet")
    bayeshunt("fit", "b.parquet", "--structure", "previous_gait", "--backoff", "5", "--out", "m.json")
    model = bh.ForwardModel.load(tmp_path / "m.json")
    assert (model.prior, model.backoff) == (0.03, 5.0)
    _, err = bayeshunt("fit", "b.parquet", "--backoff", "5", "--out", "n.json", status=2)
    assert "previous_gait" in err
