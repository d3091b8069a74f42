"""Settings that can be right but hardly are: lengths in millimetres, times in milliseconds, turns in degrees."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import BaseModel

from bayeshunt.config.schema import ExperimentSettings, PreySettings, RobotSettings
from bayeshunt.core.errors import warn

__all__ = ["warn_implausible", "warn_of_other_motion"]

#: More distance bins than this in one gait, and fewer than this part of a body, are no gait that a table can show.
_MOST_BINS, _LEAST_BODIES = 1000, 0.05
#: One length is hardly this many times another one of the same experiment.
_TIMES = 1000.0
#: What turns faster than this [rad/s] turns in degrees.
_FAST_TURN = 12.6
#: What the gaits say of a body, and is no matter of a warning.
_COMPARED = ("body.diameter", "body.length")


def warn_implausible(settings: RobotSettings | ExperimentSettings, source: str) -> None:
    """Issue a DataWarning of one line, with the fix, for the first setting that looks like one of other units."""
    problems = _robot(settings, "") if isinstance(settings, RobotSettings) else _experiment(settings)
    problem = next(problems, None) or next(_turns(settings), None)
    if problem is not None:
        warn(f"{source}: {problem}")


def warn_of_other_motion(provenance: Mapping[str, Any], robot: RobotSettings) -> None:
    """Issue a DataWarning of one line if a model is of a robot whose body or noise moves it otherwise than ``robot``.

    provenance: the model's; what its records do not say differs from nothing. It is no error: a model may be tried on
    a floor that it was not learned on. (Body length, duration and commands are compared with the gaits: another is.)
    """
    differing: dict[str, str] = {}
    for source in provenance.get("sources", ()):
        recorded = source.get("robot") if isinstance(source, Mapping) else None
        differing |= _other_motion(recorded, robot) if isinstance(recorded, Mapping) else {}
    if differing:
        warn(
            f"the model's robot has {', '.join(differing.values())} in {robot.name}: it will move otherwise than the "
            "model says; fit a model of this robot, unless that is what you want to see"
        )


def _other_motion(recorded: Mapping[str, Any], robot: RobotSettings) -> dict[str, str]:
    """What a recorded robot's body and noise say otherwise than ``robot``, by key: "noise.slip 0.1, not 0.2"."""
    now = robot.model_dump(mode="json", include={"body", "noise"})
    return dict(_differences(recorded, now, ""))


def _differences(told: Mapping[str, Any], now: Mapping[str, Any], prefix: str) -> Iterator[tuple[str, str]]:
    """Each setting that was recorded and is another now, in groups of settings too: its key, and both values."""
    for name, value in now.items():
        key, before = f"{prefix}{name}", told.get(name)
        if isinstance(value, Mapping):
            yield from _differences(before, value, f"{key}.") if isinstance(before, Mapping) else ()
        elif before is not None and before != value and key not in _COMPARED:
            yield key, f"{key} {_plain(before)}, not {_plain(value)}"


def _plain(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def _experiment(settings: ExperimentSettings) -> Iterator[str]:
    bin_width = settings.model.distance_bin
    yield from _robot(settings.robot, "robot.", bin_width)
    yield from _prey(settings.prey, settings.robot, bin_width)
    protocol, body = settings.protocol, settings.robot.body.body_length
    if protocol.catch_distance >= protocol.prey_distance:
        yield (
            f"protocol.catch_distance: {protocol.catch_distance:g} bodies, and the prey starts at "
            f"{protocol.prey_distance:g}: every hunt ends before its first decision"
        )
    for name, arena in settings.arenas.items():
        for key in ("width", "height"):
            if getattr(arena, key) > _TIMES * body:
                yield _metres(f"arenas.{name}.{key}", getattr(arena, key), f"over {_TIMES:,.0f} body lengths")


def _robot(robot: RobotSettings, prefix: str, bin_width: float = 0.1) -> Iterator[str]:
    body, speed = robot.body, robot.known_top_speed
    reach = 0.0 if speed is None else speed * robot.gait_duration
    if 0 < reach < _LEAST_BODIES * body.body_length:
        yield _metres(f"{prefix}body.diameter", body.diameter, f"but no gait goes beyond {reach:.3g} m")
    if reach > _MOST_BINS * bin_width * body.body_length:
        yield (
            f"{prefix}gait: {speed:g} m/s for {robot.gait_duration:g} s makes over 1,000 distance bins; if "
            "speeds are in mm/s or gait_duration is in ms, divide by 1000; else make model.distance_bin wider"
        )
    for key in ("axle", "wheelbase"):
        if getattr(body, key, 0.0) > _TIMES / 10 * body.diameter:
            yield _metres(f"{prefix}body.{key}", getattr(body, key), f"but the body is {body.diameter:g} m")


def _prey(prey: PreySettings, robot: RobotSettings, bin_width: float) -> Iterator[str]:
    body = robot.body.body_length
    if prey.speed * robot.gait_duration > _MOST_BINS * bin_width * body:
        yield (
            f"prey.speed: {prey.speed:g} m/s for {robot.gait_duration:g} s makes over 1,000 distance bins; "
            f"if it is in mm/s, give {prey.speed / 1000:g}"
        )
    if not body / _TIMES < prey.body.diameter < _TIMES / 10 * body:
        yield _metres("prey.body.diameter", prey.body.diameter, f"but the hunter's body is {body:g} m")
    if prey.sensor_range > _TIMES * prey.body.diameter:
        yield _metres("prey.sensor_range", prey.sensor_range, f"over {_TIMES:,.0f} body lengths")


def _turns(settings: BaseModel, prefix: str = "") -> Iterator[str]:
    """Whatever the settings describe as a rate of turning, in any group."""
    for name, field in type(settings).model_fields.items():
        value = getattr(settings, name)
        if isinstance(value, BaseModel):
            yield from _turns(value, f"{prefix}{name}.")
        elif "[rad/s]" in (field.description or "") and value > _FAST_TURN:
            yield f"{prefix}{name}: {value:g} rad/s; if it is in degrees/s, multiply by pi / 180"


def _metres(key: str, value: float, beside: str) -> str:
    return f"{key}: {value:g} m, {beside}; if it is in millimetres, give {value / 1000:g}"
