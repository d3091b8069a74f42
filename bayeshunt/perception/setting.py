"""What a sensor or a tracker is made from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from bayeshunt.config.schema.camera import CameraSettings
from bayeshunt.core.geometry import Pose

if TYPE_CHECKING:
    from bayeshunt.models.target.turns import TurnModel

__all__ = ["KnownWalls", "PerceptionContext"]

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


@dataclass(frozen=True)
class PerceptionContext:
    """What perception may know beforehand.

    time_step: seconds that a gait is held. body_length, prey_length: metres; None: not known.
    origin: where the hunter starts, in the world's frame: the origin of its odometry.
    hunter, prey: what the world calls the two.
    camera: its settings, for a sensor or a tracker that has one; None: the defaults. start: "shown" or "unknown":
    whether a camera is shown the prey once at the start.
    motion: how the prey moves per time-step as far as the hunter can know before it has seen it; None: not known.
    walls: those that the hunter has learned of; None: none.
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
