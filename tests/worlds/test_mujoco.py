"""Puppy in MuJoCo: it bounds and turns as published, falls and is set upright, and hunts a prey of the same world."""

import hashlib
import math
import sys

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.config.loading import parse
from bayeshunt.config.schema import ArenaSettings, NoiseSettings, PhysicsSettings, RobotSettings
from bayeshunt.core.errors import ConfigError, InputError
from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import Pose
from bayeshunt.core.messages import Reach
from bayeshunt.core.streams import spawn_streams
from bayeshunt.views.pages.replay import replay_data
from bayeshunt.worlds.registry import make_world
from bayeshunt.worlds.scene import HUNTER, PREY, Scene

pytest.importorskip("mujoco")

ORIGIN = Pose(0.0, 0.0, 0.0)


@pytest.fixture(scope="module")
def puppy():
    return bh.load_robot("puppy")


def alone(robot, arena=None, at=ORIGIN, seed=0):
    world = make_world("box2d", Scene(robot, None, arena or ArenaSettings(), PhysicsSettings()))
    world.reset({HUNTER: at}, {HUNTER: np.random.default_rng(seed)})
    return world


def rates(robot, gait):
    """Body lengths and radians per second of a gait that has been held for a while."""
    world = alone(robot)
    start = world.run({HUNTER: robot.gaits[gait]}, 1.024).moments[-1].poses[HUNTER]
    run = world.run({HUNTER: robot.gaits[gait]}, 4.096)
    poses = np.array([start, *(moment.poses[HUNTER] for moment in run.moments)])
    turn = np.unwrap(poses[:, 2])
    way = np.hypot(*np.diff(poses[::8, :2], axis=0).T).sum()
    return way / 0.2 / 4.096, (turn[-1] - turn[0]) / 4.096, run.energy[HUNTER] / 4.096


@pytest.mark.parametrize(
    ("gait", "speed", "turn"), [("bound", 1.75, 0.0), ("bound 1Hz", 0.9, 0.0), ("bound left 1Hz", 0.85, 1.2)]
)
def test_the_published_gaits_walk_and_turn(puppy, gait, speed, turn):
    quiet = puppy.model_copy(update={"noise": NoiseSettings(slip=0.0, drift_sd=0.0)})
    fast, turning, power = rates(quiet, gait)
    assert fast == pytest.approx(speed, rel=0.25)
    assert turning == pytest.approx(turn, abs=0.35)
    assert 0.5 < power < 6.0


def test_left_is_left_and_right_is_right(puppy):
    assert rates(puppy, "bound left")[1] > 0.4 > -0.4 > rates(puppy, "bound right")[1]


def test_its_gaits_last_whole_cycles(puppy):
    """A gait of 2 s begins in the phase in which it began before: the step of physics divides it."""
    assert puppy.physics.steps(puppy.gait_duration) * puppy.physics.step == pytest.approx(2.0)
    made = bh.load_experiment("paper", {"robot": "puppy"})
    assert made.physics == puppy.physics
    assert bh.load_experiment(made, {"robot": "khepera"}).physics == bh.load_experiment("paper").physics
    assert bh.load_experiment("paper", {"robot": "puppy", "physics.step": 0.01}).physics.step == 0.01


def test_one_seed_one_table(puppy):
    one, again, other = (bh.babble(puppy, 20, seed) for seed in (3, 3, 4))
    digests = [hashlib.sha256(f.to_csv().encode()).hexdigest() for f in (one, again, other)]
    assert digests[0] == digests[1] != digests[2]
    assert (one["energy"] > 0).all()
    assert (one["falls"] == 0).all()
    assert one.attrs["bayeshunt"]["versions"]["mujoco"]


