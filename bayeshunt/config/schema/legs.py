"""A body on legs, seen from above: its trunk, its legs, its servos, and when the load leaves the support."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from bayeshunt.config.schema.bodies import DiscSettings, NamedGait
from bayeshunt.config.schema.groups import Finite, NonNegative, Positive, Settings, Share

__all__ = ["LegGait", "LegSettings", "LeggedSettings", "legs_at_rest"]

_Phase = Annotated[float, Field(ge=0, lt=1, allow_inf_nan=False)]
_Stroke = Annotated[float, Field(ge=-math.pi / 2, le=math.pi / 2, allow_inf_nan=False)]
_Angle = Annotated[float, Field(ge=-2 * math.pi, le=2 * math.pi, allow_inf_nan=False)]


class LegSettings(Settings):
    """The legs, left right from front to back, and the ground under them. Defaults are the hexapod's."""

    joint: Literal["revolute", "prismatic"] = Field(
        "revolute", description="hips that turn the leg about the vertical, or move the foot along the trunk"
    )
    x: tuple[Finite, ...] = Field(
        (0.085, 0.085, 0.0, 0.0, -0.085, -0.085), min_length=1, max_length=10, description="of the hips, ahead [m]"
    )
    y: tuple[Finite, ...] = Field(
        (0.05, -0.05, 0.05, -0.05, 0.05, -0.05), min_length=1, max_length=10, description="of the hips, to the left [m]"
    )
    rest: tuple[_Angle, ...] = Field(
        (1.0472, -1.0472, 1.5708, -1.5708, 2.0944, -2.0944),
        description="direction of each leg at rest, counter-clockwise from ahead [rad] (revolute)",
    )
    length: Positive = Field(0.09, description="hip to foot [m]")
    mass: Positive = Field(0.05, description="of each leg [kg]")
    max_rate: Positive = Field(6.54, description="speed limit of a servo [rad/s]")
    max_torque: Positive = Field(2.16, description="torque limit of a servo [N m]")
    gain: Positive = Field(20.0, description="position gain of a servo [1/s]")
    friction: Positive = Field(0.8, description="friction coefficient of a foot in stance")
    friction_spread: Share = Field(0.25, description="half-width of its spread from foothold to foothold [share]")
    belly_friction: NonNegative = Field(0.4, description="friction coefficient of a trunk that lies on the ground")
    coupling: NonNegative = Field(2.0, description="how fast the legs' phases settle to another gait [1/s]")
    tilt_time: Positive = Field(0.15, description="time constant with which the trunk tilts and rights itself [s]")
    tilt_margin: NonNegative = Field(0.10, description="load this far outside the support is borne [body lengths]")
    tilt_scale: Positive = Field(0.15, description="so much beyond the margin the trunk lies down [body lengths]")

    @model_validator(mode="after")
    def _one_of_each(self) -> LegSettings:
        lists = {"x": self.x, "y": self.y} | ({"rest": self.rest} if self.joint == "revolute" else {})
        if len({len(values) for values in lists.values()}) > 1:
            raise ValueError(f"legs: {', '.join(f'{len(v)} of {k}' for k, v in lists.items())}; give one for each leg")
        return self


class LeggedSettings(DiscSettings):
    """A body on legs. Its collision disc, ``diameter``, can be smaller or larger than the body is long."""

    drive: Literal["legs"] = Field("legs", description="how commands move the body")
    diameter: Positive = Field(0.20, description="diameter of the disc that collides [m] (legs)")
    length: Positive | None = Field(None, description="one body length [m]; by default the diameter (legs)")
    width: Positive = Field(0.10, description="of the trunk [m] (legs)")
    mass: Positive = Field(1.2, description="of the trunk [kg] (legs)")
    step: Annotated[float, Field(gt=0, le=0.05)] = Field(
        0.008, description="the body's own physics step, at most [s] (legs); above 0.008 gaits lose speed"
    )
    top_speed: NonNegative = Field(description="measured: the fastest that any gait moves the body [m/s] (legs)")
    legs: LegSettings = Field(default_factory=LegSettings, description="the legs")


class LegGait(NamedGait):
    """One gait of a body on legs."""

    frequency: Annotated[float, Field(gt=0, le=20)] = Field(description="steps of each leg per second [Hz] (legs)")
    duty: Annotated[float, Field(gt=0, lt=1)] = Field(description="part of a step with the foot down [share] (legs)")
    stroke: tuple[_Stroke, _Stroke] = Field(
        description="half-width of the swing of left and right legs; negative walks backwards [rad] (legs)"
    )
    phase: tuple[_Phase, ...] = Field(description="part of a step by which each leg is late [share] (legs)")

    def values(self) -> tuple[float, ...]:
        """Return the command: frequency, duty, left and right stroke, then the phases."""
        return (self.frequency, self.duty, *self.stroke, *self.phase)


def legs_at_rest(body: DiscSettings) -> list[tuple[float, float, float, float]]:
    """Return hip x, y and foot x, y of each leg at rest [m], ahead and left of the body's centre; none on wheels."""
    if not isinstance(body, LeggedSettings):  # in MuJoCo a leg moves upright: seen from above only the foot shows
        return [(x, y, x, 1.5 * y) for x, y in getattr(body, "hips", ())]
    legs = body.legs
    if legs.joint == "prismatic":  # seen from above only the foot shows, outside its hip
        feet = [(x, y * (1.0 + 0.3 * legs.length / abs(y)) if y else y) for x, y in zip(legs.x, legs.y, strict=True)]
    else:
        reach, places = legs.length, zip(legs.x, legs.y, legs.rest, strict=True)
        feet = [(x + reach * math.cos(rest), y + reach * math.sin(rest)) for x, y, rest in places]
    return [(x, y, *foot) for x, y, foot in zip(legs.x, legs.y, feet, strict=True)]
