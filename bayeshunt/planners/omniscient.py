"""A hunter that knows the prey's future: how good these gaits and this time-step can be."""

from __future__ import annotations

import itertools
import math
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.errors import InputError
from bayeshunt.geometry import Polar
from bayeshunt.models.forward import ForwardModel
from bayeshunt.planners.base import Plan, Situation, check_request
from bayeshunt.planners.capture import CapturePaths, PreyPaths


class Omniscient:
    """A bound that hunts: the sequence of earliest capture, the prey's true noise-free future known.

    Every sequence of at most ``depth`` gaits with at most ``max_transitions`` changes is followed
    along its mean path, against the future that the evaluation hands in (``Situation.future``); the
    one that captures first is executed for one step, and then the hunter plans again. Where nothing
    captures within the horizon, the sequence of least end time + time to go is (see
    :meth:`~bayeshunt.planners.capture.CapturePaths.times_to_go`).

    margin: share of the catch distance that a planned capture must come within, so that a little
    noise does not spoil it. catch_distance: body lengths. ``rng`` is not used.

    It stops being exact where noise decides: it follows mean paths. A prey that senses the hunter
    reacts to it, which the future handed in leaves out.
    """

    name = "omniscient"
    needs_future = True
    ab_initio = False
    standalone = False

    def __init__(
        self,
        model: ForwardModel,
        *,
        depth: int = 4,
        max_transitions: int = 3,
        margin: float = 0.9,
        catch_distance: float = 1.02,
    ) -> None:
        check_search("omniscient", depth, max_transitions, margin, catch_distance)
        self.gaits = tuple(model.gaits.names)
        self.paths = CapturePaths(model, depth, max_transitions)
        self.margin, self.catch_distance = float(margin), float(catch_distance)
        self.leaves = np.arange(self.paths.layers[-2], self.paths.layers[-1])

    @property
    def foresight(self) -> float:
        """Seconds of the prey's future that a decision needs."""
        return self.paths.depth * self.paths.duration

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Return the sequence of earliest capture."""
        check_request(situation, rng)
        if situation.future is None:
            raise InputError("omniscient needs the prey's future, which only an evaluation hands in")
        paths = self.paths
        ahead, right = situation.future.at(paths.interval * np.arange(paths.depth * paths.points + 1))
        prey = PreyPaths(ahead[None], right[None])
        reach = self.margin * self.catch_distance * situation.body_length
        times = paths.first_captures(prey, reach, stop_at_first=True)[0]
        captured = bool(np.isfinite(times).any())
        if not captured:
            ends = paths.depth * paths.duration
            times[self.leaves] = ends + paths.times_to_go(self.leaves, prey, reach, paths.turn_price)[0]
        return capture_plan(paths, self.gaits, times, prey, situation, "time of capture [s]", prey_known=True)


def check_search(name: str, depth: Any, max_transitions: Any, margin: Any, catch_distance: Any) -> None:
    """Raise InputError unless the settings of a search over mean paths are in range."""
    for key, value, least in (("depth", depth, 1), ("max_transitions", max_transitions, 0)):
        if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or value < least:
            raise InputError(f"{name}: {key} must be a whole number >= {least}, got {value!r}")
    for key, value, most in (("margin", margin, 1.0), ("catch_distance", catch_distance, math.inf)):
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 < value <= most:
            raise InputError(f"{name}: {key} must be a number above 0, got {value!r}")


def capture_plan(
    paths: CapturePaths, gaits: tuple[str, ...], values: np.ndarray, prey: PreyPaths, situation: Situation,
    objective: str, *, prey_known: bool,
) -> Plan:  # fmt: skip
    """Return the plan of the node of least value [N]; a tie goes to the shallower, then to table order."""
    best = int(np.argmin(values))
    branch = path_to(paths, best)
    names = tuple(gaits[g] for g in paths.tree.gaits[branch[1:]])
    mean = PreyPaths(prey.forward.mean(axis=0, keepdims=True), prey.right.mean(axis=0, keepdims=True))
    steps = paths.points * np.arange(len(branch))
    predicted = Polar.from_cartesian(mean.forward[0, steps], mean.right[0, steps], np.zeros(len(branch)))
    return Plan(
        gait=names[0],
        gaits=names,
        value=float(values[best]),
        objective=objective,
        nodes=int(np.isfinite(values).sum()),
        make_trace=partial(_trace, paths, gaits, values, branch, situation.body_length),
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


def _trace(
    paths: CapturePaths, gaits: tuple[str, ...], values: np.ndarray, branch: list[int], body_length: float
) -> pd.DataFrame:
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
