"""Classical guidance: where each baseline aims, and the Kalman filter behind one of them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from planner_cases import BODY, STEP

from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import Polar
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.planners.api import Situation
from bayeshunt.planners.guidance.pursuit import ConstantVelocity, ProportionalNavigation, PurePursuit
from bayeshunt.planners.guidance.steering import intercept_time, prey_track


def situation(prey: Polar, transitions: tuple[Polar, ...] = ()) -> Situation:
    return Situation(prey, PreyModel(), body_length=BODY, time_step=STEP, transitions=transitions)


@pytest.mark.parametrize(
    ("prey", "gait"),
    [
        (Polar(1.0, 0.0, 0.0), "straight"),
        (Polar(0.19, 0.45, 0.0), "right"),
        (Polar(0.19, -0.45, 0.0), "left"),
        (Polar(0.09, 0.0, 0.0), "slow"),
    ],
)
def test_pure_pursuit_goes_where_the_prey_is(model, prey, gait):
    seen = (Polar(0.16, 1.0, 1.0),) * 3  # how the prey moves is none of its business
    plan = PurePursuit(model).plan(situation(prey, seen), rng=np.random.default_rng(0))
    assert plan.gait == gait
    assert plan.value == plan.trace["value"].min()


def test_the_track_undoes_the_transitions():
    """Forward: from a first pose through known transitions; backward: the track from the last pose."""
    moves = (Polar(0.16, 0.1, 0.3), Polar(0.15, -0.2, -0.5), Polar(0.17, 0.0, 1.2))
    poses = [Polar(0.4, 2.0, -1.0)]
    for move in moves:
        poses.append(poses[-1].compose(move))
    track = prey_track(situation(poses[-1], moves))
    for index, pose in enumerate(poses):
        assert [float(part[index]) for part in track] == pytest.approx(list(pose), abs=1e-12)


@pytest.mark.parametrize(
    ("ahead", "right", "v_ahead", "v_right"), [(0.3, 0.1, 0.03, 0.01), (0.3, 0.0, -0.04, 0.0), (-0.2, 0.4, 0.0, -0.05)]
)
def test_the_intercept_time_solves_the_race(ahead, right, v_ahead, v_right):
    time = intercept_time(ahead, right, v_ahead, v_right, 0.0576, BODY)
    assert math.hypot(ahead + v_ahead * time, right + v_right * time) == pytest.approx(0.0576 * time + BODY)


def test_the_intercept_time_of_a_prey_in_reach_or_out_of_it():
    assert intercept_time(0.05, 0.0, 0.5, 0.0, 0.05, BODY) == 0.0
    assert intercept_time(0.5, 0.0, 0.5, 0.0, 0.05, BODY) == math.inf
    assert intercept_time(0.5, 0.0, -0.05, 0.0, 0.05, BODY) == pytest.approx((0.5 - BODY) / 0.1)


def test_the_kalman_filter_finds_a_constant_velocity(model):
    """Exact observations of a prey that keeps its velocity: position and velocity come out."""
    moves = (Polar(0.15, 0.0, 0.0),) * 8
    now = Polar(0.5, 0.7, 1.1)
    ahead, right, v_ahead, v_right = ConstantVelocity(model)._estimate(situation(now, moves))
    speed = 0.15 / STEP
    assert (ahead, right) == pytest.approx((now.forward, now.right), abs=2e-3)
    assert (v_ahead, v_right) == pytest.approx((speed * math.cos(1.1), speed * math.sin(1.1)), rel=0.05)


def test_the_first_velocity_seen_by_hand(model):
    """After one transition: position and velocity known beforehand to (p, top speed), then moved, pushed and observed.

    Each coordinate by itself: P = F diag(p^2 / 2, s^2) F' + Q, gain = P[:, 0] / (P[0, 0] + p^2). The first
    position is the start and an observation too, which halves its variance before the first move.
    """
    planner = ConstantVelocity(model, acceleration=0.02, position=0.03)
    speed, p, a = planner.steering.top_speed, 0.03, 0.02
    move = Polar(0.15, 0.2, 0.0)
    prey = Polar(0.5, 0.7, 1.1)
    found = planner._estimate(situation(prey, (move,)))
    cov = np.array([[1, STEP], [0, 1]]) @ np.diag([p**2 / 2, speed**2]) @ np.array([[1, 0], [STEP, 1]])
    cov = cov + a**2 * np.outer([STEP**2 / 2, STEP], [STEP**2 / 2, STEP])
    gain = cov[:, 0] / (cov[0, 0] + p**2)
    before = prey_track(situation(prey, (move,)))
    for axis, (here, start) in enumerate(((prey.forward, before.forward[0]), (prey.right, before.right[0]))):
        step = float(here - start)
        assert (found[axis], found[2 + axis]) == pytest.approx((start + gain[0] * step, gain[1] * step), rel=1e-9)


def test_constant_velocity_leads_its_target(model):
    """A prey ahead that crosses to the right is met to the right; a standing one is met where it is."""
    prey = Polar(0.3, 0.0, 0.5 * math.pi)
    planner = ConstantVelocity(model)
    crossing = planner.plan(situation(prey, (Polar(0.1, 0.0, 0.0),) * 4), rng=np.random.default_rng(0))
    assert crossing.target is not None
    assert crossing.target.angle > 0.2
    assert crossing.prey_known
    assert math.isnan(crossing.target.heading)  # it estimates a velocity, no heading
    first = planner.plan(situation(prey), rng=np.random.default_rng(0))
    assert first.target == pytest.approx(prey, abs=1e-9)  # the prey itself, which it sees
    assert not first.prey_known


def test_proportional_navigation_turns_with_the_line_of_sight(model):
    planner = ProportionalNavigation(model)
    turns = []
    for heading in (0.5 * math.pi, -0.5 * math.pi):  # crossing to the right, to the left
        case = situation(Polar(0.5, 0.0, heading), (Polar(0.1, 0.0, 0.0),) * 2)
        gait = planner.plan(case, rng=np.random.default_rng(0)).gait
        turns.append(float(model.predict(gait).heading))
    assert turns[0] > 0.1 > -0.1 > turns[1]


def test_the_commanded_turn_by_hand(model):
    """The line of sight turns by what a moment later shows, both robots having gone on straight."""
    planner = ProportionalNavigation(model, navigation_constant=2.0)
    prey, stride, moment = Polar(0.5, 0.4, 2.0), 0.1, 1e-6  # it goes 0.1 m a step along its heading
    plan = planner.plan(situation(prey, (Polar(stride, 0.0, 0.0),)), rng=np.random.default_rng(0))
    ahead = prey.forward + stride / STEP * moment * math.cos(prey.heading) - planner.steering.top_speed * moment
    right = prey.right + stride / STEP * moment * math.sin(prey.heading)
    turn = 2.0 * (math.atan2(right, ahead) - prey.angle) / moment * STEP
    values = plan.trace.set_index("gait")["value"]
    for gait in ("straight", "right", "hard left"):
        assert values[gait] == pytest.approx(abs(float(model.predict(gait).heading) - turn), abs=1e-4)
    slow = abs(float(model.predict("slow right").heading) - turn) + math.pi
    assert values["slow right"] == pytest.approx(slow, abs=1e-4), "a slow gait only if there is no fast one"


def test_proportional_navigation_holds_a_collision_course(model):
    """A prey that moves as the hunter does, far ahead and closing head-on: the bearing is constant, go straight."""
    case = situation(Polar(1.0, 0.0, math.pi), (Polar(0.1, 0.0, 0.0),) * 2)
    assert ProportionalNavigation(model).plan(case, rng=np.random.default_rng(0)).gait == "straight"


@pytest.mark.parametrize(
    ("factory", "setting"),
    [
        (ProportionalNavigation, {"navigation_constant": 0.0}),
        (ConstantVelocity, {"acceleration": -1.0}),
        (ConstantVelocity, {"position": "small"}),
    ],
)
def test_wrong_settings(factory, setting, model):
    with pytest.raises(InputError, match=next(iter(setting))):
        factory(model, **setting)
