"""Hunters that remember earlier prey, and believe their memory as far as it predicts this one."""

from __future__ import annotations

import dataclasses
import math
import os
from collections.abc import Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from bayeshunt.core.geometry import Polar, Pose
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.target.memory import PreyMemory, TransitionTables
from bayeshunt.planners.api import Plan, Situation
from bayeshunt.planners.cost import Charges, Weighed
from bayeshunt.planners.guidance.steering import prey_track
from bayeshunt.planners.info import PlannerInfo
from bayeshunt.planners.requests import check_request
from bayeshunt.planners.sequences.capture import PreyPaths
from bayeshunt.planners.sequences.hunter import SearchSettings, SequenceHunter, capture_plan
from bayeshunt.planners.settings import Count, File, Number, planner_settings, setting

__all__ = ["Memory", "MemorySettings", "OrderMemory", "PlaceMemory"]


class _Walk(NamedTuple):
    """A prey under way: its pose in the hunter's frame (ahead, right, heading clockwise) and its last transition."""

    ahead: float
    right: float
    heading: float
    previous: Polar | None


class _Expert(NamedTuple):
    """A source of predictions: a table, and the one that it falls back on (itself for an unconditional one)."""

    label: str
    kept: TransitionTables
    general: TransitionTables


@planner_settings("memory")
class MemorySettings(SearchSettings, Weighed):
    """Settings of the hunters that remember: how far they believe their memory, and how they search."""

    tables: File[PreyMemory | str | os.PathLike[str] | None] = setting(
        None, "a PreyMemory or the path of one (bayeshunt remember --out FILE)"
    )
    believe: Number = setting(0.5, "prior weight of memory; its arenas share it equally", ge=0, le=1)
    smoothing: Number = setting(2.0, "how many observed transitions the table fallen back on is worth", gt=0)
    paths: Count = setting(24, "prey paths sampled", ge=1)
    depth: Count = setting(3, "gaits of the longest sequence", ge=1)
    max_transitions: Count = setting(2, "most changes of gait in a sequence", ge=0)


