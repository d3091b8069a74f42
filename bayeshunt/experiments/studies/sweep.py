"""How success and catch time change with the settings: one evaluation per point of a grid."""

from __future__ import annotations

import functools
import itertools
import json
import os
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from bayeshunt.config.loading import DEFAULT_PRESET, load_experiment
from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.arguments import checked_but
from bayeshunt.core.errors import InputError
from bayeshunt.experiments.preparation import check_planners
from bayeshunt.experiments.protocol import check_arenas, learn_model, names_of
from bayeshunt.experiments.run.runner import Progress, check_minds, evaluate
from bayeshunt.experiments.scores import mean_interval, summarise
from bayeshunt.models.body.forward import ForwardModel

__all__ = ["AXES", "COLUMNS", "Grid", "at_point", "combinations", "sweep"]

#: Names for sweeps that people ask for; any other axis is a dotted key of the settings.
AXES: dict[str, tuple[str, tuple[float, ...]]] = {
    "speed_ratio": ("prey speed / hunter's top speed", (0.5, 0.6, 0.7, 0.8, 0.833, 0.9, 1.0, 1.1, 1.2, 1.3)),
    "gait_duration": ("time-step [s]", (0.832, 1.664, 2.496, 3.328, 4.992)),
    "noise": ("actuator noise, as a multiple of the settings'", (0.0, 0.5, 1.0, 1.5, 2.0)),
    "slip": ("slip of both robots, half-width [share]", (0.0, 0.05, 0.10, 0.15)),
    "babbling_steps": ("gaits babbled", (50, 100, 200, 500, 1000, 2000, 5000)),
    "gaits": ("gaits, the first so many of the robot's", (3, 5, 7, 8, 10)),
    "max_transitions": ("most changes of gait in a plan", (0, 1, 2)),
}

#: Columns of a sweep after those of its axes.
COLUMNS = (
    "planner", "arena", "runs", "caught", "success", "ci_low", "ci_high", "mean_time_s", "mean_time_s_low",
    "mean_time_s_high",
)  # fmt: skip

#: A value that is a change of the settings' own.
_CHANGE = re.compile(r"[+-]\d+(\.\d+)?%")

Grid = Mapping[str, Sequence[Any]]


@checked_but("planners", "arenas")
def sweep(
    experiment: str | os.PathLike[str] | ExperimentSettings = DEFAULT_PRESET,
    grid: Grid | None = None,
    *,
    runs: int | None = None,
    seed: int = 0,
    jobs: int = 1,
    planners: str | Sequence[str] | None = None,
    arenas: str | Sequence[str] | None = None,
    out: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
) -> pd.DataFrame:
    """Evaluate every combination of the grid's values and return one row per point, planner and arena.

    grid: axis -> values; an axis is one of :data:`AXES` or a dotted key of the settings ("prey.speed").
        By default the speed ratio. A value may be a change of the experiment's own: "+5%", "-2%". The robot
        babbles and learns anew wherever the point changes its body, its gaits or its babbling.
    runs, seed, jobs, planners, arenas: as in :func:`bayeshunt.evaluate`.
    out: folder in which the hunts of every point are kept, so that a sweep that was stopped goes on.

    Columns: one per axis, then planner, arena, runs, caught, success [share], ci_low, ci_high (95 %
    Wilson), mean_time_s (a miss counts as the time limit) and its 95 % interval, mean_time_s_low and
    mean_time_s_high.

    Raises InputError for an axis, a value or a name that is wrong, before any hunt is run.
    """
    settings = load_experiment(experiment)
    grid = {"speed_ratio": AXES["speed_ratio"][1]} if grid is None else dict(grid)
    points = [(values, at_point(settings, values, runs)) for values in combinations(grid)]
    for _, point in points:
        check_planners(point, names_of(planners, point.planners, "planners"))
        check_arenas(point, names_of(arenas, tuple(point.arenas), "arenas"))
    models = _learn([point for _, point in points], seed)
    for (_, point), model in zip(points, models, strict=True):
        check_minds(names_of(planners, point.planners, "planners"), model, point)
    rows: list[dict[str, Any]] = []
    for number, ((values, point), model) in enumerate(zip(points, models, strict=True)):
        results = evaluate(
            point, seed=seed, jobs=jobs, planners=planners, arenas=arenas, model=model, progress=progress,
            out=None if out is None else Path(out) / f"point-{number:03d}",
        )  # fmt: skip
        totals = [row for row in summarise(results, point) if row["theta"] is None]
        rows += [{**values, **row, **_mean_time(results, row)} for row in totals]
    frame = pd.DataFrame(rows, columns=[*grid, *COLUMNS])
    frame.attrs = {
        "axes": list(grid),
        "seed": int(seed),
        "experiment": settings.name,
        "scaled": settings.scaled,
        "note": settings.note,
    }
    return frame


