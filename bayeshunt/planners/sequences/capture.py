"""When would a gait sequence catch the prey: mean paths, composed once, against any number of prey paths.

Unlike the distance at the end of a step, the time of first capture knows what happens within a step
and prefers the sooner of two catches. Letters: N nodes (gait sequences, the empty one is node 0),
P points per time-step, T depth, K prey paths.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.tables.structures import depends_on_previous
from bayeshunt.planners.interception.lookahead import gait_paths, path_lengths
from bayeshunt.planners.search.rollouts import GaitTree

__all__ = ["CapturePaths", "PreyPaths"]


@dataclass(frozen=True)
class PreyPaths:
    """K paths the prey may take, in the hunter's present frame.

    forward, right: metres [K, T P + 1], at equal intervals of one point from now on.
    """

    forward: np.ndarray
    right: np.ndarray

    def velocity(self, points: int, interval: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the mean velocity over the last ``points`` intervals [m/s]: forward and right, [K]."""
        span = points * interval
        return (
            (self.forward[:, -1] - self.forward[:, -1 - points]) / span,
            (self.right[:, -1] - self.right[:, -1 - points]) / span,
        )


class CapturePaths:
    """The mean path of every gait sequence of a tree, at P points per time-step.

    tree: the sequences, grown unless they are given. points: P. interval: seconds between points.
    duration: seconds per step.
    ways: metres along each sequence [N]. fastest: number of the fastest gait.
    previous_gait: the gait just executed; it and each gait of a sequence say what the next one does where the model
        depends on the gait before.
    speed: the fastest gait's mean speed [m/s]. turn_price: seconds per radian of heading error, from
    the softest turn that is driven at nearly full speed: it turns so much in one step.
    """

    def __init__(
        self, model: ForwardModel, depth: int, max_transitions: int, *, previous_gait: str | None = None,
        tree: GaitTree | None = None,
    ) -> None:  # fmt: skip
        paths = gait_paths(model.after(previous_gait))
        after = None
        if depends_on_previous(model.structure):
            after = np.stack([gait_paths(model.after(gait)) for gait in model.gaits])
        self.duration = model.gaits.need("duration")
        self.points = paths.shape[1]
        self.interval = self.duration / self.points
        self.depth = depth
        self.tree = GaitTree.grow(len(paths), depth, max_transitions) if tree is None else tree
        self.layers = np.searchsorted(self.tree.steps, np.arange(depth + 2))
        self.by_previous = after is not None
        self._compose(paths, after)
        own = gait_paths(model)
        self.lengths = path_lengths(own)
        self._ways(paths, after)
        self.fastest = int(self.lengths.argmax())
        self.speed = float(self.lengths.max() / self.duration)
        self.turn_price = self._turn_price(own)

    def _ways(self, paths: np.ndarray, after: np.ndarray | None) -> None:
        """Add up the metres along every sequence [N]."""
        tree, first = self.tree, path_lengths(paths)
        later = None if after is None else np.stack([path_lengths(part) for part in after])
        self.ways = np.zeros(len(tree.steps))
        for step in range(1, self.depth + 1):
            new = slice(self.layers[step], self.layers[step + 1])
            gaits, parents = tree.gaits[new], tree.parents[new]
            moved = first[gaits] if later is None or step == 1 else later[tree.gaits[parents], gaits]
            self.ways[new] = self.ways[parents] + moved

    def last_ways(self, nodes: np.ndarray) -> np.ndarray:
        """Return metres along the last gait of sequences [n]."""
        if self.by_previous:
            return np.asarray(self.ways[nodes] - self.ways[self.tree.parents[nodes]])
        return np.asarray(self.lengths[self.tree.gaits[nodes]])  # not the difference, which is rounded

    def _compose(self, paths: np.ndarray, after: np.ndarray | None) -> None:
        """Compose the points [N, P] of every node and its end pose, from its parent's end."""
        tree, count = self.tree, len(self.tree.steps)
        self.forward = np.zeros((count, self.points), dtype=np.float32)
        self.right = np.zeros((count, self.points), dtype=np.float32)
        self.end = np.zeros((3, count))  # forward, right, heading
        for step in range(1, self.depth + 1):
            new = slice(self.layers[step], self.layers[step + 1])
            x, y, heading = self.end[:, tree.parents[new], None]
            moves = paths[tree.gaits[new]]
            if after is not None and step > 1:
                moves = after[tree.gaits[tree.parents[new]], tree.gaits[new]]
            ahead, right, turn = np.moveaxis(moves, 2, 0)
            cos, sin = np.cos(heading), np.sin(heading)
            forward, across = x + cos * ahead - sin * right, y + sin * ahead + cos * right
            self.forward[new], self.right[new] = forward, across
            self.end[:, new] = forward[:, -1], across[:, -1], heading[:, 0] + turn[:, -1]

    def _turn_price(self, paths: np.ndarray) -> float:
        turns = np.abs(paths[:, -1, 2])
        fast = (self.lengths >= 0.8 * self.lengths.max()) & (turns > 0.1)
        turns = turns[fast] if fast.any() else turns[turns > 0.1]
        return self.duration / float(turns.min()) if turns.size else 0.0

    def first_captures(self, prey: PreyPaths, reach: float, *, stop_at_first: bool = False) -> np.ndarray:
        """Return the time within each node's last gait at which it first comes within ``reach`` [m], [K, N].

        Seconds from now, inf where it does not. stop_at_first: leave inf after the first depth at
        which anything is caught, as nothing deeper can be sooner.
        """
        times = np.full((len(prey.forward), len(self.tree.steps)), np.inf)
        for step in range(1, self.depth + 1):
            new = slice(self.layers[step], self.layers[step + 1])
            self._captures_of_step(step, new, prey, reach * reach, times)
            if stop_at_first and np.isfinite(times[:, new]).any():
                break
        return times

    def _captures_of_step(self, step: int, new: slice, prey: PreyPaths, square: float, times: np.ndarray) -> None:
        """Fill ``times`` for the nodes of one depth."""
        start = (step - 1) * self.points
        span = slice(start + 1, start + self.points + 1)
        ahead, across = self.forward[new], self.right[new]
        for k in range(len(times)):
            dx = ahead - prey.forward[k, span].astype(np.float32)
            dy = across - prey.right[k, span].astype(np.float32)
            gap = dx * dx + dy * dy
            caught = np.flatnonzero(gap.min(axis=1) <= square)
            if not caught.size:
                continue
            some = gap[caught]
            point = np.argmax(some <= square, axis=1)
            after = np.sqrt(some[np.arange(len(caught)), point])
            before = self._before(new.start + caught, point, start, prey, k)
            reach = math.sqrt(square)
            share = np.clip((before - reach) / np.maximum(before - after, 1e-9), 0.0, 1.0)
            times[k, new.start + caught] = (start + point + share) * self.interval

    def _before(self, nodes: np.ndarray, point: np.ndarray, start: int, prey: PreyPaths, k: int) -> np.ndarray:
        """Return the distance at the point before ``point`` (the parent's end if it is the first), [n]."""
        parents = self.tree.parents[nodes]
        earlier = np.maximum(point - 1, 0)
        x = np.where(point > 0, self.forward[nodes, earlier], self.end[0, parents])
        y = np.where(point > 0, self.right[nodes, earlier], self.end[1, parents])
        found: np.ndarray = np.hypot(x - prey.forward[k, start + point], y - prey.right[k, start + point])
        return found

    def times_to_go(self, nodes: np.ndarray, prey: PreyPaths, reach: float, turn_price: float) -> np.ndarray:
        """Return how long after its end a sequence would still need, [K, n] seconds, never less than 0.

        From the end pose, at top speed straight to the point where the prey is met if it keeps its
        last velocity, plus ``turn_price`` seconds per radian of heading error towards that point. If
        the prey gets away, the time is what the gap left would take at top speed, after the whole horizon.
        """
        end = self.end[:, nodes]
        step = self.tree.steps[nodes] * self.points
        v_x, v_y = prey.velocity(self.points, self.interval)
        x, y = prey.forward[:, step] - end[0], prey.right[:, step] - end[1]
        times = self._straight(x, y, v_x[:, None], v_y[:, None], reach)
        error = np.arctan2(y + v_y[:, None] * times, x + v_x[:, None] * times) - end[2]
        error = np.abs((error + np.pi) % (2 * np.pi) - np.pi)
        found: np.ndarray = times + turn_price * error
        return found

    def _straight(self, x: np.ndarray, y: np.ndarray, v_x: np.ndarray, v_y: np.ndarray, reach: float) -> np.ndarray:
        """Solve ``|p + v t| = speed t + reach`` for the least t >= 0, elementwise."""
        gap = np.maximum(x * x + y * y - reach * reach, 0.0)
        a = v_x * v_x + v_y * v_y - self.speed**2
        b = x * v_x + y * v_y - self.speed * reach
        root = b * b - a * gap
        never = self.depth * self.duration + np.sqrt(gap) * (20.0 / self.speed)
        with np.errstate(divide="ignore", invalid="ignore"):
            # a < 0 (a slower prey): one root is >= 0. a > 0: the smaller root, if the prey comes closer
            times = np.where(np.abs(a) < 1e-12, -gap / (2 * b), (-b - np.sqrt(root)) / a)
        found: np.ndarray = np.where(np.isfinite(times) & (times >= 0), np.minimum(times, never), never)
        return found
