"""The inverse model: which cell answers, what the answer carries, what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from model_cases import babbled, frame_of, random_model, repertoire, small_axes

from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.errors import ImpossibleEvidenceError, InputError, ZeroCountError
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.core.geometry import Polar
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel

AXES = small_axes(1, 36, 8, width=0.1)
FRONT, BESIDE = 18, 27  # angle bins of 0 and 90 degrees

pytestmark = pytest.mark.filterwarnings("ignore:target distance:bayeshunt.DataWarning")  # some ask far beyond it


@pytest.fixture
def three_cells() -> InverseModel:
    """Cells at 0.25 m ahead, 0.25 m to the right and 0.05 m ahead, one gait each."""
    cells = [("far", 2, FRONT, 4), ("right", 2, BESIDE, 6), ("near", 0, FRONT, 4)]
    return InverseModel(ForwardModel.fit(frame_of(cells, AXES), ["far", "right", "near"], axes=AXES))


def test_an_answer_carries_its_evidence(three_cells: InverseModel) -> None:
    answer = three_cells.posterior(0.27, 0.05)
    assert answer.best == "far"
    assert answer.probabilities.index.name == "Gait"
    assert answer.probabilities.to_dict() == {"far": 1.0, "right": 0.0, "near": 0.0}
    assert (answer.support, answer.snapped) == (1, False)
    assert answer.evidence == {"Distance": "200-300 mm", "Angle": "0 deg"}
    assert answer.target == Polar(0.27, 0.05, None)
    assert (answer.cell.distance_bin, answer.cell.angle_bin) == (2, FRONT)
    assert (answer.cell.distance, answer.cell.angle) == (pytest.approx(0.25), 0.0)
    assert answer.cell.heading_bin is None
    with pytest.raises(ValueError, match="read-only"):
        answer.values[0] = 0.0


def test_evidence_probability_by_hand(three_cells: InverseModel) -> None:
    # P(far) P(D=2 | far) P(A=front | far) = 1/3; "right" and "near" miss one of the two.
    answer = three_cells.posterior(0.25, 0.0)
    assert answer.evidence_probability == pytest.approx(1 / 3, abs=1e-15)
    assert answer.values.tolist() == [1.0, 0.0, 0.0]


def test_an_answer_says_how_far_it_is_from_what_was_asked(three_cells: InverseModel) -> None:
    own = three_cells.posterior(0.27, 0.0)
    assert (own.missed_by, own.beyond, own.heading_gap) == ("", False, None)
    assert own.gap == pytest.approx(0.02)
    far = three_cells.posterior(16, 0.0)
    assert (far.gap, far.farthest) == (pytest.approx(15.75), pytest.approx(0.3))
    assert (far.asked, far.missed_by, far.beyond) == ("16 m, 0°", "15.8 m away", True)
    assert ", for 16 m, 0° (15.8 m off); 1 row>" in repr(far)
    assert repr(own).endswith("Angle 0°; 1 row>")
    near = three_cells.posterior(0.1, math.pi / 2)  # its own bin was never reached, though it is near enough
    assert (near.gap, near.beyond) == (pytest.approx(math.hypot(0.1, 0.05)), False)
    turned = three_cells.posterior(0.25, -0.0, math.radians(112))  # learned there: heading 0 alone
    assert turned.asked == "250 mm, 0°, heading 112°"
    assert turned.missed_by == "heading 112° off"  # and not "away": the place is the one asked for
    assert ", for 250 mm, 0°, 112° (heading 112° off)" in repr(turned)
    assert turned.heading_gap == pytest.approx(math.radians(112))
    assert three_cells.posterior(0.299, 0.0).beyond is False
    assert three_cells.posterior(0.301, 0.0).beyond is True


def test_angles_are_wrapped_and_degrees_refused(three_cells: InverseModel) -> None:
    turned = three_cells.posterior(0.25, 4 * math.pi, -2 * math.pi)
    assert (turned.best, turned.snapped) == ("far", False)
    for angle, heading in ((200 * math.pi, 0.0), (0.0, 100 * math.pi), (90.0, None)):
        with pytest.raises(InputError, match="expected radians from -4 pi to 4 pi"):
            three_cells.posterior(0.25, angle, heading)


def test_nearest_is_cartesian(three_cells: InverseModel) -> None:
    # 0.1 m at 90 degrees: in bins "right" is 2 away and "near" 9; in metres "near" is 0.112, "right" 0.15.
    answer = three_cells.posterior(0.1, math.pi / 2)
    assert answer.snapped
    assert answer.best == "near"
    assert three_cells.posterior(5.0, math.radians(50)).best == "right"
    assert three_cells.posterior(5.0, math.radians(40)).best == "far"
    assert three_cells.posterior(0.1, math.pi).best == "near"
    assert three_cells.posterior(5.0, math.pi).best == "right"


def test_own_cell_wins_over_a_nearer_centre() -> None:
    # The target lies in a wide far cell, yet the centre of another learned cell is nearer.
    axes = small_axes(1, 4, 1, width=0.5)
    frame = frame_of([("wide", 1, 2, 0), ("side", 1, 3, 0)], axes)
    inverse = InverseModel(ForwardModel.fit(frame, ["wide", "side"], axes=axes))
    target = (0.99, math.radians(44.9))
    assert inverse.posterior(*target).best == "wide"
    assert not inverse.posterior(*target).snapped
    assert inverse.posterior(*target).values.tolist() == inverse.posterior_many(*target)[0].tolist()


def test_ties_go_to_the_first() -> None:
    cells = [("b", 1, FRONT + 3, 0), ("a", 1, FRONT - 3, 0)]
    inverse = InverseModel(ForwardModel.fit(frame_of(cells, AXES), ["a", "b"], axes=AXES))
    # Dead ahead both centres are equally near at any distance: the lower angle bin answers.
    for distance in (0.0, 0.05, 0.15, 0.7, 3.0, 1e4):
        assert inverse.posterior(distance, 0.0).best == "a"
        assert inverse.posterior_many([distance], [0.0])[0].tolist() == [1.0, 0.0]
    same = InverseModel(ForwardModel.fit(frame_of([("a", 0, 0, 0), ("b", 0, 0, 0)], AXES), ["b", "a"], axes=AXES))
    assert same.posterior(0.05, math.pi).best == "b"


@settings(max_examples=150)
@given(
    seed=st.integers(0, 40),
    targets=st.lists(
        st.tuples(st.floats(0.0, 3.0) | st.floats(0.0, 1e9), st.floats(-10.0, 10.0)), min_size=1, max_size=20
    ),
)
def test_the_cell_used_is_own_or_nearest(seed: int, targets: list[tuple[float, float]]) -> None:
    inverse = InverseModel(random_model(seed))
    axes, table = inverse.model.axes, inverse.table()
    centres = table["distance"].to_numpy() * np.exp(1j * table["angle"].to_numpy())
    for distance, angle in targets:
        answer = inverse.posterior(distance, angle)
        own = axes.distance.index(distance), axes.angle.index(angle)
        learned = own[0] < axes.distance.bins and inverse.model.joint.support[own] > 0
        assert answer.snapped == (not learned)
        if learned:
            assert (answer.cell.distance_bin, answer.cell.angle_bin) == own
            continue
        gaps = np.abs(centres - distance * np.exp(1j * angle))
        used = abs(answer.cell.distance * np.exp(1j * answer.cell.angle) - distance * np.exp(1j * angle))
        assert used <= gaps.min() + 1e-9 * (1.0 + distance)


def test_many_answers_equal_single_answers(inverse: InverseModel) -> None:
    rng = np.random.default_rng(5)
    distances = np.r_[rng.uniform(0.0, 0.3, 3000), rng.exponential(2.0, 500), 10 ** rng.uniform(-9, 11, 300), 0.0]
    angles = rng.uniform(-9.0, 9.0, len(distances))
    angles[::5] = np.round(angles[::5] / math.radians(5)) * math.radians(5)  # on the edges and centres of bins
    angles[1:4] = math.pi, -math.pi, np.nextafter(-math.pi, 0.0)
    values = inverse.posterior_many(distances, angles)
    singles = [inverse.posterior(d, a).values for d, a in zip(distances, angles, strict=True)]
    assert values.shape == (len(distances), 5)
    assert np.array_equal(values, np.array(singles))
    # A fresh model that is asked for many first gives the same.
    assert np.array_equal(InverseModel(inverse.model).posterior_many(distances, angles), values)
    assert np.array_equal(inverse.posterior_many(0.1, angles[:4]), inverse.posterior_many([0.1] * 4, angles[:4]))
    assert inverse.posterior_many([], []).shape == (0, 5)


@pytest.mark.parametrize("bins", [1, 2, 7, 36])
def test_any_number_of_angle_bins(bins: int) -> None:
    axes = EffectAxes.standard(0.057, angle_bins=bins, heading_bins=3, distance_bin=0.5)
    inverse = InverseModel(ForwardModel.fit(babbled(200, seed=bins), repertoire(), axes=axes))
    rng = np.random.default_rng(bins)
    distances, angles = rng.uniform(0, 0.5, 2000), rng.uniform(-math.pi, math.pi, 2000)
    values = inverse.posterior_many(distances, angles)
    table = inverse.table()
    centres = table["distance"].to_numpy() * np.exp(1j * table["angle"].to_numpy())
    for d, a, row in zip(distances, angles, values, strict=True):
        answer = inverse.posterior(d, a)
        assert np.array_equal(answer.values, row)
        own = axes.distance.index(d), axes.angle.index(a)
        if answer.snapped:
            best = np.argmin(np.abs(centres - d * np.exp(1j * a)))
            assert (answer.cell.distance, answer.cell.angle) == (table["distance"][best], table["angle"][best])
        else:
            assert (answer.cell.distance_bin, answer.cell.angle_bin) == own


def test_heading_narrows_the_answer(model: ForwardModel, inverse: InverseModel) -> None:
    plain = inverse.posterior(0.19, 0.0)
    headed = inverse.posterior(0.19, 0.0, 0.0)
    assert headed.cell.heading_label == "0 deg"
    assert headed.evidence == {**plain.evidence, "Heading": "0 deg"}
    assert headed.evidence_probability < plain.evidence_probability
    assert headed.support <= plain.support
    p = model.probabilities("Heading")[headed.cell.heading_bin]
    np.testing.assert_allclose(headed.values, plain.values * p / (plain.values * p).sum(), atol=1e-15)


def test_impossible_heading_snaps_to_the_nearest_possible() -> None:
    cells = [("a", 1, FRONT, 1), ("a", 1, FRONT, 7), ("b", 0, FRONT, 4)]
    inverse = InverseModel(ForwardModel.fit(frame_of(cells, AXES), ["a", "b"], axes=AXES))
    headings = AXES.heading.centres
    assert not inverse.posterior(0.15, 0.0, headings[1]).snapped
    near = inverse.posterior(0.15, 0.0, headings[0])  # between bins 7 and 1, across the seam: a tie
    assert (near.cell.heading_bin, near.snapped) == (1, True)
    assert inverse.posterior(0.15, 0.0, headings[0] - 0.1).cell.heading_bin == 7
    assert near.support == 1
    with pytest.raises(ImpossibleEvidenceError, match="Heading = "):
        inverse.posterior(0.15, 0.0, headings[0], snap=False)


def test_impossible_evidence_is_typed(three_cells: InverseModel) -> None:
    with pytest.raises(ImpossibleEvidenceError, match=r"Distance = 0\.25 m, Angle = -90°"):
        three_cells.posterior(0.25, -math.pi / 2, snap=False)
    with pytest.raises(ImpossibleEvidenceError, match="Distance = 9 m"):
        three_cells.posterior(9.0, 0.0, snap=False)
    assert three_cells.posterior(0.25, 0.0, snap=False).best == "far"


def test_unseen_but_possible_cell_answers_without_snapping() -> None:
    cells = [("a", 0, FRONT, 0), ("a", 1, BESIDE, 0), ("b", 0, BESIDE, 0)]
    inverse = InverseModel(ForwardModel.fit(frame_of(cells, AXES), ["a", "b"], axes=AXES))
    answer = inverse.posterior(0.15, 0.0, snap=False)  # naive Bayes: a reaches bin 1, and reaches ahead
    assert (answer.support, answer.snapped) == (0, False)
    assert answer.evidence_probability == pytest.approx(0.5 * 0.5 * 0.5)
    assert inverse.posterior(0.15, 0.0).snapped


@pytest.mark.parametrize(
    "target", [(math.nan, 0.0), (-0.01, 0.0), (math.inf, 0.0), (0.1, math.nan), (0.1, math.inf), (0.1, 0.0, math.nan)]
)
def test_bad_numbers(inverse: InverseModel, target: tuple[float, ...]) -> None:
    for snap in (True, False):
        with pytest.raises(InputError, match="target"):
            inverse.posterior(*target, snap=snap)
    if len(target) == 2:
        with pytest.raises(InputError, match="targets"):
            inverse.posterior_many([0.1, target[0]], [0.1, target[1]])


def test_angles_are_wrapped(inverse: InverseModel) -> None:
    for angle in (0.2, 3.5, 6.0):
        answer = inverse.posterior(0.15, angle - 2 * math.pi)
        assert answer.cell == inverse.posterior(0.15, angle).cell


def test_table_lists_every_learned_cell(inverse: InverseModel) -> None:
    table = inverse.table()
    assert len(table) == np.count_nonzero(inverse.model.joint.support)
    assert table["support"].sum() == inverse.model.joint.total
    np.testing.assert_allclose(table[list(inverse.model.gaits.names)].sum(axis=1), 1.0, atol=1e-12)
    row = table.iloc[3]
    answer = inverse.posterior(row["distance"], row["angle"])
    assert answer.evidence_probability == row["evidence_probability"]
    assert answer.values.tolist() == row[list(inverse.model.gaits.names)].tolist()


def test_empty_model_has_no_inverse() -> None:
    with pytest.raises(ZeroCountError, match="counted nothing"):
        InverseModel(ForwardModel.empty(GaitRepertoire.of(["a"], body_length=0.05), 1.0))


def test_a_copy_from_another_process_answers_the_same(inverse: InverseModel, worker) -> None:
    twin = worker(inverse)
    assert twin.posterior(0.4, 1.0).values.tolist() == inverse.posterior(0.4, 1.0).values.tolist()
