"""Finding and reading settings files: presets by name, your own TOML by path."""

from __future__ import annotations

import contextlib
import copy
import os
import tomllib
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from pydantic import BaseModel, ValidationError

from bayeshunt.config.describing import describe, keys_at, keys_ending_in
from bayeshunt.config.plausibility import implausible
from bayeshunt.config.scaling import absolute, rescaled
from bayeshunt.config.schema import ExperimentSettings, RobotSettings
from bayeshunt.config.schema.published import FORMS
from bayeshunt.core.arguments import checked_but
from bayeshunt.core.checks import check_kind
from bayeshunt.core.errors import ConfigError, InputError, did_you_mean, warn
from bayeshunt.core.gaits import Gait, GaitRepertoire
from bayeshunt.files.parquet import PROVENANCE_KEY

if TYPE_CHECKING:
    import pandas as pd

__all__ = [
    "DEFAULT_PRESET",
    "describe",
    "load_experiment",
    "load_robot",
    "parse",
    "preset_names",
    "recorded_gaits",
    "recorded_robot",
]

Kind = TypeVar("Kind", bound=BaseModel)
Loaded = TypeVar("Loaded", RobotSettings, ExperimentSettings)

#: The experiment that runs where none is named: the one that comes out as the paper reports it.
DEFAULT_PRESET = "oses2010"

#: The key that names a camera, and what another camera brings anew.
_CAMERA, _OF_A_CAMERA = "sensing.preset", ("sensor", "tracker", "camera", "tracker_settings")

_PRESETS = resources.files("bayeshunt") / "config" / "presets"


def load_robot(robot: str | os.PathLike[str] | RobotSettings) -> RobotSettings:
    """Return a robot given by preset name ("khepera", "car"), by TOML path, or as settings.

    Raises ConfigError in one line: file, key, what was expected.
    """
    if isinstance(robot, RobotSettings):
        return robot
    settings, source = _robot(robot)
    return _plausible(settings, source)


@checked_but("experiment")
def load_experiment(
    experiment: str | os.PathLike[str] | ExperimentSettings, overrides: dict[str, Any] | None = None
) -> ExperimentSettings:
    """Return an experiment given by preset name ("oses2010", "paper"), by TOML path, or as settings.

    overrides: values by dotted key, for example ``{"prey.speed": 0.04, "protocol.runs": 10}``. With another robot by
        name or path, the arenas and the prey are drawn to its length and top speed, what is overridden besides aside;
        ``scaled`` says so.
    A file may start from another with ``base = "paper"`` and change only some keys.
    """
    if overrides is not None:
        check_kind(overrides, "overrides", Mapping, "a dict of values by dotted key")
    if isinstance(experiment, ExperimentSettings):
        if not overrides:
            return experiment
        values, source = experiment.model_dump(), f"settings {experiment.name!r}"
    else:
        values, source = _read(experiment, "")
        values = _resolve(values, source)
    before = values
    values = copy.deepcopy(values)
    # A group before what is inside it, a preset before what changes it: the order of the changes means nothing.
    for key, value in sorted(
        (overrides or {}).items(), key=lambda change: (change[0] != "robot", change[0].count("."), change[0] != _CAMERA)
    ):
        if key == _CAMERA and isinstance(values.get("sensing"), dict):
            values["sensing"] = {k: v for k, v in values["sensing"].items() if k not in _OF_A_CAMERA}
        if key == "robot" and isinstance(value, str):
            robot = _robot(value)[0]
            if values.get("robot") is not None:
                values = rescaled(values, parse(RobotSettings, values["robot"], f"{source}: robot"), robot)
                values = _in_its_time(values, values["robot"], robot)
            value = robot.model_dump()
        _set(values, key, value, source)
    values = _in_metres(values, source)
    if overrides:
        _forget_publication(values, before, set(overrides))
    known = experiment if isinstance(experiment, ExperimentSettings) else None
    return _plausible(parse(ExperimentSettings, values, source), source, known)


def _in_its_time(values: dict[str, Any], before: Any, robot: RobotSettings) -> dict[str, Any]:
    """Settings whose physics step is the robot's, if it or the robot before it asks for one of its own."""
    usual, old = robot.physics, parse(RobotSettings, before, "robot").physics
    physics = values.get("physics", {})
    if usual == old or not isinstance(physics, dict):
        return values
    return {**values, "physics": {**physics, "step": usual.step, "control_steps": usual.control_steps}}


def _in_metres(values: dict[str, Any], source: str) -> dict[str, Any]:
    """Settings whose arenas and prey may be given relative to the hunter, with all of them in metres and seconds."""
    groups = [values.get("prey"), *(values["arenas"].values() if isinstance(values.get("arenas"), dict) else ())]
    if not any(isinstance(g, dict) and (g.get("relative") or g.get("in_bodies")) for g in groups):
        return values
    return absolute(values, parse(RobotSettings, values.get("robot"), f"{source}: robot"))


