"""What is estimated beyond the lookahead, against a second writing of it: one hunter, one future, one leg at a time."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from bayeshunt.core.geometry import wrap
from bayeshunt.planners.interception.futures import Futures
from bayeshunt.planners.interception.homing import Homing

TOP, REACH, PRICE = 0.06, 0.058, 2.5


def futures(speeds, starts, seed=0, foreseen=False):
    """Connected random paths: legs that begin at ``starts`` [K, B]."""
    rng = np.random.default_rng(seed)
    starts = np.array(starts, dtype=float)
    heading = rng.uniform(-math.pi, math.pi, starts.shape)
    x, y = rng.uniform(-0.5, 0.5, (2, *starts.shape))
    for k, speed in enumerate(speeds):
        for leg in range(1, starts.shape[1]):
            if math.isfinite(starts[k, leg]):
                run = speed * (starts[k, leg] - starts[k, leg - 1])
                x[k, leg] = x[k, leg - 1] + run * math.cos(heading[k, leg - 1])
                y[k, leg] = y[k, leg - 1] + run * math.sin(heading[k, leg - 1])
    count = len(speeds)
    return Futures(
        np.full(count, 1 / count), starts, x, y, heading, np.array(speeds, dtype=float), np.zeros(count, dtype=int),
        foreseen,
    )  # fmt: skip


def meet(x, y, heading, speed):
    """Seconds until a point at the origin can be within reach of a slower prey, by bisection."""

    def gap(t):
        return math.hypot(x + speed * t * math.cos(heading), y + speed * t * math.sin(heading)) - REACH - TOP * t

    low, high = 0.0, 1e4
    if gap(0.0) <= 0:
        return 0.0
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if gap(middle) > 0 else (low, middle)
    return high


def chase(pose, future, k, start):
    """Seconds from ``start`` to the capture, by a hunter that believes in the present leg until the next one begins."""
    x, y, facing = pose
    clock, price = start, 0.0
    starts = [*future.starts[k].tolist(), math.inf]
    for leg, (begin, over) in enumerate(itertools.pairwise(starts)):
        if over <= clock:
            continue
        heading, speed = future.heading[k, leg], future.speed[k]
        at_x = future.forward[k, leg] + speed * (clock - begin) * math.cos(heading)
        at_y = future.right[k, leg] + speed * (clock - begin) * math.sin(heading)
        slower = min(speed, 0.9 * TOP)
        time = meet(at_x - x, at_y - y, heading, slower)
        to_x = at_x - x + slower * time * math.cos(heading)
        to_y = at_y - y + slower * time * math.sin(heading)
        way = math.atan2(to_y, to_x)
        price += PRICE * abs(wrap(way - facing))
        if clock + time <= over:
            return clock + time - start + price
        x, y, facing = x + TOP * (over - clock) * math.cos(way), y + TOP * (over - clock) * math.sin(way), way
        clock = over
    raise AssertionError("the last leg lasts for ever")


STARTS = [[0.0, 4.0, 9.0], [0.0, 7.5, math.inf], [0.0, math.inf, math.inf], [0.0, 1.0, 60.0]]


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("start", [0.0, 6.656])
def test_a_surprised_hunter_against_one_leg_at_a_time(seed, start):
    ahead = futures([0.048, 0.03, 0.0, 0.09], STARTS, seed)
    ends = np.random.default_rng(seed + 100).uniform(-1.0, 1.0, (3, 5, 1))
    found = Homing(TOP, REACH, PRICE).time(ends, ahead, start)
    assert found.shape == (5, 4)
    expected = [[chase(ends[:, g, 0], ahead, k, start) for k in range(4)] for g in range(5)]
    np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("start", [0.0, 6.656])
def test_a_foreseen_path_is_met_as_early_as_can_be(seed, start):
    """The first time at which the hunter could be within reach of the prey's true place, on a fine grid."""
    ahead = futures([0.048, 0.03, 0.0, 0.05], STARTS, seed, foreseen=True)
    ends = np.random.default_rng(seed + 100).uniform(-1.0, 1.0, (3, 5, 4))  # an own pose for each future
    found = Homing(TOP, REACH, PRICE).time(ends, ahead, start)
    t = np.arange(0.0, 120.0, 1e-3)
    x, y = ahead.at(start + t)  # [4, J]
    for g in range(5):
        for k in range(4):
            across, along = x[k] - ends[0, g, k], y[k] - ends[1, g, k]
            first = int((np.hypot(across, along) - REACH - TOP * t <= 0).argmax())
            turn = abs(wrap(math.atan2(along[first], across[first]) - ends[2, g, k]))
            assert found[g, k] == pytest.approx(t[first] + PRICE * turn, abs=0.02)


def test_a_meeting_by_hand():
    """1 m ahead: it stands, flees, comes, or flees faster than can be caught (then taken at 0.9 of the top speed)."""
    homing, here = Homing(0.1, 0.05, 0.0), np.zeros((3, 1, 1))
    for heading, speed, seconds in (
        (0.0, 0.0, 0.95 / 0.1), (0.0, 0.05, 0.95 / 0.05), (math.pi, 0.05, 0.95 / 0.15), (0.0, 0.2, 0.95 / 0.01)
    ):  # fmt: skip
        one = futures([speed], [[0.0]])
        ahead = replace(one, forward=np.ones((1, 1)), right=np.zeros((1, 1)), heading=np.full((1, 1), heading))
        assert homing.time(here, ahead, 0.0)[0, 0] == pytest.approx(seconds)
        # From 2 s on the hunter has that much further to go, or less far.
        gone = 2.0 * speed * math.cos(heading)
        later = homing.time(here, ahead, 2.0)[0, 0]
        assert later == pytest.approx(seconds * (0.95 + gone) / 0.95)
    inside = replace(one, forward=np.full((1, 1), 0.04), right=np.zeros((1, 1)))
    assert homing.time(here, inside, 0.0)[0, 0] == 0.0


def test_nobody_is_met_on_a_leg_before_it_begins():
    """A prey too fast to catch turns after 5 s onto a line that leads back through the hunter: it is not there yet."""
    ahead = Futures(
        np.ones(1), np.array([[0.0, 5.0]]), np.ones((1, 2)), np.array([[-1.0, 0.0]]),
        np.array([[0.5 * math.pi, 0.0]]), np.array([0.2]), np.zeros(1, dtype=int), True,
    )  # fmt: skip
    assert Homing(TOP, REACH, 0.0).time(np.zeros((3, 1, 1)), ahead, 0.0)[0, 0] == pytest.approx(5.0)
