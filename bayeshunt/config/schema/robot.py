"""A robot: its body, the noise of its actuators, its gaits."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from bayeshunt.config.schema.groups import Finite, Positive, Settings, Share, ShownSettings
from bayeshunt.core.gaits import Gait, GaitRepertoire

__all__ = ["BodySettings", "GaitSettings", "NoiseSettings", "RobotSettings"]


class BodySettings(Settings):
    """A disc-shaped body and its drive. Defaults are the Khepera's (Webots' model)."""

    drive: Literal["differential", "car"] = Field("differential", description="how commands move the body")
    diameter: Positive = Field(0.057, description="disc diameter = one body length [m]")
    axle: Positive = Field(0.052, description="distance between the driven wheels [m] (differential)")
    wheelbase: Positive = Field(0.045, description="front to rear axle [m] (car)")
    max_steering: Annotated[float, Field(gt=0, lt=math.pi / 2)] = Field(
        0.6, description="largest steering angle [rad] (car)"
    )
    max_steering_rate: Positive = Field(2.0, description="steering speed limit [rad/s] (car)")
    max_acceleration: Positive = Field(0.6, description="wheel acceleration limit [m/s2]")
    max_traction: Positive = Field(3.0, description="largest change of body velocity the tyres carry [m/s2]")


class NoiseSettings(Settings):
    """Multiplicative noise of each actuator: (1 + slip) (1 + drift)."""

    slip: Share = Field(0.10, description="half-width of the uniform slip, redrawn every control interval [share]")
    drift_sd: Share = Field(0.025, description="standard deviation of the Ornstein-Uhlenbeck drift [share]")
    drift_time: Positive = Field(0.5, description="time constant of the drift [s]")


class GaitSettings(Settings):
    """One gait: left and right wheel speed (differential) or speed and steering (car)."""

    name: str = Field(min_length=1, max_length=200, description="unique name")
    left: Finite | None = Field(None, description="left wheel speed [m/s] (differential)")
    right: Finite | None = Field(None, description="right wheel speed [m/s] (differential)")
    speed: Finite | None = Field(None, description="speed of the rear axle [m/s] (car)")
    steering: Finite | None = Field(None, description="steering angle, left positive [rad] (car)")


_COMMAND_KEYS = {"differential": ("left", "right"), "car": ("speed", "steering")}


class RobotSettings(ShownSettings):
    """A robot: a body, its noise and its gaits."""

    name: str = Field(min_length=1, description="name shown in tables")
    description: str = Field("", description="one line about the robot")
    gait_duration: Positive = Field(3.328, description="how long one gait is held: the time-step [s]")
    body: BodySettings = Field(default_factory=BodySettings)
    noise: NoiseSettings = Field(default_factory=NoiseSettings)
    gait: tuple[GaitSettings, ...] = Field(min_length=1, description="the gaits, in table order")

    @model_validator(mode="after")
    def _commands_fit_the_drive(self) -> RobotSettings:
        keys = _COMMAND_KEYS[self.body.drive]
        other = [k for drive, ks in _COMMAND_KEYS.items() if drive != self.body.drive for k in ks]
        for gait in self.gait:
            if any(getattr(gait, key) is None for key in keys) or any(getattr(gait, k) is not None for k in other):
                raise ValueError(f"gait {gait.name!r} of a {self.body.drive} drive needs {keys[0]} and {keys[1]}")
        if self.body.drive == "car":
            for gait in self.gait:
                if abs(gait.steering or 0.0) > self.body.max_steering:
                    raise ValueError(f"gait {gait.name!r} steers beyond body.max_steering = {self.body.max_steering}")
        names = [gait.name for gait in self.gait]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"gait name {name!r} stands twice; names must be unique")
        return self

    def __repr__(self) -> str:
        return f"<RobotSettings {self.name!r}: {self.body.drive} drive, {len(self.gait)} gaits>"

    @property
    def top_speed(self) -> float:
        """The fastest that any gait drives the body's centre, without noise [m/s]."""
        if self.body.drive == "car":
            return max(abs(gait.speed or 0.0) for gait in self.gait)
        return max(abs((gait.left or 0.0) + (gait.right or 0.0)) / 2 for gait in self.gait)

    @property
    def gaits(self) -> GaitRepertoire:
        """The gaits as the models' repertoire."""
        first, second = _COMMAND_KEYS[self.body.drive]
        gaits = tuple(Gait(g.name, (getattr(g, first), getattr(g, second))) for g in self.gait)
        return GaitRepertoire(gaits, self.body.diameter, self.gait_duration)
