"""The belief hunter: the hunter's distribution after a gait sequence against the prey's."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np

from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.api import Plan, Situation
from bayeshunt.planners.interception.futures import Futures
from bayeshunt.planners.interception.intercept import InterceptPlanner, InterceptSettings
from bayeshunt.planners.interception.lookahead import PairPaths, gait_paths
from bayeshunt.planners.requests import check_request
from bayeshunt.planners.search.rollouts import Outcomes
from bayeshunt.planners.settings import Count, Number, planner_settings, setting

__all__ = ["BeliefPlanner", "BeliefSettings", "belief"]


@planner_settings("belief")
class BeliefSettings(InterceptSettings):
    """Settings of the belief hunter: those of the interception hunter (``spread`` is not used), and its samples."""

    name: ClassVar[str] = "belief"
    samples: Count = setting(64, "joint samples of hunter and prey, S", ge=2)
    blocks: Count = setting(4, "independent sets of samples; each decision picks one with its rng", ge=1)
    bank_seed: Count = setting(0, "seeds the private generator of the samples", ge=0)
    prey_noise: Number = setting(
        1.0, "the prey's spread in direction and speed, in those of the hunter's own fastest straight gait", ge=0
    )


class BeliefPlanner(InterceptPlanner):
    """The gaits of the least expected time of capture under both robots' distributions (paper, "theoretical solution").

    ``P(captured by t) = P(min over u <= t of |Hunter[u] - Prey[u]| <= reach)`` for every sequence of one
    or two gaits, at every part-way time t; ``E[time] = integral of 1 - P(captured by t) dt``, with the
    homing estimate of :class:`InterceptPlanner` beyond the second step, from each sampled end pose.

    Hunter: the forward model composed with itself, on S sampled outcomes of each gait; part-way, an
    outcome departs from the gait's mean path in proportion to time. Prey: S futures drawn from its
    turn table by systematic resampling, with the speed and direction noise of the hunter's own
    fastest straight gait. Sample s of the hunter meets sample s of the prey: one sum over S estimates
    the double integral over both distributions. ``rng`` picks the block of samples.

    Cost: S (G + G^2) P distances a decision (S = 64, G = 10, P = 13: 91,520), linear in S.
    Not exact: a standard error of about ``sqrt(p (1 - p) / S)`` on each P(captured by t); captures
    between part-way times are missed; the three variables of an outcome are independent given the
    gait; turns happen half-way through a step; beyond two steps there is an estimate, not a distribution.
    ``plan.trace`` holds P(captured by t) of every node.
    """

    name = "belief"
    Settings = BeliefSettings
    settings: BeliefSettings

    def __init__(self, model: ForwardModel, settings: BeliefSettings | None = None, **given: Any) -> None:
        super().__init__(model, settings, **given)
        chosen = self.settings
        self.spread = 0.0
        # One draw serves the hunter's two steps; a third column is the prey's own noise.
        outcomes = Outcomes.draw(model, 3, chosen.samples, chosen.blocks, chosen.bank_seed)
        paths = gait_paths(model)
        self.blocks = [self._compose(paths, outcomes, block) for block in range(chosen.blocks)]
        straight = self._straightest(paths)
        forward, right = outcomes.forward[:, 2, :, straight], outcomes.right[:, 2, :, straight]  # [B, S]
        ends = paths[straight, -1]
        self.direction = chosen.prey_noise * (np.arctan2(right, forward) - math.atan2(ends[1], ends[0]))
        reach = np.hypot(forward, right)
        self.speed_factor = np.maximum(1.0 + chosen.prey_noise * (reach / reach.mean() - 1.0), 0.0)

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Return the pair of gaits of the least expected time of capture."""
        situation = check_request(situation, rng, self.hunter)
        block = int(rng.integers(self.settings.blocks))
        return self.choose(situation, self.blocks[block], self.sampled(situation, block))

    def sampled(self, situation: Situation, block: int) -> Futures:
        """Return S equally weighted prey futures: the turn table resampled, with noise."""
        whole, count = self.futures(situation), self.settings.samples
        # Systematic resampling: the s-th sample is where the cumulative weight passes (s + 1/2) / S.
        marks = (np.arange(count) + 0.5) / count
        drawn = np.minimum(np.searchsorted(np.cumsum(whole.weights), marks), len(whole.weights) - 1)
        _, groups = np.unique(whole.groups[drawn], return_inverse=True)
        turned = self.direction[block][:, None]
        factor = self.speed_factor[block][:, None]
        ahead, right = (a[drawn] - a[drawn, :1] for a in (whole.forward, whole.right))
        cos, sin = factor * np.cos(turned), factor * np.sin(turned)
        return replace(
            whole,
            weights=np.full(count, 1.0 / count),
            starts=whole.starts[drawn],
            forward=whole.forward[drawn, :1] + cos * ahead - sin * right,
            right=whole.right[drawn, :1] + sin * ahead + cos * right,
            heading=whole.heading[drawn] + turned,
            speed=whole.speed[drawn] * factor[:, 0],
            groups=groups,
        )

    def _compose(self, paths: np.ndarray, outcomes: Outcomes, block: int) -> PairPaths:
        """Return the pairs of sampled paths [3, G, P, S] of both steps."""
        share = np.arange(1, paths.shape[1] + 1) / paths.shape[1]
        steps = []
        for step in (0, 1):
            drawn = [a[block, step].T for a in (outcomes.forward, outcomes.right, outcomes.heading)]  # [G, S]
            parts = []
            for i, end in enumerate(drawn):
                off = end - paths[:, -1, i, None]
                if i == 2:  # a heading departs by less than half a circle
                    off = np.pi - np.mod(np.pi - off, 2.0 * np.pi)
                parts.append(paths[:, :, i, None] + share[:, None] * off[:, None, :])
            steps.append(np.stack(parts))
        return PairPaths.compile(steps[0], steps[1], self.time_step)

    def _straightest(self, paths: np.ndarray) -> int:
        """Return the fastest gait that does not turn, the fastest of all if every gait turns."""
        reach = np.hypot(paths[:, -1, 0], paths[:, -1, 1])
        straight = np.abs(paths[:, -1, 2]) < self.settings.turn_threshold
        return int(np.where(straight, reach, 0.0).argmax() if straight.any() else reach.argmax())


#: The planner by the name that it is registered under.
belief = BeliefPlanner
