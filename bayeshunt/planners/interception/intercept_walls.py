"""The interception hunter that knows the walls of its arena from having babbled there."""

from __future__ import annotations

import itertools
import os
from dataclasses import replace
from typing import Any

from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import Polar, Pose
from bayeshunt.models.arena.obstacles import TouchedObstacles
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.target.at_walls import AtWalls
from bayeshunt.models.target.turns import earlier_poses
from bayeshunt.planners.api import Situation
from bayeshunt.planners.info import ROOM, PlannerInfo
from bayeshunt.planners.interception.bouncing import Walls, rooms_futures, sliding_future
from bayeshunt.planners.interception.futures import NEGLIGIBLE, Futures, mix
from bayeshunt.planners.interception.guessing import completed, untouched_sides
from bayeshunt.planners.interception.turning import TurningPlanner, TurningSettings
from bayeshunt.planners.settings import File, Number, planner_settings, setting

__all__ = ["InterceptWallsPlanner", "RoomSettings", "intercept_walls"]


@planner_settings("intercept_walls")
class RoomSettings(TurningSettings):
    """Settings of an interception hunter, the room it is in, and what a prey does at a wall."""

    clearance: Number = setting(
        0.4,
        "body lengths that the prey's centre keeps from where the hunter's own centre is stopped, believed beforehand",
        ge=0,
    )
    room: File[RoomModel | str | os.PathLike[str] | None] = setting(
        None,
        "a RoomModel or the path of one (bayeshunt explore --out FILE) to use instead; learned in another run, "
        "so that its row is not ab initio",
    )


class InterceptWallsPlanner(TurningPlanner):
    """Interception with the prey's path followed from wall to wall, the walls learned by babbling in the arena.

    The hunter babbles alone in the arena before it hunts there, as it babbled to learn its own gaits:
    an evaluation and ``bayeshunt hunt`` do so first, in every arena. What it learns is where it was held
    up (:class:`~bayeshunt.models.arena.rooms.RoomModel`), nothing of any prey. In an arena without walls it
    finds none, and then it is the interception hunter with little fear of turns. It needs to know where
    it is: ``situation.pose``.

    After little babbling there may be sides on which it was not stopped yet. Where it has met walls, square to each
    other, the room is then taken to be a rectangle, its other walls about as far from the start as those
    (:mod:`~bayeshunt.planners.interception.guessing`).

    What a prey does at a wall is counted within the hunt (:meth:`at_walls`): whether it turns away, at which
    distance and angle, or keeps its heading and slides along; and whether it turns where there is no wall, in which
    case its futures are also those of a prey that turns by chance. Settings are what is believed before that.
    """

    name = "intercept_walls"
    info = PlannerInfo(needs=(ROOM,), prepare=ROOM)
    Settings = RoomSettings
    settings: RoomSettings

    def __init__(self, model: ForwardModel, settings: RoomSettings | None = None, **given: Any) -> None:
        super().__init__(model, settings, **given)
        chosen, room = self.settings, self.settings.room
        if room is None:
            raise InputError(
                "intercept_walls: needs a room, of the arena it hunts in: bayeshunt.learn_room(experiment, arena=...), "
                'or a file made by "bayeshunt explore --out FILE"'
            )
        self.room = RoomModel.of(room)
        body = model.gaits.need("body_length")
        #: Where a body of the hunter's size is stopped.
        self.walls = Walls.of(self.room)
        #: Sides of the room on which it was not stopped yet.
        self.untouched = untouched_sides(self.walls, self.room.space)
        self.habits = AtWalls(chosen.rebound, chosen.clearance * body)
        self.body = body

    def futures(self, situation: Situation) -> Futures:
        """Return the prey's paths among the walls, weighted by what it has done at walls so far."""
        if situation.pose is None:
            raise InputError(f"{self.name}: the situation must tell the hunter's own pose")
        legs = self.legs(situation)
        known = self.prior.learn(legs)
        if not (self.settings.prior or legs):
            return self.turning(situation, known)
        now = situation.pose.compose(situation.prey)
        habits = self._at_walls(now, legs, known.speed)
        speed = known.speed / self.leg
        kept = self._kept(habits)
        rooms = [(1.0, kept)]
        if self.untouched:
            rooms = completed(kept, self.untouched, habits.keeping_clear, [*earlier_poses(now, legs), now])
        _, turned = rooms_futures(situation.prey, situation.pose, rooms, speed, known.drift, self.leg)
        if turned is None:
            return self.turning(situation, known)
        stray = 1.0 - (1.0 - habits.hazard) ** self.settings.legs_ahead
        slides = (1.0 - stray) * habits.keeping
        parts = [(1.0 - stray - slides, turned)]
        if stray > NEGLIGIBLE:
            parts.append((stray, self.turning(situation, known)))
        if slides > NEGLIGIBLE and speed > 0 and self.walls.meet(now)[0] >= 0:
            parts.append((slides, sliding_future(situation.prey, situation.pose, self.walls, speed)))
        return mix(parts) if len(parts) > 1 else turned

    def own_walls(self) -> Walls:
        """Return the walls of the room."""
        return self.walls

    def prey_walls(self) -> Walls:
        """Return the walls as a prey turns away from them that has not been seen at one."""
        return self._kept(self.habits)

    def prey_obstacles(self) -> TouchedObstacles | None:
        """Return what the hunter has touched inside the room."""
        return self.room.obstacles()

    def at_walls(self, situation: Situation) -> AtWalls:
        """Return what the prey has done at walls, and away from them, in this hunt; its ``table()`` opens it."""
        if situation.pose is None:
            raise InputError(f"{self.name}: the situation must tell the hunter's own pose")
        legs = self.legs(situation)
        return self._at_walls(situation.pose.compose(situation.prey), legs, self.prior.learn(legs).speed)

    def _at_walls(self, now: Pose, legs: tuple[Polar, ...], run: float) -> AtWalls:
        """Count the legs that the prey, at ``now``, has come; ``run``: metres of a leg if it does not turn.

        A leg met a wall if the prey would end up more than its radius beyond where it turns away, and none if a whole
        body fits in between.
        """
        poses = [*earlier_poses(now, legs), now]
        walls = self.prey_walls()
        left: list[tuple[float, float]] = []
        kept = elsewhere = strays = 0
        for leg, (before, after) in zip(legs, itertools.pairwise(poses), strict=True):
            wall, gap = walls.meet(before)
            turned = abs(leg.heading) >= self.prior.threshold
            if gap + 0.5 * self.body < run:
                if turned:
                    left.append(self.walls.left(wall, before, after, run))
                kept += not turned
            elif gap > run + self.body:
                elsewhere, strays = elsewhere + 1, strays + turned
        wall, _ = self.walls.meet(now)
        # On its way into a wall, it is nearer to where it would be stopped than to where it would turn away.
        kept += wall >= 0 and -self.walls.beyond(wall, now) < 0.5 * self.habits.clearance
        rebounds, clearances = zip(*left, strict=True) if left else ((), ())
        return replace(
            self.habits, rebounds=rebounds, clearances=clearances, kept=kept, elsewhere=elsewhere, strays=strays
        )

    def _kept(self, habits: AtWalls) -> Walls:
        """Return the walls as a prey that turns away from them keeps clear of them."""
        return self.walls.kept(habits.keeping_clear, habits.leaving)


#: The planner by the name that it is registered under.
intercept_walls = InterceptWallsPlanner
