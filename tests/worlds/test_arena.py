"""Physics: drives, limits, momentum, walls and the catch rule."""

import math

import numpy as np
import pytest
from trial_cases import Trial

from bayeshunt.config.loading import load_robot
from bayeshunt.config.schema import ArenaSettings, NoiseSettings, PhysicsSettings, PreySettings
from bayeshunt.core.geometry import Pose
from bayeshunt.worlds.box2d.world import build_walls, new_world
from bayeshunt.worlds.noise import actuator_factors

QUIET = NoiseSettings(slip=0.0, drift_sd=0.0)
ORIGIN, FAR = Pose(0.0, 0.0, 0.0), Pose(5.0, 5.0, 0.0)


def quiet(robot):
    return load_robot(robot).model_copy(update={"noise": QUIET})


def arena_for(robot, *, prey_pose=FAR, hunter_pose=ORIGIN, walled=False, prey_speed=0.0, catch=0.058):
    prey = PreySettings(behaviour="straight", speed=prey_speed, noise=QUIET)
    return Trial(
        robot, prey, ArenaSettings(walled=walled), PhysicsSettings(),
        hunter_pose=hunter_pose, prey_pose=prey_pose, catch_distance=catch,
    )  # fmt: skip


def test_straight_gait_covers_speed_times_time_less_the_start():
    arena = arena_for(quiet("khepera"))
    arena.run((0.0576, 0.0576), 3.2)
    # at 0.6 m/s2 the first two steps of 32 ms run at 19.2 and 38.4 mm/s instead of 57.6
    assert arena.hunter.pose.x == pytest.approx(0.0576 * 3.2 - (0.0384 + 0.0192) * 0.032, abs=1e-6)
    assert arena.hunter.pose.y == pytest.approx(0.0, abs=1e-6)


def test_turning_rate_is_the_wheels_difference_over_the_axle():
    arena = arena_for(quiet("khepera"))
    arena.run((0.02, 0.03), 1.0)
    start = arena.hunter.pose.theta
    arena.run((0.02, 0.03), 2.0)
    turned = arena.hunter.pose.theta - start
    assert turned == pytest.approx(0.01 / 0.052 * arena.physics.steps(2.0) * 0.032, rel=1e-3)


def test_car_follows_the_bicycle_model():
    arena = arena_for(quiet("car"))
    arena.run((0.05, 0.3), 1.0)
    start = arena.hunter.pose.theta
    arena.run((0.05, 0.3), 2.0)
    seconds = arena.physics.steps(2.0) * 0.032
    assert arena.hunter.pose.theta - start == pytest.approx(0.05 * math.tan(0.3) / 0.045 * seconds, rel=1e-3)


def test_car_cannot_turn_on_the_spot():
    arena = arena_for(quiet("car"))
    arena.run((0.0, 0.5), 3.0)
    assert arena.hunter.pose.theta == pytest.approx(0.0, abs=1e-9)


def test_momentum_is_carried_into_the_next_gait():
    rolling, resting = arena_for(quiet("khepera")), arena_for(quiet("khepera"))
    rolling.run((0.0576, 0.0576), 1.0)
    before = rolling.hunter.pose.x
    for arena in (rolling, resting):
        arena.run((0.0, 0.0), 1.0)
    assert rolling.hunter.pose.x - before > 0.001
    assert resting.hunter.pose.x == 0.0


def test_walls_stop_a_robot_and_it_slides_along_them():
    arena = arena_for(quiet("khepera"), walled=True, hunter_pose=Pose(0.0, 0.0, 0.5))
    arena.run((0.0576, 0.0576), 20.0)
    x, y, theta = arena.hunter.pose
    assert x == pytest.approx(0.6 - 0.0285, abs=0.002)
    assert y > 0.35  # it went on along the wall
    assert theta == pytest.approx(0.5, abs=1e-5)  # no friction, no spin


