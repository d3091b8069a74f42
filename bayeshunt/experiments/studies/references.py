"""Computing the reference table of an experiment, and keeping it for the next time."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.config.loading import DEFAULT_PRESET, load_experiment
from bayeshunt.config.schema import ExperimentSettings, GaitSettings, RobotSettings
from bayeshunt.core.arguments import checked
from bayeshunt.core.checks import check_whole
from bayeshunt.core.geometry import Polar
from bayeshunt.data.babbling_table import path_columns
from bayeshunt.experiments.preparation import check_planners
from bayeshunt.experiments.store.export import check_output_folder
from bayeshunt.experiments.store.identity import versions
from bayeshunt.planners.bounds.reference import FORMAT, ReferenceTable
from bayeshunt.planners.bounds.relative import Chase, Grid, solve
from bayeshunt.worlds.babbling import babble

__all__ = ["EXPECTED_SWEEPS", "reference"]

#: Sweeps and tables that a progress bar may expect; the solution usually needs fewer.
EXPECTED_SWEEPS = 110


@checked
def reference(
    experiment: str | os.PathLike[str] | ExperimentSettings = DEFAULT_PRESET,
    *,
    seed: int = 0,
    samples: int = 16,
    angles: int = 72,
    headings: int = 72,
    cache: str | os.PathLike[str] | None = None,
    progress: Callable[[int], None] | None = None,
) -> ReferenceTable:
    """Return the reference table: least expected time to capture a straight prey, by value iteration.

    The hunter's motion is sampled from babbling (its own noise and momentum included), the prey's
    from a body of the prey's settings that drives straight at its free speed.

    seed: of both. samples: paths per gait. angles, headings: grid lines per full turn.
    cache: a folder where the table is kept under the digest of all this and found the next time.
    """
    check_whole(seed, "seed", 0)
    settings = load_experiment(experiment)
    check_planners(settings, ())
    for name, value, least in (("samples", samples, 1), ("angles", angles, 4), ("headings", headings, 4)):
        check_whole(value, name, least)
    facts = _facts(settings, seed, samples, angles, headings)
    kept = None if cache is None else check_output_folder(cache) / f"reference-{facts['digest'][:16]}.npz"
    if kept is not None and kept.is_file():
        table = ReferenceTable.load(kept)
        if table.facts.get("digest") == facts["digest"]:
            return table
    chase = _chase(settings, seed, samples)
    grid = _grid(settings, angles, headings)
    values = solve(chase, grid, progress=progress)
    values.setflags(write=False)
    table = ReferenceTable(values, grid, chase, settings.robot.gaits.names, facts)
    if kept is not None:
        table.save(kept)
    return table


def _facts(settings: ExperimentSettings, seed: int, samples: int, angles: int, headings: int) -> dict[str, Any]:
    """What the table depends on, and its digest."""
    facts = {
        "experiment": settings.name,
        "format": FORMAT,
        "robot": settings.robot.model_dump(mode="json"),
        "prey": {k: v for k, v in settings.prey.model_dump(mode="json").items() if k in ("speed", "body", "noise")},
        "physics": settings.physics.model_dump(mode="json"),
        "catch_distance": settings.protocol.catch_distance,
        "seed": int(seed),
        "samples": int(samples),
        "grid": [int(angles), int(headings)],
        "versions": versions(),
    }
    text = json.dumps({k: v for k, v in facts.items() if k != "experiment"}, sort_keys=True)
    return {**facts, "digest": hashlib.sha256(text.encode()).hexdigest()}


def _grid(settings: ExperimentSettings, angles: int, headings: int) -> Grid:
    """Distances from the catch to 24 bodies, denser near the hunter."""
    body, catch = settings.robot.body.body_length, settings.protocol.catch_distance
    near, far = np.arange(0.9 * catch, 7.0, 0.35), np.arange(7.0, 24.5, 1.0)
    return Grid(np.concatenate([near, far]) * body, angles, headings)


def _chase(settings: ExperimentSettings, seed: int, samples: int) -> Chase:
    robot, prey = settings.robot, settings.prey
    straight = GaitSettings(name="straight", left=prey.speed, right=prey.speed)
    runner = RobotSettings(
        name="prey", gait_duration=robot.gait_duration, body=prey.body, noise=prey.noise, gait=(straight,)
    )
    babbled = babble(robot, 20 * samples * len(robot.gait), seed, physics=settings.physics, world=settings.world)
    ran = babble(runner, samples + 1, seed + 1, physics=settings.physics, world=settings.world)
    hunter = np.stack([_paths(babbled[babbled["gait"] == name], samples) for name in robot.gaits.names])
    speeds = np.hypot(*hunter[:, :, -1, :2].mean(axis=1).T) / robot.gait_duration
    return Chase(
        hunter,
        _paths(ran.iloc[1:], samples),  # its first step starts from rest
        duration=robot.gait_duration,
        reach=settings.protocol.catch_distance * robot.body.body_length,
        closing=max(float(speeds.max()) - prey.speed, 0.1 * float(speeds.max())),
    )


def _paths(rows: pd.DataFrame, samples: int) -> np.ndarray:
    """Return ``samples`` of the rows' paths, evenly picked, [S, P, 3]: forward, right, heading, the end included."""
    picked = rows.iloc[np.linspace(0, len(rows) - 1, samples).round().astype(int)]
    part_way = picked[path_columns(picked.columns)].to_numpy(dtype=float).reshape(len(picked), -1, 3)
    end = Polar(*(picked[name].to_numpy(dtype=float) for name in ("distance", "angle", "heading")))
    last = np.stack([end.forward, end.right, end.heading], axis=-1)
    return np.concatenate([part_way, last[:, None]], axis=1)
