"""The messages that travel the road: what a world did, what a sensor saw of it.

SI units; poses counter-clockwise in one fixed frame, what is seen from a robot (:class:`Detection`) clockwise from its
heading. The odometry frame is the one in which the hunter started at (0, 0, 0).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from bayeshunt.core.geometry import Polar, Pose

__all__ = ["Detection", "Frame", "Moment", "Observation", "Ray", "Reach", "Run"]


class Reach(NamedTuple):
    """What ends a run early: the centres of two bodies come as near as ``distance`` [m].

    who: the body that reaches. whom: the body that is reached. Data, so that a world checks it as finely as it can.
    """

    who: str
    whom: str
    distance: float


class Moment(NamedTuple):
    """One instant: time [s] since the world's reset, and the pose of every body by name."""

    time: float
    poses: Mapping[str, Pose]


class Run(NamedTuple):
    """What happened while gaits were held.

    moments: one at the end of each control interval, and one at the end of the run; none if nothing was run.
    stopped: who was reached; None if time ran out. energy: joules spent in the run, by body (0 where unknown).
    """

    moments: Sequence[Moment]
    stopped: str | None = None
    energy: Mapping[str, float] = {}  # never written to


class Ray(NamedTuple):
    """A straight line from (x, y) to (to_x, to_y), metres."""

    x: float
    y: float
    to_x: float
    to_y: float


class Detection(NamedTuple):
    """One thing in one frame of a sensor: as it was seen from there, or where it is, or both.

    seen: from the robot's pose in that frame: distance [m], bearing and heading [rad clockwise]; NaN for what was not
    measured. pose: where it is in the odometry frame, of a sensor that knows; its heading may be NaN.
    sd: standard deviations of the three of ``seen``; None: exact.
    """

    seen: Polar | None = None
    pose: Pose | None = None
    sd: Polar | None = None

    def placed(self, own: Pose) -> Pose:
        """Return where it is in the odometry frame, if ``own`` is the robot's pose in this frame of the sensor."""
        if self.pose is not None:
            return self.pose
        return Pose(math.nan, math.nan, math.nan) if self.seen is None else own.compose(self.seen)


class Frame(NamedTuple):
    """One look of a sensor: when [s], from which pose, and what was found; nothing says something too."""

    time: float
    pose: Pose
    detections: tuple[Detection, ...] = ()


class Observation(NamedTuple):
    """What the robot knows after a step, before it thinks about it.

    time: seconds since the start. pose: its own, in the odometry frame. frames: the looks of this step, empty ones
    too, the last of them now. covariance: of the own pose, [3, 3] x, y, theta; None: exact.
    """

    time: float
    pose: Pose
    frames: tuple[Frame, ...] = ()
    covariance: np.ndarray | None = None

    @property
    def detection(self) -> Detection | None:
        """What the last frame shows; None if it shows nothing. Of several things, the first."""
        detections = self.frames[-1].detections if self.frames else ()
        return detections[0] if detections else None
