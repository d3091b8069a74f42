"""Processor time of bodies on legs against bare Box2D, and what the length of the physics step changes."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from statistics import median
from typing import Any

import numpy as np

from bayeshunt.config.loading import load_robot
from bayeshunt.config.schema import ArenaSettings, NoiseSettings, PhysicsSettings
from bayeshunt.core.geometry import Pose
from bayeshunt.worlds.registry import make_world
from bayeshunt.worlds.scene import HUNTER, Scene

Table = Callable[[Sequence[str], list[list[str]]], str]
LEGGED, WHEELS = ("hexapod", "hexapod_mixed", "quadruped"), "khepera"
ROUNDS, SECONDS = 5, 20.48
_GAITS = (
    ("hexapod", "tripod fast"), ("hexapod", "turn left"), ("hexapod", "ripple"), ("quadruped", "bound"),
    ("quadruped", "trot fast"),
)  # fmt: skip


def _alone(robot: Any, seed: int) -> Any:
    world = make_world("box2d", Scene(robot, None, ArenaSettings(), PhysicsSettings()))
    world.reset({HUNTER: Pose(0.0, 0.0, 0.0)}, {HUNTER: np.random.default_rng(seed)})
    return world


def per_second(robot: Any, seed: int) -> float:
    """Milliseconds of processor time per simulated second, gaits changed every time-step."""
    world, gaits = _alone(robot, seed), list(robot.gaits)
    started, held = time.process_time(), 0.0
    while held < SECONDS:
        world.run({HUNTER: gaits[int(held * 7) % len(gaits)]}, robot.gait_duration)
        held += robot.gait_duration
    return 1000 * (time.process_time() - started) / held


def step_ratio(robot: Any, seed: int) -> tuple[float, float]:
    """Microseconds of a step with all its control, and of a bare step of the same walking bodies.

    Bare: the motors keep the rates, and the feet the loads, that they have; the two alternate, 25 physics steps each.
    """
    world = _alone(robot, seed)
    world.run({HUNTER: robot.gaits[0]}, robot.gait_duration)
    body = world.bodies[HUNTER]
    inner, count, length = body._frame.world, body._count, body._dt
    control = bare = 0.0
    for turn in range(80):
        body.command(robot.gaits[turn // 8 % len(robot.gaits)])
        started = time.process_time()
        for _ in range(25):
            body.advance()
        middle = time.process_time()
        for _ in range(25 * count):
            inner.Step(length, 6, 2)
        control, bare = control + middle - started, bare + time.process_time() - middle
    steps = 80 * 25 * count
    return 1e6 * control / steps, 1e6 * bare / steps


def speed(robot: Any, step: float, gait: Any) -> tuple[float, float]:
    """Body lengths and radians per second of a gait, without noise, at a length of the physics step."""
    quiet = robot.model_copy(update={"noise": NoiseSettings(slip=0.0, drift_sd=0.0),
                                     "body": robot.body.model_copy(update={"step": step})})  # fmt: skip
    world = _alone(quiet, 0)
    start = world.run({HUNTER: gait}, 1.024).moments[-1]
    moments = [start, *world.run({HUNTER: gait}, 4.096).moments]
    poses = np.array([moment.poses[HUNTER] for moment in moments])
    way = np.hypot(*np.diff(poses[::8, :2], axis=0).T).sum() / robot.body.body_length / 4.096
    return float(way), float((np.unwrap(poses[:, 2])[-1] - poses[0, 2]) / 4.096)


def report(seed: int, table: Table) -> Iterator[str]:
    """Yield the tables."""
    lines = []
    for name in (*LEGGED, WHEELS):
        robot = load_robot(name)
        cost = median(per_second(robot, seed) for _ in range(ROUNDS))
        ratio = ["", ""]
        if name != WHEELS:
            pairs = [step_ratio(robot, seed) for _ in range(ROUNDS)]
            ratio = [f"{median(p[0] for p in pairs):.1f} us", f"{median(p[0] / p[1] for p in pairs):.2f}"]
        lines.append([name, f"{cost:.2f} ms", *ratio])
    yield table(["robot", "a simulated second", "a step with control", "over a bare step"], lines)
    lines = []
    for name, gait in _GAITS:
        robot = load_robot(name)
        whole, half = (speed(robot, step, robot.gaits[gait]) for step in (robot.body.step, robot.body.step / 2))
        which = 1 if "turn" in gait else 0
        lines.append([f"{name}, {gait}", f"{whole[which]:.3f}", f"{half[which]:.3f}",
                      f"{100 * (half[which] / whole[which] - 1):+.1f} %"])  # fmt: skip
    yield table(["gait", "step as it ships: lengths/s, turns rad/s", "half the step", "change"], lines)
