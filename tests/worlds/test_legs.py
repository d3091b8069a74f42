"""Bodies on legs: they walk, turn, stumble where a change of gait takes the support away, and count what it costs."""

import hashlib
import math

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.config.loading import describe, parse
from bayeshunt.config.schema import ArenaSettings, NoiseSettings, PhysicsSettings, RobotSettings
from bayeshunt.core.errors import ConfigError, InputError
from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import Pose
from bayeshunt.views.figures.hunts import hunts
from bayeshunt.views.pages.replay import replay_data
from bayeshunt.worlds.box2d.support import supports
from bayeshunt.worlds.registry import make_world
from bayeshunt.worlds.scene import HUNTER, Scene

LEGGED = ("hexapod", "hexapod_mixed", "quadruped")
ORIGIN = Pose(0.0, 0.0, 0.0)
QUIET = NoiseSettings(slip=0.0, drift_sd=0.0)


def alone(robot, seed=0, arena=None, at=ORIGIN):
    world = make_world("box2d", Scene(robot, None, arena or ArenaSettings(), PhysicsSettings()))
    world.reset({HUNTER: at}, {HUNTER: np.random.default_rng(seed)})
    return world


def rates(robot, gait, seconds=2.048):
    """Body lengths and radians per second of a gait that has been held for a while; joules per second."""
    world = alone(robot)
    body, gait = world.bodies[HUNTER], robot.gaits[gait]
    start = world.run({HUNTER: gait}, 1.024).moments[-1]
    run = world.run({HUNTER: gait}, seconds)
    poses = np.array([moment.poses[HUNTER] for moment in (start, *run.moments)])
    turn = np.unwrap(poses[:, 2])
    way = np.hypot(*np.diff(poses[::8, :2], axis=0).T).sum()  # without the sway within a stride
    return way / body.length / seconds, (turn[-1] - turn[0]) / seconds, run.energy[HUNTER] / seconds


def quiet(name, **body):
    robot = bh.load_robot(name)
    return robot.model_copy(update={"noise": QUIET, "body": robot.body.model_copy(update=body)})


def test_the_hexapod_runs_and_turns_on_the_spot():
    robot = bh.load_robot("hexapod")
    assert rates(robot, "tripod fast")[0] > 1.2
    assert abs(rates(robot, "turn left")[1]) > 1.3
    assert rates(robot, "turn left")[1] > 0 > rates(robot, "turn right")[1]  # counter-clockwise
    assert rates(robot, "turn right")[0] < 0.15
    assert rates(robot, "left")[1] > 0.3
    assert rates(robot, "right")[1] < -0.3


@pytest.mark.parametrize("name", LEGGED)
def test_the_top_speed_is_the_measured_one(name):
    robot = bh.load_robot(name)
    fastest = max(rates(robot, gait.name)[0] for gait in robot.gaits if gait.command[0] == 2.0)
    assert robot.top_speed / robot.body.body_length == pytest.approx(fastest, rel=0.05)


@pytest.mark.parametrize(("name", "gait"), [("hexapod", "tripod fast"), ("hexapod", "ripple"), ("quadruped", "bound")])
def test_half_the_step_changes_the_speed_by_less_than_a_tenth(name, gait):
    speeds = [rates(quiet(name, step=step), gait)[0] for step in (0.008, 0.004)]
    assert speeds[0] == pytest.approx(speeds[1], rel=0.1)


@pytest.mark.parametrize("name", LEGGED)
def test_one_seed_gives_one_table(name):
    one, again, other = (bh.babble(name, 30, seed).drop(columns="step") for seed in (7, 7, 8))
    first, second, third = (hashlib.sha256(t.to_numpy(dtype=object).astype(str).tobytes()) for t in (one, again, other))
    assert first.hexdigest() == second.hexdigest() != third.hexdigest()


def test_a_change_to_another_pattern_loses_way_that_the_same_gait_does_not():
    frame = bh.babble("hexapod_mixed", 300, 1000)
    fast = frame[frame["gait"] == "tripod fast"]
    after = fast.groupby("previous_gait")["distance"].mean()
    assert after["wave"] < 0.75 * after["tripod fast"]


def test_a_gait_begins_in_the_phase_in_which_the_one_before_ended():
    robot = quiet("hexapod")
    world = alone(robot)
    body = world.bodies[HUNTER]
    world.run({HUNTER: robot.gaits["tripod fast"]}, 0.64)
    before = [*body._phase, body._clock]
    world.run({HUNTER: robot.gaits["wave"]}, 0.032)
    moved = [(new - old) % 1.0 for old, new in zip(before, [*body._phase, body._clock], strict=True)]
    assert max(moved) < 0.15


def test_energy_is_counted_by_the_body_and_stands_in_the_table():
    frame = bh.babble("hexapod", 24, 3)
    assert (frame["energy"] > 0).all()
    assert "energy" not in bh.babble("khepera", 10, 3)
    slow, fast = (rates(bh.load_robot("hexapod"), gait)[2] for gait in ("wave", "tripod fast"))
    assert 0.05 < slow < fast < 10.0  # watts
    with pytest.raises(bh.DataError, match="row 2: energy is nan"):
        bh.save_dataset(frame.assign(energy=frame["energy"].where(frame.index != 2)), "table.parquet")