def test_a_contact_takes_the_velocity_that_it_takes():
    """A robot held by a wall has no speed into it left, so leaving it starts from rest, within the traction limit."""
    slippery = quiet("khepera")
    slippery = slippery.model_copy(update={"body": slippery.body.model_copy(update={"max_traction": 0.05})})
    held = arena_for(slippery, walled=True, hunter_pose=Pose(0.54, 0.0, 0.0))
    held.run((0.0576, 0.0576), 6.4)
    assert held.hunter.pose.x == pytest.approx(0.6 - 0.0285, abs=0.001)
    assert abs(held.hunter.vx) * held.unit < 1e-3  # what it believes of itself is what the wall has left of it
    free = arena_for(slippery)
    starts = held.hunter.pose.x, free.hunter.pose.x
    for arena in (held, free):
        arena.run((-0.0576, -0.0576), 0.64)
    gone = [start - arena.hunter.pose.x for start, arena in zip(starts, (held, free), strict=True)]
    assert gone[1] == pytest.approx(0.05 * 0.032**2 * sum(range(1, 21)), rel=1e-4)  # 20 steps at 0.05 m/s2
    # Its wheels stop first: at 0.6 m/s2 that takes three of the steps, in which it does not move.
    assert gone[0] == pytest.approx(0.05 * 0.032**2 * sum(range(1, 18)), rel=0.02)


def test_a_pushed_robot_knows_that_it_moves():
    """The prey stands with its wheels locked; pushed out of its place, it comes to rest at its tyres' limit."""
    arena = arena_for(quiet("khepera"), prey_pose=Pose(0.06, 0.0, 0.0), catch=0.001)
    arena.run((0.0576, 0.0576), 1.6)
    assert arena.world.contactCount
    assert (arena.prey.vx, arena.prey.vy) == (arena.prey.body.linearVelocity.x, arena.prey.body.linearVelocity.y)
    assert arena.prey.vx > 0.05


def test_the_walls_are_solid_from_the_inner_edge_outwards():
    """Nothing of the rectangle itself, and two units of wall around it, corners included."""
    width, height = 6.0, 4.0
    world = new_world()  # kept: its bodies do not outlive it
    fixtures = build_walls(world, width, height).fixtures

    def solid(x, y):
        return any(fixture.TestPoint((float(x), float(y))) for fixture in fixtures)

    for x in np.linspace(-0.499, 0.499, 13) * width:
        for y in np.linspace(-0.499, 0.499, 13) * height:
            assert not solid(x, y)
    rim = [(3.0 + beyond, y) for beyond in (0.01, 1.0, 1.99) for y in np.linspace(0.0, 3.99, 12)]
    rim += [(x, 2.0 + beyond) for beyond in (0.01, 1.0, 1.99) for x in np.linspace(0.0, 4.99, 12)]
    for x, y in rim:
        for across, up in ((x, y), (-x, y), (x, -y), (-x, -y)):
            assert solid(across, up), (across, up)
    assert not solid(5.01, 0.0)
    assert not solid(0.0, -4.01)


@pytest.mark.parametrize("theta", [0.7, 2.5, -0.8, -2.3])
def test_no_robot_leaves_through_a_corner(theta):
    """A small body at ten times the usual speed, its tyres never slipping."""
    robot = quiet("khepera")
    body = robot.body.model_copy(update={"max_acceleration": 50.0, "max_traction": 500.0})
    arena = arena_for(robot.model_copy(update={"body": body}), walled=True, hunter_pose=Pose(0.0, 0.0, theta))
    moments = []
    arena.run((0.576, 0.576), 6.4, moments)
    path = np.array([moment.poses["hunter"] for moment in moments])
    assert np.abs(path[:, :2]).max() < 0.6 - 0.0285 + 0.003
    assert np.abs(path[-1, :2]) == pytest.approx(0.6 - 0.0285, abs=0.003)  # in the corner


def test_robots_do_not_pass_through_each_other():
    arena = arena_for(quiet("khepera"), prey_pose=Pose(0.1, 0.0, 0.0), catch=0.001)
    arena.run((0.0576, 0.0576), 3.0)
    gap = arena.prey.pose.x - arena.hunter.pose.x
    assert gap == pytest.approx(0.057, abs=0.001)
    assert arena.prey.pose.x > 0.105  # pushed