def _mean_time(results: pd.DataFrame, row: dict[str, Any]) -> dict[str, float]:
    """The interval of the mean time in a row."""
    hunts = results[(results["planner"] == row["planner"]) & (results["arena"] == row["arena"])]
    low, high = mean_interval(hunts["time"].to_numpy())
    return {"mean_time_s_low": low, "mean_time_s_high": high}


def _learn(points: Sequence[ExperimentSettings], seed: int) -> list[ForwardModel]:
    """The model of each point, learned once for all points that share body, gaits and babbling."""
    models: dict[str, ForwardModel] = {}
    keys = [json.dumps([p.robot.model_dump(), p.model.model_dump(), p.physics.model_dump()]) for p in points]
    for key, point in zip(keys, points, strict=True):
        if key not in models:
            models[key] = learn_model(point, seed)
    return [models[key] for key in keys]


def combinations(grid: Grid) -> list[dict[str, Any]]:
    """Return every combination of a grid's values; InputError if an axis has none."""
    for axis, values in grid.items():
        if isinstance(values, str) or not isinstance(values, Sequence) or not values:
            raise InputError(f"sweep: axis {axis!r} needs a list of values, got {values!r}")
    if not grid:
        raise InputError(f"sweep: the grid has no axis; take one of {', '.join(AXES)} or a key of the settings")
    return [dict(zip(grid, values, strict=True)) for values in itertools.product(*grid.values())]


def at_point(settings: ExperimentSettings, values: Mapping[str, Any], runs: int | None = None) -> ExperimentSettings:
    """Return the settings at one point of a grid."""
    overrides: dict[str, Any] = {} if runs is None else {"protocol.runs": runs}
    for axis, value in values.items():
        overrides.update(_meaning(axis)(settings, _changed(settings, axis, value)))
    return load_experiment(settings, overrides)


def _meaning(axis: str) -> Callable[[ExperimentSettings, Any], dict[str, Any]]:
    """How a value of an axis is said in settings by dotted key."""
    named = {
        "speed_ratio": lambda s, v: {"prey.speed": _number(axis, v, 0.0) * s.robot.top_speed},
        "gait_duration": lambda s, v: {"robot.gait_duration": v},
        "noise": _scale_noise,
        "slip": lambda s, v: {"robot.noise.slip": v, "prey.noise.slip": v},
        "babbling_steps": lambda s, v: {"model.babbling_steps": v},
        "gaits": _first_gaits,
        "max_transitions": lambda s, v: {"planner.planning.max_transitions": v},
    }
    if axis in named:
        return named[axis]
    if axis.partition(".")[0] not in ExperimentSettings.model_fields:
        raise InputError(f"sweep: unknown axis {axis!r}; expected one of {', '.join(AXES)} or a key like prey.speed")
    return lambda s, v: {axis: v}


def _changed(settings: ExperimentSettings, axis: str, value: Any) -> Any:
    """The value itself, or what a change such as "+5%" makes of the settings' own."""
    if not isinstance(value, str) or not _CHANGE.fullmatch(value):
        return value
    own: Any = {
        "speed_ratio": settings.prey.speed / settings.robot.top_speed,
        "gait_duration": settings.robot.gait_duration,
        "noise": 1.0,
        "slip": settings.robot.noise.slip,
        "babbling_steps": settings.model.babbling_steps,
    }.get(axis)
    if own is None:
        own = functools.reduce(_inside, axis.split("."), settings.model_dump())
    if isinstance(own, bool) or not isinstance(own, (int, float)):
        raise InputError(f"sweep: {axis}: {value!r} changes a number, and there is none to change")
    changed = own * (1 + float(value[:-1]) / 100)
    return round(changed) if isinstance(own, int) else changed


def _inside(group: Any, name: str) -> Any:
    return group.get(name) if isinstance(group, dict) else None


def _scale_noise(settings: ExperimentSettings, value: Any) -> dict[str, Any]:
    scale = _number("noise", value, 0.0)
    return {
        f"{who}.noise.{key}": scale * getattr(getattr(settings, who).noise, key)
        for who in ("robot", "prey")
        for key in ("slip", "drift_sd")
    }


def _first_gaits(settings: ExperimentSettings, value: Any) -> dict[str, Any]:
    gaits = [gait.model_dump() for gait in settings.robot.gait]
    if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= len(gaits):
        raise InputError(f"sweep: gaits: expected a whole number from 1 to {len(gaits)}, got {value!r}")
    return {"robot.gait": gaits[:value]}


def _number(axis: str, value: Any, least: float) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not value >= least:
        raise InputError(f"sweep: {axis}: expected a number of at least {least:g}, got {value!r}")
    return float(value)
