"""The searching hunter: intercepts what it believes in, and pays for not seeing it."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from bayeshunt.config.schema.camera import CameraSettings
from bayeshunt.core.geometry import FloatArray, Pose
from bayeshunt.core.protocols import Belief, MovingBelief
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.target.turns import TurnModel
from bayeshunt.perception.trackers.common import LEAST_RESULTANT
from bayeshunt.planners.api import Plan, Situation
from bayeshunt.planners.info import ROOM, PlannerInfo
from bayeshunt.planners.interception.futures import Futures
from bayeshunt.planners.interception.homing import Homing
from bayeshunt.planners.interception.intercept_walls import InterceptWallsPlanner, RoomSettings
from bayeshunt.planners.interception.lookahead import Charge, Outlook, PairPaths
from bayeshunt.planners.requests import check_request
from bayeshunt.planners.settings import Count, Number, planner_settings, setting
from bayeshunt.planners.uncertainty.obstructed import Obstructed
from bayeshunt.planners.uncertainty.opened import trace
from bayeshunt.planners.uncertainty.sampled import Start, going_away, sampled_futures
from bayeshunt.planners.uncertainty.sight import sight
from bayeshunt.planners.uncertainty.weighing import Price, Weighing

__all__ = ["SearchPlanner", "SearchSettings", "search"]


@planner_settings("search")
class SearchSettings(RoomSettings):
    """Settings of the interception hunter among walls, and what it costs not to see the prey."""

    samples: Count = setting(48, "futures drawn from the belief", ge=2)
    price: Number = setting(
        0.3,
        "what a future costs that is not seen: the time in which the hunter crosses, at top speed, this many times the "
        "distance between the prey in it and the middle of the unseen ones",
        ge=0,
    )
    most_price: Number = setting(12.0, "and at most so many seconds", ge=0)
    away: Number = setting(
        0.5,
        "until the prey's motion or heading was seen it is taken to go away from the hunter, which is the worst case, "
        "give or take so many radians",
        gt=0,
    )
    stuck: Number = setting(1.6, "what running into a known obstacle costs, in legs", ge=0)


class SearchPlanner(InterceptWallsPlanner):
    """Interception under uncertainty: plans on futures sampled from the belief, and pays for those it would not see.

    Every pair of gaits is valued in every sampled future, as the interception hunter does. A gait's way says in which
    futures the camera finds the prey in the first step, and what its looks then tell: futures that are nearer to each
    other, where it looks, than the camera's noise and the spread of both robots cannot be told apart. So the second
    gait is the best for what was seen, not for what is so. Futures in which nothing is seen share one second gait, and
    if they are not seen in the second step either, each pays a price.

    ``value(g) = sum_k P(k) s(g, k) min over g' of sum_j P(j | seen as k) T(g, g', j)
    + min over g' of sum_k P(k) (1 - s(g, k)) (T(g, g', k) + lost(k) (1 - s(g, g', k)))``

    T: expected time of capture [s]; s: probability of seeing the prey in the step; lost(k): ``price`` times the
    distance of future k from the middle of all, over the hunter's top speed. So nothing is paid where the prey is as
    good as known, and looking is worth most where the belief is spread out.

    A prey that was shown, but of whose heading and motion nothing was seen, may go anywhere; the decision is then taken
    for the worst case, that it goes away. The belief itself is not: what is then seen, or not, is weighed against all.

    Where the hunter has touched something inside its room, gaits that lead into it are stopped, and beyond the second
    one the way goes round it (:class:`~bayeshunt.planners.uncertainty.obstructed.Obstructed`). Walls are those of its
    room, if it has one; the prey's motion is what the belief has learned of it. Told the pose, it takes the futures of
    ``intercept_walls``. ``rng`` draws the samples. ``plan.trace`` has P(captured by t), P(in view) and the expected
    information of every node.
    """

    name = "search"
    info = PlannerInfo(prepare=ROOM)
    Settings = SearchSettings  # type: ignore[assignment]  # what its base takes, and more
    settings: SearchSettings

    def __init__(self, model: ForwardModel, settings: SearchSettings | None = None, **given: Any) -> None:
        chosen = SearchSettings(**given) if settings is None else settings
        super().__init__(model, replace(chosen, room=RoomModel.of(chosen.room)))
        obstacles = self.prey_obstacles()
        self.obstructed = None if obstacles is None else Obstructed.by(obstacles, self.settings.stuck * self.leg)

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Return the pair of gaits of the least expected time of capture, sight priced."""
        situation = check_request(situation, rng, self.hunter)
        pairs, futures = self.pairs_from(situation), self._futures(situation, rng)
        camera = situation.camera if isinstance(situation.camera, CameraSettings) else None
        width = self.body if camera is None else camera.target_width or self.body
        homing = replace(self.homing, reach=self.reach(situation))
        weighing = Weighing(
            pairs, futures, homing, self.spread, sight(pairs, camera, width, futures, self.spread),
            Price(self.settings.price, self.settings.most_price), self._round(situation, pairs, futures, homing),
        )  # fmt: skip
        outlook = weighing.outlook()
        values, pair_values = weighing.values(outlook)
        return self.best(
            values, pair_values, self.objective.replace(" [s]", ", sight priced [s]"),
            partial(trace, self.gaits, weighing, self.body), self.predicted(futures),
            prey_known=_seen_moving(situation),
        )  # fmt: skip

    def _round(self, situation: Situation, pairs: PairPaths, futures: Futures, homing: Homing) -> Charge | None:
        """Return what is charged beside the time: what stands in the way, and what else is weighed."""
        charge, obstructed, pose = self.charge(situation, pairs), self.obstructed, situation.pose
        if obstructed is None or pose is None:
            return charge

        def charged(outlook: Outlook) -> Outlook:
            found = obstructed.outlook(outlook, pairs, futures, pose, homing)
            return found if charge is None else charge(found)

        return charged

    def _futures(self, situation: Situation, rng: np.random.Generator) -> Futures:
        """Return those of the belief, or of the interception where the pose is told."""
        if situation.camera is not None or isinstance(situation.belief, MovingBelief):
            return self.sampled(situation, rng)
        return self.turning(situation) if situation.pose is None else self.futures(situation)

    def sampled(self, situation: Situation, rng: np.random.Generator) -> Futures:
        """Return equally weighted futures, drawn from the belief; without one, of the pose that is told."""
        belief = situation.belief
        own = Pose(0.0, 0.0, 0.0) if situation.pose is None else situation.pose
        count, known = self.settings.samples, self.prey(situation)
        if isinstance(belief, MovingBelief):
            if _only_shown(situation):
                pose, speed = going_away(belief, count, own, self.settings.away, rng)
            else:
                pose, speed = belief.sample_motion(count, rng=rng)
        else:
            one = own.compose(situation.prey)
            parts = belief.sample(count, rng=rng) if isinstance(belief, Belief) else one
            pose = Pose(*(np.broadcast_to(np.asarray(part, dtype=float), (count,)) for part in parts))
            speed = np.full(count, known.speed / self.leg)
        turn_at, turn = self._turns(belief, known, rng)
        return sampled_futures(Start(pose, speed, turn_at, turn), own, self.prey_walls())

    def _turns(self, belief: object, known: TurnModel, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
        """Return when each of K prey turns by chance [s from now], and by how much [rad, clockwise].

        A belief's motion counts by the time-step, what is ``known`` by the leg.
        """
        motion: Any = getattr(belief, "motion", None)
        counted, seconds = (known, self.leg) if motion is None else (motion, self.time_step)
        count, hazard = self.settings.samples, float(counted.hazard)
        turns, chances = counted.turn_table
        if not len(turns) or hazard <= 0.0:
            return np.full(count, np.inf), np.zeros(count)
        # Evenly spread over the distribution: with few samples chance alone would make every decision another one.
        level = (rng.permutation(count) + 0.5) / count
        steps = np.log1p(-level) / np.log1p(-min(hazard, 0.999))
        drawn = np.minimum(np.searchsorted(np.cumsum(chances), rng.random(count)), len(turns) - 1)
        return steps * seconds, turns[drawn]


def _seen_moving(situation: Situation) -> bool:
    """Whether anything of the prey's motion has been observed."""
    return bool(situation.transitions) or getattr(getattr(situation.belief, "motion", None), "steps", 0.0) > 0.0


def _only_shown(situation: Situation) -> bool:
    """Whether the prey has been seen, but neither its heading nor any motion of it."""
    belief = situation.belief
    if not isinstance(belief, Belief) or _seen_moving(situation):
        return False
    return math.isfinite(belief.last_seen) and belief.resultant < LEAST_RESULTANT


#: The planner by the name that it is registered under.
search = SearchPlanner