def test_the_catch_is_found_at_the_physics_step_it_happens():
    arena = arena_for(quiet("khepera"), prey_pose=Pose(0.15, 0.0, 0.0), catch=0.0581)
    assert arena.run((0.0576, 0.0576), 3.328)
    gap = math.hypot(arena.prey.pose.x - arena.hunter.pose.x, arena.prey.pose.y - arena.hunter.pose.y)
    assert 0.0581 - 0.0576 * 0.032 - 1e-6 < gap <= 0.0581 + 1e-6
    assert arena.time < 3.328
    assert arena.time / 0.032 == pytest.approx(round(arena.time / 0.032))
    before = arena.time
    assert arena.run((0.0576, 0.0576), 1.0)  # a caught prey stays caught and time stands still
    assert arena.time == before


def test_a_trial_is_repeatable_in_a_fresh_world():
    def end():
        arena = arena_for(load_robot("khepera"), prey_pose=Pose(0.2, 0.01, 2.0), walled=True, prey_speed=0.05)
        arena.run((0.0576, 0.05), 30.0)
        return arena.hunter.pose, arena.prey.pose

    assert end() == end()


def test_traction_limits_the_change_of_velocity():
    robot = quiet("khepera")
    slippery = robot.model_copy(update={"body": robot.body.model_copy(update={"max_traction": 0.02})})
    arena = arena_for(slippery)
    arena.run((0.0576, 0.0576), 1.0)
    # 0.02 m/s2 for a second: less than half of 0.02 m
    assert arena.hunter.pose.x == pytest.approx(0.5 * 0.02 * 1.0**2, rel=0.1)


@pytest.mark.parametrize("theta", [0.0, 0.6, math.pi / 4, -2.0])
def test_traction_is_the_same_in_every_direction(theta):
    robot = quiet("khepera")
    # wheels gain 0.6 m/s2, the tyres carry 0.5: full speed 0.0576 m/s is reached after 0.0576 / 0.5 s
    slippery = robot.model_copy(update={"body": robot.body.model_copy(update={"max_traction": 0.5})})
    arena = arena_for(slippery, hunter_pose=Pose(0.0, 0.0, theta))
    arena.run((0.0576, 0.0576), 3 * 0.032)
    gone = 0.5 * 0.032 * 0.032 * (1 + 2 + 3)
    assert arena.hunter.pose[:2] == pytest.approx((gone * math.cos(theta), gone * math.sin(theta)), abs=1e-8)


def test_each_wheel_speeds_up_and_slows_down_by_at_most_its_limit():
    arena = arena_for(quiet("khepera"))
    change = 0.6 * 0.032
    for left, right in ((0.05, -0.05), (-0.05, 0.05)):
        before = arena.hunter.state
        arena.run((left, right), 0.032)
        assert arena.hunter.state == pytest.approx(
            (before[0] + math.copysign(change, left), before[1] + math.copysign(change, right))
        )
    arena.run((0.05, 0.05), 1.0)
    assert arena.hunter.state == (0.05, 0.05)


def test_a_pose_has_an_angle_of_the_half_open_turn():
    arena, moments = arena_for(quiet("khepera")), []
    arena.run((0.0576, -0.0576), 10.0, moments)  # more than three times round
    angles = np.array([moment.poses["hunter"].theta for moment in moments])
    assert ((angles > -math.pi) & (angles <= math.pi)).all()
    assert np.ptp(np.unwrap(angles)) > 6 * math.pi


def test_noise_has_the_stated_spread():
    settings = NoiseSettings(slip=0.1, drift_sd=0.025, drift_time=0.5)
    factors = actuator_factors(settings, 0.064, np.random.default_rng(0))
    a = np.array([next(factors) for _ in range(20000)])
    # var = slip^2 / 3 + drift^2 (the product term is below 1e-5)
    assert a.std() == pytest.approx(math.sqrt(0.1**2 / 3 + 0.025**2), rel=0.03)
    assert a.mean() == pytest.approx(1.0, abs=0.003)
    assert abs(np.corrcoef(a.T)[0, 1]) < 0.03  # wheels slip independently
    # drift remembers: lag-1 autocovariance = drift^2 exp(-dt / tau)
    lag = np.mean((a[1:, 0] - 1) * (a[:-1, 0] - 1))
    assert lag == pytest.approx(0.025**2 * math.exp(-0.064 / 0.5), rel=0.25)
