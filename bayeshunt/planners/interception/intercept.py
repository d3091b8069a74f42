"""The interception hunter: the gait that leads to the earliest expected capture."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from bayeshunt.core.errors import InputError
from bayeshunt.core.task import CATCH_BODIES
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.target.turns import OwnMotion, TurnModel, in_legs
from bayeshunt.planners.api import Plan, Situation
from bayeshunt.planners.interception.futures import Futures, turning_futures
from bayeshunt.planners.interception.homing import Homing
from bayeshunt.planners.interception.pairs import PairPlanner
from bayeshunt.planners.requests import catch_distance, check_request
from bayeshunt.planners.settings import Count, Number, Switch, planner_settings, setting

__all__ = ["InterceptPlanner", "InterceptSettings", "intercept"]


@planner_settings("intercept")
class InterceptSettings:
    """Settings of the interception hunter; the constants were chosen on seeds that no result is reported on."""

    catch_distance: Number | None = setting(
        None, "body lengths between the centres that count as a capture; by default what the experiment says", gt=0
    )
    spread: Number = setting(
        0.1, "body lengths about catch_distance over which the chance of a capture falls from 1 to 0", gt=0
    )
    heading_price: Number = setting(
        1.0,
        "what turning towards the prey costs beyond the lookahead, in time-steps per softest full-speed turn",
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
        0.9, "that speed, as a share of the hunter's own top speed; a prey that can be caught is slower", gt=0
    )
    hazard: Number = setting(
        0.1, "chance per time-step that the prey turns, believed beforehand; 0: it never turns", ge=0, le=1
    )
    hazard_steps: Number = setting(4.0, "how many observed time-steps that belief is worth", gt=0)
    turn_weight: Number = setting(
        0.5, "how many observed turns the hunter's own turns are worth as a guess at the prey's", gt=0
    )
    turn_threshold: Number = setting(0.4, "a heading change per time-step [rad] from which a motion is a turn", gt=0)
    turn_steps: Count = setting(4, "time-steps ahead in which a turn of the prey is considered", ge=0)


class InterceptPlanner(PairPlanner):
    """Minimises the expected time of the first capture, not the distance at a step's end.

    1. The hunter: the babbled mean part-way poses of every pair of gaits, composed once; in a model of
       structure "previous_gait" each those after the gait before it.
    2. The prey: weighted futures from a :class:`TurnModel` that is learned from the transitions of
       this hunt: straight on, or one turn in one of the next steps. Its priors come from the hunter's
       own forward model: the prey goes nearly as fast as the fastest straight gait, wanders as that
       does, and turns by what the hunter's own gaits turn by.
    3. Both steps: P(captured by t) at every part-way pose, hence the expected time of capture.
    4. Beyond them: the time in which the hunter, heading straight for the meeting point at top speed,
       would meet the prey, and a price for the turns that this takes (:class:`Homing`).
    5. The second gait may depend on whether the prey was seen to turn in the first step.

    Everything is learned by babbling and within the hunt; ``rng`` is not used.
    """

    name = "intercept"
    Settings: ClassVar[type[InterceptSettings]] = InterceptSettings

    def __init__(self, model: ForwardModel, settings: InterceptSettings | None = None, **given: Any) -> None:
        self.settings = chosen = self.Settings(**given) if settings is None else settings
        step, body = model.gaits.need("duration"), model.gaits.need("body_length")
        fastest = OwnMotion.of(model, chosen.turn_threshold).top_speed
        if not fastest > 0:
            raise InputError(f"{self.name}: no gait of the forward model moves the hunter")
        steps = max(1, round(chosen.leg * body / fastest))
        own = OwnMotion.of(model, chosen.turn_threshold, steps)
        price = chosen.heading_price * steps * step / own.softest_turn
        reach = (CATCH_BODIES if chosen.catch_distance is None else chosen.catch_distance) * body
        super().__init__(model, Homing(own.top_speed / (steps * step), reach, price), chosen.spread * body)
        #: Time-steps, and seconds, in which the prey's motion is counted.
        self.steps, self.leg = steps, steps * step
        self.prior = TurnModel(
            prior_speed=chosen.prior_speed * own.top_speed,
            prior_turns=own.turns,
            prior_hazard=chosen.hazard,
            prior_steps=chosen.hazard_steps,
            turn_weight=chosen.turn_weight,
            threshold=chosen.turn_threshold,
            prior_drift=own.drift,
        )

    def prey(self, situation: Situation) -> TurnModel:
        """Return what is known of the prey: the prior and the transitions seen so far."""
        return self.prior.learn(in_legs(situation.transitions, self.steps))

    def futures(self, situation: Situation) -> Futures:
        """Return the prey's weighted futures, as the hunter sees them now."""
        known = self.prey(situation)
        futures = turning_futures(situation.prey, known, self.leg, self.settings.turn_steps)
        return futures if self.settings.prior or situation.transitions else futures.standing_still()

    def reach(self, situation: Situation) -> float:
        """Return the distance between the centres that is a capture [m]."""
        return catch_distance(situation, self.settings.catch_distance)

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Return the pair of gaits of the earliest expected capture."""
        situation = check_request(situation, rng, self.hunter)
        return self.choose(situation, self.pairs_from(situation), self.futures(situation))


#: The planner by the name that it is registered under.
intercept = InterceptPlanner
