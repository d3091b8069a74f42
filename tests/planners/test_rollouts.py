"""Compiled and lazy rollouts against composition by hand."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from planner_cases import situations

from bayeshunt.core.errors import BayesHuntError
from bayeshunt.core.geometry import Polar
from bayeshunt.planners.search.rollouts import (
    CompiledRollouts,
    GaitTree,
    HunterSamples,
    LazyRollouts,
    Outcomes,
    count_nodes,
    mean_distance,
)


def sequences(gaits: int, depth: int, max_transitions: int) -> list[tuple[int, ...]]:
    """Every gait sequence, by brute force over all products."""
    return [
        s
        for length in range(depth + 1)
        for s in itertools.product(range(gaits), repeat=length)
        if sum(a != b for a, b in itertools.pairwise(s)) <= max_transitions
    ]


def sequence_of(tree: GaitTree, node: int) -> tuple[int, ...]:
    gaits = []
    while node > 0:
        gaits.append(int(tree.gaits[node]))
        node = int(tree.parents[node])
    return tuple(reversed(gaits))


@pytest.mark.parametrize("max_transitions", [0, 1, 2, 5])
@pytest.mark.parametrize("gaits", [1, 3])
def test_the_tree_holds_every_allowed_sequence_once(gaits, max_transitions):
    tree = GaitTree.grow(gaits, 4, max_transitions)
    found = [sequence_of(tree, n) for n in range(len(tree.steps))]
    expected = sequences(gaits, 4, max_transitions)
    assert sorted(found) == sorted(expected)
    assert found == sorted(found, key=lambda s: (len(s), s))  # breadth-first, children in gait order
    assert [len(s) for s in found] == tree.steps.tolist()
    changes = [sum(a != b for a, b in itertools.pairwise(s)) for s in found]
    assert tree.transitions.tolist() == changes
    assert count_nodes(gaits, 4, max_transitions, limit=10**9) == len(expected)


def test_children_are_contiguous_and_leaves_have_none():
    tree = GaitTree.grow(3, 3, 1)
    for node in range(len(tree.steps)):
        children = range(tree.first_child[node], tree.first_child[node + 1])
        assert list(children) == np.flatnonzero(tree.parents == node).tolist()


def test_count_of_the_papers_tree():
    # 10 + 90 (T - 1) sequences of length T, T = 1..10, and the empty one.
    assert count_nodes(10, 10, 1, limit=10**9) == 1 + 100 + 90 * 45
    assert count_nodes(10, 10, 2, limit=1000) > 1000


def test_compiled_poses_are_composed_outcomes(small_model):
    outcomes = Outcomes.draw(small_model, 3, samples=4, blocks=2, seed=1)
    tree = GaitTree.grow(3, 3, 1)
    poses = CompiledRollouts(outcomes, tree).poses
    for node, block, sample in itertools.product(range(len(tree.steps)), range(2), range(4)):
        at = Polar(0.0, 0.0, 0.0)
        for step, gait in enumerate(sequence_of(tree, node)):
            place = (block, step, sample, gait)
            move = Polar.from_cartesian(
                *(float(a[place]) for a in (outcomes.forward, outcomes.right, outcomes.heading))
            )
            at = at.compose(move)
        forward, right, heading = poses[:, block, sample, node]
        assert (forward, right) == pytest.approx((at.forward, at.right), abs=1e-12)
        assert np.cos(heading - at.heading) == pytest.approx(1.0, abs=1e-12)


def test_outcomes_share_random_numbers_and_follow_the_seed(model):
    one = Outcomes.draw(model, 2, samples=8, blocks=3, seed=4)
    assert np.array_equal(one.forward, Outcomes.draw(model, 2, samples=8, blocks=3, seed=4).forward)
    assert not np.array_equal(one.forward, Outcomes.draw(model, 2, samples=8, blocks=3, seed=5).forward)
    uniforms = np.random.default_rng(4).random((3, 2, 8, 6))
    assert np.array_equal(one.forward[1, 0, 5], model.outcomes(uniforms).forward[:, 1, 0, 5])


def test_outcomes_that_are_not_finite_are_refused():
    class Broken:
        def outcomes(self, uniforms):
            shape = (2, *uniforms.shape[:-1])
            return Polar(np.full(shape, np.nan), np.zeros(shape), np.zeros(shape))

    with pytest.raises(BayesHuntError, match="not finite"):
        Outcomes.draw(Broken(), 2, samples=1, blocks=1, seed=0)


def test_mean_distance_by_hand():
    hunter = HunterSamples(
        forward=np.array([[0.0, 3.0], [0.0, 0.0]]),
        right=np.array([[0.0, 4.0], [1.0, 1.0]]),
        heading=np.zeros((2, 2)),
        steps=np.array([0, 1]),
    )
    prey = Polar(np.array([1.0, 0.0]), np.zeros(2), np.zeros(2))  # at (1, 0), then at (0, 0)
    assert mean_distance(hunter, prey) == pytest.approx([(1 + np.sqrt(2)) / 2, (5 + 1) / 2])


def test_mean_distance_does_not_depend_on_how_many_nodes_are_valued(model):
    outcomes = Outcomes.draw(model, 10, samples=8, blocks=1, seed=0)
    tree = GaitTree.grow(10, 10, 1)
    forward, right, heading = CompiledRollouts(outcomes, tree).poses[:, 0]
    prey = Polar(np.linspace(0.3, 0.9, 11), np.full(11, 0.4), np.zeros(11))
    whole = mean_distance(HunterSamples(forward, right, heading, tree.steps), prey)
    part = slice(1000, 1100)  # across a chunk's edge
    some = HunterSamples(forward[:, part], right[:, part], heading[:, part], tree.steps[part])
    assert np.array_equal(mean_distance(some, prey), whole[part])
    last = np.hypot(forward[:, -1] - prey.forward[10], right[:, -1] - prey.right[10]).mean()
    assert whole[-1] == pytest.approx(last, abs=1e-12)


def test_lazy_and_compiled_spaces_agree(small_model):
    outcomes = Outcomes.draw(small_model, 3, samples=4, blocks=2, seed=1)
    prey = situations(1)[0].prey.compose(Polar(np.linspace(0, 0.5, 4), np.zeros(4), np.zeros(4)))
    compiled = CompiledRollouts(outcomes, GaitTree.grow(3, 3, 1)).space(1, prey, mean_distance)
    lazy = LazyRollouts(outcomes, 1).space(1, prey, mean_distance)
    pairs = [(compiled.root(), lazy.root())]
    visited = 0
    while pairs:
        (one, value), (other, same) = pairs.pop()
        visited += 1
        assert value == pytest.approx(same, abs=1e-12)
        assert compiled.gait(one) == lazy.gait(other)
        about, twin = compiled.describe([one]), lazy.describe([other])
        assert all(about[key] == pytest.approx(twin[key], abs=1e-12) for key in about)
        left, right = compiled.expand(one), lazy.expand(other)
        assert len(left[0]) == len(right[0])
        pairs += zip(zip(*left, strict=True), zip(*right, strict=True), strict=True)
    assert visited == len(sequences(3, 3, 1))
