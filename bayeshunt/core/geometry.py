"""Poses in the world and egocentric polar coordinates, for scalars or arrays by broadcasting.

World frames follow Box2D: x and y in metres, theta in radians **counter-clockwise**.
Egocentric coordinates follow the paper: ``angle`` and ``heading`` in radians **clockwise**
from the robot's posteroanterior (back-to-front) vector, in (-pi, pi].
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

#: A float or an array of floats; every function here broadcasts.
Number = Any

_TWO_PI = 2.0 * math.pi


def wrap(angle: Number) -> Number:
    """Return ``angle`` [rad] wrapped to (-pi, pi]; a float for a float, an array for an array; NaN stays NaN."""
    if isinstance(angle, float):
        if -math.pi < angle <= math.pi:
            return angle
        one = math.pi - (math.pi - angle) % _TWO_PI
        return math.pi if one <= -math.pi else one
    values = np.asarray(angle, dtype=float)
    inside = (values > -np.pi) & (values <= np.pi)
    if inside.all():
        return values.copy() if values.ndim else float(values)
    wrapped = np.pi - np.mod(np.pi - values, _TWO_PI)
    # The modulo of a tiny negative number rounds up to 2 pi, which would give -pi.
    wrapped = np.where(inside, values, np.where(wrapped <= -np.pi, np.pi, wrapped))
    return wrapped if wrapped.ndim else float(wrapped)


class Polar(NamedTuple):
    """The pose of a thing as seen from a robot, centred on the robot.

    distance: metres, >= 0.
    angle: bearing of the thing, radians clockwise from the robot's heading, in (-pi, pi].
    heading: direction the thing faces, radians clockwise from the robot's heading, (-pi, pi].
    """

    distance: Number
    angle: Number
    heading: Number

    @property
    def forward(self) -> Number:
        """Metres ahead of the robot (negative: behind)."""
        return self.distance * np.cos(self.angle)

    @property
    def right(self) -> Number:
        """Metres to the right of the robot (negative: to the left)."""
        return self.distance * np.sin(self.angle)

    @classmethod
    def from_cartesian(cls, forward: Number, right: Number, heading: Number = 0.0) -> Polar:
        """Polar coordinates of a point ``forward`` [m] ahead and ``right`` [m] to the right."""
        return cls(np.hypot(forward, right), wrap(np.arctan2(right, forward)), wrap(heading))

    def compose(self, other: Polar) -> Polar:
        """Return, in this pose's own frame of reference, a pose ``other`` given in *this pose's* frame.

        If A sees B at ``self`` and B sees C at ``other``, A sees C at ``self.compose(other)``.
        """
        bearing = self.heading + other.angle
        forward = self.forward + other.distance * np.cos(bearing)
        right = self.right + other.distance * np.sin(bearing)
        return Polar.from_cartesian(forward, right, self.heading + other.heading)

    def seen_from(self, observer: Polar) -> Polar:
        """Return this pose as ``observer`` sees it; both are given in one common frame.

        The inverse of :meth:`compose`: ``a.compose(b).seen_from(a) == b``.
        """
        forward = self.forward - observer.forward
        right = self.right - observer.right
        bearing = np.arctan2(right, forward)
        return Polar(
            np.hypot(forward, right),
            wrap(bearing - observer.heading),
            wrap(self.heading - observer.heading),
        )


class Pose(NamedTuple):
    """A pose in a world frame: x, y in metres, theta in radians counter-clockwise from x."""

    x: Number
    y: Number
    theta: Number

    def relative(self, other: Pose) -> Polar:
        """Return ``other`` as seen from this pose (the paper's egocentric polar coordinates).

        ``angle = wrap(theta - atan2(dy, dx))``; ``heading = wrap(theta - theta_other)``.
        """
        dx, dy = other.x - self.x, other.y - self.y
        return Polar(
            np.hypot(dx, dy),
            wrap(self.theta - np.arctan2(dy, dx)),
            wrap(self.theta - other.theta),
        )

    def compose(self, seen: Polar) -> Pose:
        """Return the world pose of something seen at ``seen`` from here; undoes :meth:`relative`."""
        bearing = self.theta - seen.angle
        return Pose(
            self.x + seen.distance * np.cos(bearing),
            self.y + seen.distance * np.sin(bearing),
            wrap(self.theta - seen.heading),
        )


def circular_mean(angles: Number, weights: Number | None = None) -> float:
    """Return the circular mean [rad] of ``angles``, by default all of equal weight."""
    values = np.asarray(angles, dtype=float)
    if weights is None:
        weights = np.ones_like(values)
    return float(np.arctan2(np.sum(weights * np.sin(values)), np.sum(weights * np.cos(values))))
