"""Motor babbling: the robot executes random gaits alone and writes down where they took it."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterator
from importlib.metadata import version
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.config.loading import load_robot
from bayeshunt.config.schema import PhysicsSettings, RobotSettings
from bayeshunt.core.checks import check_whole
from bayeshunt.core.geometry import Pose
from bayeshunt.data.babbling_table import PROVENANCE_KEY, path_column_names
from bayeshunt.worlds.box2d.arena import new_world
from bayeshunt.worlds.box2d.bodies import Drive, build_drive

#: Intervals into which a gait is cut for its part-way poses.
PATH_INTERVALS = 13


def babble(
    robot: str | os.PathLike[str] | RobotSettings,
    steps: int = 2000,
    seed: int = 0,
    *,
    physics: PhysicsSettings | None = None,
    progress: Any = None,
) -> pd.DataFrame:
    """Return the babbling table of ``steps`` gaits, momentum carried from each to the next.

    Every gait is executed equally often (the remainder by chance), in random order. The arena is
    open and empty; after every step the origin moves to the robot, so that coordinates stay small.

    robot: preset name, TOML path or settings. progress: called with 1 after every step.
    Raises InputError if ``steps`` or ``seed`` is not a whole number in range.
    """
    robot = load_robot(robot)
    check_whole(steps, "steps", 1)
    check_whole(seed, "seed", 0)
    physics = physics or PhysicsSettings()
    choice, noise = (np.random.default_rng(s) for s in np.random.SeedSequence([seed]).spawn(2))
    order = _balanced_order(len(robot.gaits), steps, choice)
    world = new_world()
    drive = build_drive(world, robot.body, robot.noise, physics, robot.body.diameter, noise)
    executed = np.empty((steps, PATH_INTERVALS, 3))
    counts = interval_steps(physics.steps(robot.gait_duration))
    for row, gait in enumerate(order.tolist()):
        executed[row] = _execute(world, drive, physics, robot.gaits[gait].command, counts)
        if progress is not None:
            progress(1)
    return _table(robot, order, executed, provenance(robot, physics, steps, seed))


def hold(
    world: Any, drive: Drive, physics: PhysicsSettings, command: tuple[float, ...], counts: list[int]
) -> Iterator[Pose]:
    """Hold one command; yield the world pose [m, rad] at the end of each interval of ``counts`` physics steps."""
    drive.command(*command)
    taken = 0
    for count in counts:
        for _ in range(count):
            if taken % physics.control_steps == 0:
                drive.next_interval()
            drive.advance()
            world.Step(physics.step, physics.velocity_iterations, physics.position_iterations)
            taken += 1
            if world.contactCount:
                drive.read_back()
        yield drive.pose


def _execute(
    world: Any, drive: Drive, physics: PhysicsSettings, command: tuple[float, ...], counts: list[int]
) -> list[Pose]:
    """Hold ``command`` from the origin; return the world pose at the end of each interval."""
    angle = float(drive.body.angle)
    drive.place(Pose(0.0, 0.0, float(np.remainder(angle, 2 * np.pi))))
    start = drive.pose.theta
    poses = [Pose(x, y, theta - start) for x, y, theta in hold(world, drive, physics, command, counts)]
    # turned into the robot's first frame: x ahead, y to the left
    c, s = np.cos(start), np.sin(start)
    return [Pose(c * x + s * y, c * y - s * x, turn) for x, y, turn in poses]


def _table(robot: RobotSettings, order: np.ndarray, executed: np.ndarray, provenance: dict[str, Any]) -> pd.DataFrame:
    """Assemble the table from executed poses [N, P, 3] (x ahead, y left, theta counter-clockwise)."""
    names = np.array(robot.gaits.names, dtype=object)
    end = Pose(0.0, 0.0, 0.0).relative(Pose(*executed[:, -1].T))
    gait = names[order]
    frame = pd.DataFrame(
        {
            "step": np.arange(len(order), dtype=np.int64),
            "gait": gait,
            "distance": end.distance,
            "angle": end.angle,
            "heading": end.heading,
            "previous_gait": np.concatenate([[None], gait[:-1]]),
        }
    )
    part_way = executed[:, :-1] * np.array([1.0, -1.0, -1.0])  # clockwise: right and heading change sign
    part_way[..., 2] = (part_way[..., 2] + np.pi) % (2 * np.pi) - np.pi
    columns = path_column_names(PATH_INTERVALS - 1)
    paths = pd.DataFrame(part_way.reshape(len(order), -1).astype(np.float32), columns=columns)
    frame = pd.concat([frame, paths], axis=1)
    frame.attrs[PROVENANCE_KEY] = provenance
    return frame


def _balanced_order(gaits: int, steps: int, rng: np.random.Generator) -> np.ndarray:
    """Gait indices [steps]: each gait equally often, in random order."""
    whole = np.tile(np.arange(gaits), steps // gaits)
    rest = rng.permutation(gaits)[: steps % gaits]
    return rng.permutation(np.concatenate([whole, rest]))


def interval_steps(total: int) -> list[int]:
    """Return the physics steps in each of the part-way intervals; they add up to ``total``, some may be 0."""
    edges = np.linspace(0, total, PATH_INTERVALS + 1).round().astype(int)
    return np.diff(edges).tolist()


def provenance(robot: RobotSettings, physics: PhysicsSettings, steps: int, seed: int) -> dict[str, Any]:
    """Return the record of what makes a babbling table again."""
    return {
        "kind": "babbling table",
        "robot": robot.model_dump(mode="json"),
        "physics": physics.model_dump(mode="json"),
        "steps": int(steps),  # a NumPy integer is no JSON number
        "seed": int(seed),
        "versions": {
            "bayeshunt": version("bayeshunt"),
            "box2d": version("box2d"),
            "numpy": np.__version__,
            "python": platform.python_version(),
        },
    }
