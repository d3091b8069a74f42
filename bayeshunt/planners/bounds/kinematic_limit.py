"""What no hunter of this speed can beat: straight to the prey at full speed, its future known."""

from __future__ import annotations

import math

import numpy as np

from bayeshunt.core.errors import InputError
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.api import Future, Plan, Shown, Situation
from bayeshunt.planners.info import FUTURE, PlannerInfo

__all__ = ["KinematicLimit"]


class KinematicLimit(Shown):
    """A bound, not a hunter: the earliest time at which a point of the robot's top speed reaches the prey.

    It turns instantly, is at full speed at once, meets no walls, feels no noise and knows the prey's
    noise-free future. Its row in a table of results holds this time for every run; it executes no gaits.
    """

    name = "kinematic_limit"
    info = PlannerInfo(ab_initio=False, needs=(FUTURE,), hunts=False)

    def __init__(self, model: ForwardModel) -> None:
        self.gaits = tuple(model.gaits.names)

    @staticmethod
    def capture_time(future: Future, speed: float, reach: float) -> float:
        """Return the least t with ``|prey(t)| <= speed t + reach`` [s]; inf if there is none in ``future``.

        speed: metres per second. reach: metres between the centres that count as a catch.
        """
        # the gap left after driving at the prey's place at t for the whole of t; it changes sign at the capture
        gap = future.prey.distance - speed * future.times - reach
        first = int(np.argmax(gap <= 0))
        if gap[first] > 0:
            return math.inf
        if first == 0:
            return float(future.times[0])
        share = gap[first - 1] / (gap[first - 1] - gap[first])
        return float(future.times[first - 1] + share * (future.times[first] - future.times[first - 1]))

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Raise InputError: no gaits reach this bound."""
        raise InputError("kinematic_limit is a bound that no gaits reach: it can be evaluated, not hunted with")
