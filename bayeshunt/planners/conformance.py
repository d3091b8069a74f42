"""The conformance check every planner must pass; run it over your own planner too."""

from __future__ import annotations

import copy
from collections.abc import Iterable
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.arguments import checked
from bayeshunt.core.checks import check_kind, check_whole
from bayeshunt.core.errors import BayesHuntError
from bayeshunt.planners.api import Plan, Planner, Situation
from bayeshunt.planners.asking import check_can_plan

__all__ = ["check_planner", "same_plan"]


@checked
def check_planner(planner: Planner, gaits: Iterable[str], situations: Iterable[Situation], seed: int) -> None:
    """Raise BayesHuntError, naming the planner and the fault, unless it keeps the rules.

    gaits: the repertoire's names. situations: the cases to try, for example those of a hunt with any planner,
        ``bayeshunt.hunt(...).situations``. seed: of the generators it is given.
    The rules: ``rng`` is a required keyword; the plan holds gaits of the repertoire, the first of
    them to execute; one row of trace per node considered; the situation, its prey model and numpy's
    global generator are left as they were; the same situation and seed give the same plan, whatever
    was planned before.
    """
    check_can_plan(planner)
    check_whole(seed, "seed", 0)
    known, cases = set(gaits), list(situations)
    for situation in cases:
        check_kind(situation, "situations", Situation, "a list of Situations")
    if not cases:
        raise BayesHuntError("check_planner needs at least one situation")
    _check_rng_required(planner, cases[0])
    plans = []
    for number, situation in enumerate(cases):
        before, chance = copy.deepcopy(situation), _global_generator()
        plans.append(planner.plan(situation, rng=np.random.default_rng([seed, number])))
        _demand(planner, situation == before, "changed the situation or its prey model")
        _demand(planner, _global_generator() == chance, "used numpy's global generator")
        _check_plan(planner, plans[-1], known)
    for number, situation in reversed(list(enumerate(cases))):
        again = planner.plan(situation, rng=np.random.default_rng([seed, number]))
        _demand(planner, same_plan(plans[number], again), f"is not reproducible (situation {number})")


def same_plan(one: Plan, other: Plan) -> bool:
    """Return whether two plans are equal to the last bit, traces included."""
    fields = (
        "gait",
        "gaits",
        "value",
        "nodes",
        "expansions",
        "evidence_probability",
        "support",
        "prey_known",
    )
    if any(getattr(one, name) != getattr(other, name) for name in fields):
        return False
    arrays = ("target", "posterior", "predicted_prey")
    if not all(_same_arrays(getattr(one, name), getattr(other, name)) for name in arrays):
        return False
    return one.trace.equals(other.trace)


def _global_generator() -> tuple[Any, ...]:
    """The state of numpy's global generator, comparable."""
    _, keys, *rest = np.random.get_state(legacy=True)
    return tuple(np.asarray(keys).tolist()), *rest


def _check_rng_required(planner: Planner, situation: Situation) -> None:
    try:
        planner.plan(situation)  # type: ignore[call-arg]
    except TypeError:
        return
    _demand(planner, False, "plans without rng: it must be a required keyword")


def _check_plan(planner: Planner, plan: Plan, known: set[str]) -> None:
    _demand(planner, bool(plan.gaits) and plan.gait == plan.gaits[0], "does not start its sequence with its gait")
    _demand(planner, set(plan.gaits) <= known, f"plans gaits outside the repertoire: {plan.gaits}")
    _demand(planner, bool(np.isfinite(plan.value)), f"gives the value {plan.value}")
    _demand(planner, bool(plan.objective), "does not say what its value is")
    _demand(planner, isinstance(plan.trace, pd.DataFrame), "has no trace")
    rows = len(plan.trace)
    _demand(planner, rows == plan.nodes, f"considered {plan.nodes} nodes but its trace has {rows} rows")


def _demand(planner: Planner, kept: bool, fault: str) -> None:
    if not kept:
        raise BayesHuntError(f"planner {planner.name!r} {fault}")


def _same_arrays(one: Any, other: Any) -> bool:
    if one is None or other is None:
        return one is other
    return np.array_equal(np.asarray(one, dtype=float), np.asarray(other, dtype=float), equal_nan=True)
