"""The planning hunter: its search, its trace and its settings."""

from __future__ import annotations

import itertools

import joblib
import numpy as np
import pytest
from planner_cases import BODY, seen_prey, situations

from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import Polar
from bayeshunt.planners.api import Situation
from bayeshunt.planners.paper.planning import PlanningPlanner, PlanningSettings
from bayeshunt.planners.registry import make_planner
from bayeshunt.planners.search.rollouts import CompiledRollouts, LazyRollouts

EVERYTHING = {"expansions": None, "stop_distance": 0.0, "blocks": 1}


def plan(planner, situation, seed=0):
    return planner.plan(situation, rng=np.random.default_rng(seed))


def hand_value(planner: PlanningPlanner, gaits: tuple[int, ...], prey: Polar) -> float:
    """Value of one sequence, composed pose by pose from the forward model's outcomes."""
    settings, outcomes = planner.settings, planner.rollouts_outcomes
    distances = []
    for sample in range(settings.samples):
        at = Polar(0.0, 0.0, 0.0)
        for step, gait in enumerate(gaits):
            place = (0, step, sample, gait)
            at = at.compose(Polar(*(float(a[place]) for a in outcomes)))
        end = len(gaits)
        distances.append(np.hypot(at.forward - prey.forward[end], at.right - prey.right[end]))
    return float(np.mean(distances))


@pytest.fixture
def planner(small_model):
    """Three gaits, depth 3, one block: small enough to check by hand."""
    made = make_planner("planning", small_model, depth=3, samples=4, **EVERYTHING)
    uniforms = np.random.default_rng(0).random((1, 3, 4, 6))
    drawn = small_model.outcomes(uniforms)
    made.rollouts_outcomes = [np.moveaxis(np.asarray(a), 0, -1) for a in drawn]
    return made


def test_defaults_are_the_papers_preset():
    s = PlanningSettings()
    assert (s.depth, s.expansions, s.samples, s.stop_distance, s.max_transitions, s.order) == (
        10, 60, 8, 0.5, 1, "best-first",
    )  # fmt: skip


def test_unlimited_best_first_equals_exhaustive_enumeration(planner):
    for situation in situations(8):
        found = plan(planner, situation)
        allowed = [
            s
            for length in (1, 2, 3)
            for s in itertools.product(range(3), repeat=length)
            if sum(a != b for a, b in itertools.pairwise(s)) <= 1
        ]
        values = [hand_value(planner, s, found.predicted_prey) for s in allowed]
        best = allowed[int(np.argmin(values))]
        assert found.gaits == tuple(planner.gaits[g] for g in best)
        assert found.value == pytest.approx(min(values), abs=1e-12)
        assert found.nodes == 1 + len(allowed)


def test_the_predicted_prey_is_the_iterated_mean_transition(planner):
    situation = situations(1)[0]
    found = plan(planner, situation)
    for step in range(4):
        expected = situation.prey.compose(situation.prey_model.predict(step))
        at = [float(a[step]) for a in found.predicted_prey]
        assert at[0] == pytest.approx(expected.distance, abs=1e-12)
        assert np.cos(np.subtract(at[1:], expected[1:])) == pytest.approx([1.0, 1.0], abs=1e-12)


def test_the_target_is_the_prey_at_the_end_of_the_sequence(model):
    lengths = set()
    for situation in situations(10):
        found = plan(make_planner("planning", model), situation)
        assert found.target == tuple(float(a[len(found.gaits)]) for a in found.predicted_prey)
        lengths.add(len(found.gaits))
    assert lengths - {10}


def test_a_prey_model_that_predicts_nonsense_is_refused(model):
    class Broken:
        is_empty = False

        def predict_path(self, steps):
            return Polar(np.full(steps + 1, np.nan), np.zeros(steps + 1), np.zeros(steps + 1))

    for name in ("prediction", "planning"):
        with pytest.raises(InputError, match="not finite"):
            plan(make_planner(name, model), Situation(Polar(0.3, 0.0, 0.0), Broken()))


def test_trace_rows_are_recomputed_by_hand(planner):
    found = plan(planner, situations(1)[0])
    trace = found.trace
    whole = {0: ()}
    for row in trace.iloc[1:].itertuples():
        gaits = whole[row.node] = (*whole[row.parent], planner.gaits.index(row.gait))
        assert row.value_m == pytest.approx(hand_value(planner, gaits, found.predicted_prey), abs=1e-12)
        assert row.value_bodies == pytest.approx(row.value_m / BODY)
        assert row.T == row.gait_cost == len(gaits)
        assert row.transition_cost == sum(a != b for a, b in itertools.pairwise(gaits))
        assert row.prey_distance == found.predicted_prey.distance[row.T]
    assert trace["gaits"][0] == ""
    assert trace.loc[0, "value_m"] == pytest.approx(situations(1)[0].prey.distance)


def test_trace_marks_the_chosen_branch_and_the_expansions(model):
    planner = make_planner("planning", model)
    found = plan(planner, situations(3)[2])
    trace = found.trace
    assert len(trace) == found.nodes
    assert tuple(trace.loc[trace["chosen"] & (trace["T"] > 0), "gait"]) == found.gaits
    assert trace.loc[trace["T"] > 0, "value_m"].min() == found.value
    expanded = trace.loc[trace["expanded"]].sort_values("expansion")
    assert expanded["expansion"].tolist() == list(range(found.expansions))
    assert set(trace["parent"][1:]) == set(expanded["node"])


def test_the_sequence_column_counts_runs(planner):
    trace = plan(planner, situations(1)[0]).trace
    assert {"straight x3", "straight x2, slow left x1", "spin right x1, straight x2"} <= set(trace["gaits"])


