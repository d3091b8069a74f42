"""What stands in an arena: rectangles and discs."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field, model_validator

from bayeshunt.config.schema.groups import Finite, Positive, Settings
from bayeshunt.core.checks import FULL_TURN, beyond_a_turn

__all__ = ["ObstacleSettings"]

#: Corners of the polygon that a disc is drawn and mapped as; its sides are within 0.2 % of the radius.
_CORNERS = 64


class ObstacleSettings(Settings):
    """One obstacle: a disc, by its radius, or a rectangle, by its width and height; it never moves."""

    x: Finite = Field(description="of its centre, in the arena's frame [m]")
    y: Finite = Field(description="of its centre, in the arena's frame [m]")
    radius: Positive | None = Field(None, description="of a disc [m]")
    width: Positive | None = Field(None, description="of a rectangle, along its own x [m]")
    height: Positive | None = Field(None, description="of a rectangle, along its own y [m]")
    angle: Annotated[float, Field(allow_inf_nan=False)] = Field(
        0.0, description="by which a rectangle is turned, counter-clockwise [rad]"
    )

    @model_validator(mode="after")
    def _one_form(self) -> ObstacleSettings:
        disc, sides = self.radius is not None, (self.width is not None, self.height is not None)
        if disc == any(sides) or (not disc and not all(sides)):
            raise ValueError("an obstacle is a disc (radius) or a rectangle (width and height); give one of the two")
        if abs(self.angle) > FULL_TURN:
            raise ValueError(f"angle: {beyond_a_turn(self.angle)}")
        return self

    @property
    def reach(self) -> float:
        """Metres from its centre to its farthest point."""
        return self.radius if self.radius is not None else 0.5 * math.hypot(*self.sides)

    @property
    def sides(self) -> tuple[float, float]:
        """Width and height of a rectangle [m]; those of the square around a disc."""
        if self.radius is not None:
            return 2.0 * self.radius, 2.0 * self.radius
        assert self.width is not None
        assert self.height is not None
        return self.width, self.height

    def gap(self, x: float, y: float) -> float:
        """Return the metres from a point to the obstacle, 0 inside it."""
        dx, dy = x - self.x, y - self.y
        if self.radius is not None:
            return max(0.0, math.hypot(dx, dy) - self.radius)
        cos, sin = math.cos(self.angle), math.sin(self.angle)
        along, across = abs(cos * dx + sin * dy), abs(cos * dy - sin * dx)
        width, height = self.sides
        return math.hypot(max(0.0, along - 0.5 * width), max(0.0, across - 0.5 * height))

    def outline(self) -> list[tuple[float, float]]:
        """Return its corners counter-clockwise [m]; a disc as a polygon of 64."""
        if self.radius is not None:
            turns = (2.0 * math.pi * n / _CORNERS for n in range(_CORNERS))
            return [(self.x + self.radius * math.cos(a), self.y + self.radius * math.sin(a)) for a in turns]
        cos, sin = math.cos(self.angle), math.sin(self.angle)
        a, b = (0.5 * side for side in self.sides)
        corners = ((a, b), (-a, b), (-a, -b), (a, -b))
        return [(self.x + cos * u - sin * v, self.y + sin * u + cos * v) for u, v in corners]