class Memory(SequenceHunter):
    """Earliest expected capture against a prey predicted by several experts: this run and earlier ones.

    One expert is the table of the transitions seen in this run (before any, a prey that moves as the
    hunter's fastest straight gait does). The others are tables of earlier runs, one per arena that they
    were made in, conditioned on nothing, on the prey's place or on its previous transition. They are
    mixed by how well each has predicted this run so far, a Bayesian average with no switch:

        w_e  proportional to  prior_e * prod_k p_e(transition_k | transitions before it, context_k)

    with smoothed predictive probabilities (:meth:`TransitionTables.probability`; a conditional table falls
    back on the unconditional one, this run's on the average of those, so that neither starts behind). Prey
    paths are sampled from the mixture; a gait sequence's value is the mean over them of the time of
    first capture, or of its end time + time to go. The trace holds the weight of every expert.

    ``rng`` samples the paths.
    """

    name = "memory"
    kind = "all"
    info = PlannerInfo(ab_initio=False, needs=("tables",), maker="bayeshunt remember")

    Settings = MemorySettings
    settings: MemorySettings

    def __init__(self, model: ForwardModel, settings: MemorySettings | None = None, **given: Any) -> None:
        super().__init__(model, settings, **given)
        tables = self.settings.tables
        self.info.check_given(self.name, {"tables": tables})
        memory = tables if isinstance(tables, PreyMemory) else PreyMemory.load(tables)  # type: ignore[arg-type]
        kind = self.kind
        self.charges = Charges(model, self.settings.cost) if self.settings.cost.of_gaits else None
        self.experts = [_Expert(arena, kinds[kind], kinds["all"]) for arena, kinds in memory.tables.items()]

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Return the sequence of earliest expected capture."""
        situation = check_request(situation, rng, self.hunter)
        paths = self.paths
        some = self.experts[0].kept
        own = TransitionTables("all", some.axes, some.place_size)
        weights = self._weigh(situation, own)
        prey = self._sample(situation, own, weights, rng)
        reach = self.reach(situation)
        values = np.full(len(paths.tree.steps), np.inf)
        values[self.leaves] = self._value(prey, reach, situation).mean(axis=0)
        labels = ["this_run", *(expert.label for expert in self.experts)]
        weighed = "" if self.charges is None else f", weighed by {self.charges.cost}"
        what = f"expected time of capture{weighed} [s]"
        plan = capture_plan(paths, self.gaits, values, prey, situation, what, prey_known=True)
        return dataclasses.replace(plan, make_trace=partial(_with_weights, plan.make_trace, labels, weights))

    def _value(self, prey: PreyPaths, reach: float, situation: Situation) -> np.ndarray:
        """Return what every sequence of full depth is worth on every path: time of capture or cost, [K, leaves]."""
        paths, leaves = self.paths, self.leaves
        times = paths.first_captures(prey, reach)
        costs = np.zeros_like(times)
        for step in range(1, paths.depth + 1):
            new = slice(paths.layers[step], paths.layers[step + 1])
            parents = paths.tree.parents[new]
            if self.charges is not None:
                nodes = np.arange(new.start, new.stop)
                own = self.costs(paths, nodes, times[:, new], prey, reach, situation)
                costs[:, new] = np.where(np.isfinite(times[:, parents]), costs[:, parents], own)
            np.minimum(times[:, new], times[:, parents], out=times[:, new])
        if self.charges is not None:
            return np.asarray(costs[:, leaves])
        caught = times[:, leaves]
        onward = paths.depth * paths.duration + paths.times_to_go(leaves, prey, reach, paths.turn_price)
        return np.where(np.isfinite(caught), caught, onward)

    def _weigh(self, situation: Situation, own: TransitionTables) -> np.ndarray:
        """Return the weights of this run and of every memory [1 + E]; ``own`` counts this run on the way."""
        believe = self.settings.believe
        prior = np.array([1.0 - believe, *[believe / len(self.experts)] * len(self.experts)])
        with np.errstate(divide="ignore"):
            logs = np.log(prior)
        previous = None
        for place, transition in zip(_places(situation), situation.transitions, strict=True):
            logs[0] += math.log(own.probability((), transition, self._average(transition), self.settings.smoothing))
            for number, expert in enumerate(self.experts, start=1):
                logs[number] += math.log(self._probability(expert, place, previous, transition))
            own.observe((), transition)
            previous = transition
        weights = np.exp(logs - logs.max())
        found: np.ndarray = weights / weights.sum()
        return found

    def _average(self, transition: Polar) -> float:
        """Return what the unconditional memories say on average: where this run's table starts from."""
        said = [e.general.probability((), transition, e.general.uniform, self.settings.smoothing) for e in self.experts]
        return sum(said) / len(said)

    def _probability(self, expert: _Expert, place: Pose | None, previous: Polar | None, transition: Polar) -> float:
        """Return what a memory said of a transition before it was seen."""
        base = expert.general.probability((), transition, expert.general.uniform, self.settings.smoothing)
        context = expert.kept.context(place, previous)
        return expert.kept.probability(context, transition, base, self.settings.smoothing)

    def _sample(
        self, situation: Situation, own: TransitionTables, weights: np.ndarray, rng: np.random.Generator
    ) -> PreyPaths:
        """Sample prey paths, each from one expert, [K, T P + 1]."""
        paths, start = self.paths, situation.prey
        uniforms = rng.random((self.settings.paths, 1 + 2 * paths.depth))
        # stratified: the share of paths that an expert makes is its weight, to within one path
        strata = (np.arange(self.settings.paths) + uniforms[:, 0]) / self.settings.paths
        chosen = np.minimum(np.searchsorted(np.cumsum(weights), strata, side="right"), len(weights) - 1).tolist()
        ends = np.empty((2, self.settings.paths, paths.depth + 1))
        last = situation.transitions[-1] if situation.transitions else None
        for k in range(self.settings.paths):
            walk = _Walk(float(start.forward), float(start.right), float(start.heading), last)
            ends[:, k, 0] = walk.ahead, walk.right
            for step in range(paths.depth):
                u, v = uniforms[k, 1 + 2 * step], uniforms[k, 2 + 2 * step]
                expert = self.experts[chosen[k] - 1] if chosen[k] else None
                move = self._remembered(expert, situation, walk, u, v) if expert else self._seen(own, u)
                walk = _advance(walk, move)
                ends[:, k, step + 1] = walk.ahead, walk.right
        share = np.arange(paths.depth * paths.points + 1) / paths.points
        steps = np.arange(paths.depth + 1)
        rows = [np.stack([np.interp(share, steps, path) for path in part]) for part in ends]
        return PreyPaths(*rows)

    def _remembered(
        self, expert: _Expert, situation: Situation, walk: _Walk, u: float, v: float
    ) -> tuple[float, float, float]:
        """Draw a transition from memory, falling back on the general table as its probability does."""
        place = None
        if situation.pose is not None:
            seen = Polar.from_cartesian(walk.ahead, walk.right, walk.heading)
            place = situation.pose.compose(seen)
        context = expert.kept.context(place, walk.previous)
        total = expert.kept.total(context)
        if context is not None and v * (total + self.settings.smoothing) < total:
            return _draw(expert.kept, context, u)
        return self._seen(expert.general, u)

    def _seen(self, own: TransitionTables, u: float) -> tuple[float, float, float]:
        """Draw a transition from an unconditional table; from an empty one, the hunter's own straight gait."""
        return _draw(own, (), u) if own.total(()) else self._as_i_do()

    def _as_i_do(self) -> tuple[float, float, float]:
        return self.paths.speed * self.paths.duration, 0.0, 0.0


