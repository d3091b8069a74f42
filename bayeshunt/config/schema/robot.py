"""A robot: its body, the noise of its actuators, its gaits."""

from __future__ import annotations

from typing import Any

from pydantic import Field, SerializeAsAny, TypeAdapter, ValidationInfo, field_validator, model_validator

from bayeshunt.config.schema.bodies import BodySettings, GaitSettings, NoiseSettings
from bayeshunt.config.schema.drives import DriveKind, find_drive
from bayeshunt.config.schema.groups import Positive, ShownSettings
from bayeshunt.config.schema.protocol import PhysicsSettings
from bayeshunt.core.errors import InputError
from bayeshunt.core.gaits import Gait, GaitRepertoire

__all__ = ["BodySettings", "GaitSettings", "NoiseSettings", "RobotSettings"]


class RobotSettings(ShownSettings):
    """A robot: a body, its noise and its gaits. The body and the gaits are of the drive's own settings classes."""

    name: str = Field(min_length=1, description="name shown in tables")
    description: str = Field("", description="one line about the robot")
    gait_duration: Positive = Field(3.328, description="how long one gait is held: the time-step [s]")
    body: SerializeAsAny[BodySettings] = Field(default_factory=BodySettings)
    noise: NoiseSettings = Field(default_factory=NoiseSettings)
    gait: SerializeAsAny[tuple[GaitSettings, ...]] = Field(min_length=1, description="the gaits, in table order")

    @field_validator("body", mode="wrap")
    @classmethod
    def _of_the_drive(cls, value: Any, handler: Any) -> Any:
        """A body of a registered drive is checked by that drive's settings."""
        drive = value.get("drive", "differential") if isinstance(value, dict) else getattr(value, "drive", None)
        if not isinstance(drive, str):
            return handler(value)
        kind = find_drive(drive)
        return handler(value) if kind.settings is BodySettings else kind.settings.model_validate(value)

    @field_validator("gait", mode="wrap")
    @classmethod
    def _of_the_drive_too(cls, value: Any, handler: Any, info: ValidationInfo) -> Any:
        kind = find_drive(info.data["body"].drive) if "body" in info.data else None
        if kind is None or kind.gait is GaitSettings or not isinstance(value, (list, tuple)):
            return handler(value)
        return TypeAdapter(tuple[kind.gait, ...]).validate_python(value)  # type: ignore[name-defined]

    @model_validator(mode="after")
    def _commands_fit_the_drive(self) -> RobotSettings:
        drive = self.body.drive
        for gait in self.gait:
            try:
                command = find_drive(drive).command(gait)
            except ValueError as error:
                raise ValueError(f"gait {gait.name!r} of a {drive} drive {error}") from None
            fault = find_drive(drive).check(self.body, command)
            if fault is not None:
                raise ValueError(f"gait {gait.name!r} {fault}")
        names = [gait.name for gait in self.gait]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"gait name {name!r} stands twice; names must be unique")
        return self

    def __repr__(self) -> str:
        return f"<RobotSettings {self.name!r}: {self.body.drive} drive, {len(self.gait)} gaits>"

    @property
    def physics(self) -> PhysicsSettings:
        """How time advances with this robot, where no experiment says it: by a step that its body may ask for."""
        step: float | None = getattr(self.body, "physics_step", None)
        usual = PhysicsSettings()
        if step is None:
            return usual
        return PhysicsSettings(step=step, control_steps=max(1, round(usual.control_interval / step)))

    @property
    def top_speed(self) -> float:
        """The fastest that any gait moves the body's centre, without noise [m/s]; InputError if nobody says it."""
        speed, drive = self.known_top_speed, self.body.drive
        if speed is None:
            raise InputError(f"robot {self.name!r}: a {drive} drive needs robot.body.top_speed [m/s] for this")
        return speed

    @property
    def known_top_speed(self) -> float | None:
        """:attr:`top_speed`, None if nobody says it: a body that was registered without its speed."""
        kind = find_drive(self.body.drive)
        if kind.speed is not None:
            return max(kind.speed(gait.command) for gait in self.gaits)
        declared: float | None = getattr(self.body, "top_speed", None)
        return declared

    @property
    def gaits(self) -> GaitRepertoire:
        """The gaits as the models' repertoire."""
        global _made
        kind = find_drive(self.body.drive)
        if _made is None or _made[0] is not self or _made[1] is not kind:
            gaits = tuple(Gait(gait.name, kind.command(gait)) for gait in self.gait)
            _made = self, kind, GaitRepertoire(gaits, self.body.body_length, self.gait_duration)
        return _made[2]


#: The repertoire that was made last, and of what: every hunt of an evaluation asks for the same one.
_made: tuple[RobotSettings, DriveKind, GaitRepertoire] | None = None