def test_best_first_expands_the_least_open_value(model):
    trace = plan(make_planner("planning", model, stop_distance=0), situations(1)[0]).trace
    born = trace["parent"].map(trace["expansion"])  # the expansion that generated each node
    for row in trace[trace["expanded"]].itertuples():
        is_open = (born < row.expansion) & (~trace["expanded"] | (trace["expansion"] >= row.expansion))
        rivals = trace[is_open & (trace["T"] < 10)]
        if row.expansion:
            assert row.value_m == rivals["value_m"].min()


def test_breadth_first_expands_in_depth_order(model):
    trace = plan(make_planner("planning", model, order="breadth-first", stop_distance=0), situations(1)[0]).trace
    order = trace[trace["expanded"]].sort_values("expansion")
    assert len(order) == 60
    assert order["T"].is_monotonic_increasing
    assert order["node"].is_monotonic_increasing


@pytest.mark.parametrize("limit", [0, 1, 2])
def test_the_transition_limit_holds_and_is_used(small_model, limit):
    planner = make_planner("planning", small_model, depth=4, max_transitions=limit, **EVERYTHING)
    costs = plan(planner, situations(1)[0]).trace["transition_cost"]
    assert costs.max() == limit


def test_the_search_stops_at_the_stop_distance(model):
    # The prey stands one straight step ahead.
    near = Situation(Polar(0.19, 0.0, 0.0), type(seen_prey())(), body_length=BODY)
    eager = plan(make_planner("planning", model, stop_distance=1.0), near)
    thorough = plan(make_planner("planning", model, stop_distance=0.0), near)
    assert eager.gaits == ("straight",)
    assert eager.value <= BODY
    assert eager.expansions == 1 < thorough.expansions == 60
    assert thorough.value <= eager.value
    # Half a body is 28.5 mm, not half a metre: nothing comes that near a prey 5 m away.
    far = Situation(Polar(5.0, 0.0, 0.0), near.prey_model, body_length=BODY)
    assert plan(make_planner("planning", model, stop_distance=20.0), far).expansions == 60


def test_the_budget_is_kept(model):
    assert plan(make_planner("planning", model, expansions=7, stop_distance=0), situations(1)[0]).expansions == 7


def test_an_empty_prey_model_means_a_prey_that_stands_still(model):
    situation = situations(1, known=False)[0]
    found = plan(make_planner("planning", model), situation)
    assert not found.prey_known
    assert (found.predicted_prey.distance == situation.prey.distance).all()
    assert plan(make_planner("planning", model), situations(1)[0]).prey_known


@pytest.mark.parametrize("transitions", [1, 2])
def test_lazy_and_compiled_rollouts_plan_alike(small_model, transitions):
    settings = {"depth": 5, "max_transitions": transitions}
    one = make_planner("planning", small_model, rollouts="compiled", **settings)
    other = make_planner("planning", small_model, rollouts="lazy", **settings)
    assert isinstance(one.rollouts, CompiledRollouts)
    assert isinstance(other.rollouts, LazyRollouts)
    for situation in situations(10):
        a, b = plan(one, situation), plan(other, situation)
        assert a.gaits == b.gaits
        assert a.value == pytest.approx(b.value, abs=1e-12)
        assert a.trace["gaits"].tolist() == b.trace["gaits"].tolist()


def test_large_trees_are_not_compiled(model):
    planner = make_planner("planning", model, depth=30, max_transitions=3)
    assert isinstance(planner.rollouts, LazyRollouts)
    assert plan(planner, situations(1)[0]).expansions <= 60


def test_rng_picks_the_block(model):
    planner = make_planner("planning", model)
    values = {plan(planner, situations(1)[0], seed).value for seed in range(30)}
    assert 1 < len(values) <= 8


def test_another_objective_is_minimised(small_model):
    def rightmost(hunter, prey):
        return -hunter.right.mean(axis=0)

    settings = {"depth": 3, "objective": rightmost, "expansions": None, "stop_distance": 0}
    # Values below 0 would stop the search at once, so shift them.
    found = plan(
        make_planner("planning", small_model, **{**settings, "objective": lambda h, p: 9 + rightmost(h, p)}),
        situations(1)[0],
    )
    assert found.trace["hunter_right"].max() == pytest.approx(9 - found.value)


def test_a_plan_that_is_sent_keeps_its_trace_and_stays_small(model, worker, tmp_path):
    found = plan(make_planner("planning", model), situations(1)[0])
    assert worker(found).trace.equals(found.trace)
    joblib.dump(found, tmp_path / "sent")
    assert (tmp_path / "sent").stat().st_size < 500_000


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"depth": 0}, "depth must be a whole number >= 1, got 0"),
        ({"depth": 2.5}, "depth must be a whole number"),
        ({"samples": True}, "samples must be a whole number"),
        ({"expansions": 0}, "expansions must be a whole number >= 1"),
        ({"max_transitions": -1}, "max_transitions must be a whole number >= 0"),
        ({"stop_distance": float("nan")}, "stop_distance must be body lengths >= 0"),
        ({"order": "depth-first"}, "order must be one of best-first, breadth-first"),
        ({"rollouts": "eager"}, "rollouts must be one of auto, compiled, lazy"),
        ({"objective": "distance"}, "objective must be a function"),
        ({"bank_seed": None}, "bank_seed must be a whole number"),
    ],
)
def test_wrong_settings_are_named(settings, message):
    with pytest.raises(InputError, match=message):
        PlanningSettings(**settings)
