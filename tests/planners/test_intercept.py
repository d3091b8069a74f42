"""Interception: the turn table, the futures, the homing estimate, the choice; by hand and by brute force."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from planner_cases import BODY, STEP, situations

from bayeshunt.config.loading import load_robot
from bayeshunt.core.errors import InputError
from bayeshunt.core.gaits import Gait, GaitRepertoire
from bayeshunt.core.geometry import Polar
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.models.target.turns import OwnMotion, TurnModel, in_legs, joined
from bayeshunt.planners.api import Situation
from bayeshunt.planners.interception.futures import Futures, mix, turning_futures
from bayeshunt.planners.interception.homing import Homing
from bayeshunt.planners.interception.intercept import intercept
from bayeshunt.planners.interception.lookahead import PairPaths, decide, gait_paths, look_ahead
from bayeshunt.worlds.babbling import babble


def situation(distance, angle, heading, transitions=()):
    return Situation(
        Polar(distance, angle, heading), PreyModel(), body_length=BODY, time_step=STEP, transitions=tuple(transitions)
    )


def straight_future(x, y, heading, speed):
    one = np.ones((1, 1))
    return Futures(np.ones(1), 0 * one, x * one, y * one, heading * one, np.array([speed]), np.zeros(1, dtype=int))


# --- the turn table --------------------------------------------------------------------------------


def test_own_motion_reads_the_gaits(model):
    own = OwnMotion.of(model, 0.4)
    assert own.top_speed == pytest.approx(0.0576 * STEP, rel=0.02)
    assert len(own.turns) == 8  # all but the two straight gaits
    assert own.softest_turn == pytest.approx(0.0144 / 0.052 * STEP, rel=0.05)
    headings = model.probabilities("Heading")[:, model.gaits.index("straight")], model.axes.heading.centres
    assert own.drift == pytest.approx(math.sqrt(headings[0] @ headings[1] ** 2), rel=0.2)  # exact against binned


def test_drift_of_an_imported_network_is_that_of_its_bins(model):
    own = OwnMotion.of(model, 0.4).drift
    given = {"Gait": np.full(len(model.gaits), 1 / len(model.gaits)), **model.local_tables}
    imported = ForwardModel.of_tables(model.gaits, model.axes, model.structure, given)
    assert OwnMotion.of(imported, 0.4).drift == pytest.approx(own, rel=0.2)


def test_what_wanders_by_hand():
    prior = TurnModel(0.2, prior_drift=0.3, prior_steps=2.0, threshold=0.5)
    assert prior.drift == pytest.approx(0.3)
    seen = prior.learn([Polar(0.1, 0.0, 0.1), Polar(0.1, 0.0, -0.2), Polar(0.1, 0.0, 1.0)])  # the last is a turn
    assert seen.drift == pytest.approx(math.sqrt((2 * 0.09 + 0.01 + 0.04) / 4))


def test_turn_table_by_hand():
    prior = TurnModel(0.2, np.array([1.0, -1.0]), prior_hazard=0.25, prior_steps=4.0, turn_weight=1.0, threshold=0.5)
    assert prior.speed == 0.2
    assert prior.hazard == 0.25
    seen = prior.learn([Polar(0.10, 0.0, 0.1), Polar(0.05, 0.0, 2.0), Polar(0.14, 0.0, -0.4), Polar(0.12, 0.0, 0.0)])
    assert seen.speed == 0.12  # the median of three; the turn does not count
    assert seen.hazard == pytest.approx((1 + 0.25 * 4) / (4 + 4))
    turns, chances = seen.turn_table
    assert turns.tolist() == [1.0, -1.0, 2.0]
    assert chances.tolist() == pytest.approx([0.25, 0.25, 0.5])  # each prior turn weighs 1/2
    table = seen.cpt()
    assert table["probability"].sum() == pytest.approx(1.0)
    assert table["probability"].tolist() == pytest.approx([0.75, 0.0625, 0.0625, 0.125])
    assert table["seen"].tolist() == [3, 0, 0, 1]
    assert prior.turns == ()  # learning returned a new model
    for array in (turns, chances, seen.prior_turns):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 9.0


def test_turn_table_does_not_depend_on_how_transitions_arrive():
    seen = [Polar(0.1, 0.0, 0.1), Polar(0.05, 0.0, 2.0), Polar(0.12, 0.0, 0.0)]
    prior = TurnModel(0.2, np.array([1.0]))
    whole, parts = prior.learn(seen), prior.learn(seen[:1]).learn(seen[1:])
    assert (whole.speeds, whole.turns) == (parts.speeds, parts.turns)
    assert prior.learn(reversed(seen)).hazard == whole.hazard


def test_joined_transitions_by_hand():
    right = Polar(0.1, 0.0, 0.5 * math.pi)  # 0.1 m ahead, then a right angle
    assert joined([right]) == right
    corner = joined([right, right])
    assert (corner.forward, corner.right) == pytest.approx((0.1, 0.1))
    assert joined([right] * 4).distance == pytest.approx(0.0, abs=1e-12)
    assert joined([right] * 5).heading == pytest.approx(0.5 * math.pi)  # as one who looks only at its end sees it


def test_legs_end_now_and_the_oldest_may_lack_steps():
    seen = [Polar(0.01 * i, 0.0, 0.1) for i in range(1, 6)]
    assert in_legs(seen, 1) == tuple(seen)
    legs = in_legs(seen, 2)
    assert [leg.distance for leg in legs] == pytest.approx([0.02, 0.05, 0.09], rel=1e-2)  # the first at its own pace
    assert [leg.heading for leg in legs] == pytest.approx([0.1, 0.2, 0.2])
    assert in_legs((), 3) == ()


def test_motion_is_counted_over_body_lengths_whatever_the_time_step():
    """The same robot that decides eight times as often sees the same turns, speeds and prices."""
    slow, quick = (_fitted(step) for step in (3.328, 0.416))
    assert (slow.steps, quick.steps) == (1, 8)
    assert quick.leg == slow.leg
    assert quick.prior.prior_speed == pytest.approx(slow.prior.prior_speed, rel=0.03)
    # Every short step carries momentum over from other gaits: turns come out a little less.
    assert np.allclose(quick.prior.prior_turns, slow.prior.prior_turns, rtol=0.2)
    assert quick.homing.heading_price == pytest.approx(slow.homing.heading_price, rel=0.15)
    straight = [Polar(0.048 * 0.416, 0.0, 0.0)] * 16
    turned = [*straight, *[Polar(0.01, 0.0, 0.25)] * 8]
    case = Situation(Polar(0.3, 0.0, 0.0), PreyModel(), body_length=BODY, time_step=0.416)
    known = quick.prey(replace(case, transitions=tuple(turned)))
    assert known.speed == pytest.approx(0.048 * 3.328)
    assert known.turns == pytest.approx((2.0,))  # one turn in three legs, though no step turned by the threshold


def _fitted(step):
    robot = load_robot("khepera").model_copy(update={"gait_duration": step})
    return intercept(ForwardModel.fit(babble(robot, 400, 0), robot.gaits))


@pytest.mark.parametrize(
    "wrong",
    [
        {"prior_speed": 0.0},
        {"prior_hazard": 1.5},
        {"prior_steps": 0.0},
        {"prior_turns": [np.nan]},
        {"prior_drift": -1.0},
    ],
)
def test_turn_model_refuses_nonsense(wrong):
    with pytest.raises(InputError, match=next(iter(wrong))):
        TurnModel(**{"prior_speed": 0.2, **wrong})


def test_what_wandering_explains_is_no_turn():
    """A hunter whose own heading wanders takes no change of the prey's for a turn that its own would pass for.

    It does so but for 2 in 100 to a side, and that is 2.0537 standard deviations.
    """
    assert _fitted(3.328).prior.threshold == 0.4
    rows = {"gait": ["straight"] * 60, "distance": [0.2] * 60, "angle": [0.0] * 60, "heading": [-0.5, 0.0, 0.5] * 20}
    shaky = ForwardModel.fit(pd.DataFrame(rows), GaitRepertoire((Gait("straight"),), BODY, STEP))
    assert intercept(shaky).prior.threshold == pytest.approx(2.0537 * OwnMotion.of(shaky, 0.4).drift, rel=1e-4)
    assert intercept(shaky).prior.threshold > 0.8


# --- futures ---------------------------------------------------------------------------------------


def test_futures_by_hand():
    known = TurnModel(0.3, np.array([0.5 * math.pi, -1.0]), prior_hazard=0.2, turn_weight=1.0)
    futures = turning_futures(Polar(1.0, 0.0, 0.0), known, 3.0, 2)
    assert futures.weights.tolist() == pytest.approx([0.64, 0.1, 0.1, 0.08, 0.08])
    assert futures.groups[[0, 3, 4]].tolist() == [0, 0, 0]  # not yet turned at the next decision
    assert len(set(futures.groups[:3].tolist())) == 3
    forward, right = futures.at(np.array([0.0, 1.5, 3.0, 4.5]))
    assert forward[0].tolist() == pytest.approx([1.0, 1.15, 1.3, 1.45])  # 0.1 m/s
    assert forward[1].tolist() == pytest.approx([1.0, 1.15, 1.15, 1.15])  # turned right after 1.5 s
    assert right[1].tolist() == pytest.approx([0.0, 0.0, 0.15, 0.3])
    assert forward[3].tolist() == pytest.approx([1.0, 1.15, 1.3, 1.45])  # turns at 4.5 s


def test_a_prey_that_never_turns_has_one_future():
    known = TurnModel(0.3, np.array([1.0]), prior_hazard=0.0)
    futures = turning_futures(Polar(1.0, 0.3, 2.0), known, 3.0, 4)
    assert futures.weights.tolist() == [1.0]
    still = futures.standing_still().at(np.array([0.0, 50.0]))
    assert still[0][0].tolist() == pytest.approx([math.cos(0.3)] * 2)


def test_mixed_futures_keep_their_paths_and_share_the_weight():
    turning = turning_futures(Polar(1.0, 0.2, 1.0), TurnModel(0.3, np.array([1.0]), prior_hazard=0.3), 3.0, 2)
    straight = straight_future(0.5, -0.1, 2.0, 0.07)
    both = mix([(3.0, turning), (1.0, straight)])
    assert both.weights.tolist() == pytest.approx([*(0.75 * turning.weights), 0.25])
    assert both.groups[-1] == both.groups[0]  # neither has turned at the next decision
    times = np.array([0.5, 4.0, 9.0])
    for one, many in zip(straight.at(times), both.at(times), strict=True):
        assert np.allclose(many[-1], one[0])
    for one, many in zip(turning.at(times), both.at(times), strict=True):
        assert np.allclose(many[:-1], one)


# --- beyond the lookahead --------------------------------------------------------------------------


def brute_meeting(x, y, heading, speed, top, reach):
    """First time at which a point at the origin could be within reach, on a fine grid."""
    t = np.arange(0.0, 200.0, 1e-3)
    gap = np.hypot(x + speed * t * np.cos(heading), y + speed * t * np.sin(heading)) - reach - top * t
    return t[(gap <= 0).argmax()]


@pytest.mark.parametrize(
    ("x", "y", "heading"), [(0.5, 0.0, 0.0), (0.3, -0.4, 2.0), (-0.6, 0.1, -1.2), (0.01, 0.02, 0.5)]
)
def test_meeting_time_against_brute_force(x, y, heading):
    homing = Homing(top_speed=0.06, reach=0.058, heading_price=0.0)
    found = homing.time(np.zeros((3, 1, 1, 1)), straight_future(x, y, heading, 0.048), 0.0)
    assert found.shape == (1, 1, 1)
    assert found[0, 0, 0] == pytest.approx(brute_meeting(x, y, heading, 0.048, 0.06, 0.058), abs=2e-3)


def test_turning_towards_the_meeting_point_has_its_price():
    homing = Homing(0.06, 0.058, heading_price=2.0)
    prey = straight_future(0.5, 0.0, 0.0, 0.0)
    away = np.array([0.0, 0.0, 1.5]).reshape(3, 1, 1, 1)
    extra = homing.time(away, prey, 0.0) - homing.time(0 * away, prey, 0.0)
    assert extra[0, 0, 0] == pytest.approx(3.0)


@pytest.mark.parametrize("speed", [0.06, 0.09])
def test_a_faster_prey_still_makes_the_wider_gap_the_longer_chase(speed):
    homing = Homing(0.06, 0.058, 0.0)
    near, far = (homing.time(np.zeros((3, 1, 1, 1)), straight_future(x, 0.0, 0.0, speed), 0.0) for x in (0.3, 0.4))
    assert np.isfinite([near, far]).all()
    assert far[0, 0, 0] > near[0, 0, 0] > 0


def test_a_foreseen_turn_is_met_sooner_than_a_surprise():
    # The prey runs off, then comes back past the hunter.
    futures = Futures(
        weights=np.ones(1),
        starts=np.array([[0.0, 5.0]]),
        forward=np.array([[0.4, 0.4]]),
        right=np.array([[0.0, 0.25]]),
        heading=np.array([[0.5 * math.pi, -0.5 * math.pi]]),
        speed=np.array([0.05]),
        groups=np.zeros(1, dtype=int),
    )
    homing, here = Homing(0.06, 0.058, 0.0), np.zeros((3, 1, 1, 1))
    surprise = homing.time(here, futures, 0.0)[0, 0, 0]
    foreseen = homing.time(here, replace(futures, foreseen=True), 0.0)[0, 0, 0]
    assert foreseen < surprise
    t = np.arange(0.0, 100.0, 1e-3)
    x, y = (a[0] for a in futures.at(t))
    assert foreseen == pytest.approx(t[(np.hypot(x, y) - 0.058 - 0.06 * t <= 0).argmax()], abs=2e-3)


# --- both steps ------------------------------------------------------------------------------------


def test_pairs_are_compositions(model):
    pairs, paths = PairPaths.mean(model), gait_paths(model)
    for g, h in itertools.product((0, 3, 6), (1, 5, 9)):
        end = Polar.from_cartesian(*paths[g, -1]).compose(Polar.from_cartesian(*paths[h, 7]))
        assert pairs.second[:2, g, h, 7, 0] == pytest.approx([end.forward, end.right])
    assert pairs.times[[0, -1]] == pytest.approx([STEP / paths.shape[1], 2 * STEP])


def test_arcs_stand_in_for_missing_part_way_poses(model):
    paths = gait_paths(model)
    assert model.mean_paths is None
    for gait, path in zip(model.gaits, paths, strict=True):
        end = model.predict(gait)
        assert path[-1, :2] == pytest.approx([end.forward, end.right], abs=1e-9)
    assert np.hypot(*paths[0, 0, :2]) == pytest.approx(0.0576 * STEP / paths.shape[1], rel=0.02)


def test_capture_time_by_hand(model):
    planner = intercept(model, hazard=0.0, spread=1e-6)
    gap = 0.1
    prey = straight_future(gap + planner.homing.reach, 0.0, 0.0, 0.0)  # stands still ahead
    outlook = look_ahead(planner.pairs, prey, planner.homing, planner.spread)
    straight = model.gaits.index("straight")
    path = gait_paths(model)[straight]
    distance = np.hypot(gap + planner.homing.reach - path[:, 0], path[:, 1])
    missed = int((distance > planner.homing.reach).sum())
    expected = missed * STEP / len(path)  # seconds, to the part-way pose
    assert outlook.time[straight, :, 0] == pytest.approx(expected)
    assert outlook.first[straight, -1, 0] == 1.0
    assert expected == pytest.approx(gap / 0.0576, abs=STEP / len(path))


def test_the_choice_against_loops(model):
    planner = intercept(model)
    futures = planner.futures(situation(0.4, 0.7, -1.0, [Polar(0.16, 0.0, 0.1)]))
    outlook = look_ahead(planner.pairs, futures, planner.homing, planner.spread)
    values, pair_values = decide(outlook, futures)
    for g in range(len(model.gaits)):
        total = 0.0
        for group in set(futures.groups.tolist()):
            mine = np.flatnonzero(futures.groups == group)
            total += min(sum(futures.weights[k] * outlook.time[g, h, k] for k in mine) for h in range(len(model.gaits)))
        assert values[g] == pytest.approx(total)
    assert pair_values[2, 3] == pytest.approx(sum(futures.weights * outlook.time[2, 3]))


# --- the planner -----------------------------------------------------------------------------------


def test_prey_dead_ahead_and_prey_to_one_side(model):
    planner = intercept(model)
    seen = [Polar(0.16, 0.0, 0.0)]
    assert planner.plan(situation(0.4, 0.0, 0.0, seen), rng=np.random.default_rng(0)).gait == "straight"
    right = planner.plan(situation(0.3, 1.5, 1.5, seen), rng=np.random.default_rng(0)).gait
    left = planner.plan(situation(0.3, -1.5, -1.5, seen), rng=np.random.default_rng(0)).gait
    assert "right" in right
    assert "left" in left


def test_the_prior_is_a_setting_and_changes_the_first_move_only(model):
    with_prior, without = intercept(model), intercept(model, prior=False)
    first = situation(5 * BODY, 1.0, 0.0)
    plans = [planner.plan(first, rng=np.random.default_rng(0)) for planner in (with_prior, without)]
    assert plans[0].predicted_prey.distance[-1] != pytest.approx(plans[1].predicted_prey.distance[-1])
    assert plans[1].predicted_prey.distance.tolist() == pytest.approx([5 * BODY] * 3)
    assert [plan.prey_known for plan in plans] == [False, False]
    later = replace(first, transitions=(Polar(0.16, 0.0, 0.1),))
    assert (
        with_prior.plan(later, rng=np.random.default_rng(0)).value
        == without.plan(later, rng=np.random.default_rng(0)).value
    )


def test_trace_explains_the_choice(model):
    plan = intercept(model).plan(situation(0.25, 0.5, 1.0, [Polar(0.16, 0.0, 0.1)]), rng=np.random.default_rng(0))
    trace, gaits = plan.trace, len(model.gaits)
    assert len(trace) == plan.nodes == 1 + gaits + gaits**2
    assert trace.loc[trace["chosen"], "gaits"].tolist() == ["", plan.gait, ", ".join(plan.gaits)]
    firsts = trace[trace["T"] == 1]
    assert firsts["value_s"].min() == plan.value
    assert (firsts["value_s"].to_numpy() <= _least_by_parent(trace) + 1e-9).all()
    curves = trace.filter(like="capture_by_").to_numpy()
    assert (np.diff(curves[1 + gaits :], axis=1) >= 0).all()
    assert curves[1 + gaits :, -1].tolist() == trace["capture_probability"].tolist()[1 + gaits :]
    assert np.isnan(curves[1 : 1 + gaits, -1]).all()
    assert ((curves >= 0) & (curves <= 1) | np.isnan(curves)).all()


def _least_by_parent(trace):
    """What a first gait is worth if the second may not depend on what is seen: never less."""
    return trace[trace["T"] == 2].groupby("parent")["value_s"].min().to_numpy()


def test_every_situation_has_finite_values(model):
    planner = intercept(model)
    for case in situations(40):
        assert np.isfinite(planner.plan(case, rng=np.random.default_rng(0)).trace["value_s"]).all()


@pytest.mark.parametrize(
    "wrong", [{"hazard": 1.5}, {"spread": 0.0}, {"turn_steps": -1}, {"prior": 1}, {"catch_distance": math.nan}]
)
def test_wrong_settings_are_named(model, wrong):
    with pytest.raises(InputError, match=next(iter(wrong))):
        intercept(model, **wrong)
