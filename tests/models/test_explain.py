"""What each variable said: parts that add up to the log-odds, on random networks and by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from model_cases import frame_of, random_model, small_axes

import bayeshunt as bh
from bayeshunt.models.body.explain import PARTS

EFFECTS = ("Distance", "Angle", "Heading")


def check_sums(answer, frame) -> None:
    """The parts of every row add up to its log-odds, which are those of the posterior."""
    total = frame[list(PARTS)].sum(axis=1).to_numpy()
    odds = frame["log_odds"].to_numpy()
    finite = np.isfinite(odds)
    assert np.array_equal(total[~finite], odds[~finite])
    np.testing.assert_allclose(total[finite], odds[finite], rtol=0, atol=1e-9)
    position = {name: i for i, name in enumerate(frame.index)}
    for gait, row in frame.iterrows():
        ours, theirs = answer.values[position[gait]], answer.values[position[row["reference"]]]
        if ours > 0 and theirs > 0:
            assert row["log_odds"] == pytest.approx(math.log(ours / theirs), abs=1e-9)
        elif gait != row["reference"]:
            assert row["log_odds"] == (math.inf if ours > 0 else -math.inf)
    assert not frame.isna().any().any()


@settings(max_examples=150)
@given(seed=st.integers(0, 10**6), distance=st.floats(0, 1), angle=st.floats(-3, 3), heading=st.floats(-3, 3))
def test_parts_add_up_on_random_networks(seed: int, distance: float, angle: float, heading: float) -> None:
    model = random_model(seed)
    inverse = bh.InverseModel(model)
    for turn in (None, heading):
        answer = inverse.posterior(distance, angle, turn)
        if len(model.gaits) == 1:
            with pytest.raises(bh.InputError, match="only one gait"):
                answer.explain()
            continue
        check_sums(answer, answer.explain())
        check_sums(answer, answer.explain(answer.best))


@pytest.mark.parametrize("structure", ["tan", "joint", "learned"])
def test_parts_add_up_in_other_structures(khepera_frame, khepera_model, structure: str) -> None:
    model = bh.ForwardModel.fit(khepera_frame, khepera_model.gaits, prior=0.3, structure=structure)
    for target in [(0.15, 0.4), (0.1, 0.0, 0.2), (0.03, 2.0), (0.5, -2.0, 1.0)]:
        answer = bh.InverseModel(model).posterior(*target)
        check_sums(answer, answer.explain())


@pytest.fixture
def by_hand() -> bh.ForwardModel:
    """Two gaits in two distance bins, straight ahead: a was seen 3 + 1 times, b 1 + 1 times."""
    axes = small_axes(2, 4, 4)
    cells = [("a", 0, 2, 2)] * 3 + [("a", 1, 2, 2)] + [("b", 0, 2, 2), ("b", 1, 2, 3)]
    return bh.ForwardModel.fit(frame_of(cells, axes), ["a", "b"], axes=axes, gait_prior="empirical")


def test_parts_by_hand(by_hand) -> None:
    frame = bh.InverseModel(by_hand).posterior(0.05, 0.0, 0.0).explain()
    # P(a) = 4/6, P(near | a) = 3/4, P(near | b) = 1/2; straight ahead both; P(heading 0 | b) = 1/2.
    assert list(frame.loc["a", ["prior", "Distance", "Angle", "Heading"]]) == pytest.approx(
        [math.log(2), math.log(1.5), 0.0, math.log(2)]
    )
    assert frame.loc["a", "log_odds"] == pytest.approx(math.log(6))
    assert list(frame["reference"]) == ["b", "a"]
    assert frame.loc["b", "log_odds"] == -frame.loc["a", "log_odds"]


def test_a_heading_that_was_not_asked_says_nothing(by_hand) -> None:
    frame = bh.InverseModel(by_hand).posterior(0.05, 0.0).explain()
    assert list(frame["Heading"]) == [0.0, 0.0]
    assert list(frame.columns) == ["probability", "reference", *PARTS, "log_odds"]


def test_what_was_never_seen_is_minus_infinity(by_hand) -> None:
    answer = bh.InverseModel(by_hand).posterior(0.15, 0.0, math.pi / 2)
    frame = answer.explain()
    assert answer.best == "b"
    assert frame.loc["a", "Heading"] == -math.inf
    assert frame.loc["a", "log_odds"] == -math.inf
    assert frame.loc["b", "log_odds"] == math.inf
    with pytest.raises(bh.InputError, match="'a' has probability 0"):
        answer.explain("a")


def test_the_rival_of_the_only_possible_gait_is_the_one_least_ruled_out() -> None:
    axes = small_axes(3, 4, 4)
    cells = [("far", 2, 0, 2), ("best", 0, 2, 2), ("near", 0, 1, 2)]
    model = bh.ForwardModel.fit(frame_of(cells, axes), ["far", "best", "near"], axes=axes)
    frame = bh.InverseModel(model).posterior(0.05, 0.0).explain()
    assert list(frame["reference"]) == ["best", "near", "best"]


def test_unknown_references_are_refused(by_hand) -> None:
    with pytest.raises(bh.InputError, match="unknown gait 'c'"):
        bh.InverseModel(by_hand).posterior(0.05, 0.0).explain("c")
