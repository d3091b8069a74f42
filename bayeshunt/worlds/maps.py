"""Maps: where a point is free, and what stands in a ray's way. Planners see them as ``bayeshunt.protocols.Map``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from bayeshunt.config.schema import ArenaSettings
from bayeshunt.core.messages import Ray
from bayeshunt.core.protocols import Map

__all__ = ["OpenMap", "Rectangle", "map_of"]


class OpenMap:
    """A plane without walls."""

    def free(self, x: Any, y: Any) -> Any:
        """True everywhere: bool, or an array of them."""
        everywhere = np.ones(np.broadcast(x, y).shape, dtype=bool)
        return everywhere if everywhere.ndim else True

    def blocked(self, ray: Ray) -> bool:
        """Nothing stands in any way."""
        return False

    def __repr__(self) -> str:
        return "<OpenMap: no walls>"


@dataclass(frozen=True)
class Rectangle:
    """Four walls around a rectangle centred on the origin; width along x, height along y [m], inside."""

    width: float
    height: float

    def free(self, x: Any, y: Any) -> Any:
        """Whether a point is inside the walls: bool, or an array of them; their inner edge is free."""
        inside = (np.abs(x) <= 0.5 * self.width) & (np.abs(y) <= 0.5 * self.height)
        return inside if np.ndim(inside) else bool(inside)

    def blocked(self, ray: Ray) -> bool:
        """Whether a wall stands between the two ends: a rectangle is convex, so unless both ends are inside."""
        return not (self.free(ray.x, ray.y) and self.free(ray.to_x, ray.to_y))


def map_of(arena: ArenaSettings) -> Map:
    """Return the map of an arena."""
    return Rectangle(arena.width, arena.height) if arena.walled else OpenMap()
