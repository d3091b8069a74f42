"""A body in MuJoCo: an MJCF model whose hinges follow sines, the settings of its servos and of its gaits."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from bayeshunt.config.schema.bodies import DiscSettings, NamedGait
from bayeshunt.config.schema.groups import Finite, NonNegative, Positive

__all__ = ["MujocoGait", "MujocoSettings"]

_Angle = Annotated[float, Field(ge=-math.pi, le=math.pi, allow_inf_nan=False)]
_Frequency = Annotated[float, Field(ge=0, le=20, allow_inf_nan=False)]


class MujocoSettings(DiscSettings):
    """A body in MuJoCo, of any number of actuators. Needs the extra: pip install ".[mujoco]"."""

    drive: Literal["mujoco"] = Field("mujoco", description="how commands move the body")
    model: str = Field(
        "puppy", min_length=1, description="its MJCF: puppy, or the path of a file with a body trunk (mujoco)"
    )
    diameter: Positive = Field(
        0.20, description="diameter of the disc that it needs free around it at the start [m] (mujoco)"
    )
    length: Positive | None = Field(None, description="one body length [m]; by default the diameter (mujoco)")
    hips: tuple[tuple[Finite, Finite], ...] = Field(
        (), description="where legs are drawn: ahead and to the left of the body's centre [m] (mujoco)"
    )
    step: Annotated[float, Field(gt=0, le=0.01)] = Field(0.002, description="the physics step, at most [s] (mujoco)")
    physics_step: Annotated[float, Field(gt=0, le=0.2)] = Field(
        0.02, description="physics.step of experiments with this robot, unless they say another [s] (mujoco)"
    )
    top_speed: NonNegative = Field(description="measured: the fastest that any gait moves the body [m/s] (mujoco)")
    friction: Positive = Field(0.3, description="friction coefficient of everything (mujoco)")
    max_rate: Positive = Field(6.54, description="speed limit of a servo's target [rad/s] (mujoco)")
    fall_angle: Annotated[float, Field(gt=0, lt=math.pi)] = Field(
        math.pi / 3, description="tilted beyond this the body is falling [rad] (mujoco)"
    )
    fall_time: Positive = Field(0.5, description="after so long it is set upright where it lies [s] (mujoco)")


class MujocoGait(NamedGait):
    """One gait: actuator i follows amplitude[i] sin(2 pi (frequency[i] t - phase[i])) + offset[i]."""

    frequency: tuple[_Frequency, ...] = Field(min_length=1, description="of each actuator [Hz] (mujoco)")
    offset: tuple[_Angle, ...] = Field(min_length=1, description="of each actuator [rad] (mujoco)")
    amplitude: tuple[_Angle, ...] = Field(min_length=1, description="of each actuator [rad] (mujoco)")
    phase: tuple[Finite, ...] = Field(min_length=1, description="by which each actuator is late [cycles] (mujoco)")

    @model_validator(mode="after")
    def _one_of_each(self) -> MujocoGait:
        lists = {"frequency": self.frequency, "offset": self.offset, "amplitude": self.amplitude, "phase": self.phase}
        if len({len(values) for values in lists.values()}) > 1:
            raise ValueError(f"{', '.join(f'{len(v)} of {k}' for k, v in lists.items())}; give one for each actuator")
        return self

    def values(self) -> tuple[float, ...]:
        """Return the command: all frequencies, offsets, amplitudes, then phases."""
        return (*self.frequency, *self.offset, *self.amplitude, *self.phase)
