"""Robot bodies in Box2D: from a motor command to a velocity, one physics step at a time.

Box2D's unit of length is one hunter body, so that its float32 numbers stay near 1. Everything
here that is not named ``metres`` is in body lengths. These classes run once per physics step:
plain floats, slots, and live vectors that Box2D hands out once (writing ``vector.x`` is one call,
assigning ``body.linearVelocity`` four).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import cos, hypot, sin, tan
from typing import Any

import Box2D
import numpy as np

from bayeshunt.config.schema import BodySettings, NoiseSettings, PhysicsSettings
from bayeshunt.core.geometry import Pose, wrap
from bayeshunt.worlds.noise import actuator_factors


class Drive:
    """A disc with two actuators that are tracked under rate limits and carry noise.

    Subclasses say how fast the two actuators may change (:meth:`_rate_limits`), which lengths of the body
    they need (:meth:`_measure`) and how the actuators move it (:meth:`_twist`); the actuators start at rest.
    """

    __slots__ = (
        "_angular_sent", "_factors", "_limits", "_position", "_traction", "_velocity", "body", "factor_a", "factor_b",
        "moving", "speed", "state_a", "state_b", "target_a", "target_b", "turn", "unit", "vx", "vy",
    )  # fmt: skip

    def __init__(
        self,
        world: Any,
        settings: BodySettings,
        noise: NoiseSettings,
        physics: PhysicsSettings,
        unit: float,
        rng: np.random.Generator,
    ) -> None:
        """Put a disc at the origin of ``world``; ``unit`` is metres per Box2D unit."""
        fixture = Box2D.b2FixtureDef(
            shape=Box2D.b2CircleShape(radius=0.5 * settings.diameter / unit),
            density=1.0,
            friction=0.0,
            restitution=0.0,
        )
        self.body = world.CreateDynamicBody(
            fixtures=fixture, allowSleep=False, linearDamping=0.0, angularDamping=0.0, bullet=False
        )
        self.unit = unit
        self._measure(settings)
        self._position = self.body.position  # live: follows the body
        self._velocity = self.body.linearVelocity  # live: writing it moves the body
        self._factors: Iterator[tuple[float, float]] = actuator_factors(noise, physics.control_interval, rng)
        self._traction = settings.max_traction * physics.step / unit
        self._limits = self._rate_limits(settings, physics.step)
        self.state_a = self.state_b = self.target_a = self.target_b = 0.0
        self.factor_a = self.factor_b = 1.0
        self.speed = self.turn = self.vx = self.vy = self._angular_sent = 0.0
        self.moving = False  # an actuator has not reached its target yet

    def _measure(self, settings: BodySettings) -> None:
        """Keep what :meth:`_twist` needs of the body; ``self.unit`` is known by then."""

    def _rate_limits(self, settings: BodySettings, step: float) -> tuple[float, float]:
        """Largest change of each actuator in one physics step."""
        raise TypeError(f"{type(self).__name__} must say its rate limits")

    def _twist(self, a: float, b: float) -> tuple[float, float]:
        """Return speed [bodies/s] and turning rate [rad/s, counter-clockwise] for noisy actuator values."""
        raise TypeError(f"{type(self).__name__} must say how its actuators move it")

    def command(self, a: float, b: float) -> None:
        """Set the actuators' targets, in the unit of the body's gaits (m/s, rad)."""
        if a != self.target_a or b != self.target_b:
            self.target_a, self.target_b = a, b
            self.moving = True

    def next_interval(self) -> None:
        """Draw the noise of the next control interval."""
        self.factor_a, self.factor_b = next(self._factors)
        if not self.moving:
            self.speed, self.turn = self._twist(self.state_a * self.factor_a, self.state_b * self.factor_b)

    def _track(self) -> None:
        """Move both actuators towards their targets by at most one step's change."""
        limit_a, limit_b = self._limits
        gap_a, gap_b = self.target_a - self.state_a, self.target_b - self.state_b
        self.state_a += max(-limit_a, min(limit_a, gap_a))
        self.state_b += max(-limit_b, min(limit_b, gap_b))
        self.moving = abs(gap_a) > limit_a or abs(gap_b) > limit_b
        if not self.moving:
            self.state_a, self.state_b = self.target_a, self.target_b
        self.speed, self.turn = self._twist(self.state_a * self.factor_a, self.state_b * self.factor_b)

    def advance(self) -> None:
        """Set the body's velocity for the next physics step."""
        if self.moving:
            self._track()
        angle = self.body.angle
        vx, vy = self.speed * cos(angle), self.speed * sin(angle)
        dx, dy = vx - self.vx, vy - self.vy
        limit = self._traction
        if dx * dx + dy * dy > limit * limit:
            # the tyres carry only so much: |change of velocity| <= traction limit x step
            share = limit / hypot(dx, dy)
            vx, vy = self.vx + share * dx, self.vy + share * dy
        velocity = self._velocity
        velocity.x = self.vx = vx
        velocity.y = self.vy = vy
        if self.turn != self._angular_sent:
            self.body.angularVelocity = self._angular_sent = self.turn

    def read_back(self) -> None:
        """Take over the velocity that a contact has left the body with."""
        self.vx, self.vy = self._velocity.x, self._velocity.y
        self._angular_sent = self.body.angularVelocity

    @property
    def position(self) -> Any:
        """The live position vector [bodies]: read its x and y, never keep it as a value."""
        return self._position

    @property
    def pose(self) -> Pose:
        """The pose in metres and radians."""
        return Pose(self._position.x * self.unit, self._position.y * self.unit, wrap(float(self.body.angle)))

    def continue_as(self, other: Drive) -> None:
        """Take over another body's pose, velocity and actuators, as they are now."""
        self.place(other.pose)
        self._velocity.x, self._velocity.y = other._velocity.x, other._velocity.y
        self.body.angularVelocity = other.body.angularVelocity
        self.state_a, self.state_b = other.state_a, other.state_b
        self.target_a, self.target_b, self.moving = other.target_a, other.target_b, other.moving
        self.read_back()

    def place(self, pose: Pose) -> None:
        """Put the body at ``pose`` [m, rad]; velocities and actuators stay as they are."""
        self.body.transform = ((pose.x / self.unit, pose.y / self.unit), pose.theta)


