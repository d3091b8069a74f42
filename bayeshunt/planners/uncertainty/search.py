"""The searching hunter: intercepts what it believes in, and pays for not seeing it."""

from __future__ import annotations

import os
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from bayeshunt.config.schema.camera import CameraSettings
from bayeshunt.core.geometry import FloatArray, Pose
from bayeshunt.core.protocols import Belief, MovingBelief
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.tables.structures import depends_on_previous
from bayeshunt.models.target.turns import TurnModel
from bayeshunt.planners.api import Plan, Situation
from bayeshunt.planners.info import ROOM, PlannerInfo
from bayeshunt.planners.interception.bouncing import Walls
from bayeshunt.planners.interception.futures import Futures
from bayeshunt.planners.interception.turning import TurningPlanner, TurningSettings
from bayeshunt.planners.requests import check_request
from bayeshunt.planners.settings import Count, File, Number, planner_settings, setting
from bayeshunt.planners.uncertainty.opened import trace
from bayeshunt.planners.uncertainty.sampled import Start, sampled_futures
from bayeshunt.planners.uncertainty.sight import Looks
from bayeshunt.planners.uncertainty.weighing import Price, Weighing

__all__ = ["SearchPlanner", "SearchSettings", "search"]


@planner_settings("search")
class SearchSettings(TurningSettings):
    """Settings of the interception hunter, and what it costs not to see the prey."""

    hazard: Number = setting(
        0.02,
        "as for the interception hunter; a known arena leaves little reason for a turn where there is no wall",
        ge=0,
        le=1,
    )
    samples: Count = setting(48, "futures drawn from the belief", ge=2)
    price: Number = setting(
        0.3,
        "what a future costs that is not seen: the time in which the hunter crosses, at top speed, this many times the "
        "distance between the prey in it and the middle of the unseen ones",
        ge=0,
    )
    most_price: Number = setting(12.0, "and at most so many seconds", ge=0)
    clearance: Number = setting(
        0.4, "body lengths that the prey's centre keeps from where the hunter's own centre is stopped", ge=0
    )
    rebound: Number = setting(
        0.5, "angle between a wall and the prey that has turned away from it, radians", ge=0, le=1.5
    )
    room: File[RoomModel | str | os.PathLike[str] | None] = setting(
        None,
        "a RoomModel or the path of one (bayeshunt explore --out FILE) to use instead; learned in another run, "
        "so the planner is then marked *",
    )


