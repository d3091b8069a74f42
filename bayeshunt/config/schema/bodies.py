"""Bodies, their noise and their gaits: the settings of a disc on wheels, and what every other body shares with it."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, model_validator

from bayeshunt.config.schema.groups import Finite, NonNegative, Positive, Settings, Share

__all__ = ["BodySettings", "DiscSettings", "DriveSettings", "FreeGait", "GaitSettings", "NamedGait", "NoiseSettings"]


class DiscSettings(Settings):
    """What every body says of itself: a disc and the name of what moves it."""

    drive: str = Field("differential", description="how commands move the body")
    diameter: Positive = Field(0.057, description="diameter of the disc that collides [m]")

    @property
    def body_length(self) -> float:
        """The unit of bins, of the catch and of drawings [m]: ``length`` if the body has one, or the diameter."""
        length: float | None = getattr(self, "length", None)
        return self.diameter if length is None else length


class BodySettings(DiscSettings):
    """A disc-shaped body and its drive. Defaults are the Khepera's (Webots' model)."""

    drive: Literal["differential", "car"] = Field("differential", description="how commands move the body")
    diameter: Positive = Field(0.057, description="diameter of the disc that collides [m]")
    axle: Positive = Field(0.052, description="distance between the driven wheels [m] (differential)")
    wheelbase: Positive = Field(0.045, description="front to rear axle [m] (car)")
    max_steering: Annotated[float, Field(gt=0, lt=math.pi / 2)] = Field(
        0.6, description="largest steering angle [rad] (car)"
    )
    max_steering_rate: Positive = Field(2.0, description="steering speed limit [rad/s] (car)")
    max_acceleration: Positive = Field(0.6, description="wheel acceleration limit [m/s2]")
    max_traction: Positive = Field(3.0, description="largest change of body velocity the tyres carry [m/s2]")


class DriveSettings(DiscSettings):
    """A body that was registered without settings of its own; derive from it to add some."""

    drive: str = Field(description="how commands move the body: a registered name")
    length: Positive | None = Field(None, description="one body length [m]; by default the diameter")
    max_acceleration: Positive = Field(0.6, description="limit of each actuator's change [its unit per second]")
    max_traction: Positive = Field(3.0, description="largest change of body velocity the ground carries [m/s2]")
    top_speed: NonNegative | None = Field(None, description="fastest that any gait moves the body [m/s]")


class NoiseSettings(Settings):
    """Multiplicative noise of each actuator: (1 + slip) (1 + drift)."""

    slip: Share = Field(0.10, description="half-width of the uniform slip, redrawn every control interval [share]")
    drift_sd: Share = Field(0.025, description="standard deviation of the Ornstein-Uhlenbeck drift [share]")
    drift_time: Positive = Field(0.5, description="time constant of the drift [s]")


class NamedGait(Settings):
    """What every gait has."""

    name: str = Field(min_length=1, max_length=200, description="unique name")


class GaitSettings(NamedGait):
    """One gait: left and right wheel speed (differential) or speed and steering (car)."""

    left: Finite | None = Field(None, description="left wheel speed [m/s] (differential)")
    right: Finite | None = Field(None, description="right wheel speed [m/s] (differential)")
    speed: Finite | None = Field(None, description="speed of the rear axle [m/s] (car)")
    steering: Finite | None = Field(None, description="steering angle, left positive [rad] (car)")


class FreeGait(NamedGait):
    """One gait of a body that was registered: the keys that its registration names, or a list called ``command``."""

    model_config = ConfigDict(frozen=True, extra="allow")
    command: tuple[Finite, ...] | None = Field(None, min_length=1, description="a value for each actuator, in order")
    __pydantic_extra__: dict[str, Finite]

    @model_validator(mode="before")
    @classmethod
    def _of_one_body(cls, values: Any) -> Any:
        """Leave out the keys that gaits of another body have and this one does not use."""
        if not isinstance(values, dict):
            return values
        return {key: value for key, value in values.items() if value is not None}