def test_however_a_run_is_cut_it_is_the_same(puppy):
    """Phase and servo carry over: a gait held in one run, or in pieces, is one motion."""
    whole, cut = alone(puppy), alone(puppy)
    whole.run({HUNTER: puppy.gaits["bound"]}, 1.28)
    for _ in range(10):
        cut.run({HUNTER: puppy.gaits["bound"]}, 0.128)
    assert whole.bodies[HUNTER].pose == pytest.approx(cut.bodies[HUNTER].pose, abs=1e-6)


def test_a_body_that_lies_too_long_is_set_upright_where_it_lies(puppy):
    world = alone(puppy)
    body = world.bodies[HUNTER]
    world.run({HUNTER: puppy.gaits["bound"]}, 0.64)
    body.data.qpos[body.place_at + 3 : body.place_at + 7] = (0.0, 1.0, 0.0, 0.0)  # on its back
    lying = Gait("lies", (1.0,) * 4 + (0.0,) * 12)
    for _ in range(3):
        world.run({HUNTER: lying}, 0.32)
    assert body.falls == 1
    quaternion = body.data.qpos[body.place_at + 3 : body.place_at + 7]
    assert 1 - 2 * (quaternion[1] ** 2 + quaternion[2] ** 2) > 0.9


def test_it_is_placed_as_it_is(puppy):
    """A rigid move turns its way along."""
    one, other = alone(puppy), alone(puppy)
    for world in (one, other):
        world.run({HUNTER: puppy.gaits["bound"]}, 1.28)
    other.bodies[HUNTER].place(Pose(1.0, -2.0, 2.0))
    ends = []
    for world in (one, other):
        start = world.bodies[HUNTER].pose
        world.run({HUNTER: puppy.gaits["bound"]}, 0.64)
        ends.append(start.relative(world.bodies[HUNTER].pose))
    # the noise of a new control interval is another, so only nearly
    assert ends[1].forward == pytest.approx(ends[0].forward, abs=0.03)
    assert other.bodies[HUNTER].pose.x < 1.0  # it faces 115 degrees to the left


def test_walls_and_obstacles_hold_both(puppy):
    arena = ArenaSettings(walled=True, width=0.6, height=0.6, obstacles=({"x": 0.2, "y": 0.2, "radius": 0.05},))
    world = alone(puppy, arena)
    world.run({HUNTER: puppy.gaits["bound"]}, 4.0)
    assert abs(world.bodies[HUNTER].pose.x) < 0.3
    assert abs(world.bodies[HUNTER].pose.y) < 0.3


def scene(puppy, **changes):
    settings = bh.load_experiment("paper", {"robot": "puppy", **changes})
    return settings, Scene(puppy, settings.prey, settings.arenas["open"], settings.physics)


def test_the_prey_runs_in_the_same_world_as_fast_as_it_says(puppy):
    settings, both = scene(puppy, **{"prey.noise.slip": 0.0, "prey.noise.drift_sd": 0.0, "prey.behaviour": "straight"})
    world = make_world("mujoco", both)
    world.reset({HUNTER: ORIGIN, PREY: Pose(1.0, 0.5, 1.0)}, spawn_streams(1))
    world.run({HUNTER: puppy.gaits["bound"]}, 1.28)
    before = world.bodies[PREY].pose
    world.run({HUNTER: puppy.gaits["bound"]}, 1.28)
    moved = before.relative(world.bodies[PREY].pose)
    assert moved.distance == pytest.approx(1.28 * settings.prey.speed, rel=0.01)
    assert abs(moved.angle) < 0.01
    twin = world.fork(PREY)
    assert list(twin.bodies) == [PREY]
    twin.run({}, 1.28)
    world.run({HUNTER: puppy.gaits["bound"]}, 1.28)
    assert twin.bodies[PREY].pose == pytest.approx(world.bodies[PREY].pose, abs=0.01)


