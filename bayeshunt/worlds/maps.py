"""Maps: where a point is free, and what stands in a ray's way. Planners see them as ``bayeshunt.protocols.Map``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from bayeshunt.config.schema import ArenaSettings, ObstacleSettings
from bayeshunt.core.geometry import Pose
from bayeshunt.core.messages import Ray
from bayeshunt.core.protocols import Map

__all__ = ["ForBody", "Obstructed", "OpenMap", "Rectangle", "map_of"]


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


@dataclass(frozen=True)
class Obstructed:
    """A map in which obstacles stand. ground: the map without them."""

    ground: Map
    obstacles: Sequence[ObstacleSettings]

    @cached_property
    def solid(self) -> Any:
        """All obstacles as one shapely geometry, prepared for many questions."""
        import shapely

        whole = shapely.union_all([shapely.Polygon(obstacle.outline()) for obstacle in self.obstacles])
        shapely.prepare(whole)
        return whole

    def free(self, x: Any, y: Any) -> Any:
        """Whether a point is free: bool, or an array of them; the edge of an obstacle is."""
        import shapely

        outside = np.logical_not(shapely.contains_xy(self.solid, x, y)) & self.ground.free(x, y)
        return outside if np.ndim(outside) else bool(outside)

    def blocked(self, ray: Ray) -> bool:
        """Whether a wall or an obstacle stands between the two ends, or touches the line between them."""
        import shapely

        line = shapely.LineString([(ray.x, ray.y), (ray.to_x, ray.to_y)])
        return self.ground.blocked(ray) or bool(shapely.intersects(self.solid, line))


@dataclass(frozen=True)
class ForBody:
    """A map for the centre of a body of ``radius`` [m], in the frame in which it started at ``start``."""

    ground: Map
    start: Pose
    radius: float

    def free(self, x: Any, y: Any) -> Any:
        """Whether the body's centre can be at a point: bool, or an array of them; asked at twelve of its edge."""
        at_x, at_y = self._placed(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
        clear = np.asarray(self.ground.free(at_x, at_y))
        for turn in np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False):
            clear = clear & self.ground.free(at_x + self.radius * np.cos(turn), at_y + self.radius * np.sin(turn))
        return clear if np.ndim(clear) else bool(clear)

    def blocked(self, ray: Ray) -> bool:
        """Whether something stands in the way of the straight line."""
        begin, end = self._placed(ray.x, ray.y), self._placed(ray.to_x, ray.to_y)
        return self.ground.blocked(Ray(*begin, *end))

    def _placed(self, x: Any, y: Any) -> tuple[Any, Any]:
        cos, sin = np.cos(self.start.theta), np.sin(self.start.theta)
        return self.start.x + cos * x - sin * y, self.start.y + sin * x + cos * y


@lru_cache(maxsize=32)
def map_of(arena: ArenaSettings) -> Map:
    """Return the map of an arena: the same one for the same arena, whose obstacles are then united once."""
    ground: Map = Rectangle(arena.width, arena.height) if arena.walled else OpenMap()
    return Obstructed(ground, arena.obstacles) if arena.obstacles else ground
