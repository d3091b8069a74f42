"""Making a prey memory: earlier runs whose seeds no evaluation uses."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from bayeshunt.config.loading import DEFAULT_PRESET, load_experiment
from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.arguments import checked_but
from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.checks import check_whole
from bayeshunt.core.geometry import Polar, Pose
from bayeshunt.episodes.loop import hunt
from bayeshunt.experiments.preparation import check_model, check_planners, learn_rooms, prepare_planner
from bayeshunt.experiments.protocol import check_arenas, learn_model, names_of
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.target.memory import PreyMemory

__all__ = ["PLACE_SIZE", "remember", "training_seed"]

_TRAINING = 1  # a fourth number in the seed sequence, which the hunts of an evaluation do not have
PLACE_SIZE = 3.5  # body lengths


def training_seed(seed: int, theta_index: int, run: int) -> int:
    """Return the seed of a training hunt; by construction no hunt of an evaluation has the same stream."""
    return int(np.random.SeedSequence([seed, theta_index, run, _TRAINING]).generate_state(1, np.uint64)[0] >> 1)


@checked_but("arenas")
def remember(
    experiment: str | os.PathLike[str] | ExperimentSettings = DEFAULT_PRESET,
    *,
    arenas: str | Sequence[str] | None = None,
    planner: str = "reactive",
    runs: int = 30,
    seed: int = 0,
    model: ForwardModel | None = None,
    progress: Callable[[int], None] | None = None,
) -> PreyMemory:
    """Return the tables of the prey seen in ``runs`` training hunts per bearing and arena.

    arenas: by default all of the settings'. planner: who hunts meanwhile; the reactive hunter seldom
    catches, so that it sees much. seed: of the training hunts and, without ``model``, of the babbling.
    Raises InputError for a wrong number, an unknown planner, or an arena that is unknown or named twice.
    """
    settings = load_experiment(experiment)
    check_planners(settings, [planner], hunting=True)
    check_whole(runs, "runs", 1)
    check_whole(seed, "seed", 0)
    chosen = list(names_of(arenas, tuple(settings.arenas), "arenas"))
    check_arenas(settings, chosen)
    body, sizes = settings.robot.body.body_length, settings.model
    if model is not None:
        check_model(model, settings)
    axes = EffectAxes.standard(
        body, distance_bin=sizes.distance_bin, angle_bins=sizes.angle_bins, heading_bins=sizes.heading_bins
    )
    origin = {"experiment": settings.name, "arenas": chosen, "planner": planner, "runs": int(runs), "seed": int(seed)}
    memory = PreyMemory.empty(chosen, axes, PLACE_SIZE * body, origin)
    model = learn_model(settings, seed) if model is None else model
    rooms = learn_rooms(settings, [planner], chosen, seed, model)
    for arena in chosen:
        mind = prepare_planner(planner, model, settings, rooms, arena)
        for index, theta in enumerate(settings.protocol.thetas):
            for run in range(runs):
                _learn(memory, settings, mind, arena, theta, training_seed(seed, index, run))
                if progress is not None:
                    progress(1)
    return memory


def _learn(memory: PreyMemory, settings: ExperimentSettings, planner: Any, arena: str, theta: float, seed: int) -> None:
    """Run one hunt and count what its prey did."""
    frame = hunt(settings, planner, arena=arena, theta=theta, seed=seed).frame
    # the place before each transition is where the prey was one decision earlier
    places = frame[["prey_x", "prey_y", "prey_theta"]].to_numpy(dtype=float)[:-1]
    seen = frame[["observed_distance", "observed_angle", "observed_heading"]].to_numpy(dtype=float)[1:]
    memory.observe_track(arena, [Pose(*row) for row in places.tolist()], [Polar(*row) for row in seen.tolist()])
