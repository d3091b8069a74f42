"""What planners do first with a situation: check it, complete it, and take from it what all of them need."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from bayeshunt.core.checks import check_generator, check_kind
from bayeshunt.core.errors import InputError
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.core.geometry import FloatArray, Polar
from bayeshunt.core.task import CATCH_BODIES
from bayeshunt.planners.api import Situation

__all__ = ["catch_distance", "check_request", "predict_prey"]


def check_request(situation: Situation, rng: np.random.Generator, hunter: GaitRepertoire) -> Situation:
    """Return what a planner was asked, with the hunter's measures filled in from its model's gaits, ``hunter``.

    Raises InputError unless it is a situation and a generator, or if the situation is one of another body length
    or time-step than the model's.
    """
    check_kind(situation, "situation", Situation, "a Situation")
    check_generator(rng)
    known = (hunter.body_length, hunter.duration)
    if (situation.body_length, situation.time_step) == known:
        return situation
    given = (situation.body_length, situation.time_step)
    for name, unit, asked, own in zip(("body_length", "time_step"), ("m", "s"), given, known, strict=True):
        if asked is not None and own is not None and not math.isclose(asked, own, rel_tol=1e-6):
            raise InputError(
                f"situation: {name} is {asked:g} {unit}, but the planner's model is of a robot with {own:g} {unit}; "
                "fit a model for this robot"
            )
    return replace(
        situation,
        body_length=known[0] if given[0] is None else given[0],
        time_step=known[1] if given[1] is None else given[1],
    )


def catch_distance(situation: Situation, chosen: float | None) -> float:
    """Return the distance between the centres that counts as a catch [m].

    chosen: a planner's own setting, body lengths; None: the situation's task says, or else the paper does.
    """
    if chosen is None and situation.task.catch_distance is not None:
        return situation.task.catch_distance
    return (CATCH_BODIES if chosen is None else chosen) * situation.need("body_length")


def predict_prey(situation: Situation, steps: int) -> tuple[Polar[FloatArray], bool]:
    """Return the prey 0..steps ahead as the hunter sees it now, and whether the prey model was used.

    The path is a Polar of arrays [steps + 1]. While the prey model is empty the prey is taken to
    stand still, and the flag is False.
    """
    if situation.prey_model.is_empty:
        return Polar(*(np.full(steps + 1, float(value)) for value in situation.prey)), False
    path = situation.prey.compose(situation.prey_model.predict_path(steps))
    if not np.isfinite(path).all():
        raise InputError(f"the prey model predicts a pose that is not finite within {steps} steps")
    return path, True
