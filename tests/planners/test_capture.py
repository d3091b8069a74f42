"""Times of first capture and times to go, against plain loops and closed forms."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pandas as pd
import pytest
from planner_cases import BODY, STEP

import bayeshunt as bh
from bayeshunt.core.geometry import Polar
from bayeshunt.planners.interception.lookahead import gait_paths
from bayeshunt.planners.sequences.capture import CapturePaths, PreyPaths


def straight_prey(paths: CapturePaths, ahead: float, right: float, v_ahead: float, v_right: float) -> PreyPaths:
    times = paths.interval * np.arange(paths.depth * paths.points + 1)
    return PreyPaths((ahead + v_ahead * times)[None], (right + v_right * times)[None])


def by_hand(model, sequence, prey: PreyPaths, interval: float, reach: float) -> tuple[float, Polar]:
    """Follow a gait sequence point by point; the time of the first point within reach, and the end pose."""
    here, point = Polar(0.0, 0.0, 0.0), 0
    for gait in sequence:
        for ahead, right, turn in gait_paths(model)[gait]:
            point += 1
            at = here.compose(Polar.from_cartesian(ahead, right, turn))
            gap = math.hypot(at.forward - prey.forward[0, point], at.right - prey.right[0, point])
            if gap <= reach:
                return point * interval, at
        here = at
    return math.inf, here


@pytest.mark.parametrize(("ahead", "right"), [(0.25, 0.05), (0.05, -0.1), (0.35, 0.1), (0.1, 0.08)])
def test_first_captures_agree_with_a_walk_along_every_sequence(small_model, ahead, right):
    paths = CapturePaths(small_model, depth=3, max_transitions=2)
    prey = straight_prey(paths, ahead, right, 0.02, -0.01)
    times = paths.first_captures(prey, BODY)[0]
    for step in range(2, 4):
        new = slice(paths.layers[step], paths.layers[step + 1])
        times[new] = np.minimum(times[new], times[paths.tree.parents[new]])
    leaves = range(paths.layers[3], paths.layers[4])
    caught = 0
    for node, sequence in zip(leaves, itertools.product(range(3), repeat=3), strict=True):
        expected, end = by_hand(small_model, sequence, prey, paths.interval, BODY)
        caught += math.isfinite(expected)
        if math.isinf(expected):
            assert math.isinf(times[node])
            assert paths.end[:2, node] == pytest.approx([end.forward, end.right], abs=1e-5)
        else:  # between the last point outside and the first inside
            assert expected - paths.interval - 1e-9 <= times[node] <= expected + 1e-9
    assert caught, "no sequence captures: the case shows nothing"


def test_stopping_at_the_first_depth_loses_nothing(model):
    paths = CapturePaths(model, depth=3, max_transitions=1)
    for angle in np.linspace(-3, 3, 7):
        prey = straight_prey(paths, 0.3 * math.cos(angle), 0.3 * math.sin(angle), -0.01, 0.02)
        full, first = (paths.first_captures(prey, BODY, stop_at_first=stop)[0] for stop in (False, True))
        assert np.argmin(full) == np.argmin(first)
        assert full.min() == first.min()


def test_the_time_to_go_solves_the_race_and_prices_the_heading(small_model):
    paths = CapturePaths(small_model, depth=1, max_transitions=0)
    nodes = np.arange(1, 4)
    prey = straight_prey(paths, 0.5, 0.3, 0.03, 0.0)
    plain = paths.times_to_go(nodes, prey, BODY, 0.0)[0]
    end, t = paths.end[:, nodes], STEP
    x, y = 0.5 + 0.03 * (t + plain) - end[0], 0.3 - end[1]
    assert np.hypot(x, y) == pytest.approx(paths.speed * plain + BODY, abs=1e-6)
    priced = paths.times_to_go(nodes, prey, BODY, 2.0)[0]
    error = np.abs((np.arctan2(y, x) - end[2] + np.pi) % (2 * np.pi) - np.pi)
    assert priced - plain == pytest.approx(2.0 * error, abs=1e-6)


def test_a_prey_that_gets_away_costs_more_the_farther_it_is(small_model):
    paths = CapturePaths(small_model, depth=1, max_transitions=0)
    near, far = (
        paths.times_to_go(np.array([1]), straight_prey(paths, ahead, 0.0, 0.2, 0.0), BODY, 0.0)[0, 0]
        for ahead in (0.4, 0.5)
    )
    assert math.isfinite(near)
    assert STEP < near < far


def test_the_price_of_turning_is_a_step_per_softest_fast_turn(model):
    paths = CapturePaths(model, depth=1, max_transitions=0)
    turn = abs(float(model.predict("right").heading))
    left = abs(float(model.predict("left").heading))
    assert paths.turn_price == pytest.approx(STEP / min(turn, left), rel=1e-6)


@pytest.mark.parametrize("angle", [170.0, -170.0, 180.0, 120.0])
def test_a_gait_that_ends_behind_drives_backwards(angle):
    """Without part-way poses: on the short arc, and not the long way round."""
    frame = pd.DataFrame({"gait": ["back"] * 3, "distance": 0.5, "angle": np.radians(angle), "heading": 0.0})
    model = bh.ForwardModel.fit(frame, bh.GaitRepertoire.of(["back"], body_length=0.5, duration=1.0))
    path = gait_paths(model)[0]
    assert np.hypot(*path[-1, :2]) == pytest.approx(0.5)
    assert np.degrees(np.arctan2(path[-1, 1], path[-1, 0])) % 360 == pytest.approx(angle % 360)
    ways = np.hypot(*np.diff(path[:, :2], axis=0, prepend=0.0).T)
    assert ways.sum() < 0.5 * np.pi / 2  # at most half a circle over the chord
    assert path[0, 0] < 0
