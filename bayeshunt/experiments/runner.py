"""Running the protocol: every hunt once, on as many workers as asked, with one result for one seed."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from itertools import groupby
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.config import ExperimentSettings
from bayeshunt.errors import InputError
from bayeshunt.experiments.protocol import HuntTask, learn_model, plan_hunts
from bayeshunt.hunting import Result, run_hunt
from bayeshunt.models.forward import ForwardModel
from bayeshunt.planners.registry import make_planner
from bayeshunt.settings import load_experiment

_BATCH = 20  # hunts handed to a worker at a time

#: Called with the number of hunts that have just ended.
Progress = Callable[[int], None]


def evaluate(
    experiment: str | os.PathLike[str] | ExperimentSettings = "paper",
    *,
    runs: int | None = None,
    seed: int = 0,
    jobs: int = 1,
    planners: Sequence[str] | None = None,
    arenas: Sequence[str] | None = None,
    model: ForwardModel | None = None,
    progress: Progress | None = None,
) -> pd.DataFrame:
    """Run the experiment and return one row per hunt.

    experiment: preset name, TOML path or settings. runs: per bearing, the settings' by default.
    seed: of every hunt and, if no model is given, of the babbling it is learned from.
    jobs: worker processes; -1 for one per core. planners, arenas: names, the settings' by default.

    Columns: planner, arena, theta [rad], run, seed (of that hunt), caught, time [s, the limit if
    missed], decisions, transitions, distance [m]. The same seed gives the same table at any ``jobs``.
    ``frame.attrs["settings"]`` holds the settings used.

    Raises InputError for a wrong name or number.
    """
    settings = experiment_settings(experiment, runs)
    check_jobs(jobs)
    _check_seed(seed)
    planners = tuple(planners) if planners else settings.planners
    arenas = tuple(arenas) if arenas else tuple(settings.arenas)
    tasks = plan_hunts(settings, planners, arenas, seed)
    if model is None:
        model = learn_model(settings, seed)
    check_model(model, settings)
    for name in planners:  # a wrong planner or setting fails here, not in a worker
        make_planner(name, model, **settings.planner.get(name, {}))
    ended: dict[HuntTask, Result] = {}
    for pairs in run_tasks(settings, model, tasks, jobs):
        ended.update(pairs)
        if progress is not None:
            progress(len(pairs))
    return results_frame(tasks, ended, settings, seed)


def experiment_settings(
    experiment: str | os.PathLike[str] | ExperimentSettings, runs: int | None = None
) -> ExperimentSettings:
    """Return the experiment's settings, with ``runs`` per bearing if given."""
    return load_experiment(experiment, None if runs is None else {"protocol.runs": runs})


def check_model(model: ForwardModel, settings: ExperimentSettings) -> None:
    """Raise InputError unless the model's gaits are the robot's."""
    if model.gaits.names != settings.robot.gaits.names:
        raise InputError(
            f"the model's gaits ({', '.join(model.gaits.names)}) are not those of robot {settings.robot.name!r} "
            f"({', '.join(settings.robot.gaits.names)}); fit a model for this robot"
        )


def run_tasks(
    settings: ExperimentSettings, model: ForwardModel, tasks: Sequence[HuntTask], jobs: int
) -> Iterator[list[tuple[HuntTask, Result]]]:
    """Yield finished hunts, a batch at a time, in any order."""
    batches = list(_batches(tasks))
    if jobs == 1:
        yield from (run_batch(settings, model, batch) for batch in batches)
        return
    from joblib import Parallel, delayed

    parallel = Parallel(n_jobs=jobs, return_as="generator_unordered", pre_dispatch="2*n_jobs", batch_size=1)
    yield from parallel(delayed(run_batch)(settings, model, batch) for batch in batches)


def run_batch(
    settings: ExperimentSettings, model: ForwardModel, tasks: Sequence[HuntTask]
) -> list[tuple[HuntTask, Result]]:
    """Run hunts of one planner one after the other."""
    name = tasks[0].planner
    planner = make_planner(name, model, **settings.planner.get(name, {}))
    return [(task, run_hunt(settings, planner, task.arena, task.theta, task.seed)) for task in tasks]


def results_frame(
    tasks: Sequence[HuntTask], ended: dict[HuntTask, Result], settings: ExperimentSettings, seed: int
) -> pd.DataFrame:
    """Return one row per hunt, in the order of the protocol, whatever the order they ended in."""
    frame = pd.DataFrame([(*task, *ended[task]) for task in tasks], columns=[*HuntTask._fields, *Result._fields])
    frame["caught"] = frame["caught"].astype(bool)
    frame.attrs = {"settings": settings.model_dump(mode="json"), "seed": int(seed)}
    return frame


def check_jobs(jobs: int) -> None:
    """Raise InputError unless ``jobs`` is a positive whole number or -1."""
    if isinstance(jobs, bool) or not isinstance(jobs, (int, np.integer)) or not (jobs >= 1 or jobs == -1):
        raise InputError(f"jobs: expected a whole number of at least 1, or -1 for one per core, got {jobs!r}")


def _check_seed(seed: Any) -> None:
    if isinstance(seed, bool) or not isinstance(seed, (int, np.integer)) or seed < 0:
        raise InputError(f"seed: expected a whole number of at least 0, got {seed!r}")


def _batches(tasks: Sequence[HuntTask]) -> Iterator[list[HuntTask]]:
    """Cut the hunts into batches that share a planner."""
    for _, group in groupby(tasks, key=lambda task: (task.planner, task.arena)):
        hunts = list(group)
        yield from (hunts[i : i + _BATCH] for i in range(0, len(hunts), _BATCH))
