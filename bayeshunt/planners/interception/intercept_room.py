"""The interception hunter by the name under which it first guessed its room; ``intercept`` now does."""

from __future__ import annotations

from typing import ClassVar

from bayeshunt.planners.info import PlannerInfo
from bayeshunt.planners.interception.intercept import InterceptPlanner, InterceptSettings
from bayeshunt.planners.settings import planner_settings

__all__ = ["InterceptRoomPlanner", "RoomGuessSettings", "intercept_room"]


@planner_settings("intercept_room")
class RoomGuessSettings(InterceptSettings):
    """Settings of the interception hunter."""

    name: ClassVar[str] = "intercept_room"


class InterceptRoomPlanner(InterceptPlanner):
    """The same hunter as ``intercept``, which guesses the room it is in too: kept for those who name it."""

    name = "intercept_room"
    info = PlannerInfo(deprecated='write "intercept", the same hunter; it goes in 0.3')
    Settings = RoomGuessSettings


#: The planner by the name that it is registered under.
intercept_room = InterceptRoomPlanner
