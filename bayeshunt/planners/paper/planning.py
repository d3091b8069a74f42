"""The paper's planning hunter: search over gait sequences with sampled hunter outcomes."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from functools import partial
from typing import Any, Literal

import numpy as np
import pandas as pd

from bayeshunt.core.geometry import FloatArray, Polar
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.api import Plan, Shown, Situation
from bayeshunt.planners.cost import Charges, Weighed
from bayeshunt.planners.requests import check_request, predict_prey
from bayeshunt.planners.search.rollouts import (
    CompiledRollouts,
    GaitTree,
    LazyRollouts,
    Objective,
    Outcomes,
    Spent,
    count_nodes,
    mean_distance,
)
from bayeshunt.planners.search.search import Search, SearchTree
from bayeshunt.planners.settings import Count, Number, planner_settings, setting

__all__ = ["PlanningPlanner", "PlanningSettings"]

# Above this many gait sequences, valuing all of them costs more than composing those expanded.
_COMPILED_NODES = 20_000
# Above this many poses (24 bytes each), a compiled bank takes too much memory.
_COMPILED_POSES = 4_000_000


@planner_settings("planning")
class PlanningSettings(Weighed):
    """Settings of the planning hunter; the defaults are those of the preset "paper"."""

    depth: Count = setting(10, "longest gait sequence, time-steps", ge=1)
    expansions: Count | None = setting(60, "most nodes expanded in a decision; None: no limit", ge=1)
    samples: Count = setting(8, "hunter outcomes sampled per node", ge=1)
    stop_distance: Number = setting(
        0.5, "the search stops at a node of this value or less, body lengths", unit="body lengths", ge=0
    )
    max_transitions: Count = setting(1, "most changes of gait in a sequence; the first gait is none", ge=0)
    order: Literal["best-first", "breadth-first"] = setting("best-first", '"best-first" or "breadth-first"')
    blocks: Count = setting(8, "independent sets of samples; each decision picks one with its rng", ge=1)
    bank_seed: Count = setting(0, "seeds the private generator of the uniforms behind all samples", ge=0)
    rollouts: Literal["auto", "compiled", "lazy"] = setting(
        "auto", '"compiled" composes every sequence beforehand, "lazy" on expansion, "auto" chooses by size'
    )
    objective: Objective = setting(
        mean_distance, "values of sequences from hunter samples and the predicted prey path [m]"
    )


class PlanningPlanner(Shown):
    """The gait sequence that ends nearest the predicted prey (paper, planning; best-first search).

    A node is a sequence of T gaits with at most ``max_transitions`` changes. Its value is the mean
    over sampled hunter outcomes of the distance to the prey predicted T steps ahead. The plan is the
    sequence of least value among all nodes generated; a tie goes to the one generated first, and
    children are generated in gait order. While the prey model is empty the prey is taken to stand
    still, and ``prey_known`` is False. ``rng`` picks the block of samples. In a model of structure
    "previous_gait" each outcome is drawn given the gait before: within the sequence and, for its first
    gait, the one just executed (at the start of a hunt it is not known, and summed over).

    Where changes of gait, energy or way cost something, the value has what a sequence costs beyond as long a run of the
    fastest gait, in metres: as many as the fastest gait gains on the prey for the same cost. Where planning costs
    something, the search stops once an expansion costs more than all that is left to gain.
    """

    name = "planning"
    Settings = PlanningSettings

    def __init__(self, model: ForwardModel, settings: PlanningSettings | None = None, **given: Any) -> None:
        self.settings = settings = PlanningSettings(**given) if settings is None else settings
        self.hunter = model.gaits
        self.gaits = tuple(model.gaits.names)
        weighs = settings.cost.of_gaits or settings.cost.planning
        #: What gaits cost beside their distance to the prey; None: nothing.
        self.charges = Charges(model, settings.cost) if weighs else None
        outcomes = Outcomes.draw(model, settings.depth, settings.samples, settings.blocks, settings.bank_seed)
        after = {self.gaits[gait]: outcomes.starting_after(gait) for gait in range(len(outcomes.after))}
        make = self._maker(1 + len(after))
        self.rollouts = make(outcomes)
        #: Those of sequences that follow a gait, where that changes them.
        self.rollouts_after = {gait: make(part) for gait, part in after.items()}

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Search, and return the best sequence found."""
        situation = check_request(situation, rng, self.hunter)
        chosen = self.settings
        prey, known = predict_prey(situation, chosen.depth)
        rollouts = self.rollouts_after.get(situation.previous_gait or "", self.rollouts)
        body = situation.need("body_length")
        spent, price = self._charged(situation, prey)
        space = rollouts.space(int(rng.integers(chosen.blocks)), prey, chosen.objective, spent)
        stop = max(chosen.stop_distance * body, price)
        tree = Search(chosen.order, chosen.depth, chosen.expansions, stop).run(space)
        gaits = tuple(self.gaits[space.gait(tree.handles[n])] for n in tree.branch(tree.best)[1:])
        return Plan(
            gait=gaits[0],
            gaits=gaits,
            value=tree.values[tree.best],
            objective=self._objective,
            nodes=len(tree.handles),
            make_trace=partial(_trace, self.gaits, space.describe, tree, prey, body),
            expansions=len(tree.expanded),
            target=Polar(*(float(values[len(gaits)]) for values in prey)),
            prey_known=known,
            predicted_prey=prey,
        )

    @property
    def _objective(self) -> str:
        """What the values of plans are."""
        chosen = self.settings.objective
        if chosen is not mean_distance:
            return getattr(chosen, "__name__", repr(chosen))
        weighed = "" if self.charges is None else f", weighed by {self.settings.cost}"
        return f"mean distance to the prey at the end of the sequence{weighed} [m]"

    def _charged(self, situation: Situation, prey: Polar[FloatArray]) -> tuple[Spent | None, float]:
        """Return what sequences after the gait just executed cost, None: nothing, and an expansion; in metres left."""
        if self.charges is None:
            return None, 0.0
        metres, cost = self.charges.metres_of(prey), self.charges.cost
        price = cost.planning * cost.seconds_per_node * len(self.gaits) * metres
        before = self.charges.number(situation.previous_gait)
        return (Spent(self.charges.beyond_fastest * metres, before) if cost.of_gaits else None), price

    def _maker(self, banks: int) -> Callable[[Outcomes], CompiledRollouts | LazyRollouts]:
        """Return what makes rollouts of outcomes: composed beforehand, if ``banks`` of them are not too many."""
        chosen = self.settings
        if not self._compiles(banks):
            return partial(LazyRollouts, max_transitions=chosen.max_transitions)
        return partial(CompiledRollouts, tree=GaitTree.grow(len(self.gaits), chosen.depth, chosen.max_transitions))

    def _compiles(self, banks: int) -> bool:
        chosen = self.settings
        if chosen.rollouts != "auto":
            return chosen.rollouts == "compiled"
        nodes = count_nodes(len(self.gaits), chosen.depth, chosen.max_transitions, limit=_COMPILED_NODES)
        return nodes <= _COMPILED_NODES and nodes * chosen.samples * chosen.blocks * banks <= _COMPILED_POSES


