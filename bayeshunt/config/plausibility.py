"""Settings that can be right but hardly are: lengths in millimetres, times in milliseconds, turns in degrees."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import BaseModel

from bayeshunt.config.schema import ExperimentSettings, PreySettings, RobotSettings
from bayeshunt.core.errors import warn

__all__ = ["implausible", "warn_of_mixed_motion", "warn_of_other_motion"]

#: More distance bins than this in one gait, and fewer than this part of a body, are no gait that a table can show.
_MOST_BINS, _LEAST_BODIES = 1000, 0.05
#: One length is hardly this many times another one of the same experiment.
_TIMES = 1000.0
#: What turns faster than this [rad/s] turns in degrees.
_FAST_TURN = 12.6
#: What the gaits say of a body, and is no matter of a warning.
_COMPARED = ("body.diameter", "body.length")
#: Groups of a robot's settings that say how it moves.
_MOVING = ("body", "noise")


def implausible(settings: RobotSettings | ExperimentSettings) -> str | None:
    """Return in one line, with the fix, the first setting that looks like one of other units; None if none does."""
    problems = _robot(settings, "") if isinstance(settings, RobotSettings) else _experiment(settings)
    return next(problems, None) or next(_turns(settings), None)


def warn_of_other_motion(provenance: Mapping[str, Any] | None, robot: RobotSettings, what: str = "model") -> None:
    """Issue a DataWarning of one line if rows are of a robot whose body or noise moves it otherwise than ``robot``.

    provenance: that of the model, or of the table, which ``what`` says; what its records do not say differs from
    nothing. It is no error: a model may be tried on a floor that it was not learned on. (Body length, duration and
    commands are compared with the gaits: another is.)
    """
    if differing := _other_motion(provenance, robot.model_dump(mode="json", include={*_MOVING})):
        fix = "babble with" if what == "table" else "fit a model of"
        warn(
            f"the {what}'s robot has {differing} in {robot.name}: it will move otherwise than the {what} says; {fix} "
            "this robot, unless that is what you want to see"
        )


def warn_of_mixed_motion(record: Mapping[str, Any] | None, provenance: Mapping[str, Any], what: str = "table") -> None:
    """Issue a DataWarning of one line if body or noise of a robot on record are not those of a model's robot.

    record: of ``what``, a table or what was made with another model. provenance: the model's.
    """
    for own in _robots(provenance):
        if differing := _other_motion(record, {k: own[k] for k in _MOVING if isinstance(own.get(k), Mapping)}):
            warn(
                f"the {what}'s robot has {differing} in the model's: they move otherwise; use those of one robot, "
                "unless that is what you want to see"
            )
            return


def _other_motion(provenance: Mapping[str, Any] | None, now: Mapping[str, Any]) -> str:
    """What the robots of a record say otherwise than ``now`` does: "noise.slip 0.1, not 0.2"; empty for nothing."""
    found: dict[str, str] = {}
    for recorded in _robots(provenance):
        found |= _differences(recorded, now, "")
    return ", ".join(found.values())


def _robots(provenance: Mapping[str, Any] | None) -> Iterator[Mapping[str, Any]]:
    """Settings of the robots that a table's record, or those of a model's tables, name."""
    record = provenance or {}
    for source in record.get("sources", (record,)):
        robot = source.get("robot") if isinstance(source, Mapping) else None
        if isinstance(robot, Mapping):
            yield robot


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
