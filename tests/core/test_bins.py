"""Discretisation: bins, labels, seams."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bayeshunt.core.bins import Axis, EffectAxes
from bayeshunt.core.errors import InputError

turn = Axis.full_turn("Angle", 36)


def test_a_bin_is_centred_on_zero():
    assert turn.centres[turn.index(0.0)] == 0.0
    assert turn.index(math.radians(4.9)) == turn.index(math.radians(-4.9)) == turn.index(0.0)
    assert turn.index(math.radians(5.1)) == turn.index(0.0) + 1


def test_both_sides_of_the_seam_share_a_bin():
    assert turn.index(math.pi - 0.01) == turn.index(-math.pi + 0.01)
    assert abs(turn.centres[turn.index(math.pi)]) == pytest.approx(math.pi)


@pytest.mark.parametrize("bins", [1, 2, 5, 36, 37])
@given(angle=st.floats(-10, 10))
def test_every_angle_is_within_half_a_bin_of_its_centre(bins, angle):
    axis = Axis.full_turn("Angle", bins)
    gap = math.remainder(angle - axis.centres[axis.index(angle)], 2 * math.pi)
    assert abs(gap) <= axis.width / 2 + 1e-9


@given(st.lists(st.floats(0, 3), min_size=1))
def test_scalar_and_array_indices_agree(values):
    for axis in (turn, Axis.linear("Distance", 0.0057)):
        assert axis.index(np.array(values)).tolist() == [axis.index(v) for v in values]


@pytest.mark.parametrize("bins", [1, 2, 5, 36, 37])
def test_indices_around_the_whole_turn(bins):
    axis = Axis.full_turn("Angle", bins)
    ends = [math.pi, -math.pi, math.nextafter(-math.pi, 0.0), math.nextafter(math.pi, 0.0)]
    angles = np.array([*np.linspace(-10, 10, 2001), *ends])
    indices = axis.index(angles)
    assert indices.tolist() == [axis.index(angle) for angle in angles.tolist()]
    assert set(indices.tolist()) == set(range(bins))
    assert (np.diff(axis.edges) > 0).all()
    assert axis.edges[0] <= -math.pi + 1e-12, "bins begin at or before the seam and come in order of angle"
    assert axis.index(axis.centres).tolist() == list(range(bins))
    assert 0.0 in axis.centres
    assert ((axis.centres > -math.pi) & (axis.centres <= math.pi)).all()


def test_distance_bins_are_open_ended():
    axis = Axis.linear("Distance", 0.01, 3)
    assert axis.index(0.0) == 0
    assert axis.index(0.999) == 99
    assert axis.extended(5).bins == 5
    assert axis.extended(2) is axis
    assert turn.extended(99) is turn


@pytest.mark.parametrize("axis", [turn, Axis.linear("Distance", 0.0057, 400), Axis.full_turn("Heading", 360)])
def test_labels_are_unique(axis):
    assert len(set(axis.labels)) == axis.bins


def test_labels_are_readable():
    assert Axis.linear("Distance", 0.0057, 2).labels == ("0-5.7 mm", "5.7-11.4 mm")
    assert turn.labels[turn.index(0.0)] == "0 deg"
    assert turn.labels[turn.index(math.radians(-10))] == "-10 deg"


def test_arrays_are_read_only():
    with pytest.raises(ValueError, match="read-only"):
        turn.centres[0] = 1.0


@pytest.mark.parametrize(("width", "bins"), [(0.0, 3), (-1.0, 3), (math.nan, 3), (1.0, 0)])
def test_nonsense_is_refused(width, bins):
    with pytest.raises(InputError):
        Axis("Distance", width, bins)


@pytest.mark.parametrize("bins", [0, -3])
def test_a_turn_without_bins_is_refused(bins):
    with pytest.raises(InputError, match="axis Angle: needs at least one bin"):
        EffectAxes.standard(0.057, angle_bins=bins)


def test_axes_by_name():
    axes = EffectAxes.standard(0.057)
    assert axes["Angle"].bins == 36
    assert axes["Distance"].width == pytest.approx(0.0057)
    with pytest.raises(InputError, match="expected one of Distance, Angle, Heading"):
        axes["Speed"]
