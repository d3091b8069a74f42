"""Bodies on wheels: two driven wheels, and a car with steered front wheels."""

from __future__ import annotations

from math import tan

from bayeshunt.config.schema import BodySettings
from bayeshunt.worlds.box2d.bodies import Drive, Parts

__all__ = ["CarDrive", "DifferentialDrive"]


class DifferentialDrive(Drive):
    """Two driven wheels; the actuators are the left and right wheel speed [m/s]."""

    __slots__ = ("_half_scale", "_inverse_axle")
    settings: BodySettings

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self._inverse_axle, self._half_scale = 1.0 / self.settings.axle, 0.5 * self._scale

    def _move(self) -> None:
        # what the base does with twist(), in one call: it runs for both robots in every control interval of a hunt
        (left, right), (one, other) = self.state, self.factors
        left, right = left * one, right * other
        self.speed, self.turn = (left + right) * self._half_scale, (right - left) * self._inverse_axle

    def limits(self, step: float) -> tuple[float, float]:
        """Both wheels gain and lose speed by the same acceleration."""
        return self.settings.max_acceleration * step, self.settings.max_acceleration * step

    def twist(self, left: float, right: float) -> tuple[float, float, float]:  # type: ignore[override]  # two of them
        """v = (left + right) / 2, omega = (right - left) / axle."""
        return 0.5 * (left + right), 0.0, (right - left) * self._inverse_axle


class CarDrive(Drive):
    """Steered front wheels (bicycle model); the actuators are the rear axle's speed [m/s] and the steering [rad]."""

    __slots__ = ("_inverse_wheelbase",)
    settings: BodySettings

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        self._inverse_wheelbase = 1.0 / self.settings.wheelbase

    def limits(self, step: float) -> tuple[float, float]:
        """An acceleration and a steering rate."""
        return self.settings.max_acceleration * step, self.settings.max_steering_rate * step

    def twist(self, speed: float, steering: float) -> tuple[float, float, float]:  # type: ignore[override]
        """v = speed, omega = speed tan(steering) / wheelbase."""
        return speed, 0.0, speed * tan(steering) * self._inverse_wheelbase
