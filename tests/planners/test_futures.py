"""Futures and the choice over them, held to enumeration: what the hunter can tell apart at the next decision."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from one_room import room_futures

from bayeshunt.core.geometry import Polar, Pose, wrap
from bayeshunt.models.target.turns import TurnModel
from bayeshunt.planners.interception.bouncing import Walls
from bayeshunt.planners.interception.futures import Futures, mix, turning_futures
from bayeshunt.planners.interception.homing import Homing
from bayeshunt.planners.interception.lookahead import PairPaths, decide, look_ahead

STEP, SPEED = 3.328, 0.05
SIDES = ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))
KNOWN = TurnModel(SPEED * STEP, np.array([1.0, -0.7]), prior_hazard=0.3, prior_steps=4.0)


def square(half):
    """Walls at ``half`` metres to every side."""
    return Walls(SIDES, (half,) * 4, 0.4)


def three_gaits(points=4):
    """Straight on, to the right and to the left, 0.18 m a step: [3, G, P, 1]."""
    share = np.arange(1, points + 1) / points
    turns = np.array([0.0, 1.2, -1.2])[:, None] * share
    forward, right = 0.18 * share * np.cos(turns / 2), 0.18 * share * np.sin(turns / 2)
    return np.stack([forward, right, turns])[..., None]


def beliefs(hunter, prey):
    """The prey turns anywhere, or it is in one of three rooms: bounces before the next decision and after it."""
    seen = hunter.relative(prey)
    parts = [(0.4, turning_futures(seen, KNOWN, STEP, 2))]
    for chance, half in ((0.3, 0.5), (0.2, 0.6), (0.1, 0.9)):
        bounced = room_futures(seen, hunter, square(half), SPEED, 0.3, STEP, legs=3)
        if bounced is not None:
            parts.append((chance, bounced))
    return parts


def observed(futures, k):
    """What the hunter has seen of future k by the next decision: the way that it went, to 0.1 um."""
    forward, right = (a[k] for a in futures.at(np.linspace(0.0, STEP, 40)))
    return (*np.round(forward, 7).tolist(), *np.round(right, 7).tolist())


def least_by_enumeration(time, futures, first):
    """The least expected time over every policy: a second gait for each thing that can be observed."""
    seen = [observed(futures, k) for k in range(len(futures.weights))]
    things = sorted(set(seen))
    least = math.inf
    for policy in itertools.product(range(time.shape[1]), repeat=len(things)):
        second = dict(zip(things, policy, strict=True))
        expected = sum(
            w * time[first, second[s], k] for k, (w, s) in enumerate(zip(futures.weights, seen, strict=True))
        )
        least = min(least, expected)
    return least


HUNTER = Pose(0.1, -0.2, 0.6)
PREYS = {
    "bounces in the small room": Pose(0.42, 0.1, 0.2),
    "bounces in two rooms": Pose(0.48, 0.1, 0.3),
    "head-on, may take either side": Pose(0.41, -0.1, 0.05),
    "far from every wall": Pose(0.1, 0.1, 0.4),
}


@pytest.mark.parametrize("prey", PREYS.values(), ids=PREYS)
def test_the_value_is_the_best_policy_over_what_can_be_observed(prey):
    futures = mix(beliefs(HUNTER, prey))
    path = three_gaits()
    outlook = look_ahead(PairPaths.compile(path, path, STEP), futures, Homing(0.06, 0.058, 1.0), 0.01)
    values, pairs = decide(outlook, futures)
    for first in range(3):
        assert values[first] == pytest.approx(least_by_enumeration(outlook.time, futures, first), abs=1e-9)
        # Nothing new seen: the same second gait whatever happens can only be worse.
        assert values[first] <= pairs[first].min() + 1e-12


@pytest.mark.parametrize("prey", PREYS.values(), ids=PREYS)
def test_groups_are_what_can_be_told_apart(prey):
    parts = beliefs(HUNTER, prey)
    for futures in (mix(parts), parts[0][1], parts[1][1]):
        seen = [observed(futures, k) for k in range(len(futures.weights))]
        for one, other in itertools.combinations(range(len(seen)), 2):
            assert (futures.groups[one] == futures.groups[other]) == (seen[one] == seen[other])
        turned = futures.starts[:, 1] < STEP
        np.testing.assert_array_equal(futures.groups != 0, turned)


def test_the_cases_hold_every_kind_of_bounce():
    """Of the rooms of the cases above: so many futures bounce before the next decision."""
    early = {}
    for name, prey in PREYS.items():
        starts = [futures.starts[:, 1] for _, futures in beliefs(HUNTER, prey)[1:]]
        early[name] = [int((start < STEP).sum()) for start in starts]
    assert early == {
        "bounces in the small room": [2, 0, 0],
        "bounces in two rooms": [1, 2, 0],
        "head-on, may take either side": [2, 0, 0],
        "far from every wall": [0, 0, 0],
    }


def test_seeing_the_bounce_is_worth_something():
    """A hunter that could not tell a bounce from going straight on would value its second gait too low."""
    futures = mix(beliefs(HUNTER, PREYS["bounces in the small room"]))
    path = three_gaits()
    outlook = look_ahead(PairPaths.compile(path, path, STEP), futures, Homing(0.06, 0.058, 1.0), 0.01)
    blind = replace(futures, groups=np.zeros(len(futures.weights), dtype=int))
    assert (decide(outlook, futures)[0] < decide(outlook, blind)[0] - 0.01).any()


def test_turning_futures_against_a_walk():
    """Every path is walked in small steps; its chance is that of surviving so many steps and then turning."""
    prey = Polar(0.4, 0.7, -1.1)
    futures = turning_futures(prey, KNOWN, STEP, 3)
    turns, chances = KNOWN.turn_table
    hazard = KNOWN.hazard
    assert futures.weights.sum() == pytest.approx(1.0)
    assert futures.weights[0] == pytest.approx((1 - hazard) ** 3)
    times = np.linspace(0.0, 4 * STEP, 57)
    forward, right = futures.at(times)
    cases = list(itertools.product(range(3), range(len(turns))))
    for k, (step, turn) in enumerate(cases, start=1):
        assert futures.weights[k] == pytest.approx(hazard * (1 - hazard) ** step * chances[turn])
        when = (step + 0.5) * STEP
        for j, t in enumerate(times.tolist()):
            corner = prey.compose(Polar(KNOWN.speed / STEP * min(t, when), 0.0, 0.0 if t < when else turns[turn]))
            end = corner.compose(Polar(KNOWN.speed / STEP * max(t - when, 0.0), 0.0, 0.0))
            assert (forward[k, j], right[k, j]) == pytest.approx((end.forward, end.right), abs=1e-12)


def test_the_likeliest_path_says_where_it_faces():
    futures = mix(beliefs(HUNTER, PREYS["bounces in two rooms"]))
    favoured = replace(futures, weights=np.where(np.arange(len(futures.weights)) == 6, 0.9, 0.0))
    assert futures.starts[6, 1] < STEP
    path = favoured.likeliest(np.array([0.1, STEP, 2 * STEP]))
    forward, right = favoured.at(np.array([0.0, 0.1, STEP, 2 * STEP]))
    np.testing.assert_allclose(path.forward, forward[6])
    np.testing.assert_allclose(path.right, right[6], atol=1e-12)
    legs = [0, 0, 1, int((futures.starts[6] <= 2 * STEP).sum()) - 1]
    np.testing.assert_allclose(path.heading, wrap(futures.heading[6, legs]))


def test_a_mixture_pads_with_legs_that_never_begin():
    one = Futures(
        np.ones(1), *(np.full((1, 1), v) for v in (0.0, 0.3, 0.1, 0.5)), np.array([0.05]), np.zeros(1, dtype=int)
    )
    three = room_futures(Polar(0.1, 0.0, 0.0), Pose(0.0, 0.0, 0.0), square(0.5), SPEED, 0.1, STEP, legs=3)
    both = mix([(1.0, one), (3.0, three)])
    assert both.starts.shape[1] == 3
    assert both.starts[0].tolist() == [0.0, math.inf, math.inf]
    assert not both.foreseen
    for times in (np.array([0.0]), np.array([1e6])):
        for mixed, alone in zip(both.at(times), one.at(times), strict=True):
            np.testing.assert_array_equal(mixed[0], alone[0])
    np.testing.assert_allclose(both.weights, [0.25, *(0.75 * three.weights)])
