"""Both robots' motion sampled under the forward model's own spread, for decisions that plan for noise.

Letters: G gaits, P part-way poses of a gait, S samples, K prey futures.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from bayeshunt.core.geometry import FloatArray
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.interception.futures import Futures
from bayeshunt.planners.interception.lookahead import PairPaths, gait_paths
from bayeshunt.planners.search.rollouts import Outcomes

__all__ = ["BLOCKS", "SAMPLES", "Samples"]

#: Joint samples of both robots in a set, and independent sets, unless a planner is told others.
SAMPLES, BLOCKS = 64, 4


@dataclass(frozen=True, eq=False)
class Samples:
    """One set of samples: sample s of the hunter meets sample s of the prey.

    pairs: the hunter's paths in both steps, S of each. The first step has as many different outcomes as each of
        them has second ones, the square root of S; outcome [S] says which. After the first step the hunter sees which
        one it got, and decides again.
    firsts: where a gait depends on the one before, the paths [3, G, P, S] of the first step after each gait; ``pairs``
        are then those after a gait that is not known. second: the paths of the second step, after each first gait if
        they depend on it. duration: seconds of a step.
    direction: radians [S], by which the prey's direction departs from its mean. pace: its speed as a share of the
        mean [S]. Both are those of the hunter's own fastest straight gait.
    """

    pairs: PairPaths
    firsts: Mapping[str, np.ndarray]
    second: np.ndarray
    duration: float
    outcome: np.ndarray
    direction: np.ndarray
    pace: np.ndarray

    @classmethod
    def draw(
        cls, model: ForwardModel, straight: float, *, samples: int = SAMPLES, blocks: int = BLOCKS, seed: int = 0,
        prey_noise: float = 1.0,
    ) -> tuple[Samples, ...]:  # fmt: skip
        """Return independent sets of samples from a private generator seeded by ``seed``.

        straight: radians; a gait whose heading changes by less is straight. prey_noise: the prey's spread in those of
        the hunter's gait.
        """
        paths, seen = gait_paths(model), np.arange(samples) % math.isqrt(samples)
        outcomes = Outcomes.of(model, _uniforms(seen, samples, blocks, seed))
        return tuple(cls._of(model, paths, outcomes, block, seen, straight, prey_noise) for block in range(blocks))

    @classmethod
    def _of(
        cls, model: ForwardModel, paths: np.ndarray, outcomes: Outcomes, block: int, seen: np.ndarray,
        straight: float, prey_noise: float,
    ) -> Samples:  # fmt: skip
        duration = model.gaits.need("duration")
        first, second = (_departing(paths, _ends(outcomes, block, step)) for step in range(2))
        firsts = {}
        if outcomes.after:
            after = [
                (gait_paths(model.after(gait)), part)
                for gait, part in zip(model.gaits.names, outcomes.after, strict=True)
            ]
            made = [_departing(own, _ends(part, block, 0)) for own, part in after]
            firsts = dict(zip(model.gaits.names, made, strict=True))
            second = np.stack([_departing(own, _ends(part, block, 1)) for own, part in after], axis=1)
        pairs = PairPaths.compile(first, second, duration)
        gait = _straightest(paths, straight)
        forward, right = _ends(outcomes, block, 2)[:2, gait]  # the prey's own noise
        direction = prey_noise * (np.arctan2(right, forward) - math.atan2(paths[gait, -1, 1], paths[gait, -1, 0]))
        reach = np.hypot(forward, right)
        return cls(
            pairs,
            firsts,
            second,
            duration,
            seen,
            direction,
            np.maximum(1.0 + prey_noise * (reach / reach.mean() - 1.0), 0.0),
        )

    def after(self, previous_gait: str | None) -> PairPaths:
        """Return the hunter's paths in both steps after the gait just executed, where that changes them."""
        first = self.firsts.get(previous_gait or "")
        return self.pairs if first is None else PairPaths.compile(first, self.second, self.duration)

    def futures(self, whole: Futures) -> Futures:
        """Return S equally weighted prey futures: ``whole`` resampled, with noise.

        Futures of one group cannot be told apart at the next decision, neither by the prey nor by where the hunter is.
        """
        count = len(self.direction)
        # Systematic resampling: the s-th sample is where the cumulative weight passes (s + 1/2) / S.
        marks = (np.arange(count) + 0.5) / count
        drawn = np.minimum(np.searchsorted(np.cumsum(whole.weights), marks), len(whole.weights) - 1)
        _, groups = np.unique(whole.groups[drawn] * count + self.outcome, return_inverse=True)
        cos, sin = (self.pace * part(self.direction) for part in (np.cos, np.sin))
        ahead, right = (a[drawn] - a[drawn, :1] for a in (whole.forward, whole.right))
        return replace(
            whole.only(drawn),
            weights=np.full(count, 1.0 / count),
            forward=whole.forward[drawn, :1] + cos[:, None] * ahead - sin[:, None] * right,
            right=whole.right[drawn, :1] + sin[:, None] * ahead + cos[:, None] * right,
            heading=whole.heading[drawn] + self.direction[:, None],
            speed=whole.speed[drawn] * self.pace,
            groups=groups,
        )


def _uniforms(seen: np.ndarray, samples: int, blocks: int, seed: int) -> FloatArray:
    """Return uniforms [B, 3, S, 6]; those of the first step are the same where ``seen`` [S] is."""
    rng = np.random.default_rng(seed)
    found = np.empty((blocks, 3, samples, 6))
    for block in found:
        block[0] = _stratified(int(seen.max()) + 1, rng)[seen]
        block[1:] = [_stratified(samples, rng) for _ in range(2)]
    return found


def _stratified(count: int, rng: np.random.Generator) -> FloatArray:
    """Return a Latin hypercube [count, 6]: one point in each of ``count`` equal parts of every axis."""
    cells = rng.permuted(np.tile(np.arange(count)[:, None], 6), axis=0)
    return (cells + rng.random(cells.shape)) / count


def _ends(outcomes: Outcomes, block: int, step: int) -> FloatArray:
    """Return the sampled ends [3, G, S] of each gait in a step."""
    return np.stack([a[block, step].T for a in (outcomes.forward, outcomes.right, outcomes.heading)])


def _departing(paths: np.ndarray, ends: np.ndarray) -> FloatArray:
    """Return paths [3, G, P, S] to ``ends`` [3, G, S], departing from the mean ones [G, P, 3] in proportion to time."""
    share = np.arange(1, paths.shape[1] + 1) / paths.shape[1]
    mean = np.moveaxis(paths, -1, 0)[..., None]
    off = ends - mean[:, :, -1]
    off[2] = np.pi - np.mod(np.pi - off[2], 2.0 * np.pi)  # a heading departs by less than half a circle
    found: FloatArray = mean + share[:, None] * off[:, :, None]
    return found


def _straightest(paths: np.ndarray, straight: float) -> int:
    """Return the fastest gait that does not turn, the fastest of all if every gait turns."""
    reach = np.hypot(paths[:, -1, 0], paths[:, -1, 1])
    ahead = np.abs(paths[:, -1, 2]) < straight
    return int(np.where(ahead, reach, 0.0).argmax() if ahead.any() else reach.argmax())