def _trace(
    gaits: tuple[str, ...],
    describe: Callable[[list[Any]], dict[str, np.ndarray]],
    tree: SearchTree,
    prey: Polar[FloatArray],
    body_length: float,
) -> pd.DataFrame:
    """One row per node generated, in order: the paper's node fields and how the search used them.

    T; gaits (Gait[1..T]); gait_cost (gaits executed, = T); transition_cost; hunter_* (Hunter[T], mean
    of the samples); prey_* (predicted prey at T); value_m, value_bodies; expansion (order, -1: not expanded).
    """
    nodes = np.arange(len(tree.handles))
    steps = np.array(tree.depths)
    described = describe(tree.handles)
    last = [gaits[g] if g >= 0 else "" for g in described["gait"].tolist()]
    expansion = np.full(len(nodes), -1)
    expansion[tree.expanded] = np.arange(len(tree.expanded))
    values = np.array(tree.values)
    return pd.DataFrame(
        {
            "node": nodes,
            "parent": tree.parents,
            "T": steps,
            "gaits": _sequences(last, tree.parents),
            "gait": last,
            "gait_cost": steps,
            **{name: column for name, column in described.items() if name != "gait"},
            "prey_distance": prey.distance[steps],
            "prey_angle": prey.angle[steps],
            "prey_heading": prey.heading[steps],
            "value_m": values,
            "value_bodies": values / body_length,
            "expanded": expansion >= 0,
            "expansion": expansion,
            "chosen": np.isin(nodes, tree.branch(tree.best)),
        }
    )


def _sequences(last: list[str], parents: list[int]) -> list[str]:
    """Return each node's gait sequence, run by run: "left x3, straight x2"; the root's is ""."""
    whole: list[tuple[str, ...]] = [()]
    for gait, parent in zip(last[1:], parents[1:], strict=True):
        whole.append((*whole[parent], gait))
    return [", ".join(f"{gait} x{len(list(run))}" for gait, run in itertools.groupby(sequence)) for sequence in whole]
