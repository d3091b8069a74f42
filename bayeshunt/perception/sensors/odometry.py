"""Dead reckoning: where the hunter takes itself to be, from its own way, with the errors that such a count has."""

from __future__ import annotations

import numpy as np

from bayeshunt.config.schema.camera import CameraSettings
from bayeshunt.core.geometry import Pose, in_frame, wrap

__all__ = ["Odometry"]


class Odometry:
    """Adds up the hunter's way, every time-step with its own error of scale; exact where the errors are 0.

    origin: where it starts, in the world's frame. The errors are shares of the way and of the turn (standard
    deviations), drawn once a step: wheels that slip do so for a while.
    """

    def __init__(self, origin: Pose, camera: CameraSettings) -> None:
        self.origin = origin
        self.errors = (camera.distance_error, camera.turn_error)
        self._true: Pose | None = None
        self._told = Pose(0.0, 0.0, 0.0)
        self._scales = (1.0, 1.0)

    @property
    def exact(self) -> bool:
        """Whether it makes no error."""
        return self.errors == (0.0, 0.0)

    def begin_step(self, rng: np.random.Generator) -> None:
        """Draw the errors of a step; nothing is drawn where there are none."""
        if not self.exact:
            way, turn = rng.normal(0.0, self.errors)
            self._scales = (1.0 + float(way), 1.0 + float(turn))

    def follow(self, pose: Pose) -> Pose:
        """Return where the hunter takes itself to be when it is at ``pose`` [world]; call it in order of time."""
        now = in_frame(pose, self.origin)
        if self.exact:
            return now
        if self._true is not None:
            moved = self._true.relative(now)
            way, turn = self._scales
            step = moved._replace(distance=moved.distance * way, heading=wrap(moved.heading * turn))
            self._told = self._told.compose(step)
        self._true = now
        return Pose(*(float(part) for part in self._told))
