"""The interception hunter that knows the walls of its arena from having babbled there."""

from __future__ import annotations

import os
from typing import Any

from bayeshunt.core.errors import InputError
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.api import Situation
from bayeshunt.planners.info import ROOM, PlannerInfo
from bayeshunt.planners.interception.bouncing import Walls, room_futures
from bayeshunt.planners.interception.futures import Futures
from bayeshunt.planners.interception.intercept import InterceptPlanner, InterceptSettings
from bayeshunt.planners.settings import File, Number, planner_settings, setting

__all__ = ["InterceptWallsPlanner", "RoomSettings", "intercept_walls"]


@planner_settings("intercept_walls")
class RoomSettings(InterceptSettings):
    """Settings of the interception hunter, the room it is in, and what a prey does at a wall."""

    hazard: Number = setting(
        0.02,
        "as for the interception hunter; a known arena leaves little reason for a turn where there is no wall",
        ge=0,
        le=1,
    )
    clearance: Number = setting(
        0.4, "body lengths that the prey's centre keeps from where the hunter's own centre is stopped", ge=0
    )
    rebound: Number = setting(
        0.5, "angle between a wall and the prey that has turned away from it, radians", ge=0, le=1.5
    )
    room: File[RoomModel | str | os.PathLike[str] | None] = setting(
        None,
        "a RoomModel or the path of one (bayeshunt explore --out FILE) to use instead; learned in another run, "
        "so that its row is not ab initio",
    )


class InterceptWallsPlanner(InterceptPlanner):
    """Interception with the prey's path followed from wall to wall, the walls learned by babbling in the arena.

    The hunter babbles alone in the arena before it hunts there, as it babbled to learn its own gaits:
    an evaluation and ``bayeshunt hunt`` do so first, in every arena. What it learns is where it was held
    up (:class:`~bayeshunt.models.arena.rooms.RoomModel`), nothing of any prey. In an arena without walls it
    finds none, and then it is the interception hunter with little fear of turns. It needs to know where
    it is: ``situation.pose``.
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
        self.room = room if isinstance(room, RoomModel) else RoomModel.load(room)
        keep = chosen.clearance * model.gaits.need("body_length")
        self.walls = Walls(
            tuple((float(x), float(y)) for x, y in self.room.normals),
            tuple(float(offset) - keep for offset in self.room.offsets),
            chosen.rebound,
        )

    def futures(self, situation: Situation) -> Futures:
        """Return the prey's paths among the walls."""
        if situation.pose is None:
            raise InputError(f"{self.name}: the situation must tell the hunter's own pose")
        known = self.prey(situation)
        if not (self.settings.prior or situation.transitions):
            return super().futures(situation)
        speed = known.speed / self.leg
        found = room_futures(situation.prey, situation.pose, self.walls, speed, known.drift, self.leg)
        return super().futures(situation) if found is None else found


#: The planner by the name that it is registered under.
intercept_walls = InterceptWallsPlanner
