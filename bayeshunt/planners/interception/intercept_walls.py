"""The interception hunter that knows the walls of its arena from having babbled there."""

from __future__ import annotations

import os
from dataclasses import dataclass, fields
from typing import Any

from bayeshunt.core.errors import InputError
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.api import Situation, known_length
from bayeshunt.planners.info import ROOM, PlannerInfo
from bayeshunt.planners.interception.bouncing import Walls, room_futures
from bayeshunt.planners.interception.futures import Futures
from bayeshunt.planners.interception.intercept import InterceptPlanner, InterceptSettings, check_number


@dataclass(frozen=True)
class RoomSettings(InterceptSettings):
    """Settings of the interception hunter, and of what a prey does at a wall.

    hazard: as for the interception hunter; a known arena leaves little reason for a turn where there is no wall.
    clearance: body lengths that the prey's centre keeps from where the hunter's own centre is stopped, >= 0.
    rebound: angle between a wall and the prey that has turned away from it, radians in [0, 1.5].
    """

    hazard: float = 0.02
    clearance: float = 0.4
    rebound: float = 0.5

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("clearance", self.clearance)
        check_number("rebound", self.rebound, most=1.5)


class InterceptWallsPlanner(InterceptPlanner):
    """Interception with the prey's path followed from wall to wall, the walls learned by babbling in the arena.

    The hunter babbles alone in the arena before it hunts there, as it babbled to learn its own gaits:
    an evaluation and ``bayeshunt hunt`` do so first, in every arena. What it learns is where it was held
    up (:class:`~bayeshunt.models.arena.rooms.RoomModel`), nothing of any prey. In an arena without walls it
    finds none, and then it is the interception hunter with little fear of turns. It needs to know where
    it is: ``situation.pose``.

    room: a RoomModel or the path of one (``bayeshunt explore --out FILE``) to use instead; learned in
    another run, so that its row is not ab initio.
    """

    name = "intercept_walls"
    info = PlannerInfo(needs=(ROOM,), prepare=ROOM)
    settings: RoomSettings

    def __init__(
        self, model: ForwardModel, settings: RoomSettings | None = None, *, room: RoomModel | str | os.PathLike[str]
    ) -> None:
        chosen = RoomSettings() if settings is None else settings
        super().__init__(model, chosen)
        self.room = room if isinstance(room, RoomModel) else RoomModel.load(room)
        keep = chosen.clearance * known_length(model.gaits.body_length, self.name)
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
        speed = known.speed / self.time_step
        found = room_futures(situation.prey, situation.pose, self.walls, speed, known.drift, self.time_step)
        return super().futures(situation) if found is None else found


def intercept_walls(
    model: ForwardModel, *, room: RoomModel | str | os.PathLike[str] | None = None, **settings: Any
) -> InterceptWallsPlanner:
    """Return an interception hunter for the arena that ``room`` was learned in.

    settings: fields of :class:`RoomSettings`. Raises InputError without a room.
    """
    if room is None:
        raise InputError(
            "intercept_walls: needs a room, of the arena it hunts in: bayeshunt.learn_room(experiment, arena=...), "
            'or a file made by "bayeshunt explore --out FILE"'
        )
    return InterceptWallsPlanner(model, RoomSettings(**settings), room=room)


#: Names of the settings that :func:`intercept_walls` takes.
SETTINGS = ("room", *(field.name for field in fields(RoomSettings)))
