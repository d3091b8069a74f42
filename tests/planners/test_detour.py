"""The way round: geodesics by hand, and the planner that takes them."""

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import Pose
from bayeshunt.core.task import Task
from bayeshunt.models.arena.free_space import FreeSpace
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.planners.api import Situation
from bayeshunt.planners.conformance import check_planner
from bayeshunt.planners.detour.ways import WayFinder
from bayeshunt.planners.registry import make_planner

CELL = 0.0285


def ground(blocked, reach=16, visits=20):
    """A table in which every cell within ``reach`` of the start was visited but for those that ``blocked`` names."""
    numbers = range(-reach, reach + 1)
    free = [(x, y) for x in numbers for y in numbers if not blocked(x, y)]
    shut = [(x, y) for x in numbers for y in numbers if blocked(x, y)]
    visited, hit = (CELL * np.array(cells, dtype=float).reshape(-1, 2) for cells in (free, shut))
    return FreeSpace.of(CELL, np.repeat(visited, visits, axis=0), np.repeat(hit, visits, axis=0))


def barrier(x, y):
    return x == 6 and abs(y) <= 6


@pytest.fixture(scope="module")
def model(khepera_model):
    return khepera_model


def planner(model, space):
    return make_planner("detour", model, room=room(space))


def room(space):
    return RoomModel(np.zeros((0, 2)), np.zeros(0), np.zeros(0), np.zeros(0), {}, space)


def lure(pose, at):
    """A situation in which a prey that stands still has been seen for a while."""
    seen = pose.relative(Pose(*at, 0.0))
    rest = pose.relative(pose)
    return Situation(seen, PreyModel(), pose=pose, transitions=(rest,) * 3, task=Task(0.058, 60.0))


def test_a_way_round_by_hand():
    ways = WayFinder(ground(lambda x, y: False)).to(10 * CELL, 0.0)
    sure = 20.05 / 20.5
    assert ways.length(np.array([0.0]), np.array([0.0])) == pytest.approx([10 * CELL / sure], rel=0.01)
    assert ways.direction(np.array([0.0]), np.array([0.0])) == pytest.approx([0.0])
    round_it = WayFinder(ground(barrier)).to(10 * CELL, 0.0)
    # to the barrier's end at (6, 7), not cutting its corner, and on: six diagonals and one straight each way, less two
    (length,) = round_it.length(np.array([0.0]), np.array([0.0]))
    straight = 2 * np.hypot(7, 5) * CELL
    assert straight < length * sure < 1.15 * straight
    (direction,) = round_it.direction(np.array([0.0]), np.array([0.0]))
    assert abs(direction) == pytest.approx(np.arctan2(1, 1), abs=0.35)


def test_what_was_never_visited_is_avoided_but_not_shut():
    """A band that nobody has visited costs ten times its width, so a short way round is taken and a long one is not."""

    def known(gap):
        space = ground(lambda x, y: False)
        visits = np.where((np.arange(-16, 17)[:, None] == 6) & (np.arange(-16, 17)[None] < gap), 0, space.visits)
        return FreeSpace(CELL, space.origin, visits, space.hits)

    near, far = (WayFinder(known(gap)).to(10 * CELL, 0.0).length(0.0, 0.0) for gap in (3, 15))
    assert near < 13 * CELL
    assert far == pytest.approx((9 + 2 * 10) * CELL, rel=0.1)


def test_ways_are_found_once():
    finder = WayFinder(ground(barrier))
    assert finder.to(0.2, 0.0) is finder.to(0.2, 0.001)


def test_it_conforms(model):
    situations = [lure(Pose(0.0, 0.0, 0.3), (0.28, 0.0)), lure(Pose(-0.2, 0.1, 2.0), (0.28, 0.1))]
    check_planner(planner(model, ground(barrier)), model.gaits.names, situations, seed=0)


