"""What hunters that search for a capture along mean paths share: the search's size, its reach, its plan."""

from __future__ import annotations

import itertools
from functools import partial
from typing import Any, ClassVar

import numpy as np
import pandas as pd

from bayeshunt.core.geometry import Polar
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.api import Plan, Shown, Situation
from bayeshunt.planners.cost import Charges
from bayeshunt.planners.requests import catch_distance
from bayeshunt.planners.sequences.capture import CapturePaths, PreyPaths
from bayeshunt.planners.settings import Count, Number, planner_settings, setting

__all__ = ["SearchSettings", "SequenceHunter", "capture_plan", "path_to"]


@planner_settings("sequences")
class SearchSettings:
    """Settings of a search over mean paths."""

    depth: Count = setting(4, "gaits of the longest sequence", ge=1)
    max_transitions: Count = setting(3, "most changes of gait in a sequence", ge=0)
    margin: Number = setting(
        0.9,
        "share of the catch distance that a planned capture must come within, so that a little noise does not spoil it",
        gt=0,
        le=1,
    )
    catch_distance: Number | None = setting(
        None, "body lengths between the centres that count as a catch; by default what the experiment says", gt=0
    )


class SequenceHunter(Shown):
    """A hunter that follows every short gait sequence along its mean path and asks when it captures.

    charges: what gaits cost beside their time, of planners that weigh it.
    """

    name: str
    Settings: ClassVar[type[SearchSettings]] = SearchSettings
    charges: Charges | None = None

    def __init__(self, model: ForwardModel, settings: SearchSettings | None = None, **given: Any) -> None:
        self.settings = self.Settings(**given) if settings is None else settings
        self.hunter = model.gaits
        self.gaits = tuple(model.gaits.names)
        self._spent: dict[int, np.ndarray] = {}
        model.gaits.need("duration")
        self.paths = CapturePaths(model, self.settings.depth, self.settings.max_transitions)
        self._first = self._first_gaits()
        self.leaves = np.arange(self.paths.layers[-2], self.paths.layers[-1])  # the sequences of full depth

    def reach(self, situation: Situation) -> float:
        """Return the distance between the centres that a planned capture must come within [m]."""
        return self.settings.margin * catch_distance(situation, self.settings.catch_distance)

    def costs(
        self, paths: CapturePaths, nodes: np.ndarray, caught: np.ndarray, prey: PreyPaths, reach: float,
        situation: Situation,
    ) -> np.ndarray:  # fmt: skip
        """Return the cost of sequences that end after their last gait, or at the capture within it, [K, n].

        caught: when each captures in its last gait [K, n]; inf: it does not, and then goes on at top speed. Of planners
        that weigh costs (:attr:`charges`). The change from the gait just executed counts.
        """
        assert self.charges is not None
        tree = paths.tree
        end = tree.steps[nodes] * paths.duration
        within = np.isfinite(caught)
        onward = paths.times_to_go(nodes, prey, reach, paths.turn_price)
        time = np.where(within, caught, end + onward)
        # of the last gait, only what is driven before the capture
        share = np.where(within, (caught - (end - paths.duration)) / paths.duration, 1.0)
        onward = np.where(within, 0.0, onward)
        distance = paths.ways[nodes] - (1 - share) * paths.last_ways(nodes) + paths.speed * onward
        changes = tree.transitions[nodes] + (0 if situation.previous_gait is None else self._changed(nodes, situation))
        energy = self._joules(self.charges, paths, nodes, share, onward, situation.previous_gait)
        return np.asarray(self.charges.cost.total(time, distance, changes, 0.0, energy))

    def _joules(
        self, charges: Charges, paths: CapturePaths, nodes: np.ndarray, share: np.ndarray, onward: np.ndarray,
        previous: str | None,
    ) -> np.ndarray | float:  # fmt: skip
        """Return the energy [J] of sequences [n], of ``share`` of their last gait, and of going on at top speed."""
        if not charges.cost.energy:
            return 0.0
        before, parents = charges.number(previous), paths.tree.parents[nodes]
        if before not in self._spent:
            self._spent[before] = paths.tree.along(charges.joules, before)
        spent, fast = self._spent[before], paths.fastest
        rate = charges.joules[fast, fast] / paths.duration
        found: np.ndarray = spent[parents] + share * (spent[nodes] - spent[parents]) + rate * onward
        return found

    def _changed(self, nodes: np.ndarray, situation: Situation) -> np.ndarray:
        """Return 1 where a sequence does not begin with the gait just executed, [n]."""
        if situation.previous_gait not in self.gaits:
            return np.ones(len(nodes))
        found: np.ndarray = (self._first[nodes] != self.gaits.index(situation.previous_gait)).astype(float)
        return found

    def _first_gaits(self) -> np.ndarray:
        """Return the first gait of every sequence, [N]."""
        tree, layers = self.paths.tree, self.paths.layers
        first = tree.gaits.copy()
        for step in range(2, self.paths.depth + 1):
            new = slice(layers[step], layers[step + 1])
            first[new] = first[tree.parents[new]]
        return first


def capture_plan(
    paths: CapturePaths, gaits: tuple[str, ...], values: np.ndarray, prey: PreyPaths, situation: Situation,
    objective: str, *, prey_known: bool,
) -> Plan:  # fmt: skip
    """Return the plan of the node of least value [N]; a tie goes to the shallower, then to table order.

    Paths are places: of the predicted headings only the present one is known, the others are NaN.
    """
    best = int(np.argmin(values))
    branch = path_to(paths, best)
    names = tuple(gaits[g] for g in paths.tree.gaits[branch[1:]])
    mean = PreyPaths(prey.forward.mean(axis=0, keepdims=True), prey.right.mean(axis=0, keepdims=True))
    steps = paths.points * np.arange(len(branch))
    headings = np.full(len(branch), np.nan)
    headings[0] = situation.prey.heading
    predicted = Polar.from_cartesian(mean.forward[0, steps], mean.right[0, steps], headings)
    return Plan(
        gait=names[0],
        gaits=names,
        value=float(values[best]),
        objective=objective,
        nodes=int(np.isfinite(values).sum()),
        make_trace=partial(_trace, paths, gaits, values, branch),
        target=Polar(*(float(part[-1]) for part in predicted)),
        prey_known=prey_known,
        predicted_prey=predicted,
    )


def path_to(paths: CapturePaths, node: int) -> list[int]:
    """Return the nodes from the root to ``node``."""
    branch = [node]
    while branch[-1]:
        branch.append(int(paths.tree.parents[branch[-1]]))
    return branch[::-1]


def _trace(paths: CapturePaths, gaits: tuple[str, ...], values: np.ndarray, branch: list[int]) -> pd.DataFrame:
    """One row per sequence that was given a value: its gaits, its mean end and its value."""
    nodes = np.flatnonzero(np.isfinite(values))
    chosen = set(branch)
    sequences = [[gaits[g] for g in paths.tree.gaits[path_to(paths, int(n))[1:]]] for n in nodes]
    return pd.DataFrame(
        {
            "node": nodes,
            "T": paths.tree.steps[nodes],
            "gaits": [", ".join(f"{g} x{len(list(run))}" for g, run in itertools.groupby(s)) for s in sequences],
            "gait": [s[0] for s in sequences],
            "transition_cost": paths.tree.transitions[nodes],
            "hunter_forward": paths.end[0, nodes],
            "hunter_right": paths.end[1, nodes],
            "value": values[nodes],
            "chosen": [int(n) in chosen for n in nodes],
        }
    )
