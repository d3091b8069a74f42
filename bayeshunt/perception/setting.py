"""What a sensor or a tracker is made from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from bayeshunt.config.schema.camera import CameraSettings
from bayeshunt.core.geometry import FloatArray, Pose

if TYPE_CHECKING:
    from bayeshunt.models.target.turns import TurnModel

__all__ = ["KnownObstacles", "KnownWalls", "PerceptionContext"]

_ORIGIN = Pose(0.0, 0.0, 0.0)


class KnownWalls(Protocol):
    """Half-planes ``nx x + ny y <= offset`` [m] that a prey's centre does not leave, in the odometry frame.

    rebound: angle between a wall and the prey that has turned away from it [rad].
    """

    @property
    def normals(self) -> Sequence[tuple[float, float]]:
        """Unit vectors towards the walls."""

    @property
    def offsets(self) -> Sequence[float]:
        """Metres from the origin."""

    @property
    def rebound(self) -> float:
        """Angle between a wall and the prey that has turned away from it [rad]."""


class KnownObstacles(Protocol):
    """What stands in the arena, in the odometry frame: no prey is in it, and none is seen behind it."""

    def inside(self, x: FloatArray, y: FloatArray) -> np.ndarray:
        """Return whether points [m] lie in an obstacle: bool in the shape of ``x``."""

    def met(self, from_x: FloatArray, from_y: FloatArray, x: FloatArray, y: FloatArray) -> np.ndarray:
        """Return whether ways from points [m, N] to points [N] lead into an obstacle: bool [N].

        One that starts in an obstacle leads out of it.
        """

    def hidden(self, from_x: float, from_y: float, x: FloatArray, y: FloatArray) -> np.ndarray:
        """Return whether an obstacle lies between a point [m] and the points [N]: bool [N]."""


@dataclass(frozen=True)
class PerceptionContext:
    """What perception may know beforehand.

    time_step: seconds that a gait is held. body_length, prey_length: metres; None: not known.
    origin: where the hunter starts, in the world's frame: the origin of its odometry.
    hunter, prey: what the world calls the two.
    camera: its settings, for a sensor or a tracker that has one; None: the defaults. start: "shown" or "unknown":
    whether a camera is shown the prey once at the start.
    motion: how the prey moves per time-step as far as the hunter can know before it has seen it; None: not known.
    walls, obstacles: those that the hunter has learned of; None: none.
    """

    time_step: float | None = None
    body_length: float | None = None
    prey_length: float | None = None
    origin: Pose = _ORIGIN
    hunter: str = "hunter"
    prey: str = "prey"
    camera: CameraSettings | None = None
    start: str = "shown"
    motion: TurnModel | None = None
    walls: KnownWalls | None = None
    obstacles: KnownObstacles | None = None

    @property
    def own_camera(self) -> CameraSettings:
        """The camera's settings: the defaults where none are given."""
        return CameraSettings() if self.camera is None else self.camera

    @property
    def target_width(self) -> float:
        """Width of the prey [m]: the camera's setting, or else its body's, the hunter's, a Khepera's."""
        return self.own_camera.target_width or self.prey_length or self.body_length or _KHEPERA


#: Metres, of a hunter and a prey of which nothing is known.
_KHEPERA = 0.057
