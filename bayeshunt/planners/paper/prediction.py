"""The paper's prey-prediction hunter: aim where the prey is expected to be."""

from __future__ import annotations

import math

import numpy as np

from bayeshunt.core.geometry import Polar
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel
from bayeshunt.planners.api import Plan, Shown, Situation
from bayeshunt.planners.paper.reactive import aim
from bayeshunt.planners.requests import check_request, predict_prey

__all__ = ["PredictionPlanner", "steps_ahead"]

# A distance of 5 bodies may arrive as 4.999999999999999; it must not change the rounding.
_ROUNDING_SLACK = 1e-9


def steps_ahead(distance: float, body_length: float) -> int:
    """Return T, the nearest integer to half the ``distance`` [m] in bodies; halves round up.

    ``T = floor(d / (2 body_length) + 1/2)``: 5 bodies, 2.5 steps, gives 3.
    """
    return math.floor(distance / (2.0 * body_length) + 0.5 + _ROUNDING_SLACK)


class PredictionPlanner(Shown):
    """argmax of P(Gait | Distance, Angle) at the prey predicted T steps ahead (paper, prey prediction).

    While the prey model is empty it aims at the prey's present position, and the plan says so:
    ``prey_known`` is False. In a model of structure "previous_gait", given the gait just executed as
    well. A tie goes to the first gait in table order. ``rng`` is not used.
    """

    name = "prediction"

    def __init__(self, model: ForwardModel) -> None:
        self.inverse = InverseModel(model)
        self.hunter = model.gaits
        self.gaits = tuple(model.gaits.names)

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Return the gait of highest posterior at the prey's predicted position."""
        situation = check_request(situation, rng, self.hunter)
        steps = steps_ahead(situation.prey.distance, situation.need("body_length"))
        path, known = predict_prey(situation, steps)
        target = Polar(*(float(values[-1]) for values in path))
        inverse = self.inverse.after(situation.previous_gait)
        return aim(inverse, self.gaits, target, situation.interval, prey_known=known, predicted_prey=path)
