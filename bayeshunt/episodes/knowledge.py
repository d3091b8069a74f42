"""What a planner has learned that a belief may rest on as well: how prey move, and where walls are."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from bayeshunt.perception.setting import KnownWalls
from bayeshunt.planners.api import Planner
from bayeshunt.planners.asking import Timed

if TYPE_CHECKING:
    from bayeshunt.models.target.turns import TurnModel

__all__ = ["NOTHING", "Knowledge", "known_to"]


class Knowledge(NamedTuple):
    """What is believed of how the prey moves before it was seen, per time-step, and the walls; None: nothing."""

    motion: TurnModel | None = None
    walls: KnownWalls | None = None


NOTHING = Knowledge()


def known_to(planner: Planner) -> Knowledge:
    """Return what a planner knows: of those that intercept, what they take a prey to do, and the walls of the arena."""
    from bayeshunt.planners.interception.turning import TurningPlanner  # brings models, and pandas

    planner = planner.planner if isinstance(planner, Timed) else planner
    return Knowledge(planner.step_prior, planner.prey_walls()) if isinstance(planner, TurningPlanner) else NOTHING
