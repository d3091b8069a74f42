"""The belief hunter: the hunter's distribution after a gait sequence against the prey's."""

from __future__ import annotations

from typing import ClassVar

from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.interception.intercept import InterceptPlanner, InterceptSettings
from bayeshunt.planners.interception.sampling import BLOCKS, SAMPLES, Samples
from bayeshunt.planners.settings import Count, Number, planner_settings, setting

__all__ = ["BeliefPlanner", "BeliefSettings", "belief"]


@planner_settings("belief")
class BeliefSettings(InterceptSettings):
    """Settings of the belief hunter: those of the interception hunter (``spread`` is not used), and its samples."""

    name: ClassVar[str] = "belief"
    samples: Count = setting(SAMPLES, "joint samples of hunter and prey, S", ge=2)
    blocks: Count = setting(BLOCKS, "independent sets of samples; each decision picks one with its rng", ge=1)
    bank_seed: Count = setting(0, "seeds the private generator of the samples", ge=0)
    prey_noise: Number = setting(
        1.0, "the prey's spread in direction and speed, in those of the hunter's own fastest straight gait", ge=0
    )


class BeliefPlanner(InterceptPlanner):
    """The gaits of the least expected time of capture under both robots' distributions (paper, "theoretical solution").

    ``P(captured by t) = P(min over u <= t of |Hunter[u] - Prey[u]| <= reach)`` for every sequence of one
    or two gaits, at every part-way time t; ``E[time] = integral of 1 - P(captured by t) dt``, with the
    homing estimate of :class:`InterceptPlanner` beyond the second step, from each sampled end pose.

    Hunter: the forward model composed with itself, on sampled outcomes of each gait (in a model of structure
    "previous_gait" of each after the gait before it); part-way, an outcome departs from the gait's mean path in
    proportion to time. After the first step the hunter sees where it is, and the best second gait is taken from there:
    sqrt(S) first outcomes, as many second ones after each. Prey: S futures drawn from its turn table by systematic
    resampling, with the speed and direction noise of the hunter's own
    fastest straight gait. Sample s of the hunter meets sample s of the prey: one sum over S estimates
    the double integral over both distributions. ``rng`` picks the block of samples.

    Cost: S (G + G^2) P distances a decision (S = 64, G = 10, P = 13: 91,520), linear in S.
    Not exact: a standard error of at most about ``sqrt(p (1 - p) / sqrt(S))`` on each P(captured by t), less because
    samples are a Latin hypercube; captures between part-way times are missed; the three variables of an outcome are
    independent given the gait; turns happen half-way through a step; beyond two steps there is an estimate, not a
    distribution. ``plan.trace`` holds P(captured by t) of every node.
    """

    name = "belief"
    Settings = BeliefSettings
    settings: BeliefSettings

    def sample(self, model: ForwardModel) -> tuple[Samples, ...]:
        """Return the sets of samples."""
        given = self.settings
        return Samples.draw(
            model, given.turn_threshold, samples=given.samples, blocks=given.blocks, seed=given.bank_seed,
            prey_noise=given.prey_noise,
        )  # fmt: skip


#: The planner by the name that it is registered under.
belief = BeliefPlanner
