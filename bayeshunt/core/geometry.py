"""Poses in the world and egocentric polar coordinates, for scalars or arrays by broadcasting.

World frames follow Box2D: x and y in metres, theta in radians **counter-clockwise**.
Egocentric coordinates follow the paper: ``angle`` and ``heading`` in radians **clockwise**
from the robot's posteroanterior (back-to-front) vector, in (-pi, pi].

``Pose`` and ``Polar`` are of floats; ``Pose[FloatArray]`` and ``Polar[FloatArray]`` are of arrays.
"""

from __future__ import annotations

import math
from typing import Any, Generic, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import TypeVar

from bayeshunt.core.errors import InputError, shown

__all__ = ["FloatArray", "FloatLike", "Polar", "Pose", "in_frame", "placed", "wrap"]

FloatArray = NDArray[np.float64]
#: A float or an array of floats; every function here broadcasts.
FloatLike = float | FloatArray
#: What a pose is of: numbers or arrays; of numbers where nothing is said.
Part = TypeVar("Part", bound=FloatLike, default=float)

_TWO_PI = 2.0 * math.pi


@overload
def wrap(angle: float) -> float: ...
@overload
def wrap(angle: FloatArray) -> FloatArray: ...
@overload
def wrap(angle: ArrayLike) -> Any: ...
def wrap(angle: ArrayLike) -> FloatLike:
    """Return ``angle`` [rad] wrapped to (-pi, pi]; a float for a float, an array for an array; NaN stays NaN.

    Raises InputError unless it is a number or an array of numbers.
    """
    if isinstance(angle, float):
        if -math.pi < angle <= math.pi:
            return angle
        one = math.pi - (math.pi - angle) % _TWO_PI
        return math.pi if one <= -math.pi else one
    try:
        values = np.asarray(angle, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"angle: expected radians, a number or an array, got {shown(angle)}") from None
    inside = (values > -np.pi) & (values <= np.pi)
    if inside.all():
        return values.copy() if values.ndim else float(values)
    wrapped = np.pi - np.mod(np.pi - values, _TWO_PI)
    # The modulo of a tiny negative number rounds up to 2 pi, which would give -pi.
    wrapped = np.where(inside, values, np.where(wrapped <= -np.pi, np.pi, wrapped))
    return wrapped if wrapped.ndim else float(wrapped)


def _shown(pose: tuple[Any, ...], names: tuple[str, ...]) -> str:
    """A pose in one line, numpy's numbers as plain ones."""
    values = (value.item() if isinstance(value, np.generic) else value for value in pose)
    return ", ".join(f"{name}={value!r}" for name, value in zip(names, values, strict=True))


class Polar(NamedTuple, Generic[Part]):
    """The pose of a thing as seen from a robot, centred on the robot.

    distance: metres, >= 0.
    angle: bearing of the thing, radians clockwise from the robot's heading, in (-pi, pi].
    heading: direction the thing faces, radians clockwise from the robot's heading, (-pi, pi].
    """

    distance: Part
    angle: Part
    heading: Part

    def __repr__(self) -> str:
        return f"Polar({_shown(self, self._fields)})"

    @property
    def forward(self) -> Part:
        """Metres ahead of the robot (negative: behind)."""
        here: Polar[Any] = self  # numpy's types know no float-or-array
        forward: Part = here.distance * np.cos(here.angle)
        return forward

    @property
    def right(self) -> Part:
        """Metres to the right of the robot (negative: to the left)."""
        here: Polar[Any] = self
        right: Part = here.distance * np.sin(here.angle)
        return right

    @overload
    @classmethod
    def from_cartesian(cls, forward: float, right: float, heading: float = 0.0) -> Polar: ...
    @overload
    @classmethod
    def from_cartesian(cls, forward: FloatArray, right: FloatArray, heading: FloatLike = 0.0) -> Polar[FloatArray]: ...
    @classmethod
    def from_cartesian(cls, forward: FloatLike, right: FloatLike, heading: FloatLike = 0.0) -> Polar[Any]:
        """Polar coordinates of a point ``forward`` [m] ahead and ``right`` [m] to the right."""
        try:
            distance, angle = _length(forward, right), np.arctan2(right, forward)
        except (TypeError, AttributeError):
            raise InputError(
                f"forward, right: expected metres, numbers or arrays, got {shown(forward)} and {shown(right)}"
            ) from None
        return Polar(distance, wrap(angle), wrap(heading))

    @overload
    def compose(self, other: Polar) -> Polar[Part]: ...
    @overload
    def compose(self, other: Polar[FloatArray]) -> Polar[FloatArray]: ...
    def compose(self, other: Polar[Any]) -> Polar[Any]:
        """Return, in this pose's own frame of reference, a pose ``other`` given in *this pose's* frame.

        If A sees B at ``self`` and B sees C at ``other``, A sees C at ``self.compose(other)``.
        Raises InputError unless ``other`` is a Polar.
        """
        try:
            bearing = self.heading + other.angle
            forward = self.forward + other.distance * np.cos(bearing)
            right = self.right + other.distance * np.sin(bearing)
            heading: Any = self.heading + other.heading
            return Polar(_length(forward, right), wrap(np.arctan2(right, forward)), wrap(heading))
        except (AttributeError, TypeError):
            raise _mistaken("other", Polar, other) from None

    @overload
    def seen_from(self, observer: Polar) -> Polar[Part]: ...
    @overload
    def seen_from(self, observer: Polar[FloatArray]) -> Polar[FloatArray]: ...
    def seen_from(self, observer: Polar[Any]) -> Polar[Any]:
        """Return this pose as ``observer`` sees it; both are given in one common frame.

        The inverse of :meth:`compose`: ``a.compose(b).seen_from(a) == b``.
        Raises InputError unless ``observer`` is a Polar.
        """
        try:
            forward = self.forward - observer.forward
            right = self.right - observer.right
            bearing: Any = np.arctan2(right, forward)
            return Polar(
                _length(forward, right),
                wrap(bearing - observer.heading),
                wrap(self.heading - observer.heading),
            )
        except (AttributeError, TypeError):
            raise _mistaken("observer", Polar, observer) from None