class DifferentialDrive(Drive):
    """Two driven wheels; a and b are the left and right wheel speed [m/s]."""

    __slots__ = ("_half_inverse_unit", "_inverse_axle")

    def _measure(self, settings: BodySettings) -> None:
        self._half_inverse_unit = 0.5 / self.unit
        self._inverse_axle = 1.0 / settings.axle

    def _rate_limits(self, settings: BodySettings, step: float) -> tuple[float, float]:
        return settings.max_acceleration * step, settings.max_acceleration * step

    def _twist(self, a: float, b: float) -> tuple[float, float]:
        # v = (left + right) / 2, omega = (right - left) / axle
        return (a + b) * self._half_inverse_unit, (b - a) * self._inverse_axle


class CarDrive(Drive):
    """Steered front wheels (bicycle model); a is the rear axle's speed [m/s], b the steering [rad]."""

    __slots__ = ("_inverse_unit", "_inverse_wheelbase")

    def _measure(self, settings: BodySettings) -> None:
        self._inverse_unit = 1.0 / self.unit
        self._inverse_wheelbase = 1.0 / settings.wheelbase

    def _rate_limits(self, settings: BodySettings, step: float) -> tuple[float, float]:
        return settings.max_acceleration * step, settings.max_steering_rate * step

    def _twist(self, a: float, b: float) -> tuple[float, float]:
        # v = a, omega = a tan(b) / wheelbase
        return a * self._inverse_unit, a * tan(b) * self._inverse_wheelbase


#: How each ``body.drive`` of the settings is built; add a new kind of body here.
DRIVES: dict[str, Callable[..., Drive]] = {"differential": DifferentialDrive, "car": CarDrive}


def build_drive(
    world: Any,
    settings: BodySettings,
    noise: NoiseSettings,
    physics: PhysicsSettings,
    unit: float,
    rng: np.random.Generator,
) -> Drive:
    """Return the drive that ``settings.drive`` names, at the origin of ``world``."""
    return DRIVES[settings.drive](world, settings, noise, physics, unit, rng)
