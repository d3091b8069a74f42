"""What a hunt costs: the weights of all planners that search, and what gaits cost as their model learned it.

Letters: G gaits. Row G of a table by the gait before is for one that is not known.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cached_property
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator

from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import FloatArray, Polar
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.interception.lookahead import gait_paths, path_lengths
from bayeshunt.planners.settings import Number, planner_settings, setting

__all__ = ["Charges", "Cost", "Weighed"]

#: A prey faster than the rest of the hunter's top speed might never be met, and then a metre must still cost something.
LEAST_GAIN = 0.1


@planner_settings("cost")
class Cost:
    """What each part of a hunt costs; the unit of cost is free."""

    time: Number = setting(1.0, "cost of a second until the catch", ge=0)
    distance: Number = setting(0.0, "cost of a metre travelled; time or distance must cost something", ge=0)
    transitions: Number = setting(0.0, "cost of a change of gait", ge=0)
    planning: Number = setting(0.0, "cost of a second of planning", ge=0)
    energy: Number = setting(0.0, "cost of a joule, as learned after each gait; only of bodies that measure it", ge=0)
    clearance: Number = setting(
        0.0, "cost of a second nearer to a wall than a body length; only of planners that know walls", ge=0
    )
    seconds_per_node: Number = setting(1e-6, "seconds that considering one sequence takes", ge=0)

    def __post_init__(self) -> None:
        if not self.time + self.distance > 0:
            raise InputError("cost: time or distance must cost something, or standing still would be best")

    def total(
        self, time: Any, distance: Any, transitions: Any, planning: Any, energy: Any = 0.0, clearance: Any = 0.0
    ) -> Any:
        """Return the cost of seconds, metres, changes of gait, seconds of planning, joules and seconds near walls."""
        moved = self.time * time + self.distance * distance + self.transitions * transitions
        return moved + self.planning * planning + self.energy * energy + self.clearance * clearance

    @property
    def of_gaits(self) -> bool:
        """Whether anything costs that depends on the gaits of a sequence, beside its time."""
        return any((self.distance, self.transitions, self.energy, self.clearance))

    def __str__(self) -> str:
        weights = {name: getattr(self, name) for name in ("time", "distance", "transitions", "planning", "energy")}
        weights["clearance"] = self.clearance
        return ", ".join(f"{name} {weight:g}" for name, weight in weights.items() if weight)


def _weights(given: Any) -> Any:
    """A cost as it is, or of weights by name."""
    return Cost(**given) if isinstance(given, Mapping) else given


@planner_settings("cost")
class Weighed:
    """Settings of a planner that weighs what a hunt costs."""

    cost: Annotated[Cost, BeforeValidator(_weights)] = setting(
        _weights({}), "what each part of a hunt costs, over the group cost of the experiment", kw_only=True
    )


class Charges:
    """What gaits cost beside their time, each after the gait before it: tables [G + 1, G] of a model.

    changes: 1 where the gait differs from the one before, 0 where that is not known. metres: its way [m]. joules:
    expected energy [J]; 0 where energy costs nothing. speed: m/s, of the fastest gait; joules_per_second: of it after
    itself.
    """

    def __init__(self, model: ForwardModel, cost: Cost) -> None:
        """Take them over from a model, of any structure.

        InputError if energy costs something and the model's rows do not say it. A gait that was never babbled costs
        what the dearest does.
        """
        count = len(model.gaits)
        self.cost, self.seconds, self.names = cost, model.gaits.need("duration"), tuple(model.gaits.names)
        lengths = self.metres = np.stack([path_lengths(gait_paths(model.after(b))) for b in (*self.names, None)])
        self.changes = np.concatenate([1.0 - np.eye(count), np.zeros((1, count))])
        self.joules = np.zeros((count + 1, count))
        if cost.energy:
            known = np.stack([model.expected_energy(before) for before in (*model.gaits.names, None)])
            self.joules = np.where(np.isnan(known), np.nanmax(known, initial=0.0), known)
        fast = int(lengths[count].argmax())
        self.speed = float(lengths[count, fast] / self.seconds)
        self.joules_per_second = float(self.joules[fast, fast] / self.seconds)

    def number(self, gait: str | None) -> int:
        """Return the number of the gait just executed; -1: not known."""
        return self.names.index(gait) if gait in self.names else -1

    @property
    def per_second(self) -> float:
        """Cost of a second of the fastest gait after itself."""
        return float(self.cost.total(1.0, self.speed, 0.0, 0.0, self.joules_per_second))

    @cached_property
    def beyond_fastest(self) -> np.ndarray:
        """What a gait costs [G + 1, G] beyond as long a time of the fastest one."""
        spent = self.cost.total(0.0, self.metres, self.changes, 0.0, self.joules)
        rate = self.cost.total(0.0, self.speed, 0.0, 0.0, self.joules_per_second)
        found: np.ndarray = spent - rate * self.seconds
        return found

    def metres_of(self, prey: Polar[FloatArray]) -> float:
        """Return the metres left to a prey that cost 1: as many as the fastest gait gains on it for that.

        prey: the path that it is expected to take, [steps + 1] from now on.
        """
        steps = len(prey.distance) - 1
        gone = math.hypot(float(np.diff(prey.forward[[0, -1]])[0]), float(np.diff(prey.right[[0, -1]])[0]))
        gained = self.speed - gone / (steps * self.seconds)
        return max(gained, LEAST_GAIN * self.speed) / self.per_second
