"""The planner that weighs its costs."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from planner_cases import situations

from bayeshunt.core.errors import InputError
from bayeshunt.planners.guidance.steering import Steering
from bayeshunt.planners.sequences.frugal import CostWeights, Frugal


def plan(planner: Frugal, case):
    return planner.plan(case, rng=np.random.default_rng(0))


def changes(plan, case) -> int:
    whole = [case.previous_gait, *plan.gaits]
    return sum(a != b for a, b in pairwise(whole))


def test_the_value_is_the_cost_of_the_plan(model):
    """Weights are linear: the cost under all of them is the sum of the parts of the same plan."""
    case = replace(situations(1)[0], previous_gait="straight")
    parts = {"time": 2.0, "distance": 7.0, "transitions": 3.0}
    chosen = plan(Frugal(model, **parts), case)
    time_only, no_time = Frugal(model, time=1.0), Frugal(model, time=1e-9, distance=1.0)
    row = chosen.trace.index[chosen.trace["chosen"]][-1]
    node = chosen.trace["node"][row]
    time = plan(time_only, case).trace.set_index("node")["value"][node]
    distance = plan(no_time, case).trace.set_index("node")["value"][node]
    assert chosen.value == pytest.approx(2.0 * time + 7.0 * distance + 3.0 * changes(chosen, case), rel=1e-6)


def test_dear_transitions_are_avoided(model):
    cases = [replace(case, previous_gait="slow") for case in situations(12)]
    cheap, dear = Frugal(model), Frugal(model, transitions=1e6)
    assert sum(changes(plan(cheap, case), case) for case in cases) > 6
    assert all(changes(plan(dear, case), case) == 0 for case in cases)


def test_dear_planning_looks_less_far(model):
    for case in situations(6):
        far, near = plan(Frugal(model), case), plan(Frugal(model, planning=1e12), case)
        assert near.nodes == len(model.gaits) < far.nodes
        assert len(near.gaits) == 1


def test_a_prey_dead_ahead_is_met_at_full_speed(model):
    case = replace(
        situations(1, known=False)[0], prey=situations(1)[0].prey._replace(distance=0.3, angle=0.0, heading=0.0)
    )
    assert plan(Frugal(model), case).gait == "straight"
    assert not plan(Frugal(model), case).prey_known
    assert Steering(model).top_speed == pytest.approx(Frugal(model).paths.speed, rel=0.05)


@pytest.mark.parametrize(
    ("setting", "value"), [("time", -1.0), ("transitions", float("nan")), ("distance", "far"), ("seconds_per_node", -1)]
)
def test_wrong_weights(setting, value, model):
    with pytest.raises(InputError, match=setting):
        Frugal(model, **{setting: value})


def test_something_must_cost():
    with pytest.raises(InputError, match="standing still"):
        CostWeights(time=0.0, transitions=1.0)
    assert CostWeights(1.0, 2.0, 3.0, 4.0).total(1.0, 10.0, 100.0, 1000.0) == 1 + 20 + 300 + 4000
