"""What the prey of a trial would do from now on if nothing disturbed it: for upper bounds, not for hunters."""

from __future__ import annotations

import numpy as np

from bayeshunt.config.schema import NoiseSettings
from bayeshunt.core.geometry import FloatArray, Pose
from bayeshunt.worlds.box2d.arena import Arena, build_walls, new_world
from bayeshunt.worlds.box2d.bodies import build_drive
from bayeshunt.worlds.prey.behaviours import Context, build_prey

_NO_NOISE = NoiseSettings(slip=0.0, drift_sd=0.0)


def foresee(arena: Arena, duration: float) -> tuple[np.ndarray, Pose[FloatArray]]:
    """Return times [M] from now [s] and the prey's poses then (a Pose of arrays [M]), one per control interval.

    A copy of the prey, in the state it is in now, runs alone and without noise in a fresh world with
    the same walls. It does not meet the hunter: what a prey that senses the hunter would do about it
    is not foreseen, and neither are the random turns of a behaviour that makes any (its controller
    starts anew, with its noise off).

    duration: how far to look [s]; the last pose is at or after it.
    """
    context, physics, prey = arena.context, arena.physics, arena.prey
    quiet = context.settings.model_copy(
        update={"noise": _NO_NOISE, "sensor_noise": 0.0, "turn_sd": 0.0, "senses_hunter": False}
    )
    world, unit = new_world(), arena.unit
    if context.walls is not None:
        build_walls(world, 2 * context.walls[0] / unit, 2 * context.walls[1] / unit)
    nobody = np.random.default_rng(0)  # every noise is zero: what it draws has no effect
    twin = build_drive(world, quiet.body, quiet.noise, physics, unit, nobody)
    twin.continue_as(prey)
    controller = build_prey(Context(quiet, context.arena, context.hunter_diameter, context.interval, nobody))
    x, y, theta = twin.pose
    poses = [(x, y, theta)]
    far = 1e6 * unit  # where the hunter would be seen by a behaviour that looks for it
    for _ in range(int(np.ceil(duration / physics.control_interval - 1e-9))):
        twin.next_interval()
        twin.command(*controller.act(x, y, theta, far, far))
        for _ in range(physics.control_steps):
            twin.advance()
            world.Step(physics.step, physics.velocity_iterations, physics.position_iterations)
            if world.contactCount:
                twin.read_back()
        x, y, theta = twin.pose
        poses.append((x, y, theta))
    return physics.control_interval * np.arange(len(poses)), Pose(*np.array(poses).T)
