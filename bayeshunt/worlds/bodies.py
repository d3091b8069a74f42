"""Kinds of bodies by name: ``drive = "differential"`` in a robot's settings, or one of your own."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

from bayeshunt.config.schema import DiscSettings, DriveSettings
from bayeshunt.config.schema.drives import DriveKind, Speed, drive_names, know_drive
from bayeshunt.core.arguments import checked
from bayeshunt.core.errors import InputError, shown

__all__ = ["BodyEntry", "body_factory", "register_body", "registered_bodies"]


class BodyEntry(NamedTuple):
    """How a kind of body was registered."""

    factory: Callable[..., Any]
    commands: tuple[str, ...]
    settings: type[DiscSettings]
    speed: Speed | None


_SHIPPED = frozenset(drive_names())
_BODIES: dict[str, BodyEntry] = {}


@checked
def register_body(
    name: str, factory: Callable[..., Any], *, commands: Sequence[str] = (),
    settings: type[DiscSettings] = DriveSettings, speed: Speed | None = None,
) -> None:  # fmt: skip
    """Give a kind of body a name that ``robot.body.drive`` may use.

    factory: makes the body in the world that ships, from ``Parts``: a subclass of ``bayeshunt.Drive``.
    commands: keys of a gait in the order of the actuators; by default a gait gives a list called ``command``.
    settings: class of the body's own settings, derived from ``bayeshunt.DriveSettings``. speed: metres per second
    that a command moves the body's centre; by default the setting ``robot.body.top_speed`` says the most.

    Worker processes of an evaluation are told of it too. Raises InputError if the name is empty or ships, or the
    factory, the keys or the settings cannot be what they are for.
    """
    if not isinstance(name, str) or not name.strip():
        raise InputError(f"a body needs a name, got {shown(name)}")
    if name in _SHIPPED:
        raise InputError(f"a body called {name!r} ships already; choose another name")
    if not callable(factory):
        raise InputError(f"body {name!r}: expected a class or function that makes it, got {shown(factory)}")
    if isinstance(commands, str) or not all(isinstance(key, str) and key.isidentifier() for key in commands):
        raise InputError(f"body {name!r}: commands: expected the keys of a gait, for example ('left', 'right')")
    if not (isinstance(settings, type) and issubclass(settings, DiscSettings)):
        raise InputError(f"body {name!r}: settings: expected a class derived from bayeshunt.DriveSettings")
    entry = BodyEntry(factory, tuple(commands), settings, speed)
    _BODIES[name] = entry
    know_drive(name, DriveKind(settings, entry.commands, speed))


def registered_bodies() -> Mapping[str, BodyEntry]:
    """Return the bodies registered beside those that ship, by name."""
    return dict(_BODIES)


def body_factory(drive: str) -> Callable[..., Any]:
    """Return what makes a body of this kind in Box2D; InputError if the name is known nowhere."""
    from bayeshunt.worlds.box2d.legs import Legs
    from bayeshunt.worlds.box2d.wheels import CarDrive, DifferentialDrive

    shipped: dict[str, Callable[..., Any]] = {"differential": DifferentialDrive, "car": CarDrive, "legs": Legs}
    if drive in shipped:
        return shipped[drive]
    if drive not in _BODIES:
        raise InputError(f"unknown drive {drive!r}; register it with bayeshunt.register_body")
    return _BODIES[drive].factory
