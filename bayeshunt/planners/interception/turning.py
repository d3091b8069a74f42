"""What interception hunters share: own motion, a prey that may turn, the earliest expected capture."""

from __future__ import annotations

import math
from dataclasses import replace
from statistics import NormalDist
from typing import Any, ClassVar

import numpy as np

from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import Polar
from bayeshunt.core.task import CATCH_BODIES
from bayeshunt.models.arena.obstacles import TouchedObstacles
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.target.turns import OwnMotion, TurnModel, in_legs
from bayeshunt.planners.api import Plan, Situation
from bayeshunt.planners.cost import Weighed
from bayeshunt.planners.interception.bouncing import Walls
from bayeshunt.planners.interception.futures import NEGLIGIBLE, Futures, turning_futures
from bayeshunt.planners.interception.homing import CHASE_SHARE, Homing
from bayeshunt.planners.interception.lookahead import PairPaths
from bayeshunt.planners.interception.pairs import PairPlanner
from bayeshunt.planners.interception.sampling import Samples
from bayeshunt.planners.requests import catch_distance, check_request
from bayeshunt.planners.settings import Count, Number, Switch, planner_settings, setting

__all__ = ["TurningPlanner", "TurningSettings"]

#: A change of heading is a turn if wandering, of which this is so many standard deviations, is too improbable.
_WANDER = NormalDist().inv_cdf(1.0 - NEGLIGIBLE)


@planner_settings("interception")
class TurningSettings(Weighed):
    """Settings of the interception hunter; the constants were chosen on seeds that no result is reported on."""

    catch_distance: Number | None = setting(
        None, "body lengths between the centres that count as a capture; by default what the experiment says", gt=0
    )
    spread: Number = setting(
        0.1, "body lengths about catch_distance over which the chance of a capture falls from 1 to 0", gt=0
    )
    heading_price: Number = setting(
        1.0,
        "what turning towards the prey costs beyond the lookahead, in legs per softest full-speed turn",
        ge=0,
    )
    leg: Number = setting(
        3.4,
        "body lengths at top speed over which motions are compared, by the nearest number of time-steps: hazard, turns "
        "and prices are per such leg",
        gt=0,
    )
    prior: Switch = setting(
        True, 'before anything is seen, "it moves nearly as fast as I do" (True), or the prey stands still (False)'
    )
    prior_speed: Number = setting(
        CHASE_SHARE, "that speed, as a share of the hunter's own top speed; a prey that can be caught is slower", gt=0
    )
    hazard: Number = setting(
        0.02,
        "chance per leg that the prey turns for no reason known, believed beforehand; 0: it never turns",
        ge=0,
        le=1,
    )
    hazard_steps: Number = setting(4.0, "how many observed legs that belief is worth", gt=0)
    turn_weight: Number = setting(
        0.5, "how many observed turns the hunter's own turns are worth as a guess at the prey's", gt=0
    )
    turn_threshold: Number = setting(
        0.4, "the least heading change per leg [rad] that is a turn, if it is beyond the hunter's own wandering", gt=0
    )
    rebound: Number = setting(
        0.5,
        "angle between a wall and the prey that has turned away from it, radians, believed beforehand",
        ge=0,
        le=1.5,
    )
    turn_steps: Count | None = setting(
        None,
        "legs ahead in which a turn of the prey is considered; by default as many as hazard_steps, a part counts whole",
        ge=0,
    )

    @property
    def legs_ahead(self) -> int:
        """Legs ahead in which a turn of the prey is considered."""
        return math.ceil(self.hazard_steps) if self.turn_steps is None else self.turn_steps


