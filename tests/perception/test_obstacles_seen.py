"""Particles know what the hunter has touched: no prey is in it, none goes through it, none is seen behind it."""

import math

import numpy as np
import pytest

from bayeshunt.config.schema.camera import CameraSettings
from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import Pose
from bayeshunt.core.messages import Frame, Observation
from bayeshunt.models.arena.free_space import FreeSpace
from bayeshunt.models.arena.obstacles import TouchedObstacles
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.models.target.turns import TurnModel
from bayeshunt.perception.setting import PerceptionContext
from bayeshunt.perception.trackers.particles import ParticleTracker

CELL, HERE, GAIT = 0.03, Pose(0.0, 0.0, 0.0), Gait("ahead", (0.05, 0.05))
NO_WALLS = (np.zeros((0, 2)), np.zeros(0))


def line(x, low, high):
    """Cells of a wall across the way, ``x`` ahead, from ``low`` to ``high`` to the left [m]."""
    left = np.arange(low, high + 1e-9, CELL)
    return np.column_stack([np.full(len(left), x), left])


@pytest.fixture(scope="module")
def barrier():
    """A barrier 0.3 m ahead, 0.36 m wide; cells before and behind it have been visited."""
    visited = np.vstack([line(0.15, -0.3, 0.3), line(0.6, -0.6, 0.6)])
    return TouchedObstacles.of(FreeSpace.of(CELL, visited, line(0.3, -0.18, 0.18)), *NO_WALLS)


def tracker(obstacles, start="shown", **camera):
    motion = TurnModel(prior_speed=0.1, prior_turns=np.array([1.0, -1.0]))
    context = PerceptionContext(
        2.0, 0.06, 0.06, camera=CameraSettings(**camera), start=start, motion=motion, obstacles=obstacles
    )
    return ParticleTracker(context, 2000)


def test_what_was_touched_inside_the_walls_is_an_obstacle_and_what_was_never_visited_is_not(barrier):
    x, y = np.array([0.3, 0.3, 0.15, 0.45, 0.3]), np.array([0.0, 0.15, 0.0, 0.0, 0.3])
    assert barrier.inside(x, y).tolist() == [True, True, False, False, False]
    space = FreeSpace.of(CELL, line(0.15, -0.3, 0.3), line(0.3, -0.18, 0.18))
    assert TouchedObstacles.of(space, np.array([[1.0, 0.0]]), np.array([0.27])) is None  # it is the wall's own line
    assert TouchedObstacles.of(None, *NO_WALLS) is None
    visits = FreeSpace.of(CELL, np.repeat([[0.3, 0.0]], 3, axis=0), np.array([[0.3, 0.0]]))
    assert TouchedObstacles.of(visits, *NO_WALLS) is None  # one touch among visits: it is free
    assert RoomModel.empty().obstacles() is None


def test_nothing_is_seen_behind_it_and_no_way_leads_through_it(barrier):
    x, y = np.array([0.5, 0.2, 0.5, -0.5]), np.array([0.0, 0.0, 0.5, 0.0])
    assert barrier.hidden(0.0, 0.0, x, y).tolist() == [True, False, False, False]
    start = np.zeros(4)
    assert barrier.met(start, start, x, y).tolist() == [True, False, False, False]
    assert not barrier.met(np.array([0.3]), np.array([0.0]), np.array([0.5]), np.array([0.0]))[0]  # out of it


def test_a_prey_that_is_not_seen_may_be_behind_it(barrier):
    shares = []
    for obstacles in (None, barrier):
        belief = tracker(obstacles, "unknown").start(Observation(0.0, HERE, (Frame(0.0, HERE),)))
        x, y, weight = belief.cloud.x, belief.cloud.y, belief.cloud.weight
        behind = (x > 0.36) & (np.abs(np.arctan2(y, x)) < 0.4)
        shares.append(float(weight[behind].sum()))
        if obstacles is not None:
            assert weight[obstacles.inside(x, y)].sum() < 0.005  # a 37th of the square is in it
    assert shares[0] < 0.02  # looked at, and nothing there
    assert shares[1] > 0.05  # as it was before the look


def test_a_prey_that_meets_it_turns_away_and_is_not_lost_on_the_other_side(barrier):
    far = []
    for obstacles in (None, barrier):
        mind, rng = tracker(obstacles), np.random.default_rng(3)
        seen = [mind.camera.detection_of(0.0, distance=0.15 + 0.05 * time, width=0.06) for time in range(3)]
        belief = mind.start(Observation(0.0, HERE, (Frame(0.0, HERE, (seen[0],)),)))
        frames = tuple(Frame(float(time), HERE, (seen[time],)) for time in (1, 2))
        belief = mind.update(belief, GAIT, Observation(2.0, HERE, frames), rng=rng)
        away = Pose(0.0, 0.0, math.pi)  # the hunter looks elsewhere
        for time in (4.0, 6.0):
            belief = mind.update(belief, GAIT, Observation(time, away, (Frame(time, away),)), rng=rng)
        far.append(float(belief.cloud.weight @ (belief.cloud.x > 0.33)))
    assert far[0] > 0.6
    assert far[1] < 0.1


def test_a_planner_lends_what_it_has_touched(khepera_model):
    from bayeshunt.episodes.knowledge import known_to
    from bayeshunt.planners.registry import make_planner

    walls = {"lengths": np.ones(1), "blocked": np.ones(1, dtype=int)}
    space = FreeSpace.of(CELL, line(0.15, -0.3, 0.3), line(0.3, -0.18, 0.18))
    room = RoomModel(np.array([[1.0, 0.0]]), np.array([0.6]), **walls, space=space)
    for name in ("search", "intercept_walls", "detour"):
        found = known_to(make_planner(name, khepera_model, room=room)).obstacles
        assert found is not None
        assert found.inside(np.array([0.3]), np.array([0.0]))[0]
    assert known_to(make_planner("intercept", khepera_model)).obstacles is None
