"""What a quicker catch costs: time, distance, changes of gait and planning time of several planners and weights."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.config.loading import DEFAULT_PRESET, load_experiment
from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.arguments import checked_but
from bayeshunt.core.errors import InputError, did_you_mean
from bayeshunt.episodes.loop import run_hunt
from bayeshunt.experiments.preparation import check_planners, learn_rooms, own_settings, prepare_planner
from bayeshunt.experiments.protocol import check_arenas, hunt_seed, learn_model, names_of
from bayeshunt.experiments.run.runner import Progress, evaluate
from bayeshunt.experiments.scores import mean_interval, wilson_interval
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.asking import Timed
from bayeshunt.planners.cost import Cost
from bayeshunt.planners.registry import planner_info
from bayeshunt.planners.settings import settings_fields

__all__ = ["VARIED", "WEIGHED", "planning_time", "tradeoff"]

#: The planner that weighs its costs; the others are shown beside it.
WEIGHED = "frugal"
#: Values of a varied weight by default: per metre, per change of gait, per second of planning, per joule.
VARIED: dict[str, tuple[float, ...]] = {
    "distance": (0.0, 10.0, 30.0, 100.0),
    "transitions": (0.0, 1.0, 3.0, 10.0),
    "planning": (0.0, 1e2, 1e3, 1e4),
    "energy": (0.0, 0.3, 1.0, 3.0),
}


@checked_but("planners")
def tradeoff(
    experiment: str | os.PathLike[str] | ExperimentSettings = DEFAULT_PRESET,
    vary: Mapping[str, Sequence[float]] | None = None,
    *,
    runs: int | None = None,
    seed: int = 0,
    jobs: int = 1,
    planners: str | Sequence[str] = ("prediction", "planning"),
    arena: str = "open",
    progress: Progress | None = None,
) -> pd.DataFrame:
    """Evaluate the planner ``frugal`` under several weights, and others beside it; one row for each.

    vary: weight -> values, one weight at a time, the others as in ``cost`` and ``planner.frugal`` of the settings.
    planners: those beside it. arena: one of the settings'.

    Columns: planner, weight, value (what was varied; empty for the others), runs, caught, success,
    ci_low, ci_high (95 % Wilson), mean_time_s, mean_distance_m, mean_transitions, each of the three with its 95 %
    interval (``..._low``, ``..._high``), planning_ms (median of one decision,
    measured on this machine, alone among the columns in that), mean_planning_s, cost (under the
    settings' weights); of a body that measures what it spends also mean_energy_j with its interval.
    """
    settings = load_experiment(experiment, None if runs is None else {"protocol.runs": runs})
    vary = {"transitions": VARIED["transitions"]} if vary is None else vary
    weights = _weights(settings)
    beside = names_of(planners, (), "planners")
    check_planners(settings, beside)
    check_arenas(settings, [arena])
    cases = [(name, "", float("nan"), settings) for name in beside]
    for weight, values in vary.items():
        if weight not in vars(weights):
            raise InputError(f"unknown weight {weight!r}{did_you_mean(weight, vars(weights))}")
        for value in values:
            point = load_experiment(settings, {f"planner.{WEIGHED}.{weight}": value})
            _weights(point)  # a wrong value fails here, before any work
            check_planners(point, [WEIGHED])
            cases.append((WEIGHED, weight, float(value), point))
    model = learn_model(settings, seed)
    rows = []
    for planner, weight, value, point in cases:
        hunts = evaluate(
            point, seed=seed, jobs=jobs, planners=[planner], arenas=[arena], model=model, progress=progress
        )
        rows.append({"planner": planner, "weight": weight, "value": value}
                    | _summary(hunts, weights, planning_time(point, model, planner, arena, seed)))  # fmt: skip
    frame = pd.DataFrame(rows)
    frame.attrs = {"experiment": settings.name, "scaled": settings.scaled, "note": settings.note, "seed": int(seed),
                   "arena": arena, "weights": vars(weights).copy()}  # fmt: skip
    return frame


def planning_time(settings: ExperimentSettings, model: ForwardModel, planner: str, arena: str, seed: int) -> float:
    """Return the median processor time of one decision [s], over one hunt per bearing; 0 for a bound."""
    if not planner_info(planner).hunts:
        return 0.0
    rooms = learn_rooms(settings, [planner], [arena], seed, model)
    timed = Timed(prepare_planner(planner, model, settings, rooms, arena))
    for index, theta in enumerate(settings.protocol.thetas):
        run_hunt(settings, timed, arena, theta, hunt_seed(seed, index, 0))
    return float(np.median(timed.seconds)) if timed.seconds else 0.0


def _weights(settings: ExperimentSettings) -> Cost:
    chosen = own_settings(settings, WEIGHED)
    return Cost(**{f.name: chosen[f.name] for f in settings_fields(Cost) if f.name in chosen})


def _intervals(hunts: pd.DataFrame) -> dict[str, float]:
    """Low and high of the 95 % intervals of the means."""
    means = {"mean_time_s": "time", "mean_distance_m": "distance", "mean_transitions": "transitions"}
    if "energy" in hunts:
        means["mean_energy_j"] = "energy"
    limits = {name: mean_interval(hunts[column].to_numpy()) for name, column in means.items()}
    return {f"{name}_{end}": limit[i] for name, limit in limits.items() for i, end in enumerate(("low", "high"))}


def _summary(hunts: pd.DataFrame, weights: Cost, per_decision: float) -> dict[str, Any]:
    runs, caught = len(hunts), int(hunts["caught"].sum())
    low, high = wilson_interval(caught, runs)
    planning = float(hunts["decisions"].mean()) * per_decision
    time_s, distance, transitions = (float(hunts[name].mean()) for name in ("time", "distance", "transitions"))
    spent = {"mean_energy_j": float(hunts["energy"].mean())} if "energy" in hunts else {}
    return {
        "runs": runs,
        "caught": caught,
        "success": caught / runs,
        "ci_low": low,
        "ci_high": high,
        "mean_time_s": time_s,
        "mean_distance_m": distance,
        "mean_transitions": transitions,
        **spent,
        **_intervals(hunts),
        "planning_ms": 1e3 * per_decision,
        "mean_planning_s": planning,
        "cost": float(weights.total(time_s, distance, transitions, planning, spent.get("mean_energy_j", 0.0))),
    }
