"""Hunters with a model in which the gait before matters: it is the one executed, and then those of the plan."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from planner_cases import BODY, STEP, WHEELS, arcs, seen_prey, situations

import bayeshunt as bh
from bayeshunt.core.geometry import Polar
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel
from bayeshunt.planners.interception import sampling
from bayeshunt.planners.search.rollouts import CompiledRollouts, GaitTree, LazyRollouts, Outcomes

NAMES = ("straight", "spin right", "spin left")


@pytest.fixture(scope="module")
def model() -> ForwardModel:
    """Three gaits; what a gait does is turned by what the one before was doing."""
    rng = np.random.default_rng(2)
    gait = rng.integers(3, size=900)
    before = np.r_[0, gait[:-1]]
    wheels = np.array([WHEELS[name] for name in NAMES])
    wheels = (wheels[gait] + 0.25 * wheels[before]) * rng.uniform(0.9, 1.1, (900, 2))
    pose = arcs(wheels[:, 0], wheels[:, 1])
    names = np.array(NAMES, dtype=object)
    previous = names[before]
    previous[0] = None
    table = pd.DataFrame({"gait": names[gait], **pose._asdict(), "previous_gait": previous})
    repertoire = bh.GaitRepertoire(tuple(bh.Gait(n, WHEELS[n]) for n in NAMES), BODY, STEP)
    return ForwardModel.fit(table, repertoire, structure="previous_gait")


def moment(before: str | None) -> bh.Situation:
    """One situation, whatever was executed before it."""
    return bh.Situation(Polar(0.2, 0.4, 0.1), seen_prey(), body_length=BODY, time_step=STEP, previous_gait=before)


def sequence_of(tree: GaitTree, node: int) -> tuple[int, ...]:
    return () if node == 0 else (*sequence_of(tree, int(tree.parents[node])), int(tree.gaits[node]))


@pytest.mark.parametrize("start", [None, 0, 2])
def test_every_gait_of_a_sequence_follows_the_one_before(model: ForwardModel, start: int | None) -> None:
    outcomes = Outcomes.draw(model, 3, samples=4, blocks=2, seed=1)
    uniforms = np.random.default_rng(1).random((2, 3, 4, 6))
    tree = GaitTree.grow(3, 3, 2)
    begun = outcomes if start is None else outcomes.starting_after(start)
    poses = CompiledRollouts(begun, tree).poses
    for node, block, sample in itertools.product(range(len(tree.steps)), range(2), range(4)):
        at, before = Polar(0.0, 0.0, 0.0), None if start is None else NAMES[start]
        for step, gait in enumerate(sequence_of(tree, node)):
            drawn = model.after(before).outcomes(uniforms[block, step, sample])  # Polar of [G]
            at = at.compose(Polar(*(float(part[gait]) for part in drawn)))
            before = NAMES[gait]
        np.testing.assert_allclose(poses[:2, block, sample, node], [at.forward, at.right], atol=1e-12)


@pytest.mark.parametrize("transitions", [0, 1, 2])
def test_lazy_and_compiled_rollouts_plan_alike(model: ForwardModel, transitions: int) -> None:
    settings = {"depth": 4, "samples": 5, "blocks": 2, "max_transitions": transitions}
    one = bh.make_planner("planning", model, rollouts="compiled", **settings)
    other = bh.make_planner("planning", model, rollouts="lazy", **settings)
    assert isinstance(one.rollouts_after["straight"], CompiledRollouts)
    assert isinstance(other.rollouts_after["straight"], LazyRollouts)
    for number, situation in enumerate(situations(20)):
        known = replace(situation, previous_gait=(*NAMES, None)[number % 4])
        plans = [p.plan(known, rng=np.random.default_rng(number)) for p in (one, other)]
        assert plans[0].gaits == plans[1].gaits
        assert plans[0].value == plans[1].value
        np.testing.assert_allclose(plans[0].trace["hunter_forward"], plans[1].trace["hunter_forward"], atol=1e-12)


def test_plans_depend_on_the_gait_just_executed(model: ForwardModel) -> None:
    planner = bh.make_planner("planning", model, depth=3)
    values = set()
    for before in (*NAMES, None):
        plan = planner.plan(moment(before), rng=np.random.default_rng(0))
        assert plan.trace["value_m"][1:].min() == plan.value
        values.add(plan.value)
    assert len(values) == 4


@pytest.mark.parametrize("name", ["reactive", "prediction"])
def test_the_inverse_is_given_the_gait_just_executed(model: ForwardModel, name: str) -> None:
    planner, inverse = bh.make_planner(name, model), InverseModel(model)
    differs = False
    for situation in situations(40):
        for before in (*NAMES, None):
            plan = planner.plan(replace(situation, previous_gait=before), rng=np.random.default_rng(0))
            answer = inverse.after(before).posterior(plan.target.distance, plan.target.angle)
            assert plan.posterior.tolist() == answer.values.tolist()
            assert (plan.gait, plan.support) == (answer.best, answer.support)
            unknown = inverse.posterior(plan.target.distance, plan.target.angle)
            differs |= answer.values.tolist() != unknown.values.tolist()
    assert differs


@pytest.mark.parametrize("before", [None, *NAMES])
def test_pairs_of_mean_paths_follow_the_gait_before(model: ForwardModel, before: str | None) -> None:
    planner = bh.make_planner("intercept", model)
    pairs = planner.pairs_from(moment(before))
    for (i, one), (j, two) in itertools.product(enumerate(NAMES), repeat=2):
        first = model.after(before).predict(one)
        end = first.compose(model.after(one).predict(two))
        np.testing.assert_allclose(pairs.first_end[:2, i, 0], [first.forward, first.right], atol=1e-12)
        np.testing.assert_allclose(pairs.end[:2, i, j, 0], [end.forward, end.right], atol=1e-12)
        gap = pairs.end[2, i, j, 0] - float(end.heading)
        assert abs(np.remainder(gap + np.pi, 2 * np.pi) - np.pi) < 1e-12
        np.testing.assert_allclose(pairs.second[:2, i, j, -1, 0], pairs.end[:2, i, j, 0], atol=1e-12)
    plan = planner.plan(moment(before), rng=np.random.default_rng(0))
    assert plan.trace["hunter_forward"][1:4].tolist() == pairs.first_end[0, :, 0].tolist()


def test_other_structures_keep_one_bank_of_rollouts(small_model: ForwardModel) -> None:
    planner = bh.make_planner("planning", small_model, depth=3)
    assert planner.rollouts_after == {}
    assert bh.make_planner("intercept", small_model).pairs_after == {}
    one, other = (planner.plan(moment(before), rng=np.random.default_rng(0)) for before in (None, "straight"))
    assert one.trace.equals(other.trace)


@pytest.mark.parametrize("name", ["reactive", "prediction", "planning", "intercept", "belief", "frugal"])
def test_every_kind_of_planner_hunts_with_it(name: str, tmp_path) -> None:
    frame = bh.babble("khepera", steps=400, seed=0)
    path = tmp_path / "model.json"
    bh.ForwardModel.fit(frame, bh.load_robot("khepera").gaits, 0.03, structure="previous_gait").save(path)
    loaded = bh.ForwardModel.load(path)
    one, again = (bh.hunt("paper", bh.make_planner(name, loaded), theta=3.0, seed=1) for _ in range(2))
    assert one.frame["gait"].tolist() == again.frame["gait"].tolist()
    assert one.time == again.time


@pytest.mark.parametrize("before", [None, "spin left"])
def test_sampled_pairs_follow_the_gait_before(model: ForwardModel, before: str | None) -> None:
    """Both ends of a sampled pair are outcomes after the gait before each."""
    planner = bh.make_planner("belief", model, samples=4, blocks=2, bank_seed=5)
    uniforms = sampling._uniforms(np.arange(4) % 2, 4, 2, 5)
    pairs = planner.samples[1].after(before)
    for sample, one, two in itertools.product(range(4), range(3), range(3)):
        first = Polar(*(float(part[one]) for part in model.after(before).outcomes(uniforms[1, 0, sample])))
        then = Polar(*(float(part[two]) for part in model.after(NAMES[one]).outcomes(uniforms[1, 1, sample])))
        assert pairs.first[:2, one, -1, sample] == pytest.approx([first.forward, first.right])
        end = first.compose(then)
        assert pairs.second[:2, one, two, -1, sample] == pytest.approx([end.forward, end.right])


def test_hunters_that_aim_at_a_point_ask_what_leads_there_now(model: ForwardModel) -> None:
    planner = bh.make_planner("pure_pursuit", model)
    for before in (None, *NAMES):
        trace = planner.plan(moment(before), rng=np.random.default_rng(0)).trace
        ends = [model.after(before).predict(gait) for gait in NAMES]
        assert trace["end_forward"].tolist() == pytest.approx([end.forward for end in ends])
        assert trace["end_right"].tolist() == pytest.approx([end.right for end in ends])
