"""Laws of poses and egocentric coordinates."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bayeshunt.core.geometry import Polar, Pose, wrap

metres = st.floats(-5, 5)
radians = st.floats(-20, 20)
poses = st.builds(Pose, metres, metres, radians)
polars = st.builds(Polar, st.floats(0.001, 5), radians, radians)


def same_angle(a, b, tolerance=1e-9):
    return abs(wrap(float(a - b))) < tolerance


@given(radians)
def test_wrap_stays_in_the_half_open_turn_and_keeps_the_direction(angle):
    wrapped = wrap(angle)
    assert -math.pi < wrapped <= math.pi
    assert math.isclose(math.cos(wrapped), math.cos(angle), abs_tol=1e-9)
    assert math.isclose(math.sin(wrapped), math.sin(angle), abs_tol=1e-9)


def test_wrap_ends():
    assert wrap(math.pi) == math.pi
    assert wrap(-math.pi) == math.pi


def test_what_is_not_known_stays_unknown():
    assert math.isnan(wrap(math.nan))
    np.testing.assert_array_equal(wrap(np.array([math.nan, 4.0])), [math.nan, 4.0 - 2 * math.pi])
    seen = Polar.from_cartesian(0.3, 0.4, math.nan)
    assert (seen.distance, math.isnan(seen.heading)) == (0.5, True)
    assert math.isnan(Pose(0.0, 0.0, 1.0).compose(seen).theta)
    assert wrap(np.nextafter(-math.pi, -4)) <= math.pi
    np.testing.assert_array_equal(wrap(np.array([-math.pi, math.pi, 0.0])), [math.pi, math.pi, 0.0])


@given(radians)
def test_wrap_of_a_float_equals_wrap_of_an_array(angle):
    assert wrap(angle) == wrap(np.array([angle]))[0]


def test_angles_are_clockwise():
    robot = Pose(0.0, 0.0, math.pi / 2)  # faces along y
    seen = robot.relative(Pose(1.0, 0.0, 0.0))  # a thing to its right that faces right
    assert seen.distance == pytest.approx(1.0)
    assert seen.angle == pytest.approx(math.pi / 2)
    assert seen.heading == pytest.approx(math.pi / 2)
    assert seen.right == pytest.approx(1.0)
    assert seen.forward == pytest.approx(0.0, abs=1e-12)


@given(poses, poses)
def test_composing_what_was_seen_gives_it_back(p, q):
    r = p.compose(p.relative(q))
    assert math.isclose(r.x, q.x, abs_tol=1e-9)
    assert math.isclose(r.y, q.y, abs_tol=1e-9)
    assert same_angle(r.theta, q.theta)


@given(poses, polars, polars)
def test_composition_is_associative(p, a, b):
    left, right = p.compose(a).compose(b), p.compose(a.compose(b))
    assert math.isclose(left.x, right.x, abs_tol=1e-9)
    assert math.isclose(left.y, right.y, abs_tol=1e-9)
    assert same_angle(left.theta, right.theta)


@given(polars, polars)
def test_seen_from_undoes_compose(a, b):
    back = a.compose(b).seen_from(a)
    assert math.isclose(back.distance, b.distance, abs_tol=1e-9)
    assert same_angle(back.angle, b.angle, 1e-6)
    assert same_angle(back.heading, b.heading)


@given(poses, poses, polars, polars)
def test_every_angle_stays_in_the_half_open_turn(p, q, a, b):
    cartesian = Polar.from_cartesian(0.3, -0.2, a.heading)
    for seen in (p.relative(q), a.compose(b), a.seen_from(b), cartesian):
        assert -math.pi < seen.angle <= math.pi
        assert -math.pi < seen.heading <= math.pi
    assert -math.pi < p.compose(a).theta <= math.pi
    assert same_angle(cartesian.heading, a.heading)


def test_arrays_broadcast_like_scalars():
    rng = np.random.default_rng(1)
    x, y, t = rng.uniform(-2, 2, (3, 50))
    seen = Pose(0.1, -0.2, 0.7).relative(Pose(x, y, t))
    for i in range(50):
        one = Pose(0.1, -0.2, 0.7).relative(Pose(x[i], y[i], t[i]))
        np.testing.assert_allclose([seen.distance[i], seen.angle[i], seen.heading[i]], one, atol=1e-12)


def test_a_pose_is_shown_in_plain_numbers():
    assert repr(Polar(np.float64(0.19), 0.5, None)) == "Polar(distance=0.19, angle=0.5, heading=None)"
    assert repr(Pose(np.float32(0.5), 1, np.float64(-0.25))) == "Pose(x=0.5, y=1, theta=-0.25)"
    assert "array(" in repr(Polar(np.zeros(2), 0.0, 0.0))


@given(*[st.floats(allow_nan=True, allow_infinity=True)] * 2)
def test_a_distance_is_that_of_numpy_to_the_last_bit(dx, dy):
    with np.errstate(over="ignore"):
        seen, expected = Pose(0.0, 0.0, 0.0).relative(Pose(dx, dy, 0.0)), np.hypot(dx, dy)
    assert type(seen.distance) is np.float64
    np.testing.assert_array_equal(seen.distance, expected)