def recorded_robot(frame: pd.DataFrame | Mapping[str, Any], source: str = "") -> RobotSettings:
    """Return the robot that made a babbling table, from the provenance that babbling leaves in it.

    frame: the table, or its provenance record itself.
    source: what starts an error message, for example "babbling.parquet: ". Raises InputError if the
    table does not say, ConfigError if the record is damaged.
    """
    record = frame if isinstance(frame, Mapping) else frame.attrs.get(PROVENANCE_KEY, {})
    recorded = record.get("robot")
    if recorded is None:
        raise InputError(f"{source}the table does not say which robot made it; add --robot, or pass its gaits")
    return parse(RobotSettings, recorded, f"{source}provenance: robot")


def recorded_gaits(frame: pd.DataFrame | Mapping[str, Any], source: str = "") -> GaitRepertoire:
    """Return the gaits that a babbling table was made with: of a robot, or of a log, which has no settings.

    Arguments and errors as for :func:`recorded_robot`.
    """
    record = frame if isinstance(frame, Mapping) else frame.attrs.get(PROVENANCE_KEY, {})
    stored = record.get("repertoire")
    if stored is None:
        return recorded_robot(record, source).gaits
    try:
        gaits = tuple(Gait(str(g["name"]), tuple(map(float, g["command"]))) for g in stored["gaits"])
        return GaitRepertoire(gaits, body_length=stored["body_length"], duration=stored["duration"])
    except (KeyError, TypeError, ValueError) as error:
        raise ConfigError(f"{source}provenance: repertoire is damaged ({str(error).splitlines()[0]})") from None


def preset_names(folder: str = "") -> list[str]:
    """Return the names of the presets that ship: experiments, or "robots"."""
    place = _PRESETS / folder if folder else _PRESETS
    return sorted(p.name.removesuffix(".toml") for p in place.iterdir() if p.name.endswith(".toml"))


def _robot(robot: str | os.PathLike[str]) -> tuple[RobotSettings, str]:
    """Return a robot by name or path, and what to call it in a message."""
    values, source = _read(robot, "robots")
    return parse(RobotSettings, values, source), source


def _plausible(settings: Loaded, source: str, before: ExperimentSettings | None = None) -> Loaded:
    """The settings, after a warning if they look like some of other units; ``before``: what was warned of already."""
    problem = implausible(settings)
    if problem is not None and (before is None or problem != implausible(before)):
        warn(f"{source}: {problem}")
    return settings


def parse(kind: type[Kind], values: Any, source: str) -> Kind:
    """Return ``values`` as settings of ``kind``; a ConfigError names ``source``, the key and the fix."""
    try:
        return kind.model_validate(values)
    except ValidationError as error:
        raise ConfigError(f"{source}: {_explain(error, kind, values)}") from None


def _read(name: str | os.PathLike[str], folder: str) -> tuple[dict[str, Any], str]:
    """Return the parsed TOML of a preset name or path and what to call it in a message."""
    if not isinstance(name, (str, os.PathLike)):
        raise ConfigError(f"expected the name of a preset or the path of a .toml file, got {name!r}")
    text = os.fspath(name)
    if not text.endswith(".toml") and os.sep not in text:
        known = preset_names(folder)
        if text not in known:
            raise ConfigError(f"no preset called {text!r}{did_you_mean(text, [*known, 'a path to a .toml file'])}")
        place: Any = (_PRESETS / folder if folder else _PRESETS) / f"{text}.toml"
        source = f"preset {text!r}"
    else:
        place, source = Path(text), text
    try:
        return tomllib.loads(place.read_text(encoding="utf-8-sig")), source
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(f"{source}: not valid TOML: {error}") from None
    except UnicodeDecodeError:
        raise ConfigError(f"{source}: not a text file in UTF-8") from None
    except OSError as error:
        raise ConfigError(f"{source}: cannot be read ({error.strerror or error})") from None


def _resolve(values: dict[str, Any], source: str) -> dict[str, Any]:
    """Apply ``base`` and replace a robot given by name or path by its settings."""
    folder = Path(source).parent if source.endswith(".toml") else Path()
    base = values.pop("base", None)
    if base is not None:
        if not isinstance(base, str) or base not in preset_names():
            raise ConfigError(
                f"{source}: base: expected a preset ({', '.join(preset_names())}), got {base!r}"
                f"{did_you_mean(base, preset_names(), listed=False)}"
            )
        below, _ = _read(base, "")
        below = _resolve(below, base)
        named = {"name": Path(source).stem, **values}
        values = _merge(below, named)
        _resolve_robot(values, folder)
        _forget_publication(values, below, set(named))
    _resolve_robot(values, folder)
    return values


