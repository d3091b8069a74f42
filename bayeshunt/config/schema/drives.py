"""What moves a body, by name: the settings it takes, the keys that command it, and how fast that makes it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from bayeshunt.config.schema.bodies import BodySettings, DiscSettings, FreeGait, GaitSettings, NamedGait
from bayeshunt.config.schema.legs import LegGait, LeggedSettings
from bayeshunt.config.schema.mujoco import MujocoGait, MujocoSettings
from bayeshunt.core.errors import InputError, did_you_mean

__all__ = ["DriveKind", "drive_names", "find_drive", "know_drive"]

#: Metres per second that the command of one gait moves the body's centre.
Speed = Callable[[Sequence[float]], float]


@dataclass(frozen=True)
class DriveKind:
    """A kind of body.

    settings: of the body. commands: keys of a gait in the order of the actuators; none: a list called ``command``.
    speed: metres per second of one command; None: the body's setting ``top_speed`` says the most.
    gait: the settings of one gait. check: says what is wrong with a command for a body, None if nothing is.
    world: what moves it where the experiment names no other world.
    """

    settings: type[DiscSettings]
    commands: tuple[str, ...] = ()
    speed: Speed | None = None
    gait: type[NamedGait] = FreeGait
    check: Callable[[Any, Sequence[float]], str | None] = lambda body, command: None
    world: str = "box2d"

    def command(self, gait: NamedGait) -> tuple[float, ...]:
        """Return the command of a gait; ValueError if it lacks a key, or has another drive's."""
        if isinstance(gait, (LegGait, MujocoGait)):
            return gait.values()
        held = {**gait.__dict__, **(gait.__pydantic_extra__ or {})}
        given = {key: value for key, value in held.items() if key != "name" and value is not None}
        wanted = self.commands or ("command",)
        if set(given) != set(wanted):
            raise ValueError(f"needs {_listed(wanted)}")
        return tuple(given[key] for key in wanted) if self.commands else tuple(given["command"])


def _listed(keys: Sequence[str]) -> str:
    return f"{', '.join(keys[:-1])} and {keys[-1]}" if len(keys) > 1 else keys[0]


def _steering(body: BodySettings, command: Sequence[float]) -> str | None:
    if abs(command[1]) > body.max_steering:
        return f"steers beyond body.max_steering = {body.max_steering}"
    return None


def _a_phase_for_each(body: LeggedSettings, command: Sequence[float]) -> str | None:
    legs, phases = len(body.legs.x), len(command) - _BEFORE_PHASES
    return None if legs == phases else f"has {phases} phases for {legs} legs"


#: Values of a command on legs before the phases: frequency, duty, left and right stroke.
_BEFORE_PHASES = 4

_DRIVES: dict[str, DriveKind] = {
    "differential": DriveKind(
        BodySettings, ("left", "right"), lambda command: abs(command[0] + command[1]) / 2, GaitSettings
    ),
    "car": DriveKind(BodySettings, ("speed", "steering"), lambda command: abs(command[0]), GaitSettings, _steering),
    "legs": DriveKind(LeggedSettings, ("frequency", "duty", "stroke", "phase"), None, LegGait, _a_phase_for_each),
    "mujoco": DriveKind(
        MujocoSettings, ("frequency", "offset", "amplitude", "phase"), None, MujocoGait, world="mujoco"
    ),
}


def find_drive(name: Any) -> DriveKind:
    """Return the kind of body called ``name``; InputError if there is none."""
    kind = _DRIVES.get(name) if isinstance(name, str) else None
    if kind is None:
        raise InputError(f"unknown drive {name!r}{did_you_mean(name, _DRIVES)}")
    return kind


def drive_names() -> tuple[str, ...]:
    """Return the names of all kinds of bodies."""
    return tuple(_DRIVES)


def know_drive(name: str, kind: DriveKind) -> None:
    """Let settings use the name of a kind of body; see ``bayeshunt.register_body``, which says how it is built too."""
    _DRIVES[name] = kind
