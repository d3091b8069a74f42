"""Babbling inside an arena: random gaits from the starting pose, walls included."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd

from bayeshunt.config.schema import ArenaSettings, PhysicsSettings, RobotSettings
from bayeshunt.core.checks import check_whole
from bayeshunt.core.geometry import Pose, in_frame
from bayeshunt.data.babbling_table import PROVENANCE_KEY
from bayeshunt.worlds.babbling import hold, interval_steps, provenance
from bayeshunt.worlds.registry import BOX2D, make_world
from bayeshunt.worlds.scene import HUNTER, Scene

__all__ = ["explore"]

_CENTRE = Pose(0.0, 0.0, 0.0)


def explore(
    robot: RobotSettings,
    arena: ArenaSettings,
    steps: int,
    seed: int,
    *,
    physics: PhysicsSettings | None = None,
    start: Pose = _CENTRE,
    progress: Callable[[int], None] | None = None,
    world: str = BOX2D,
) -> pd.DataFrame:
    """Return where random gaits took the robot, alone in ``arena``; it starts at ``start``.

    Columns: step, gait, interval (1..13, part-way through the step), x, y [m], theta [rad,
    counter-clockwise] in the frame of the start, as dead reckoning gives them. One row per interval.

    steps: gaits executed, each equally often, in random order. start: in the arena's frame; by default the centre,
    facing along x. progress: called with 1 after every step.
    world: name of the world, "box2d" or a registered one.
    Raises InputError if ``steps`` or ``seed`` is not a whole number in range, or there is no such world.
    """
    check_whole(steps, "steps", 1)
    check_whole(seed, "seed", 0)
    physics = physics or robot.physics
    choice, noise = (np.random.default_rng(s) for s in np.random.SeedSequence([seed, 1]).spawn(2))
    order = choice.permutation(np.arange(steps) % len(robot.gaits))
    alone = make_world(world, Scene(robot, None, arena, physics))
    start = alone.reset({HUNTER: start}, {HUNTER: noise}).poses[HUNTER]
    counts, gaits = interval_steps(physics.steps(robot.gait_duration)), tuple(robot.gaits)
    poses: list[Pose] = []
    for gait in order.tolist():
        poses.extend(hold(alone, gaits[gait], physics.step, counts))
        if progress is not None:
            progress(1)
    x, y, theta = np.array([in_frame(pose, start) for pose in poses]).T
    names = np.array(robot.gaits.names, dtype=object)[order]
    frame = pd.DataFrame(
        {
            "step": np.repeat(np.arange(steps), len(counts)),
            "gait": np.repeat(names, len(counts)),
            "interval": np.tile(np.arange(1, len(counts) + 1), steps),
            "x": x,
            "y": y,
            "theta": theta,
        }
    )
    made = provenance(robot, physics, steps, seed, alone.identity)
    alone.close()
    record = {**made, "kind": "exploration", "arena": arena.model_dump(mode="json")}
    frame.attrs[PROVENANCE_KEY] = record
    return frame
