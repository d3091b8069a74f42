"""The paper's protocol as a list of hunts: which planner, arena, bearing, run and seed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.errors import InputError, shown
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.tables.structures import depends_on_previous
from bayeshunt.worlds.babbling import babble

__all__ = ["HuntTask", "check_arenas", "check_once", "hunt_seed", "learn_model", "names_of", "plan_hunts"]


class HuntTask(NamedTuple):
    """One hunt to run. ``seed`` depends on theta's position and the run alone, not on planner or arena."""

    planner: str
    arena: str
    theta: float
    run: int
    seed: int


def hunt_seed(seed: int, theta_index: int, run: int) -> int:
    """Return the seed of one hunt: a whole number below 2**63 that ``bayeshunt hunt --seed`` takes."""
    return int(np.random.SeedSequence([seed, theta_index, run]).generate_state(1, np.uint64)[0] >> 1)


def plan_hunts(
    settings: ExperimentSettings, planners: Sequence[str], arenas: Sequence[str], seed: int
) -> list[HuntTask]:
    """Return every hunt of the protocol in the order of the results.

    Raises InputError for an arena that the settings lack or a name that is given twice.
    """
    check_arenas(settings, arenas)
    check_once("planner", planners)
    protocol = settings.protocol
    return [
        HuntTask(planner, arena, theta, run, hunt_seed(seed, index, run))
        for arena in arenas
        for planner in planners
        for index, theta in enumerate(protocol.thetas)
        for run in range(protocol.runs)
    ]


def names_of(given: str | Sequence[str] | None, default: Sequence[str], what: str) -> tuple[str, ...]:
    """Return one name, several, or the settings' own; InputError for anything else, ``what`` says of what."""
    if isinstance(given, str):
        return (given,)
    if given is not None and not isinstance(given, Sequence):
        raise InputError(f"{what}: expected a name or a list of names, got {shown(given)}")
    return tuple(given or default)


def check_arenas(settings: ExperimentSettings, arenas: Sequence[str]) -> None:
    """Raise InputError for an arena that the settings lack or that is named twice."""
    for arena in arenas:
        settings.check_arena(arena)
    check_once("arena", arenas)


def check_once(kind: str, names: Sequence[str]) -> None:
    """Raise InputError for a name that is given twice; ``kind``: of what, for the message."""
    for name in names:
        if list(names).count(name) > 1:
            raise InputError(f"{kind} {name!r} is given twice")


def learn_model(settings: ExperimentSettings, seed: int, progress: Any = None) -> ForwardModel:
    """Babble with the experiment's robot and fit the forward model: what the robot knows of its own body."""
    model, robot = settings.model, settings.robot
    frame = babble(robot, model.babbling_steps, seed, physics=settings.physics, progress=progress, world=settings.world)
    axes = EffectAxes.standard(
        robot.body.body_length,
        distance_bin=model.distance_bin,
        angle_bins=model.angle_bins,
        heading_bins=model.heading_bins,
    )
    backoff = model.backoff if depends_on_previous(model.structure) else None
    return ForwardModel.fit(
        frame, robot.gaits, prior=model.prior, axes=axes, structure=model.structure, backoff=backoff
    )
