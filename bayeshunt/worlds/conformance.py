"""The checks that every body, world and prey must pass; run them over your own too."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from bayeshunt.config.loading import load_experiment, load_robot
from bayeshunt.config.schema import ArenaSettings, ExperimentSettings, RobotSettings
from bayeshunt.core.arguments import checked
from bayeshunt.core.checks import check_whole
from bayeshunt.core.errors import BayesHuntError, InputError, did_you_mean, shown
from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import Pose
from bayeshunt.core.messages import Moment, Reach, Run
from bayeshunt.core.protocols import Body, World
from bayeshunt.core.streams import global_generator, spawn_streams
from bayeshunt.worlds.prey.behaviours import Context, build_prey
from bayeshunt.worlds.registry import BOX2D, make_world
from bayeshunt.worlds.scene import HUNTER, PREY, Scene

__all__ = ["check_body", "check_prey", "check_world"]

_START: Mapping[str, Pose] = {HUNTER: Pose(0.0, 0.0, 0.0), PREY: Pose(0.3, 0.1, 0.5)}


@checked
def check_world(world: str, experiment: str | ExperimentSettings = "paper", arena: str = "open", seed: int = 0) -> None:
    """Raise BayesHuntError, naming the world and the fault, unless it keeps the rules.

    world: the name of a registered world. experiment, arena: whose robot, prey and walls it is tried with.
    The rules: it makes the bodies asked for, at rest where they were put; a run ends in time, tells a moment per
    control interval and its end, in order, and stops when who is to be reached is reached; with duration 0 it only
    tells whether that is so; the same seed gives the same moments, another seed others (if there is noise); a fork
    goes the same way every time and leaves the world as it is; numpy's global generator is left alone.
    """
    check_whole(seed, "seed", 0)
    settings = load_experiment(experiment)
    if arena not in settings.arenas:
        raise InputError(f"arena: unknown arena {arena!r}{did_you_mean(arena, settings.arenas)}")
    fault = _Fault(f"world {world!r}")
    chance = global_generator()
    first, again, other = (_moments(world, settings, arena, s, fault) for s in (seed, seed, seed + 1))
    fault.unless(first == again, "is not reproducible: the same seed gave other moments")
    noisy = settings.robot.noise.slip > 0 or settings.robot.noise.drift_sd > 0
    fault.unless(first != other or not noisy, "does not use its generators: another seed gave the same moments")
    _check_reach(world, settings, arena, seed, fault)
    _check_fork(world, settings, arena, seed, fault)
    fault.unless(global_generator() == chance, "used numpy's global generator")


@checked
def check_body(robot: str | RobotSettings, world: str = BOX2D, seed: int = 0) -> None:
    """Raise BayesHuntError, naming the robot and the fault, unless its body keeps the rules in ``world``.

    robot: settings, preset or TOML path of a robot whose ``body.drive`` may be a registered one.
    The rules: the body has all that a ``bayeshunt.protocols.Body`` has; it stays where it is put until it is commanded;
    every gait can be commanded and leaves it at a finite pose, and at least one moves it; what is no gait of its own is
    refused; the same seed gives the same poses.
    """
    check_whole(seed, "seed", 0)
    settings = load_robot(robot)
    fault = _Fault(f"body of robot {settings.name!r}")
    ends = [_executed(settings, world, seed, fault) for _ in range(2)]
    fault.unless(ends[0] == ends[1], "is not reproducible: the same seed gave other poses")
    moved = max(math.hypot(pose.x, pose.y) + abs(pose.theta) for pose in ends[0])
    fault.unless(moved > 1e-6, "does not move, whatever gait it is given")


@checked
def check_prey(behaviour: str, experiment: str | ExperimentSettings = "paper", seed: int = 0) -> None:
    """Raise BayesHuntError, naming the prey and the fault, unless a behaviour keeps the rules.

    behaviour: the name of one that is registered. The rules: it answers with two finite wheel speeds wherever it is,
    whoever is near, in every arena; the same seed gives the same answers; numpy's global generator is left alone.
    """
    check_whole(seed, "seed", 0)
    settings = load_experiment(experiment, {"prey.behaviour": behaviour})
    fault = _Fault(f"prey {behaviour!r}")
    chance = global_generator()
    for name, arena in settings.arenas.items():
        answers = [_answers(settings, arena, seed) for _ in range(2)]
        fault.unless(bool(np.isfinite(answers[0]).all()), f"gives wheel speeds that are not finite (arena {name})")
        fault.unless(answers[0] == answers[1], f"is not reproducible (arena {name})")
    fault.unless(global_generator() == chance, "used numpy's global generator")


class _Fault:
    """What is being checked, for the message."""

    def __init__(self, what: str) -> None:
        self.what = what

    def unless(self, kept: bool, fault: str) -> None:
        """Raise BayesHuntError with the fault if a rule was not kept."""
        if not kept:
            raise BayesHuntError(f"{self.what} {fault}")


def _begun(world: str, settings: ExperimentSettings, arena: str, seed: int, fault: _Fault) -> tuple[World, Moment]:
    scene = Scene(settings.robot, settings.prey, settings.arenas[arena], settings.physics)
    made = make_world(world, scene)
    moment = made.reset(_START, spawn_streams(seed))
    fault.unless(isinstance(moment, Moment), f"reset() gave {shown(moment)}, expected a Moment")
    fault.unless(set(made.bodies) == set(_START), f"made the bodies {', '.join(made.bodies)}, not {', '.join(_START)}")
    for name, body in made.bodies.items():
        fault.unless(isinstance(body, Body), f"has a {name} that is no bayeshunt.protocols.Body")
        fault.unless(np.allclose(body.pose, _START[name], atol=1e-5), f"put the {name} at {body.pose}")
        fault.unless(np.allclose(moment.poses[name], body.pose), f"tells another pose of the {name} than its body has")
    fault.unless(bool(made.identity.get("engine") and made.identity.get("version")), "does not name engine and version")
    fault.unless(made.control_interval > 0, "has no control interval")
    return made, moment


def _moments(world: str, settings: ExperimentSettings, arena: str, seed: int, fault: _Fault) -> list[Moment]:
    """What three gaits do, each for a time-step."""
    made, moment = _begun(world, settings, arena, seed, fault)
    told, gaits, step = [moment], tuple(settings.robot.gaits), settings.robot.gait_duration
    for gait in gaits[:3]:
        run = made.run({HUNTER: gait}, step)
        fault.unless(isinstance(run, Run) and len(run.moments) > 0, f"run() gave {shown(run)}, not a Run of moments")
        fault.unless(run.stopped is None, "stopped a run that nothing was to stop")
        told += list(run.moments)
        late = abs(told[-1].time - told[0].time - step * (1 + gaits.index(gait)))
        in_time = late <= made.control_interval + 1e-9
        fault.unless(in_time, f"was at {run.moments[-1].time} s, not where it was told to be")
    times = [one.time for one in told]
    fault.unless(bool((np.diff(times) > 0).all()), "tells moments that are not in order of time")
    gap = float(np.diff(times).max())
    fault.unless(gap <= 1.001 * made.control_interval, f"lets {gap:g} s pass between two moments")
    fault.unless(all(np.isfinite(pose).all() for one in told for pose in one.poses.values()), "tells poses not finite")
    made.close()
    return told


def _check_reach(world: str, settings: ExperimentSettings, arena: str, seed: int, fault: _Fault) -> None:
    made, start = _begun(world, settings, arena, seed, fault)
    gap = math.hypot(*(a - b for a, b in zip(start.poses[HUNTER][:2], start.poses[PREY][:2], strict=True)))
    near, far = Reach(HUNTER, PREY, 1.01 * gap), Reach(HUNTER, PREY, 0.99 * gap)
    nothing = made.run({}, 0.0, far)
    fault.unless(nothing.stopped is None and not len(nothing.moments), "says that who is not within reach is reached")
    fault.unless(made.run({}, 0.0, near).stopped == PREY, "does not say that who is within reach is reached")
    late = made.run({HUNTER: settings.robot.gaits[0]}, settings.robot.gait_duration, near)
    fault.unless(late.stopped == PREY and not len(late.moments), "goes on although the prey is reached already")
    made.close()


def _check_fork(world: str, settings: ExperimentSettings, arena: str, seed: int, fault: _Fault) -> None:
    made, _ = _begun(world, settings, arena, seed, fault)
    made.run({HUNTER: settings.robot.gaits[0]}, settings.robot.gait_duration)
    before = {name: body.pose for name, body in made.bodies.items()}
    ends = []
    for _ in range(2):
        twin = made.fork(PREY)
        fault.unless(list(twin.bodies) == [PREY], f"forked {', '.join(twin.bodies)} where only the prey was asked for")
        fault.unless(np.allclose(twin.bodies[PREY].pose, before[PREY], atol=1e-5), "forks a prey that is elsewhere")
        twin.run({}, settings.robot.gait_duration)
        ends.append(twin.bodies[PREY].pose)
        twin.close()
    fault.unless(ends[0] == ends[1], "forks with noise: two forks went different ways")
    fault.unless(before == {name: body.pose for name, body in made.bodies.items()}, "was changed by its fork")
    made.close()


def _executed(robot: RobotSettings, world: str, seed: int, fault: _Fault) -> list[Pose]:
    """Where each gait takes the body, alone, one after the other."""
    made = make_world(world, Scene(robot, None, ArenaSettings(), robot.physics))
    made.reset({HUNTER: _START[HUNTER]}, spawn_streams(seed))
    body = made.bodies[HUNTER]
    fault.unless(isinstance(body, Body), "is no bayeshunt.protocols.Body")
    fault.unless(math.isclose(body.length, robot.body.body_length), f"has the length {body.length} m")
    ends = []
    for gait in robot.gaits:
        made.run({HUNTER: gait}, robot.gait_duration)
        ends.append(body.pose)
        fault.unless(bool(np.isfinite(body.pose).all()), f"is at {body.pose} after gait {gait.name!r}")
    placed = Pose(0.1, -0.2, 0.3)
    try:
        body.place(placed)
    except InputError:  # a real robot, which nobody can put somewhere else
        placed = body.pose
    fault.unless(np.allclose(body.pose, placed, atol=1e-5), f"was put at {placed} and is at {body.pose}")
    try:
        body.command(Gait("no gait of its own", (0.0,) * 17))
    except InputError:
        return ends
    raise BayesHuntError(f"{fault.what} takes a command of 17 values; raise InputError")


def _answers(settings: ExperimentSettings, arena: ArenaSettings, seed: int) -> list[tuple[float, float]]:
    """Wheel speeds at many poses, the hunter near and far."""
    places = np.random.default_rng(0)
    length, interval = settings.robot.body.diameter, settings.physics.control_interval
    prey = build_prey(Context(settings.prey, arena, length, interval, np.random.default_rng(seed)))
    width, height = 0.45 * arena.width, 0.45 * arena.height
    poses = places.uniform((-width, -height, -4.0, -width, -height), (width, height, 4.0, width, height), (200, 5))
    return [prey.act(*map(float, pose)) for pose in poses]
