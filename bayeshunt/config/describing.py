"""The keys of settings files in words: name, range, default and meaning, read off the schema."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from bayeshunt.config.schema import ExperimentSettings, RobotSettings
from bayeshunt.config.schema.drives import drive_names
from bayeshunt.config.schema.legs import LegGait, LeggedSettings
from bayeshunt.config.schema.mujoco import MujocoGait, MujocoSettings
from bayeshunt.core.errors import ConfigError, did_you_mean

__all__ = ["describe", "keys_at", "keys_ending_in"]


def describe(kind: str) -> list[dict[str, Any]]:
    """Return every key of an "experiment" or "robot" settings file: key, range, default, meaning.

    range: what it takes, in the words of ``bayeshunt planners NAME`` ("text", "whole number >= 1"). A key of a robot
    that another kind of body takes with another range, default or meaning has a row for each, which names the kind.
    Raises ConfigError for another kind.
    """
    kinds: dict[str, type[BaseModel]] = {"experiment": ExperimentSettings, "robot": RobotSettings}
    if kind not in kinds:
        near = did_you_mean(kind, kinds, listed=False) or "; expected experiment or robot"
        raise ConfigError(f"unknown kind of settings {kind!r}{near}")
    keys = list(_describe(kinds[kind], ""))
    if kind == "robot":
        for prefix, drive in _LEGS:
            keys += [key for key in _describe(drive, prefix) if key not in keys and key["key"] != _DRIVE]
        next(key for key in keys if key["key"] == _DRIVE)["range"] = " | ".join(drive_names())
        groups = list(dict.fromkeys(key["key"].split(".")[0] for key in keys))
        keys.sort(key=lambda key: groups.index(key["key"].split(".")[0]))
    return keys


_DRIVE = "body.drive"
#: Settings that only bodies on legs, and those in MuJoCo, have, and where they stand in a robot's file.
_LEGS: tuple[tuple[str, type[BaseModel]], ...] = (
    ("body.", LeggedSettings), ("gait[].", LegGait), ("body.", MujocoSettings), ("gait[].", MujocoGait),
)  # fmt: skip


def keys_at(kind: Any, location: tuple[Any, ...]) -> list[str]:
    """Names of the settings that may stand at ``location``."""
    for part in location:
        fields = getattr(kind, "model_fields", {})
        if part in fields:
            kind = _settings_inside(fields[part].annotation) or kind
    return list(getattr(kind, "model_fields", {}))


def keys_ending_in(kind: type[BaseModel], name: str) -> list[str]:
    """Return the dotted keys of settings whose last part is ``name``."""
    return [key["key"] for key in _describe(kind, "") if key["key"].rpartition(".")[2] == name]


#: Groups whose description says what is in them.
_SAID = ("published", "obstacles")


def _describe(kind: type[BaseModel], prefix: str) -> Iterator[dict[str, Any]]:
    schema = kind.model_json_schema()["properties"]
    for name, info in kind.model_fields.items():
        inner = None if name in _SAID else _settings_inside(info.annotation)
        if inner is not None:
            many = "" if inner is info.annotation else "[]" if name == "gait" else ".<name>"
            yield from _describe(inner, f"{prefix}{name}{many}.")
            continue
        default = None if info.is_required() else info.get_default(call_default_factory=True)
        yield {
            "key": prefix + name,
            "range": _range(schema.get(name, {})),
            "default": "required" if info.is_required() else default,
            "meaning": info.description or "",
        }


def _settings_inside(annotation: Any) -> type[BaseModel] | None:
    """The settings class that an annotation is or holds, if any."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    inside = map(_settings_inside, getattr(annotation, "__args__", ()))
    return next((found for found in inside if found is not None), None)


#: Types of a JSON schema in words.
_TYPES = {
    "string": "text", "integer": "whole number", "number": "number", "boolean": "true or false", "array": "list",
    "object": "group", "null": "none", None: "any",
}  # fmt: skip


def _range(schema: dict[str, Any]) -> str:
    """A readable range from a JSON schema."""
    if "enum" in schema:
        return " | ".join(map(str, schema["enum"]))
    if "anyOf" in schema:
        return " or ".join(_range(option) for option in schema["anyOf"])
    if schema.get("type") == "array":
        return _list_range(schema)
    low = schema.get("minimum", schema.get("exclusiveMinimum"))
    high = schema.get("maximum", schema.get("exclusiveMaximum"))
    limits = []
    if low is not None and low > -1e6:
        limits.append(f"{'>=' if 'minimum' in schema else '>'} {low:g}")
    if high is not None and high < 1e6:
        limits.append(f"{'<=' if 'maximum' in schema else '<'} {high:g}")
    return f"{_TYPES[schema.get('type')]} {', '.join(limits)}".rstrip()


def _list_range(schema: dict[str, Any]) -> str:
    """The same of a list: how many of what, where its items are numbers or lists of them."""
    item = schema["prefixItems"][0] if "prefixItems" in schema else schema.get("items", {})
    inside = _range(item) if item.get("type") in ("number", "integer", "array") else ""
    if not inside:
        return "list"
    low, high = schema.get("minItems"), schema.get("maxItems")
    many = "" if high is None else f" {high}" if low == high else f" {low} to {high}" if low else f" up to {high}"
    one, space, limits = inside.partition(" ") if item["type"] != "integer" else ("whole number", "", "")
    return f"list of{many} {one}s{space}{limits}"
