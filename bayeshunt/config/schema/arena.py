"""Where a hunt takes place."""

from __future__ import annotations

from pydantic import Field

from bayeshunt.config.schema.groups import Positive, Settings
from bayeshunt.config.schema.obstacles import ObstacleSettings

__all__ = ["ArenaSettings"]


class ArenaSettings(Settings):
    """The arena: open, or a walled rectangle centred on the origin; obstacles may stand in either."""

    walled: bool = Field(False, description="whether there are walls")
    width: Positive = Field(1.2, description="inner size along x [m]")
    height: Positive = Field(1.2, description="inner size along y [m]")
    in_bodies: bool = Field(False, description="whether its lengths are given in the hunter's body lengths")
    obstacles: tuple[ObstacleSettings, ...] = Field(
        (),
        description="discs (x, y, radius [m]) and rectangles (x, y, width, height [m], angle [rad]) that stand in it",
    )