class SearchPlanner(TurningPlanner):
    """Interception under uncertainty: plans on futures sampled from the belief, and pays for those it would not see.

    Every pair of gaits is valued in every sampled future, as the interception hunter does. A gait's way says which
    futures the camera would see in the first step. Those get the second gait that is best for each of them; the others
    cannot be told apart, share one, and if they are not seen in the second step either, each pays a price.

    ``value(g) = sum_k P(k) s(g, k) min over g' of T(g, g', k)
    + min over g' of sum_k P(k) (1 - s(g, k)) (T(g, g', k) + lost(k) (1 - s(g, g', k)))``

    T: expected time of capture [s]; s: probability of seeing the prey in the step; lost(k): ``price`` times the
    distance of future k from the middle of all, over the hunter's top speed. So nothing is paid where the prey is as
    good as known, and looking is worth most where the belief is spread out: without a camera, or with one that sees all
    round, this is interception averaged over the belief.

    With exact sensing the belief is one pose. Walls are those of its room, if it has one; the prey's motion is what the
    belief has learned of it. ``rng`` draws the samples. ``plan.trace`` has P(captured by t), P(in view) and the
    expected information of every node.
    """

    name = "search"
    info = PlannerInfo(prepare=ROOM)
    Settings = SearchSettings
    settings: SearchSettings

    def __init__(self, model: ForwardModel, settings: SearchSettings | None = None, **given: Any) -> None:
        super().__init__(model, settings, **given)
        chosen, room = self.settings, self.settings.room
        self.room = room if room is None or isinstance(room, RoomModel) else RoomModel.load(room)
        self.body = model.gaits.need("body_length")
        keep = chosen.clearance * self.body
        self.walls = Walls((), (), chosen.rebound)
        if self.room is not None:
            self.walls = Walls(
                tuple((float(x), float(y)) for x, y in self.room.normals),
                tuple(float(offset) - keep for offset in self.room.offsets),
                chosen.rebound,
            )
        after = self.gaits if depends_on_previous(model.structure) else ()
        self.looks = Looks.of(model)
        self.looks_after = {gait: Looks.of(model, gait) for gait in after}

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Return the pair of gaits of the least expected time of capture, sight priced."""
        situation = check_request(situation, rng, self.hunter)
        futures = self.sampled(situation, rng)
        camera = situation.camera if isinstance(situation.camera, CameraSettings) else None
        looks = self.looks_after.get(situation.previous_gait or "", self.looks)
        reach = float("inf") if camera is None else camera.reach(camera.target_width or self.body)
        weighing = Weighing(
            self.pairs_from(situation), futures, replace(self.homing, reach=self.reach(situation)), self.spread,
            looks.sight(camera, reach, futures), Price(self.settings.price, self.settings.most_price),
        )  # fmt: skip
        outlook = weighing.outlook()
        values, pair_values = weighing.values(outlook)
        first = int(values.argmin())
        second = int(pair_values[first].argmin())
        return Plan(
            gait=self.gaits[first],
            gaits=(self.gaits[first], self.gaits[second]),
            value=float(values[first]),
            objective="expected time to the capture, sight priced [s]",
            nodes=1 + len(values) + pair_values.size,
            make_trace=partial(trace, self.gaits, weighing, self.body),
            expansions=1 + len(values),
            prey_known=_seen_moving(situation),
            predicted_prey=futures.likeliest(np.array([1.0, 2.0]) * self.time_step),
        )

    def sampled(self, situation: Situation, rng: np.random.Generator) -> Futures:
        """Return equally weighted futures, drawn from the belief; without one, of the pose that is told."""
        count = self.settings.samples
        own = Pose(0.0, 0.0, 0.0) if situation.pose is None else situation.pose
        belief, known = situation.belief, self.prey(situation)
        if isinstance(belief, MovingBelief):
            pose, speed = belief.sample_motion(count, rng=rng)
        else:
            one = own.compose(situation.prey)
            parts = belief.sample(count, rng=rng) if isinstance(belief, Belief) else one
            pose = Pose(*(np.broadcast_to(np.asarray(part, dtype=float), (count,)) for part in parts))
            speed = np.full(count, known.speed / self.time_step)
        turn_at, turn = _turns(belief, known, count, self.time_step, rng)
        return sampled_futures(Start(pose, speed, turn_at, turn), own, self.walls)


def _seen_moving(situation: Situation) -> bool:
    """Whether anything of the prey's motion has been observed."""
    return bool(situation.transitions) or getattr(getattr(situation.belief, "motion", None), "steps", 0.0) > 0.0


def _turns(
    belief: object, known: TurnModel, count: int, step: float, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    """Return when each of K prey turns by chance [s from now], and by how much [rad, clockwise]."""
    motion: Any = getattr(belief, "motion", None)
    hazard = float(known.hazard if motion is None else motion.hazard)
    turns, chances = known.turn_table if motion is None else motion.turn_table()
    if not len(turns) or hazard <= 0.0:
        return np.full(count, np.inf), np.zeros(count)
    # Evenly spread over the distribution: with few samples chance alone would make every decision another one.
    level = (rng.permutation(count) + 0.5) / count
    steps = np.log1p(-level) / np.log1p(-min(hazard, 0.999))
    drawn = np.minimum(np.searchsorted(np.cumsum(chances), rng.random(count)), len(turns) - 1)
    return steps * step, turns[drawn]


#: The planner by the name that it is registered under.
search = SearchPlanner