def _resolve_robot(values: dict[str, Any], folder: Path) -> None:
    robot = values.get("robot")
    if isinstance(robot, str):
        path = folder / robot if robot.endswith(".toml") else robot
        values["robot"] = _robot(path)[0].model_dump()


#: What makes an experiment another one than the published: change it, and the published figures say nothing.
_EXPERIMENT = ("robot", "prey", "arenas", "physics", "sensing", "protocol", "model")


def _forget_publication(values: dict[str, Any], before: dict[str, Any], given: set[str]) -> None:
    """Drop the published figures and reword the note where the experiment is no longer the published one."""
    changed = [key for key in _EXPERIMENT if _without_runs(values, key) != _without_runs(before, key)]
    if not changed or not before.get("published"):
        return
    if "published" not in given:
        values["published"] = {}
    if "note" not in given:
        values["note"] = (
            f"Changed from {before['name']!r} ({', '.join(changed)}), whose own settings were fitted to published "
            "totals; these figures have no published counterpart."
        )


def _without_runs(values: dict[str, Any], key: str) -> Any:
    """A group of settings as parsed, defaults filled in; more runs make no other experiment."""
    group = ExperimentSettings.model_fields[key].annotation
    given = values.get(key, {})
    if isinstance(group, type) and issubclass(group, BaseModel):
        with contextlib.suppress(ValidationError):  # said later, with its key
            given = group.model_validate(given).model_dump()
    if not isinstance(given, dict):
        return given  # not even a group: that too is said later
    return {name: value for name, value in given.items() if name != "runs"}


def _merge(below: dict[str, Any], above: dict[str, Any]) -> dict[str, Any]:
    merged = dict(below)
    for key, value in above.items():
        old = merged.get(key)
        merged[key] = _merge(old, value) if isinstance(old, dict) and isinstance(value, dict) else value
    return merged


def _set(values: dict[str, Any], dotted: str, value: Any, source: str) -> None:
    *groups, last = dotted.split(".")
    place = values
    for group in groups:
        inner = place.setdefault(group, {})
        if not isinstance(inner, dict):
            raise ConfigError(f"{source}: {dotted}: {group!r} is not a group of settings")
        place[group] = place = dict(inner)
    place[last] = value


def _explain(error: ValidationError, kind: type[BaseModel], values: Any) -> str:
    """One line for the first thing that is wrong in ``values``."""
    first = error.errors(include_url=False)[0]
    place = tuple(part for part in first["loc"] if part not in FORMS)
    key = _key(place, values)
    if first["type"] == "extra_forbidden":
        known = keys_at(kind, place[:-1])
        if place[-1] in known:  # those of every kind of group that there is are listed
            return f"{key}: unknown key for this {place[-2]}{_robots_with(values, place[:-1])}"
        hint = did_you_mean(place[-1], known, listed=False) or _elsewhere(kind, place[-1], first.get("input"))
        return f"{key}: unknown key{hint or did_you_mean(place[-1], known) or '; it is not a setting'}"
    if first["type"] == "missing":
        return f"{key}: required, but not given"
    message = str(first["msg"]).removeprefix("Value error, ")
    if not key:
        return message
    given = first.get("input")
    shown = f", got {given!r}" if isinstance(given, (str, int, float, bool)) and ", got " not in message else ""
    return f"{key}: {message[:1].lower()}{message[1:]}{shown}"


def _robots_with(values: Any, place: tuple[int | str, ...]) -> str:
    """How an error about a setting of another drive's body ends: the drive, and the robots that ship with it."""
    for part in place:
        values = values[part]
    drive = values.get("drive")
    robots = [name for name in preset_names("robots") if _robot(name)[0].body.drive == drive]
    start = f"; to start from a robot that has it: robot = {' or '.join(map(repr, robots))}" if robots else ""
    return f", whose drive is {drive!r}{start}" if drive else ""


def _elsewhere(kind: type[BaseModel], name: Any, value: Any) -> str:
    """How an error about an unknown key ends whose name, or that of the setting in it, stands in another group."""
    leaf = next(iter(value)) if isinstance(value, dict) and len(value) == 1 else name
    found = keys_ending_in(kind, str(leaf))
    return f"; did you mean {' or '.join(map(repr, found))}?" if 0 < len(found) < 4 else ""


def _key(location: tuple[int | str, ...], values: Any) -> str:
    """The dotted key of a place in ``values``; one of several groups by its number, from 1, and its name."""
    key = ""
    for part in location:
        try:
            values = values[part]
        except (KeyError, IndexError, TypeError):  # what is missing has no name
            values = None
        if isinstance(part, int) and isinstance(values, dict):
            name = f" ({values['name']!r})" if isinstance(values.get("name"), str) else ""
            key += f" {part + 1}{name}"
        else:
            key += f".{part}" if key else str(part)
    return key