class TurningPlanner(PairPlanner):
    """Chooses the pair of gaits of the earliest expected capture of a prey that turns by chance."""

    Settings: ClassVar[type[TurningSettings]] = TurningSettings

    def __init__(self, model: ForwardModel, settings: TurningSettings | None = None, **given: Any) -> None:
        self.settings = chosen = self.Settings(**given) if settings is None else settings
        step, body = model.gaits.need("duration"), model.gaits.need("body_length")
        fastest = OwnMotion.of(model, chosen.turn_threshold).top_speed
        if not fastest > 0:
            raise InputError(f"{self.name}: no gait of the forward model moves the hunter")
        steps = max(1, round(chosen.leg * body / fastest))
        own = OwnMotion.of(model, chosen.turn_threshold, steps)
        price = chosen.heading_price * steps * step / own.softest_turn
        reach = (CATCH_BODIES if chosen.catch_distance is None else chosen.catch_distance) * body
        super().__init__(model, Homing(own.top_speed / (steps * step), reach, price), chosen.spread * body, chosen.cost)
        #: Time-steps, and seconds, in which the prey's motion is counted.
        self.steps, self.leg = steps, steps * step
        self.prior = TurnModel(
            prior_speed=chosen.prior_speed * own.top_speed,
            prior_turns=own.turns,
            prior_hazard=chosen.hazard,
            prior_steps=chosen.hazard_steps,
            turn_weight=chosen.turn_weight,
            threshold=max(chosen.turn_threshold, _WANDER * own.drift),
            prior_drift=own.drift,
        )
        #: The same belief per time-step, as trackers count; a turn is as far, however short the steps. What the hunter
        #: wanders by is that of its own speed, and a slower prey wanders less.
        self.step_prior = _per_step(replace(self.prior, prior_drift=chosen.prior_speed * own.drift), steps)
        #: Sets of samples of both robots' motion, of which each decision picks one; none: decided along mean paths.
        self.samples = self.sample(model)

    def sample(self, model: ForwardModel) -> tuple[Samples, ...]:
        """Return sets of samples where the hunter's own wandering would hide a turn, elsewhere none.

        None either of a model in which a gait depends on the one before.
        """
        hides = self.prior.threshold > self.settings.turn_threshold
        return Samples.draw(model, self.settings.turn_threshold) if hides and not self.pairs_after else ()

    def legs(self, situation: Situation) -> tuple[Polar, ...]:
        """Return the transitions seen so far, over a leg each."""
        return in_legs(situation.transitions, self.steps)

    def prey(self, situation: Situation) -> TurnModel:
        """Return what is known of the prey, per leg: the prior and the transitions seen so far."""
        return self.prior.learn(self.legs(situation))

    def prey_walls(self) -> Walls | None:
        """Return the walls that the prey's centre is believed not to leave, in the frame of the start; None: none."""
        return None

    def prey_obstacles(self) -> TouchedObstacles | None:
        """Return what is known to stand in the arena, in the frame of the start; None: nothing."""
        return None

    def turning(self, situation: Situation, known: TurnModel | None = None) -> Futures:
        """Return the weighted futures of a prey that turns by chance, as the hunter sees them now.

        known: what :meth:`prey` returns, where that has been asked already.
        """
        known = self.prey(situation) if known is None else known
        futures = turning_futures(situation.prey, known, self.leg, self.settings.legs_ahead)
        return futures if self.settings.prior or situation.transitions else futures.standing_still()

    def futures(self, situation: Situation) -> Futures:
        """Return the prey's weighted futures that the decision is taken over."""
        return self.turning(situation)

    def reach(self, situation: Situation) -> float:
        """Return the distance between the centres that is a capture [m]."""
        return catch_distance(situation, self.settings.catch_distance)

    def ahead(
        self, situation: Situation, futures: Futures, rng: np.random.Generator
    ) -> tuple[PairPaths, Futures, float]:
        """Return the hunter's paths, the prey's ``futures``, and the spread [m] between them that a decision is over.

        Along mean paths, or with one of the sets of samples, which has its spread in it; ``rng`` picks it.
        """
        if not self.samples:
            return self.pairs_from(situation), futures, self.spread
        samples = self.samples[int(rng.integers(len(self.samples)))]
        return samples.after(situation.previous_gait), samples.futures(futures), 0.0

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Return the pair of gaits of the earliest expected capture."""
        situation = check_request(situation, rng, self.hunter)
        return self.choose(situation, *self.ahead(situation, self.futures(situation), rng))


def _per_step(leg: TurnModel, steps: int) -> TurnModel:
    """Return what is believed of a leg of so many time-steps, of one of them: the same prey in the same time."""
    if steps == 1:
        return leg
    return replace(
        leg,
        prior_speed=leg.prior_speed / steps,
        prior_hazard=1.0 - (1.0 - leg.prior_hazard) ** (1.0 / steps),
        prior_steps=leg.prior_steps * steps,
        prior_drift=leg.prior_drift / math.sqrt(steps),
    )
