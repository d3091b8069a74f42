"""What a hunt costs: the weights of planners that weigh, and what they learned that gaits cost.

Letters: G gaits, N gait sequences. Row G of a table by the gait before is for one that is not known.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from bayeshunt.core.errors import InputError
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.search.rollouts import GaitTree
from bayeshunt.planners.settings import Number, planner_settings, setting

__all__ = ["Cost", "Energies"]


@planner_settings("cost")
class Cost:
    """What each part of a hunt costs; the unit of cost is free."""

    time: Number = setting(1.0, "cost of a second until the catch", ge=0)
    distance: Number = setting(0.0, "cost of a metre travelled; time or distance must cost something", ge=0)
    transitions: Number = setting(0.0, "cost of a change of gait", ge=0)
    planning: Number = setting(0.0, "cost of a second of planning", ge=0)
    energy: Number = setting(0.0, "cost of a joule, as learned after each gait; only of bodies that measure it", ge=0)

    def __post_init__(self) -> None:
        if not self.time + self.distance > 0:
            raise InputError("cost: time or distance must cost something, or standing still would be best")

    def total(self, time: Any, distance: Any, transitions: Any, planning: Any, energy: Any = 0.0) -> Any:
        """Return the cost of seconds, metres, changes of gait, seconds of planning and joules; numbers or arrays."""
        moved = self.time * time + self.distance * distance + self.transitions * transitions
        return moved + self.planning * planning + self.energy * energy


class Energies:
    """The expected energy of gait sequences, each gait after the one before it.

    steps: E[energy | gait, gait before] [G + 1, G] in joules.
    """

    def __init__(self, model: ForwardModel) -> None:
        """Take them over from a model, of any structure; InputError if the rows that it counted do not say them.

        A gait that was never babbled costs what the dearest does.
        """
        known = np.stack([model.expected_energy(before) for before in (*model.gaits.names, None)])
        self.steps = np.where(np.isnan(known), np.nanmax(known, initial=0.0), known)
        self._made: dict[int, np.ndarray] = {}

    def of(self, tree: GaitTree, before: int) -> np.ndarray:
        """Return the energy [J] of every sequence of a tree [N] after gait number ``before`` (-1: not known)."""
        if before not in self._made:
            total = np.zeros(len(tree.steps))
            for step in range(1, int(tree.steps.max()) + 1):
                new = np.flatnonzero(tree.steps == step)
                parents = tree.parents[new]
                last = tree.gaits[parents] if step > 1 else np.full(len(new), before)
                total[new] = total[parents] + self.steps[last, tree.gaits[new]]
            total.setflags(write=False)
            self._made[before] = total
        return self._made[before]
