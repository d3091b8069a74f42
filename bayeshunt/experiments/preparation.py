"""Before the hunts: the robot babbles alone in an arena, and planners are made with what it learned there."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from bayeshunt.config.loading import DEFAULT_PRESET, load_experiment
from bayeshunt.config.plausibility import warn_of_other_motion
from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.arguments import checked
from bayeshunt.core.checks import check_kind
from bayeshunt.core.errors import InputError, did_you_mean
from bayeshunt.experiments.protocol import learn_model
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.api import Planner
from bayeshunt.planners.cost import Cost, Weighed
from bayeshunt.planners.registry import check_hunts, check_needs, check_sections, explores, find_planner, make_planner
from bayeshunt.worlds.exploring import explore

__all__ = ["check_model", "check_planners", "learn_room", "learn_rooms", "own_settings", "prepare_planner"]

#: Seconds for which a robot babbles in an arena before it hunts there: 1,000 time-steps of preset "paper".
_EXPLORING = 3328.0


def check_planners(settings: ExperimentSettings, planners: Iterable[str], *, hunting: bool = False) -> None:
    """Raise InputError for what is wrong with planners or their settings, as far as that shows before any work.

    planners: the names of those to run; a section of settings for any other must be right too.
    hunting: whether they must be planners that hunt, so that bounds are refused.
    """
    check_sections(settings.planner)
    Cost(**settings.cost)  # a wrong weight fails here, before any work
    for name in planners:
        check_needs(name, settings.planner.get(name, {}))
        if hunting:
            check_hunts(name)


def check_model(model: ForwardModel, settings: ExperimentSettings) -> None:
    """Raise InputError unless it is a model and its gaits are the robot's; warn of a robot that moves otherwise."""
    check_kind(model, "model", ForwardModel, "a ForwardModel")
    if model.gaits.names != settings.robot.gaits.names:
        raise InputError(
            f"the model's gaits ({', '.join(model.gaits.names)}) are not those of robot {settings.robot.name!r} "
            f"({', '.join(settings.robot.gaits.names)}); fit a model for this robot"
        )
    difference = model.gaits.difference(settings.robot.gaits, "the model's robot", settings.robot.name)
    if difference is not None:
        raise InputError(f"{difference}; fit a model of this robot")
    warn_of_other_motion(model.provenance, settings.robot)


@checked
def learn_room(
    experiment: str | os.PathLike[str] | ExperimentSettings = DEFAULT_PRESET,
    *,
    arena: str = "walled",
    steps: int = 1000,
    seed: int = 0,
    model: ForwardModel | None = None,
    progress: Callable[[int], None] | None = None,
) -> RoomModel:
    """Return the walls of one of the experiment's arenas, learned by babbling ``steps`` gaits in it.

    seed: of the babbling and, without ``model``, of the forward model's. progress: called with 1 after
    every step of either. Raises InputError for an unknown arena or a wrong number.
    """
    settings = load_experiment(experiment)
    check_planners(settings, ())
    if arena not in settings.arenas:
        raise InputError(f"unknown arena {arena!r}{did_you_mean(arena, settings.arenas)}")
    if model is not None:
        check_model(model, settings)
    track = explore(
        settings.robot, settings.arenas[arena], steps, seed, physics=settings.physics,
        start=settings.protocol.hunter_pose, progress=progress, world=settings.world,
    )  # fmt: skip
    return RoomModel.fit(track, learn_model(settings, seed, progress) if model is None else model)


def learn_rooms(
    settings: ExperimentSettings, planners: Iterable[str], arenas: Iterable[str], seed: int, model: ForwardModel
) -> dict[str, RoomModel]:
    """Return the room of each arena, learned there beforehand; none if no planner explores.

    settings: ``model.exploring_steps`` gaits are babbled, by default ``_EXPLORING`` seconds of them.
    seed: of the babbling; the room of an arena is the same whatever else is evaluated.
    """
    if not any(explores(name, settings.planner.get(name, {})) for name in planners):
        return {}
    steps = settings.model.exploring_steps or math.ceil(_EXPLORING / settings.robot.gait_duration)
    return {arena: learn_room(settings, arena=arena, steps=steps, seed=seed, model=model) for arena in arenas}


def own_settings(settings: ExperimentSettings, name: str) -> dict[str, Any]:
    """Return what an experiment gives a planner by name: its section, and what all planners are told a hunt costs.

    Where ``protocol.thinking`` is "nodes", a node takes as long as it does there. Raises InputError for a wrong cost.
    """
    given, typed = dict(settings.planner.get(name, {})), find_planner(name).typed
    shared = dict(settings.cost)
    if settings.protocol.thinking == "nodes":
        shared = {"seconds_per_node": settings.protocol.seconds_per_node, **shared}
    if typed is not None and issubclass(typed, Cost):
        return {**shared, **given}
    if typed is not None and issubclass(typed, Weighed) and isinstance(own := given.get("cost", {}), Mapping):
        given["cost"] = Cost(**{**shared, **own})
    return given


def prepare_planner(
    name: str, model: ForwardModel, settings: ExperimentSettings, rooms: Mapping[str, RoomModel], arena: str
) -> Planner:
    """Return a planner with the experiment's settings, ready to hunt in ``arena``.

    rooms: of :func:`learn_rooms`. Raises InputError for an unknown name or a wrong setting.
    """
    given = own_settings(settings, name)
    if explores(name, given) and arena in rooms:
        given["room"] = rooms[arena]
    return make_planner(name, model, **given)
