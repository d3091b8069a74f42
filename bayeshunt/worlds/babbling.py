"""Motor babbling: the robot executes random gaits alone and writes down where they took it."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Iterator, Mapping
from importlib.metadata import version
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.config.loading import load_robot
from bayeshunt.config.schema import ArenaSettings, PhysicsSettings, RobotSettings
from bayeshunt.core.arguments import checked
from bayeshunt.core.checks import check_whole
from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import Polar, Pose
from bayeshunt.core.protocols import World
from bayeshunt.data.babbling_table import PROVENANCE_KEY, path_column_names
from bayeshunt.worlds.registry import BOX2D, make_world
from bayeshunt.worlds.scene import HUNTER, Scene

__all__ = ["PATH_INTERVALS", "babble", "balanced_order", "hold", "interval_steps", "provenance", "table_of"]

#: Intervals into which a gait is cut for its part-way poses.
PATH_INTERVALS = 13


@checked
def babble(
    robot: str | os.PathLike[str] | RobotSettings,
    steps: int = 2000,
    seed: int = 0,
    *,
    physics: PhysicsSettings | None = None,
    progress: Callable[[int], None] | None = None,
    world: str = BOX2D,
    choose: Callable[[tuple[int, Polar] | None], int] | None = None,
) -> pd.DataFrame:
    """Return the babbling table of ``steps`` gaits, momentum carried from each to the next.

    A body that measures what it spends adds the columns ``energy`` [J] and ``falls``.

    Every gait is executed equally often (the remainder by chance), in random order. The arena is
    open and empty; after every step the origin moves to the robot, so that coordinates stay small.

    robot: preset name, TOML path or settings. progress: called with 1 after every step.
    world: name of the world it babbles in, "box2d" or a registered one.
    choose: called before every step with the gait before (its number) and where it led, None at first; returns the
        number of the gait to execute. None: in random order.
    Raises InputError if ``steps`` or ``seed`` is not a whole number in range, or there is no such world.
    """
    robot = load_robot(robot)
    check_whole(steps, "steps", 1)
    check_whole(seed, "seed", 0)
    physics = physics or robot.physics
    choice, noise = (np.random.default_rng(s) for s in np.random.SeedSequence([seed]).spawn(2))
    order = balanced_order(len(robot.gaits), steps, choice)
    alone = make_world(world, Scene(robot, None, ArenaSettings(), physics))
    alone.reset({HUNTER: Pose(0.0, 0.0, 0.0)}, {HUNTER: noise})
    executed, energy = np.empty((steps, PATH_INTERVALS, 3)), np.empty(steps)
    falls = np.empty(steps, dtype=np.int64)
    counts, gaits = interval_steps(physics.steps(robot.gait_duration)), tuple(robot.gaits)
    end = Pose(0.0, 0.0, 0.0)
    for row in range(steps):
        if choose is not None:
            order[row] = choose((int(order[row - 1]), Pose(0.0, 0.0, 0.0).relative(end)) if row else None)
        gait = int(order[row])
        body = alone.bodies[HUNTER]
        spent, fallen = body.energy, body.falls
        poses = _execute(alone, gaits[gait], physics.step, counts)
        executed[row], end = poses, poses[-1]
        energy[row], falls[row] = body.energy - spent, body.falls - fallen
        if progress is not None:
            progress(1)
    record = provenance(robot, physics, steps, seed, alone.identity)
    if choose is not None:
        record["chosen"] = "by what came before"
    alone.close()
    return table_of(robot.gaits.names, order, executed, record, (energy, falls) if energy.any() else None)


def hold(world: World, gait: Gait, step: float, counts: list[int]) -> Iterator[Pose]:
    """Hold one gait; yield the robot's pose [m, rad] after each interval of ``counts`` steps of ``step`` [s]."""
    for count in counts:
        if count:
            world.run({HUNTER: gait}, count * step)
        yield world.bodies[HUNTER].pose


def _execute(world: World, gait: Gait, step: float, counts: list[int]) -> list[Pose]:
    """Hold ``gait`` from the origin; return the pose at the end of each interval in the robot's first frame."""
    body = world.bodies[HUNTER]
    body.place(Pose(0.0, 0.0, float(np.remainder(body.pose.theta, 2 * np.pi))))
    start = body.pose.theta
    poses = [Pose(x, y, theta - start) for x, y, theta in hold(world, gait, step, counts)]
    # turned into the robot's first frame: x ahead, y to the left
    c, s = np.cos(start), np.sin(start)
    return [Pose(c * x + s * y, c * y - s * x, turn) for x, y, turn in poses]


def table_of(
    names: tuple[str, ...], order: np.ndarray, executed: np.ndarray, provenance: dict[str, Any],
    spent: tuple[np.ndarray, np.ndarray] | None = None,
) -> pd.DataFrame:  # fmt: skip
    """Return a babbling table of executed poses [N, P, 3] (x ahead, y left, theta counter-clockwise), the last the end.

    names: of the gaits. order: index of the gait executed [N]. provenance: kept in the table's attributes.
    spent: energy [J] and falls of each [N], if they were measured.
    """
    end = Pose(0.0, 0.0, 0.0).relative(Pose(*executed[:, -1].T))
    gait = np.array(names, dtype=object)[order]
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
    columns = path_column_names(executed.shape[1] - 1)
    paths = pd.DataFrame(part_way.reshape(len(order), -1).astype(np.float32), columns=columns)
    if spent is not None:
        frame["energy"], frame["falls"] = spent
    frame = pd.concat([frame, paths], axis=1)
    frame.attrs[PROVENANCE_KEY] = provenance
    return frame


def balanced_order(gaits: int, steps: int, rng: np.random.Generator) -> np.ndarray:
    """Return gait indices [steps]: each gait equally often, in random order."""
    whole = np.tile(np.arange(gaits), steps // gaits)
    rest = rng.permutation(gaits)[: steps % gaits]
    return rng.permutation(np.concatenate([whole, rest]))


def interval_steps(total: int) -> list[int]:
    """Return the physics steps in each of the part-way intervals; they add up to ``total``, some may be 0."""
    edges = np.linspace(0, total, PATH_INTERVALS + 1).round().astype(int)
    found: list[int] = np.diff(edges).tolist()
    return found


def provenance(
    robot: RobotSettings, physics: PhysicsSettings, steps: int, seed: int, engine: Mapping[str, str] | None = None
) -> dict[str, Any]:
    """Return the record of what makes a babbling table again. engine: identity of the world, Box2D by default."""
    if engine is None:
        engine = make_world(BOX2D, Scene(robot, None, ArenaSettings(), physics)).identity
    return {
        "kind": "babbling table",
        "robot": robot.model_dump(mode="json"),
        "physics": physics.model_dump(mode="json"),
        "steps": int(steps),  # a NumPy integer is no JSON number
        "seed": int(seed),
        "versions": {
            "bayeshunt": version("bayeshunt"),
            engine["engine"]: engine["version"],
            "numpy": np.__version__,
            "python": platform.python_version(),
        },
    }