def test_walls_hold_it_and_it_walks_away_again():
    robot = bh.load_robot("hexapod")
    world = alone(robot, arena=ArenaSettings(walled=True, width=1.0, height=1.0))
    body = world.bodies[HUNTER]
    world.run({HUNTER: robot.gaits["tripod fast"]}, 4.8)
    assert 0.3 < body.pose.x < 0.5 - 0.5 * robot.body.diameter + 0.01
    trunk = body._frame.trunk.position
    assert math.hypot(trunk.x * body.unit - body.pose.x, trunk.y * body.unit - body.pose.y) < 0.02
    world.run({HUNTER: robot.gaits["turn left"]}, 2.24)
    world.run({HUNTER: robot.gaits["tripod fast"]}, 2.0)
    assert body.pose.x < 0.3


def test_placing_moves_all_of_it_rigidly():
    robot = quiet("hexapod")
    ends = []
    for place in (None, Pose(0.3, -0.2, 1.0)):
        world = alone(robot)
        body = world.bodies[HUNTER]
        world.run({HUNTER: robot.gaits["left"]}, 0.96)
        if place is not None:
            body.place(place)
        start = body.pose
        world.run({HUNTER: robot.gaits["left"]}, 0.96)
        ends.append(start.relative(body.pose))
    assert np.allclose(ends[0], ends[1], atol=5e-3)


def test_a_fork_goes_on_as_the_body_would_without_noise():
    robot = quiet("hexapod")
    world = alone(robot)
    world.run({HUNTER: robot.gaits["wide left"]}, 0.96)
    twin = world.fork()
    for one in (world, twin):
        one.run({HUNTER: robot.gaits["tripod"]}, 0.96)
    assert np.allclose(world.bodies[HUNTER].pose, twin.bodies[HUNTER].pose, atol=5e-3)


@pytest.mark.parametrize("name", LEGGED)
def test_it_keeps_the_rules_of_bodies(name):
    bh.check_body(name)


def test_it_stays_where_it_is_until_it_is_commanded():
    world = alone(bh.load_robot("quadruped"), at=Pose(0.1, 0.2, 0.3))
    world.run({}, 0.64)
    assert np.allclose(world.bodies[HUNTER].pose, (0.1, 0.2, 0.3), atol=1e-6)


def test_the_load_is_shared_so_that_it_lies_over_the_feet_that_are_down():
    square = ((0.4, 0.3), (0.4, -0.3), (-0.4, 0.3), (-0.4, -0.3))
    table = supports(square)
    assert table[0b1111] == (pytest.approx((0.25,) * 4, abs=1e-3), pytest.approx((0, 0, 0), abs=1e-6))
    assert table[0b1001] == (pytest.approx((0.5, 0, 0, 0.5), abs=1e-3), pytest.approx((0, 0, 0), abs=1e-6))
    assert table[0b0011][1] == pytest.approx((0.4, 0.0, 0.0), abs=1e-3)  # it tips backwards
    assert table[0] == ((0.0,) * 4, (0.0, 0.0, 0.5))  # nothing is down: it falls


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"gait": [{"name": "a", "frequency": 1, "duty": 0.5, "stroke": [0.4, 0.4], "phase": [0, 0.5]}]}, "2 phases"),
        ({"gait": [{"name": "a", "left": 1.0, "right": 1.0}]}, "unknown key|required"),
        ({"body": {"drive": "legs", "top_speed": 0.2, "legs": {"x": [0.1], "y": [0.1, 0.2]}}}, "one for each leg"),
        ({"body": {"drive": "legs", "top_speed": 0.2, "step": 0.1}}, "body.step"),
        ({"body": {"drive": "legs"}}, "body.top_speed: required"),
    ],
)
def test_what_does_not_fit_the_legs_is_told_in_one_line(change, said):
    values = {**bh.load_robot("hexapod").model_dump(), **change}
    with pytest.raises(ConfigError, match=said) as told:
        parse(RobotSettings, values, "mine")
    assert "\n" not in str(told.value)


def test_a_command_for_other_legs_is_refused():
    body = alone(bh.load_robot("quadruped")).bodies[HUNTER]
    with pytest.raises(InputError, match="commands 6 legs, not 4"):
        body.command(Gait("six", (1.0, 0.5, 0.4, 0.4, *[0.0] * 6)))


def test_every_key_of_legs_is_described():
    keys = {key["key"]: key for key in describe("robot")}
    assert {"body.length", "body.width", "body.legs.tilt_time", "gait[].phase", "gait[].duty"} <= set(keys)
    assert keys["body.legs.friction"]["default"] == 0.8
    assert all(key["meaning"] for key in keys.values())
    assert keys["body.drive"]["range"] == "differential | car | legs | mujoco"
    assert keys["gait[].stroke"]["range"] == "list of 2 numbers >= -1.5708, <= 1.5708"
    assert keys["body.legs.x"]["range"] == "list of 1 to 10 numbers"
    assert keys["body.hips"]["range"] == "list of lists of 2 numbers"
    steps = [(key["range"], key["default"]) for key in describe("robot") if key["key"] == "body.step"]
    assert steps == [("number > 0, <= 0.05", 0.008), ("number > 0, <= 0.01", 0.002)]  # on legs, and in MuJoCo


def test_legs_hunt():
    settings = bh.load_experiment(
        "paper", {"robot": "hexapod", "prey.speed": 0.1, "prey.body.diameter": 0.2, "protocol.time_limit": 6.0}
    )
    model = bh.ForwardModel.fit(bh.babble("hexapod", 240, 3), settings.robot.gaits, 0.03)
    episode = bh.hunt(settings, bh.make_planner("planning", model), arena="open", theta=0.5, seed=1)
    assert len(episode.frame) >= 4
    scene = replay_data(episode)
    assert len(scene["legs"]) == 6
    assert scene["legs"][0] == pytest.approx([0.085, 0.05, 0.13, 0.1279], abs=1e-3)
    assert hunts([episode]).axes
