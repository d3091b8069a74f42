"""What a planner hands on to a tracker: per time-step, whatever the legs that it compares motions over."""

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.core.geometry import Polar, Pose
from bayeshunt.episodes.knowledge import NOTHING, known_to
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.planners.api import Situation


@pytest.fixture(scope="module")
def legs(khepera_model):
    """Two hunters: of legs of one time-step, and of two."""
    one, two = (bh.make_planner("search", khepera_model, leg=leg, hazard=0.5) for leg in (3.4, 6.8))
    assert (one.steps, two.steps) == (1, 2)
    return one, two


def test_what_is_known_of_the_prey_is_per_time_step(legs):
    one, two = (known_to(planner).motion for planner in legs)
    leg = legs[0].prior
    assert (one.prior_speed, one.prior_hazard, one.prior_steps) == (leg.prior_speed, leg.prior_hazard, leg.prior_steps)
    assert np.array_equal(one.prior_turns, leg.prior_turns)
    assert one.prior_drift == pytest.approx(0.9 * leg.prior_drift)  # at its speed, as believed: 0.9 of the hunter's
    assert two.prior_speed == pytest.approx(one.prior_speed, rel=0.02)  # the same top speed
    assert two.prior_drift == pytest.approx(one.prior_drift, rel=0.02)
    assert (1.0 - two.prior_hazard) ** 2 == pytest.approx(1.0 - one.prior_hazard)  # both of a leg
    assert two.prior_steps == 2.0 * one.prior_steps


def test_a_searching_hunter_counts_speed_and_turns_by_the_leg(legs):
    case = Situation(Polar(0.4, 0.1, 0.5), PreyModel(), pose=Pose(0.0, 0.0, 0.0))
    for planner in legs:
        futures = planner.sampled(case, np.random.default_rng(0))
        assert futures.speed == pytest.approx(planner.prior.prior_speed / planner.leg)
        assert (futures.starts[:, 1] <= planner.leg).mean() == pytest.approx(0.5, abs=0.03)  # hazard per leg


@pytest.mark.parametrize("name", ["intercept_walls", "detour", "search"])
def test_walls_are_those_of_the_prey_not_of_the_hunter(khepera_model, name):
    sides = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    room = RoomModel(sides, np.full(4, 0.57), np.full(4, 1.1), np.full(4, 50))
    walls = known_to(bh.make_planner(name, khepera_model, room=room, clearance=0.5, rebound=0.4)).walls
    assert walls.offsets == pytest.approx([0.57 - 0.5 * khepera_model.gaits.body_length] * 4)
    assert walls.rebound == pytest.approx(0.4)


def test_who_knows_no_room_knows_no_walls(khepera_model):
    assert known_to(bh.make_planner("intercept", khepera_model)).walls is None
    assert known_to(bh.make_planner("planning", khepera_model)) == NOTHING
