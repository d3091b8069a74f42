"""The rows behind a cell: as many as the count says, for every cell; clear words where there are none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from model_cases import babbled, repertoire

import bayeshunt as bh

EFFECTS = ("Distance", "Angle", "Heading")


def check_every_cell(model: bh.ForwardModel) -> None:
    """Every cell of every table: as many rows as counted, each of them in the cell."""
    for variable in EFFECTS:
        counts, axis = model.counts(variable), model.axes[variable]
        for index, label in enumerate(counts.index):
            for gait in counts.columns:
                rows = model.rows(variable, label, gait)
                assert len(rows) == counts.loc[label, gait]
                assert (rows["gait"] == gait).all()
                assert np.all(axis.index(rows[variable.lower()].to_numpy(dtype=float)) == index)
    for gait, count in model.counts("Gait")["count"].items():
        assert len(model.rows("Gait", gait)) == count


def test_rows_equal_counts_for_every_cell(model) -> None:
    check_every_cell(model)


@settings(max_examples=15)
@given(seed=st.integers(0, 10**6), rows=st.integers(5, 60))
def test_rows_equal_counts_on_random_tables(seed: int, rows: int) -> None:
    axes = bh.EffectAxes.standard(0.057, angle_bins=7, heading_bins=5)
    check_every_cell(bh.ForwardModel.fit(babbled(rows, seed), repertoire(), prior=1.0, axes=axes))


def test_rows_of_an_updated_model_come_from_both_tables() -> None:
    first, second = babbled(60, seed=1), babbled(40, seed=2)
    model = bh.ForwardModel.fit(first, repertoire()).update(second)
    check_every_cell(model)
    straight = model.rows("Gait", "straight")
    assert len(straight) == (first["gait"] == "straight").sum() + (second["gait"] == "straight").sum()


def test_all_gaits_and_bins_by_number(model) -> None:
    label = model.counts("Angle").index[18]
    rows = model.rows("Angle", 18)
    assert len(rows) == model.counts("Angle").loc[label].sum()
    pd.testing.assert_frame_equal(rows, model.rows("Angle", label))
    pd.testing.assert_frame_equal(model.rows("Angle", 18, model.gaits[0]), model.rows("Angle", 18, "straight"))


def test_rows_are_the_callers_own_rows(frame, model) -> None:
    rows = model.rows("Gait", "slow")
    pd.testing.assert_frame_equal(rows, frame[frame["gait"] == "slow"])
    rows["distance"] = -1.0
    assert (model.rows("Gait", "slow")["distance"] >= 0).all()


def test_a_loaded_model_says_how_to_get_its_rows(frame, model, tmp_path: Path) -> None:
    model.save(tmp_path / "model.json")
    loaded = bh.ForwardModel.load(tmp_path / "model.json")
    with pytest.raises(bh.DataError, match=r"model\.with_data\(frame\)"):
        loaded.rows("Gait", "slow")
    assert loaded.with_data(frame) == loaded
    check_every_cell(loaded.with_data(frame))
    shuffled = frame.sample(frac=1.0, random_state=3)
    assert len(loaded.with_data(shuffled).rows("Gait", "slow")) == len(model.rows("Gait", "slow"))


def test_other_rows_are_refused(frame, model) -> None:
    with pytest.raises(bh.DataError, match="counted 800 rows, but 799 are here"):
        model.with_data(frame.iloc[1:])
    with pytest.raises(bh.DataError, match="not the rows that the model counted"):
        model.with_data(frame.assign(angle=frame["angle"].to_numpy()[::-1]))
    with pytest.raises(bh.DataError, match="column 'angle' is missing"):
        model.with_data(frame.drop(columns="angle"))


def test_rows_changed_after_the_fit_are_noticed() -> None:
    frame = babbled(50, seed=4)
    model = bh.ForwardModel.fit(frame, repertoire())
    frame["distance"] = frame["distance"] * 3
    with pytest.raises(bh.DataError, match="not the rows"):
        model.rows("Gait", "slow")


def test_models_travel_without_their_rows(model, worker) -> None:
    arrived = worker(model)
    assert arrived == model
    assert not arrived.data


@pytest.mark.parametrize(
    ("place", "says"),
    [
        (("Speed", 0), "unknown variable 'Speed'"),
        (("Angle", "17 deg"), "Angle has no bin '17 deg'"),
        (("Angle", 36), "from 0 to 35"),
        (("Angle", True), "expected a label of Angle"),
        (("Angle", 0, "fly"), "unknown gait 'fly'"),
        (("Gait", "fly"), "unknown gait 'fly'"),
    ],
)
def test_wrong_cells_are_refused(model, place: tuple, says: str) -> None:
    with pytest.raises(bh.InputError, match=says):
        model.rows(*place)
