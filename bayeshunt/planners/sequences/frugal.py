"""A hunter that weighs the time of the catch against way, energy, changes of gait and thinking."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.tables.structures import depends_on_previous
from bayeshunt.planners.api import Plan, Situation
from bayeshunt.planners.cost import Charges, Cost
from bayeshunt.planners.requests import check_request, predict_prey
from bayeshunt.planners.sequences.capture import CapturePaths, PreyPaths
from bayeshunt.planners.sequences.hunter import SearchSettings, SequenceHunter, capture_plan
from bayeshunt.planners.settings import Count, planner_settings, setting

__all__ = ["CostWeights", "Frugal", "FrugalSettings"]

#: The weights as they were called before other planners took them.
CostWeights = Cost


@planner_settings("frugal")
class FrugalSettings(SearchSettings, Cost):
    """Settings of the frugal hunter: what a hunt costs, and how it searches."""

    depth: Count = setting(3, "gaits of the longest sequence", ge=1)
    max_transitions: Count = setting(2, "most changes of gait in a sequence", ge=0)


class Frugal(SequenceHunter):
    """The gait sequence of least cost: capture time, distance, gait transitions and planning time, weighed.

    The prey is predicted by the mean transition seen in this run (before any: it moves straight on as
    the hunter's fastest gait does). A sequence that captures costs what it takes until then; one that
    does not, what it takes to its end and then straight to the prey at top speed. The change from the
    gait just executed counts as a transition.

    The search deepens step by step, and stops where looking one step further would cost more planning
    than the last step further has gained (the first: than there is to gain): nodes x
    the seconds of a node x the price of planning.

    ``rng`` is not used.
    """

    name = "frugal"
    Settings = FrugalSettings
    settings: FrugalSettings

    def __init__(self, model: ForwardModel, settings: FrugalSettings | None = None, **given: Any) -> None:
        super().__init__(model, settings, **given)
        depth, changes = self.settings.depth, self.settings.max_transitions
        self._after = {
            gait: CapturePaths(model, depth, changes, previous_gait=gait, tree=self.paths.tree)
            for gait in (self.gaits if depends_on_previous(model.structure) else ())
        }
        self.charges = Charges(model, self.settings)

    def paths_after(self, previous_gait: str | None) -> CapturePaths:
        """Return the mean paths of every sequence that follows a gait, where that changes them."""
        return self._after.get(previous_gait or "", self.paths)

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Return the sequence of least cost."""
        situation = check_request(situation, rng, self.hunter)
        paths, known = self.paths_after(situation.previous_gait), not situation.prey_model.is_empty
        prey = self._prey(situation)
        reach = self.reach(situation)
        caught = paths.first_captures(prey, reach)[0]
        values = np.full(len(paths.tree.steps), np.inf)
        best = math.inf
        for depth in range(1, paths.depth + 1):
            new = np.arange(paths.layers[depth], paths.layers[depth + 1])
            costs = self.costs(paths, new, caught[None, new], prey, reach, situation)[0]
            shallower, best = best, min(best, float(costs.min()))
            values[new] = costs
            # looking further can gain at most what is left to pay
            if self._enough(depth, shallower - best if depth > 1 else best):
                break
        # a sequence that has not captured is judged by its continuations, where there are any
        values[: new[0]] = np.where(np.isfinite(caught[: new[0]]), values[: new[0]], np.inf)
        return capture_plan(
            paths, self.gaits, values, prey, situation, "cost of the hunt, as weighed", prey_known=known
        )

    def _enough(self, depth: int, gained: float) -> bool:
        """Return whether one step further costs more planning than the last step further has gained."""
        if depth == self.paths.depth:
            return True
        more = self.paths.layers[depth + 2] - self.paths.layers[depth + 1]
        return bool(self.settings.planning * self.settings.seconds_per_node * more > gained)

    def _prey(self, situation: Situation) -> PreyPaths:
        """Return the one path that the prey is expected to take, [1, T P + 1]."""
        paths = self.paths
        if situation.prey_model.is_empty:
            here, heading = situation.prey, float(situation.prey.heading)
            gone = paths.speed * paths.interval * np.arange(paths.depth * paths.points + 1)
            ahead, right = here.forward + gone * math.cos(heading), here.right + gone * math.sin(heading)
            return PreyPaths(ahead[None], right[None])
        path, _ = predict_prey(situation, paths.depth)
        share = np.arange(paths.depth * paths.points + 1) / paths.points
        steps = np.arange(paths.depth + 1)
        return PreyPaths(np.interp(share, steps, path.forward)[None], np.interp(share, steps, path.right)[None])
