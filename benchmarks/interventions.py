"""Hunters made only to find out what a gap is due to: each differs from one of ours in one thing."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.api import Future, Plan, Situation
from bayeshunt.planners.bounds.omniscient import Omniscient
from bayeshunt.planners.info import ROOM, PlannerInfo
from bayeshunt.planners.interception.intercept_walls import intercept_walls
from bayeshunt.planners.registry import planner_names, register_planner

FORESEEN = "omniscient_search_of_predicted_prey"


class Foreseen:
    """The omniscient hunter's search, given the path that ``intercept_walls`` finds likeliest instead of the true one.

    Against ``omniscient`` it differs in what is known of the prey; against ``intercept_walls`` in the search.
    """

    name = FORESEEN

    def __init__(self, model: ForwardModel, *, room: Any) -> None:
        self.walls = intercept_walls(model, room=room)
        self.search = Omniscient(model)
        self.times = np.linspace(0.0, self.search.foresight, 1 + int(np.ceil(self.search.foresight / 0.064)))

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Return the sequence of earliest capture of the likeliest path."""
        path = self.walls.futures(situation).likeliest(self.times[1:])
        return self.search.plan(replace(situation, future=Future(self.times, path)), rng=rng)


def register() -> None:
    """Make them known in this process."""
    if FORESEEN not in planner_names():
        register_planner(FORESEEN, Foreseen, info=PlannerInfo(needs=(ROOM,), prepare=ROOM))
