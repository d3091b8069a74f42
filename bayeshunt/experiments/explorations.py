"""Learning a room: the robot babbles alone in an arena before any hunt."""

from __future__ import annotations

import os

from bayeshunt.config import ExperimentSettings
from bayeshunt.errors import InputError
from bayeshunt.experiments.protocol import learn_model
from bayeshunt.models.forward import ForwardModel
from bayeshunt.models.rooms import RoomModel
from bayeshunt.settings import load_experiment
from bayeshunt.world.exploring import explore


def learn_room(
    experiment: str | os.PathLike[str] | ExperimentSettings = "paper",
    *,
    arena: str = "walled",
    steps: int = 1000,
    seed: int = 0,
    model: ForwardModel | None = None,
) -> RoomModel:
    """Return the walls of one of the experiment's arenas, learned by babbling ``steps`` gaits in it.

    seed: of the babbling and, without ``model``, of the forward model's. Raises InputError for an
    unknown arena or a wrong number.
    """
    settings = load_experiment(experiment)
    if arena not in settings.arenas:
        raise InputError(f"unknown arena {arena!r}; expected one of {', '.join(settings.arenas)}")
    track = explore(settings.robot, settings.arenas[arena], steps, seed, physics=settings.physics)
    return RoomModel.fit(track, learn_model(settings, seed) if model is None else model)
