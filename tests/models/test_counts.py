"""Exact counts: whatever the order, the split or the tally, the same bits."""

from __future__ import annotations

import itertools

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from model_cases import babbled, frame_of, repertoire, small_axes

from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.errors import DataError, InputError, ZeroCountError
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.counting import cells, tally
from bayeshunt.models.counting.joint import JointCounts

NAMES = ["a", "b", "c"]
AXES = small_axes(1, 5, 6)
GAITS = GaitRepertoire.of(NAMES)

rows_ = st.lists(
    st.tuples(
        st.sampled_from(NAMES),
        st.floats(0.0, 0.9),
        st.floats(-3.2, 3.2),
        st.floats(-3.2, 3.2),
        st.floats(-0.5, 0.5),
    ),
    min_size=1,
    max_size=30,
)


def table(rows: list[tuple]) -> pd.DataFrame:
    frame = pd.DataFrame(rows, columns=["gait", "distance", "angle", "heading", "path_01_forward"])
    return frame.assign(path_01_right=frame["path_01_forward"] / 3, path_01_heading=frame["heading"] / 2)


def test_cells_and_counts_by_hand() -> None:
    cells = [("b", 2, 1, 3), ("a", 0, 4, 0), ("b", 2, 1, 3), ("b", 0, 0, 5)]
    joint = JointCounts.of(frame_of(cells, AXES), GAITS, AXES)
    assert joint.cells.tolist() == [[0, 0, 4, 0], [1, 0, 0, 5], [1, 2, 1, 3]]
    assert joint.counts.tolist() == [1, 1, 2]
    assert joint.axes.distance.bins == 3
    assert joint.marginal("Gait").tolist() == [1, 3, 0]
    assert joint.marginal("Distance").tolist() == [[1, 1, 0], [0, 0, 0], [0, 2, 0]]
    assert joint.support[2, 1] == 2
    assert joint.support.sum() == 4


@settings(max_examples=60)
@given(rows=rows_, seed=st.integers(0, 2**32 - 1))
def test_order_of_observations_changes_nothing(rows: list[tuple], seed: int) -> None:
    frame = table(rows)
    shuffled = frame.iloc[np.random.default_rng(seed).permutation(len(frame))]
    assert JointCounts.of(frame, GAITS, AXES) == JointCounts.of(shuffled, GAITS, AXES)


@settings(max_examples=60)
@given(rows=rows_, cuts=st.lists(st.integers(0, 30), max_size=4))
def test_any_split_merges_to_the_batch(rows: list[tuple], cuts: list[int]) -> None:
    frame = table(rows)
    merged = JointCounts.empty(GAITS, AXES)
    edges = [0, *sorted(c for c in cuts if c < len(frame)), len(frame)]
    for low, high in itertools.pairwise(edges):
        if low < high:
            merged = merged.merge(JointCounts.of(frame.iloc[low:high], GAITS, AXES))
    assert merged == JointCounts.of(frame, GAITS, AXES)


def test_dense_and_sorted_tally_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    frame, axes = babbled(500, seed=3), EffectAxes.standard(0.057)
    monkeypatch.setattr(cells, "_DENSE_CELLS_PER_ROW", 1 << 23)
    dense = JointCounts.of(frame, repertoire(), axes)
    monkeypatch.setattr(cells, "_DENSE_CELLS_PER_ROW", 0)
    assert JointCounts.of(frame, repertoire(), axes) == dense


@pytest.mark.parametrize("part_rows", [1, 7, 499, 500])
def test_parts_and_threads_change_no_bit(monkeypatch: pytest.MonkeyPatch, part_rows: int) -> None:
    frame, axes = babbled(500, seed=3, points=2), EffectAxes.standard(0.057)
    whole = JointCounts.of(frame, repertoire(), axes)
    monkeypatch.setattr(tally, "_PART_ROWS", part_rows)
    for kind in ("str", "object", "category"):
        assert JointCounts.of(frame.astype({"gait": kind}), repertoire(), axes) == whole


def test_parts_name_rows_of_the_whole_table(monkeypatch: pytest.MonkeyPatch) -> None:
    frame = babbled(50, seed=1)
    frame.loc[frame.index >= 37, "gait"] = "moonwalk"
    monkeypatch.setattr(tally, "_PART_ROWS", 10)
    with pytest.raises(DataError, match="row 37: gait 'moonwalk'"):
        JointCounts.of(frame, repertoire(), EffectAxes.standard(0.057))


def test_parts_do_not_hide_sums_that_could_overflow(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each part alone would pass: 50 rows of 1e8 m are 5e18 nm, more than 2^62; 10 rows are not."""
    frame = babbled(50, seed=1, points=1).assign(path_01_forward=1e8)
    monkeypatch.setattr(tally, "_PART_ROWS", 10)
    with pytest.raises(DataError, match="too far for exact sums"):
        JointCounts.of(frame, repertoire(), EffectAxes.standard(0.057))


def test_a_negative_distance_is_refused_not_counted() -> None:
    frame = babbled(20, seed=1)
    frame.loc[7, "distance"] = -0.1
    with pytest.raises(DataError, match="row 7: distance"):
        JointCounts.of(frame, repertoire(), EffectAxes.standard(0.057))


def test_mean_poses_are_the_means_of_the_rows() -> None:
    frame = babbled(300, seed=4, points=2)
    joint = JointCounts.of(frame, repertoire(), EffectAxes.standard(0.057))
    for index, name in enumerate(repertoire().names):
        rows = frame[frame["gait"] == name]
        poses = joint.mean_poses(index)
        assert poses.shape == (3, 3)
        assert poses[0, 0] == pytest.approx(rows["path_01_forward"].mean(), abs=1e-9)
        assert poses[2, 1] == pytest.approx((rows["distance"] * np.sin(rows["angle"])).mean(), abs=1e-9)
        vector = np.exp(1j * rows["heading"]).mean()
        assert poses[2, 2] == pytest.approx(np.angle(vector), abs=1e-8)


def test_gait_without_rows_has_no_mean() -> None:
    joint = JointCounts.of(frame_of([("a", 0, 0, 0)], AXES), GAITS, AXES)
    with pytest.raises(ZeroCountError, match="'b' has no rows"):
        joint.mean_poses(1)


def test_counts_of_other_gaits_or_bins_do_not_merge() -> None:
    joint = JointCounts.of(frame_of([("a", 0, 0, 0)], AXES), GAITS, AXES)
    with pytest.raises(InputError, match="different gaits"):
        joint.merge(JointCounts.empty(GaitRepertoire.of(["a", "b"]), AXES))
    with pytest.raises(InputError, match="different bins"):
        joint.merge(JointCounts.empty(GAITS, small_axes(1, 6, 6)))


def test_rows_with_and_without_paths_do_not_mix() -> None:
    model = ForwardModel.fit(babbled(50, seed=1, points=2), repertoire())
    with pytest.raises(DataError, match="part-way poses"):
        model.update(babbled(50, seed=2))


def test_an_absurd_distance_is_refused_not_tabulated() -> None:
    frame = babbled(20, seed=1)
    frame.loc[7, "distance"] = 1e9
    with pytest.raises(DataError, match="row 7: distance"):
        JointCounts.of(frame, repertoire(), EffectAxes.standard(0.057))


def test_arrays_stay_read_only_when_sent_to_another_process(worker) -> None:
    joint = JointCounts.of(babbled(30, seed=1), repertoire(), EffectAxes.standard(0.057))
    twin = worker(joint)
    assert twin == joint
    for array in (twin.cells, twin.counts, twin.sums):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