def test_the_catch_is_seen_within_a_step_of_the_engine(puppy):
    _, both = scene(puppy, **{"prey.speed": 0.0})
    world = make_world("mujoco", both)
    world.reset({HUNTER: ORIGIN, PREY: Pose(0.5, 0.0, 0.0)}, spawn_streams(1))
    run = world.run({HUNTER: puppy.gaits["bound"]}, 6.0, Reach(HUNTER, PREY, 0.25))
    assert run.stopped == PREY
    a, b = run.moments[-1].poses[HUNTER], run.moments[-1].poses[PREY]
    assert math.hypot(a.x - b.x, a.y - b.y) == pytest.approx(0.25, abs=0.003)
    assert run.moments[-1].time == pytest.approx(world.time)


def test_a_hunt_says_what_it_cost_and_replays(puppy):
    model = bh.ForwardModel.fit(bh.babble(puppy, 60, 1), puppy.gaits, 0.03)
    settings = bh.load_experiment("paper", {"robot": "puppy", "protocol.time_limit": 6.0})
    episode = bh.hunt(settings, bh.make_planner("intercept", model), arena="open", theta=1.0, seed=2)
    again = bh.hunt(settings, bh.make_planner("intercept", model), arena="open", theta=1.0, seed=2)
    assert again.trail.equals(episode.trail)
    assert episode.provenance["energy"] > 1.0
    assert len(replay_data(episode)["legs"]) == 4


def test_what_cannot_be_is_said_in_one_line(puppy, tmp_path, monkeypatch):
    with pytest.raises(InputError, match=r"robot 'khepera' has a differential drive"):
        make_world("mujoco", Scene(bh.load_robot("khepera"), None, ArenaSettings(), PhysicsSettings()))
    with pytest.raises(InputError, match=r"commands 2 actuators, not 4"):
        alone(puppy).run({HUNTER: Gait("half", (1.0,) * 8)}, 0.1)
    values = puppy.model_dump()
    short = {**values, "gait": [{**values["gait"][0], "phase": [0.0]}]}
    with pytest.raises(ConfigError, match=r"gait 1 \('bound'\).*1 of phase"):
        parse(RobotSettings, short, "mine.toml")
    path = tmp_path / "mine.xml"
    for text, said in (
        ("not xml", "not MJCF"), ("<mujoco/>", "a body 'trunk' on a free joint"),
    ):  # fmt: skip
        path.write_text(text)
        mine = parse(RobotSettings, {**values, "body": {**values["body"], "model": str(path)}}, "mine.toml")
        with pytest.raises(InputError, match=said):
            alone(mine)
    lost = parse(RobotSettings, {**values, "body": {**values["body"], "model": "lost.xml"}}, "mine.toml")
    with pytest.raises(InputError, match="neither puppy nor the path"):
        alone(lost)


def test_without_mujoco_one_line_says_how_to_install_it(bayeshunt, monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "mujoco", None)
    _, err = bayeshunt("babble", "--robot", "puppy", "--steps", "5", "--out", str(tmp_path / "b.parquet"), status=2)
    assert "pip install '.[mujoco]'" in err
    assert "puppy" in bayeshunt("robots")[0]


def test_it_keeps_the_rules_of_worlds_and_bodies(puppy):
    bh.check_world("mujoco", bh.load_experiment("paper", {"robot": "puppy"}), arena="walled", seed=1)
    bh.check_body("puppy")


@pytest.mark.slow
def test_babbling_seldom_falls_and_the_gait_before_matters(puppy):
    frame = bh.babble(puppy, 2000, 0)
    assert frame["falls"].mean() <= 0.01
    learned, held_out = frame.iloc[:1600], frame.iloc[1600:]
    axes = bh.EffectAxes.standard(0.2).extended(40)  # every row lies within
    naive = bh.ForwardModel.fit(learned, puppy.gaits, 0.03, axes=axes)
    previous = bh.ForwardModel.fit(learned, puppy.gaits, axes=axes, structure="previous_gait", backoff=5.0)
    gain = (previous.log_likelihood(held_out) - naive.log_likelihood(held_out)) / len(held_out)
    assert gain > 1.0  # nats a row