class PlaceMemory(Memory):
    """:class:`Memory` with tables conditioned on the prey's place: arena cell and direction."""

    name = "memory_place"
    kind = "place"


class OrderMemory(Memory):
    """:class:`Memory` with tables conditioned on the prey's previous transition (order 1)."""

    name = "memory_previous"
    kind = "previous"


def _advance(walk: _Walk, move: tuple[float, float, float]) -> _Walk:
    """Take one transition (ahead, right, turn) in the prey's own frame."""
    ahead, right, turn = move
    cos, sin = math.cos(walk.heading), math.sin(walk.heading)
    done = Polar.from_cartesian(ahead, right, turn)
    return _Walk(
        walk.ahead + cos * ahead - sin * right, walk.right + sin * ahead + cos * right, walk.heading + turn, done
    )


def _draw(tables: TransitionTables, context: tuple[int, ...], u: float) -> tuple[float, float, float]:
    """Draw a transition of a context by inverse CDF over its cells in table order."""
    table = sorted(tables.counts[context].items())
    reach = u * sum(count for _, count in table)
    for cell, count in table:
        reach -= count
        if reach < 0:
            return tables.centre(cell)
    return tables.centre(table[-1][0])


def _places(situation: Situation) -> Sequence[Pose | None]:
    """Return the prey's pose before each transition, in the hunter's first frame; Nones if that is not known."""
    if situation.pose is None:
        return [None] * len(situation.transitions)
    track = prey_track(situation)
    seen: list[tuple[float, float, float]] = list(zip(*(part.tolist() for part in track), strict=True))
    return [situation.pose.compose(Polar(*pose)) for pose in seen[:-1]]


def _with_weights(make_trace: Any, labels: list[str], weights: np.ndarray) -> Any:
    """Return a trace with the weight of every expert in every row."""
    return make_trace().assign(**{f"weight_{label}": weight for label, weight in zip(labels, weights, strict=True)})
