"""The prey's paths in a room that is known."""

from __future__ import annotations

from typing import Any

from bayeshunt.core.geometry import Polar, Pose
from bayeshunt.planners.interception.bouncing import Walls, rooms_futures
from bayeshunt.planners.interception.futures import Futures

__all__ = ["room_futures"]


def room_futures(prey: Polar, pose: Pose, walls: Walls, *prey_moves: float, **how: Any) -> Futures | None:
    """The paths of ``rooms_futures`` in one room; None if there is no wall ahead of the prey."""
    return rooms_futures(prey, pose, [(1.0, walls)], *prey_moves, **how)[1]
