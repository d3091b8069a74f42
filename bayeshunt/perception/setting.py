"""What a sensor or a tracker is made from."""

from __future__ import annotations

from dataclasses import dataclass

from bayeshunt.core.geometry import Pose

__all__ = ["PerceptionContext"]

_ORIGIN = Pose(0.0, 0.0, 0.0)


@dataclass(frozen=True)
class PerceptionContext:
    """What perception may know beforehand.

    time_step: seconds that a gait is held. body_length, prey_length: metres; None: not known.
    origin: where the hunter starts, in the world's frame: the origin of its odometry.
    hunter, prey: what the world calls the two.
    """

    time_step: float | None = None
    body_length: float | None = None
    prey_length: float | None = None
    origin: Pose = _ORIGIN
    hunter: str = "hunter"
    prey: str = "prey"
