"""Where the hunter would end up: sampled poses of every gait sequence, from the forward model.

The outcomes are poses in the hunter's own present frame, so they do not depend on the situation:
they are drawn and composed once, when a planner is made, and every decision reads them. Where a gait's
outcome depends on the gait before it, the first gait of a sequence follows the one just executed.

Letters: B blocks of S samples, T depth, G gaits, N nodes (gait sequences, the empty one included).
The same uniforms serve every gait at a given block, depth and sample (common random numbers), so
that two sequences differ by their gaits and not by their luck.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from bayeshunt.core.errors import BayesHuntError
from bayeshunt.core.geometry import FloatArray, Polar, wrap
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.tables.structures import depends_on_previous

__all__ = [
    "CompiledRollouts",
    "CompiledSpace",
    "GaitTree",
    "HunterSamples",
    "LazyRollouts",
    "LazySpace",
    "Objective",
    "Outcomes",
    "Spent",
    "children_allowed",
    "count_nodes",
    "mean_distance",
]

# Nodes evaluated at a time: the temporaries then stay in cache and below malloc's mmap threshold.
_CHUNK = 1024


class HunterSamples(NamedTuple):
    """Predicted hunter poses of N gait sequences, in its present frame.

    forward, right: metres [S, N]. heading: radians clockwise, not wrapped [S, N].
    steps: T, the number of gaits executed, int [N].
    """

    forward: np.ndarray
    right: np.ndarray
    heading: np.ndarray
    steps: np.ndarray


#: Turns predicted hunter samples and the predicted prey path (Polar of arrays [depth + 1], in the
#: hunter's present frame) into one value per gait sequence, [N]; the least is best.
Objective = Callable[[HunterSamples, Polar[FloatArray]], np.ndarray]


def mean_distance(hunter: HunterSamples, prey: Polar[FloatArray]) -> np.ndarray:
    """Return the mean distance [m] between hunter and prey at the end of each sequence, [N].

    ``value[n] = 1/S sum_s | hunter[s, n] - prey[T(n)] |`` (the paper's Value, with a sampled hunter).
    """
    ahead, right = prey.forward[hunter.steps], prey.right[hunter.steps]
    values = np.empty(len(hunter.steps))
    for start in range(0, len(values), _CHUNK):
        part = slice(start, start + _CHUNK)
        square = hunter.forward[:, part] - ahead[part]
        across = hunter.right[:, part] - right[part]
        square *= square
        across *= across
        square += across
        np.sqrt(square, out=square)
        np.add.reduce(square, axis=0, out=values[part])
    values /= len(hunter.forward)
    return values


class Spent(NamedTuple):
    """What is added to the values of sequences: a table [G + 1, G] by gait before and gait, summed along each.

    before: number of the gait just executed, -1 (the last row): not known.
    """

    table: np.ndarray
    before: int


@dataclass(frozen=True)
class GaitTree:
    """Every gait sequence of at most ``depth`` gaits with at most ``max_transitions`` changes of gait.

    Nodes are numbered breadth-first, children in gait order; node 0 is the empty sequence.
    parents, steps, gaits, transitions: int [N]; the root has parent -1 and gait -1.
    first_child: int [N + 1]; the children of node n are first_child[n] to first_child[n + 1] - 1.
    """

    parents: np.ndarray
    steps: np.ndarray
    gaits: np.ndarray
    transitions: np.ndarray
    first_child: np.ndarray

    def along(self, table: np.ndarray, before: int) -> np.ndarray:
        """Return the sum of a table [G + 1, G] by gait before and gait along every sequence [N], read-only.

        before: number of the gait just executed, -1 (the last row): not known.
        """
        total = np.zeros(len(self.steps))
        for step in range(1, int(self.steps.max()) + 1):
            new = np.flatnonzero(self.steps == step)
            parents = self.parents[new]
            last = self.gaits[parents] if step > 1 else np.full(len(new), before)
            total[new] = total[parents] + table[last, self.gaits[new]]
        total.setflags(write=False)
        return total

    @classmethod
    def grow(cls, gaits: int, depth: int, max_transitions: int) -> GaitTree:
        """Return the tree of a repertoire of ``gaits`` gaits."""
        layers = [(np.array([-1]), np.array([-1]), np.array([0]))]  # parents, gaits, transitions
        child_counts = []
        start = 0
        for step in range(depth):
            _, gait, changes = layers[-1]
            allowed = children_allowed(gait, changes, gaits, max_transitions)
            child_counts.append(allowed.sum(axis=1))
            row, new = np.nonzero(allowed)
            changed = (new != gait[row]) if step else np.zeros(len(new), dtype=bool)
            layers.append((start + row, new, changes[row] + changed))
            start += len(gait)
        child_counts.append(np.zeros(len(layers[-1][0]), dtype=int))
        steps = np.repeat(np.arange(depth + 1), [len(layer[0]) for layer in layers])
        first_child = 1 + np.concatenate([[0], np.cumsum(np.concatenate(child_counts))])
        columns = (np.concatenate(column) for column in zip(*layers, strict=True))
        parents, last, changes = columns
        return cls(parents, steps, last, changes, first_child)


def children_allowed(gait: np.ndarray, changes: np.ndarray, gaits: int, max_transitions: int) -> np.ndarray:
    """Return bool [n, G]: which gait may follow each node; the first gait is no transition (gait -1)."""
    same = gait[:, None] == np.arange(gaits)
    found: np.ndarray = same | (changes < max_transitions)[:, None] | (gait < 0)[:, None]
    return found


def count_nodes(gaits: int, depth: int, max_transitions: int, *, limit: int) -> int:
    """Return the size of :meth:`GaitTree.grow`'s tree, the root included, or any number above ``limit``."""
    by_changes = [gaits]  # sequences of the present length, by number of transitions
    total = 1
    for _ in range(depth):
        total += sum(by_changes)
        if total > limit:
            break
        longer = [*by_changes, 0]
        for changes, count in enumerate(by_changes):
            longer[changes + 1] += count * (gaits - 1)
        by_changes = longer[: max_transitions + 1]
    return total


@dataclass(frozen=True)
class Outcomes:
    """Sampled outcomes of one time-step in the hunter's frame before it: arrays [B, T, S, G].

    forward, right: metres; heading: radians clockwise.
    after: the outcomes right after each gait [G], if they depend on it; these are then for a gait
        before that is not known.
    """

    forward: np.ndarray
    right: np.ndarray
    heading: np.ndarray
    after: tuple[Outcomes, ...] = ()

    @classmethod
    def draw(cls, model: ForwardModel, depth: int, samples: int, blocks: int, seed: int) -> Outcomes:
        """Draw from the forward model's tables with uniforms of a private generator seeded by ``seed``."""
        return cls.of(model, np.random.default_rng(seed).random((blocks, depth, samples, 6)))

    @classmethod
    def of(cls, model: ForwardModel, uniforms: np.ndarray) -> Outcomes:
        """Return the outcomes that uniforms [B, T, S, 6] in [0, 1) draw; the same uniforms serve every gait before."""
        drawn = model.outcomes(uniforms)  # Polar of [G, B, T, S]
        forward, right, heading = (
            np.ascontiguousarray(np.moveaxis(a, 0, -1)) for a in (drawn.forward, drawn.right, drawn.heading)
        )
        if not all(np.isfinite(a).all() for a in (forward, right, heading)):
            raise BayesHuntError("the forward model sampled a pose that is not finite")
        parts = [model.after(gait) for gait in model.gaits] if depends_on_previous(model.structure) else []
        return cls(forward, right, heading, tuple(cls.of(part, uniforms) for part in parts))

    def moves(self, step: int, before: np.ndarray, gaits: np.ndarray) -> list[np.ndarray]:
        """Return forward, right, heading [B, S, n] of ``gaits`` [n] executed after ``before`` [n] at a step.

        before: -1 at the first step, which these outcomes themselves are for.
        """
        if not (self.after and step):
            return [a[:, step][..., gaits] for a in (self.forward, self.right, self.heading)]
        moved = np.empty((3, self.forward.shape[0], self.forward.shape[2], len(gaits)))
        for gait, part in enumerate(self.after):
            mine = before == gait
            moved[..., mine] = part.moves(step, before[mine], gaits[mine])
        return list(moved)

    def starting_after(self, gait: int) -> Outcomes:
        """Return the outcomes whose first step follows ``gait``; the same if that changes nothing."""
        return replace(self.after[gait], after=self.after) if self.after else self


class CompiledRollouts:
    """The poses of every node of a gait tree, composed once: arrays [B, S, N]."""

    def __init__(self, outcomes: Outcomes, tree: GaitTree) -> None:
        blocks, depth, samples, _ = outcomes.forward.shape
        self.tree = tree
        poses = np.zeros((3, blocks, samples, len(tree.steps)))
        ends = np.searchsorted(tree.steps, np.arange(depth + 2))
        for step in range(depth):
            new = slice(ends[step + 1], ends[step + 2])
            parents = tree.parents[new]
            moved = outcomes.moves(step, tree.gaits[parents], tree.gaits[new])
            poses[..., new] = _compose(*poses[..., parents], *moved)
        poses.setflags(write=False)
        self.poses = poses
        self._first_child: list[int] = tree.first_child.tolist()

    def space(
        self, block: int, prey: Polar[FloatArray], objective: Objective, spent: Spent | None = None
    ) -> CompiledSpace:
        """Return the search space of one decision: every node is valued in one pass."""
        forward, right, heading = self.poses[:, block]
        samples = HunterSamples(forward, right, heading, self.tree.steps)
        values = objective(samples, prey)
        values = values if spent is None else values + self.tree.along(*spent)
        return CompiledSpace(self.tree, self._first_child, samples, values)


class CompiledSpace:
    """A search space over a compiled tree; handles are node numbers of the tree."""

    def __init__(self, tree: GaitTree, first_child: list[int], samples: HunterSamples, values: np.ndarray) -> None:
        self._gaits, self._first_child, self._values = tree.gaits, first_child, values
        # Last gait, transitions and mean pose of nodes; apart from the values, which a kept plan can spare.
        self.describe = partial(_describe_compiled, tree, samples)

    def root(self) -> tuple[int, float]:
        """Return node 0 and the present value."""
        return 0, float(self._values[0])

    def expand(self, handle: int) -> tuple[Sequence[int], list[float]]:
        """Return the numbers and values of a node's children, in gait order."""
        first, end = self._first_child[handle], self._first_child[handle + 1]
        return range(first, end), self._values[first:end].tolist()

    def gait(self, handle: int) -> int:
        """Return the index of the node's last gait."""
        return int(self._gaits[handle])


class LazyRollouts:
    """Composes a node's children when it is expanded: for trees too large to compile."""

    def __init__(self, outcomes: Outcomes, max_transitions: int) -> None:
        self.outcomes, self.max_transitions = outcomes, max_transitions

    def space(self, block: int, prey: Polar[FloatArray], objective: Objective, spent: Spent | None = None) -> LazySpace:
        """Return the search space of one decision."""
        return LazySpace(self, block, prey, objective, spent)


class LazySpace:
    """A search space whose handles are (T, gait, transitions, forward [S], right [S], heading [S], spent)."""

    def __init__(
        self, rollouts: LazyRollouts, block: int, prey: Polar[FloatArray], objective: Objective,
        spent: Spent | None = None,
    ) -> None:  # fmt: skip
        first, *after = (
            [a[block] for a in (part.forward, part.right, part.heading)]  # [T, S, G]
            for part in (rollouts.outcomes, *rollouts.outcomes.after)
        )
        self._moves, self._moves_after = first, after
        self._max_transitions, self._prey, self._objective = rollouts.max_transitions, prey, objective
        self._spent = spent

    def root(self) -> tuple[Any, float]:
        """Return the empty sequence and the present value."""
        still = np.zeros(self._moves[0].shape[1])
        samples = HunterSamples(still[:, None], still[:, None], still[:, None], np.zeros(1, dtype=int))
        return (0, -1, 0, still, still, still, 0.0), float(self._objective(samples, self._prey)[0])

    def expand(self, handle: Any) -> tuple[Sequence[Any], list[float]]:
        """Return the handles and values of a node's children, in gait order."""
        step, gait, changes, *before, spent = handle
        depth, _, gaits = self._moves[0].shape
        if step == depth:
            return (), []
        free = gait < 0 or changes < self._max_transitions
        new = list(range(gaits)) if free else [gait]
        known = self._moves_after[gait] if self._moves_after and step else self._moves
        moves = [a[step][:, new] for a in known]
        poses = _compose(*(a[:, None] for a in before), *moves)
        values = self._objective(HunterSamples(*poses, np.full(len(new), step + 1)), self._prey)
        costs = np.zeros(len(new))
        if self._spent is not None:
            costs = spent + self._spent.table[gait if step else self._spent.before, new]
            values = values + costs
        children = [
            (step + 1, g, changes + (gait >= 0 and g != gait), *(a[:, i] for a in poses), costs[i])
            for i, g in enumerate(new)
        ]
        return children, values.tolist()

    def gait(self, handle: Any) -> int:
        """Return the index of the node's last gait."""
        return int(handle[1])

    @staticmethod
    def describe(handles: list[Any]) -> dict[str, np.ndarray]:
        """Return the last gait, transitions and mean pose of every node, arrays [n]."""
        poses = [np.stack([h[i] for h in handles], axis=1) for i in (3, 4, 5)]
        return _description(np.array([h[1] for h in handles]), np.array([h[2] for h in handles]), *poses)


def _compose(
    forward: np.ndarray, right: np.ndarray, heading: np.ndarray, ahead: Any, across: Any, turn: Any
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the pose reached by a move (ahead, across, turn) made from a pose; Polar.compose, Cartesian."""
    cos, sin = np.cos(heading), np.sin(heading)
    return forward + cos * ahead - sin * across, right + sin * ahead + cos * across, heading + turn


def _describe_compiled(tree: GaitTree, samples: HunterSamples, handles: list[int]) -> dict[str, np.ndarray]:
    poses = [a[:, handles] for a in (samples.forward, samples.right, samples.heading)]
    return _description(tree.gaits[handles], tree.transitions[handles], *poses)


def _description(
    gaits: np.ndarray, changes: np.ndarray, forward: np.ndarray, right: np.ndarray, heading: np.ndarray
) -> dict[str, np.ndarray]:
    mean_heading = np.arctan2(np.sin(heading).mean(axis=0), np.cos(heading).mean(axis=0))
    return {
        "gait": gaits,
        "transition_cost": changes,
        "hunter_forward": forward.mean(axis=0),
        "hunter_right": right.mean(axis=0),
        "hunter_heading": np.asarray(wrap(mean_heading)),
    }
