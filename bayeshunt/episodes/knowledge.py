"""What a planner has learned that a belief may rest on as well: how prey move, and where walls and obstacles are."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from bayeshunt.perception.setting import KnownObstacles, KnownWalls
from bayeshunt.planners.api import Planner
from bayeshunt.planners.asking import Timed

if TYPE_CHECKING:
    from bayeshunt.models.target.turns import TurnModel

__all__ = ["NOTHING", "Knowledge", "known_to"]


class Knowledge(NamedTuple):
    """What is believed of how the prey moves before it was seen, per time-step, walls, obstacles; None: nothing."""

    motion: TurnModel | None = None
    walls: KnownWalls | None = None
    obstacles: KnownObstacles | None = None


NOTHING = Knowledge()


def known_to(planner: Planner) -> Knowledge:
    """Return what a planner knows: of those that intercept, what they take a prey to do, and what of the arena."""
    from bayeshunt.planners.interception.turning import TurningPlanner  # brings models, and pandas

    planner = planner.planner if isinstance(planner, Timed) else planner
    if not isinstance(planner, TurningPlanner):
        return NOTHING
    return Knowledge(planner.step_prior, planner.prey_walls(), planner.prey_obstacles())