class Pose(NamedTuple, Generic[Part]):
    """A pose in a world frame: x, y in metres, theta in radians counter-clockwise from x."""

    x: Part
    y: Part
    theta: Part

    def __repr__(self) -> str:
        return f"Pose({_shown(self, self._fields)})"

    @overload
    def relative(self, other: Pose) -> Polar[Part]: ...
    @overload
    def relative(self, other: Pose[FloatArray]) -> Polar[FloatArray]: ...
    def relative(self, other: Pose[Any]) -> Polar[Any]:
        """Return ``other`` as seen from this pose (the paper's egocentric polar coordinates).

        ``angle = wrap(theta - atan2(dy, dx))``; ``heading = wrap(theta - theta_other)``.
        Raises InputError unless ``other`` is a Pose.
        """
        try:
            dx, dy = other.x - self.x, other.y - self.y
            return Polar(
                _length(dx, dy),
                wrap(self.theta - np.arctan2(dy, dx)),
                wrap(self.theta - other.theta),
            )
        except (AttributeError, TypeError):
            raise _mistaken("other", Pose, other) from None

    @overload
    def compose(self, seen: Polar) -> Pose[Part]: ...
    @overload
    def compose(self, seen: Polar[FloatArray]) -> Pose[FloatArray]: ...
    def compose(self, seen: Polar[Any]) -> Pose[Any]:
        """Return the world pose of something seen at ``seen`` from here; undoes :meth:`relative`.

        Raises InputError unless ``seen`` is a Polar.
        """
        try:
            bearing = self.theta - seen.angle
            return Pose(
                self.x + seen.distance * np.cos(bearing),
                self.y + seen.distance * np.sin(bearing),
                wrap(self.theta - seen.heading),
            )
        except (AttributeError, TypeError):
            raise _mistaken("seen", Polar, seen) from None


def in_frame(pose: Pose, frame: Pose) -> Pose:
    """Return ``pose`` in the frame whose origin is ``frame``: what odometry says after a start from there.

    Both are given in one common frame. A frame at (0, 0, 0) leaves every bit as it is.
    """
    if frame == (0.0, 0.0, 0.0):
        return pose
    dx, dy = pose.x - frame.x, pose.y - frame.y
    cos, sin = math.cos(frame.theta), math.sin(frame.theta)
    return Pose(cos * dx + sin * dy, cos * dy - sin * dx, wrap(pose.theta - frame.theta))


def placed(pose: Pose, forward: NDArray[Any], right: NDArray[Any]) -> tuple[FloatArray, FloatArray]:
    """Return x, y [m] of points ``forward`` and ``right`` [m] of a robot at ``pose``, in the frame of that pose."""
    cos, sin = np.cos(pose.theta), np.sin(pose.theta)
    return pose.x + cos * forward + sin * right, pose.y + sin * forward - cos * right


def _length(one: Any, other: Any) -> Any:
    """``np.hypot``, to the last bit: Python's complex numbers ask the same function, in an eighth of the time."""
    if isinstance(one, float) and isinstance(other, float):
        try:
            return np.float64(abs(complex(one, other)))
        except OverflowError:  # which is inf to NumPy
            pass
    return np.hypot(one, other)


def _mistaken(name: str, kind: type, value: object) -> InputError:
    """The error for what is no pose of numbers: looked for only once the arithmetic has failed."""
    return InputError(f"{name}: expected a {kind.__name__}({', '.join(kind._fields)}) of numbers, got {shown(value)}")  # type: ignore[attr-defined]