def test_without_a_map_and_where_the_way_is_free_it_is_the_interception(model):
    case = lure(Pose(0.0, 0.0, 0.3), (0.28, 0.05))
    plans = [
        each.plan(case, rng=np.random.default_rng(0))
        for each in (
            make_planner("intercept_walls", model, room=RoomModel.empty()), make_planner("detour", model),
            planner(model, ground(lambda x, y: False)),
        )
    ]  # fmt: skip
    assert len({(plan.gaits, plan.value, plan.objective) for plan in plans}) == 1


def test_it_goes_round_a_barrier(model):
    """Straight ahead is a lure behind a barrier: the interception runs at it, the detour turns to the nearer end."""
    case = lure(Pose(0.1, 0.05, 0.0), (0.3, 0.0))
    straight = make_planner("intercept_walls", model, room=RoomModel.empty()).plan(case, rng=np.random.default_rng(0))
    assert straight.gait in ("straight", "slow straight")
    plan = planner(model, ground(barrier)).plan(case, rng=np.random.default_rng(0))
    assert "way round" in plan.objective
    end = plan.trace[plan.trace["chosen"]].iloc[1]
    assert end["hunter_heading"] < -0.3  # clockwise: it has turned to the left
    assert plan.target.angle < -0.3  # where the way leads
    assert plan.value > 2 * straight.value


def test_the_trace_tells_the_probability_of_running_into_something(model):
    plan = planner(model, ground(barrier)).plan(lure(Pose(0.1, 0.05, 0.0), (0.3, 0.0)), rng=np.random.default_rng(0))
    trace = plan.trace.set_index("gaits")
    assert len(trace) == 1 + 10 + 100
    assert trace.loc["straight", "collision_probability"] == pytest.approx(1 - 0.05 / 20.5)
    assert trace.loc[plan.gait, "collision_probability"] < 0.5
    assert trace["value_s"].min() == plan.value
    assert trace[trace["chosen"]]["T"].tolist() == [0, 1, 2]


def test_no_gait_leads_through_a_thin_wall(model):
    """Few of the way's points lie in it: the rest of the way is free, and so is the prey's place behind it."""
    from bayeshunt.models.arena.obstacles import TouchedObstacles

    space = ground(barrier)
    hunter = planner(model, space)
    assert isinstance(hunter.obstacles, TouchedObstacles)
    seen = lure(Pose(0.0, 0.0, 0.0), (11 * CELL, 0.0))
    plan = hunter.plan(seen, rng=np.random.default_rng(0))
    assert "the way round" in plan.objective
    assert plan.gaits != ("straight", "straight")


def test_it_must_know_where_it_is(model):
    lost = lure(Pose(0.0, 0.0, 0.0), (0.3, 0.0))
    lost = Situation(lost.prey, lost.prey_model, transitions=lost.transitions, task=lost.task)
    with pytest.raises(InputError, match="detour: the situation must tell the hunter's own pose"):
        planner(model, ground(barrier)).plan(lost, rng=np.random.default_rng(0))


@pytest.mark.slow
@pytest.mark.parametrize(("arena", "seconds"), [("barrier", 20.0), ("u", 28.0)])
def test_a_lure_behind_something_is_reached(arena, seconds):
    """Seeds on which nothing was chosen and nothing is reported."""
    table = bh.evaluate("detour", planners=["detour"], arenas=[arena], runs=4, seed=700)
    assert table["caught"].all()
    assert table["time"].mean() < seconds + 2.0 * table["time"].std() / len(table) ** 0.5


@pytest.mark.slow
def test_who_does_not_know_the_obstacle_stays_there():
    table = bh.evaluate("detour", planners=["intercept_walls"], runs=1, seed=700)
    assert not table["caught"].any()


@pytest.mark.slow
def test_a_moving_prey_among_obstacles_is_caught_as_soon():
    table = bh.evaluate("clutter", planners=["intercept_walls", "detour"], runs=8, seed=700)
    times = table.pivot_table(index=["arena", "theta", "run"], columns="planner", values="time")
    later = times["detour"] - times["intercept_walls"]
    assert later.mean() < 2.0 * later.std() / len(later) ** 0.5
