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
    """A hunter that follows every short gait sequence along its mean path and asks when it captures."""

    name: str
    Settings: ClassVar[type[SearchSettings]] = SearchSettings

    def __init__(self, model: ForwardModel, settings: SearchSettings | None = None, **given: Any) -> None:
        self.settings = self.Settings(**given) if settings is None else settings
        self.hunter = model.gaits
        self.gaits = tuple(model.gaits.names)
        model.gaits.need("duration")
        self.paths = CapturePaths(model, self.settings.depth, self.settings.max_transitions)
        self.leaves = np.arange(self.paths.layers[-2], self.paths.layers[-1])  # the sequences of full depth

    def reach(self, situation: Situation) -> float:
        """Return the distance between the centres that a planned capture must come within [m]."""
        return self.settings.margin * catch_distance(situation, self.settings.catch_distance)


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
