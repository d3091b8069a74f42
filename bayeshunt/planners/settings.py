"""Settings of planners: frozen, typed, each with its meaning, unit and range; a wrong one is a line that names it."""

from __future__ import annotations

import dataclasses
import functools
import types
import typing
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Annotated, Any, Literal, TypeVar, dataclass_transform

import numpy as np
import pydantic
from pydantic import BeforeValidator, ConfigDict, Field, SkipValidation, ValidationError
from pydantic.fields import FieldInfo

from bayeshunt.core.errors import BayesHuntError, InputError, did_you_mean, shown

__all__ = ["Count", "File", "Number", "SettingField", "Switch", "planner_settings", "setting", "settings_fields"]

Kind = TypeVar("Kind")


def _plain(value: Any) -> Any:
    """A number of Python: NumPy's own are taken as well."""
    return value.item() if isinstance(value, np.generic) else value


#: A finite number, a whole number, true or false; never a text, and no truth passes for a number.
Number = Annotated[float, BeforeValidator(_plain)]
Count = Annotated[int, BeforeValidator(_plain)]
Switch = Annotated[bool, BeforeValidator(_plain)]
#: A thing that was made beforehand, or the path of its file; whoever reads it checks it.
_MADE = "made beforehand"
File = Annotated[Kind, SkipValidation, _MADE]

#: Limits as pydantic calls them.
_SIGNS = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}
_WORDS: dict[Any, str] = {int: "a whole number", float: "a number", bool: "true or false"}


def setting(
    default: Any, meaning: str, *, unit: str = "", range: str = "", gt: float | None = None, ge: float | None = None,
    lt: float | None = None, le: float | None = None, kw_only: bool = False,
) -> Any:  # fmt: skip
    """Return a setting's default with what is said of it.

    meaning: what it does, without its range. unit: what an error calls the number ("body lengths"). range: in words,
    where the limits (above gt, at least ge, below lt, at most le) do not say all of it. kw_only: given by name alone.
    """
    extra: Any = {"unit": unit, "range": range}
    return Field(default, description=meaning, json_schema_extra=extra, gt=gt, ge=ge, lt=lt, le=le, kw_only=kw_only)


@dataclass_transform(frozen_default=True, field_specifiers=(setting,))
def planner_settings(planner: str) -> Callable[[type[Kind]], type[Kind]]:
    """Make a class the settings of ``planner``: a frozen dataclass whose wrong values are InputErrors of one line."""
    config = ConfigDict(strict=True, allow_inf_nan=False, arbitrary_types_allowed=True, extra="forbid")

    def decorate(cls: type[Kind]) -> type[Kind]:
        made = pydantic.dataclasses.dataclass(frozen=True, config=config)(cls)
        validate = made.__init__

        @functools.wraps(validate)
        def init(self: Any, *given: Any, **named: Any) -> None:
            try:
                validate(self, *given, **named)
            except ValidationError as error:
                raise _explained(error, planner, made) from None

        made.__init__ = init  # type: ignore[method-assign]
        return typing.cast("type[Kind]", made)

    return decorate


@dataclass(frozen=True)
class SettingField:
    """What is known of a setting: ``hint`` is its type, without its limits."""

    name: str
    hint: Any
    default: Any
    meaning: str
    range: str
    unit: str


def settings_fields(kind: type) -> Iterator[SettingField]:
    """Yield what is known of every setting of a class made by :func:`planner_settings`, files first, those given by
    name alone last."""
    hints = typing.get_type_hints(kind)
    fields: dict[str, FieldInfo] = kind.__pydantic_fields__  # type: ignore[attr-defined]
    order = sorted(dataclasses.fields(kind), key=lambda field: (not _is_file(fields[field.name]), field.kw_only))
    for field in order:
        info, hint = fields[field.name], hints[field.name]
        extra = typing.cast("dict[str, str]", info.json_schema_extra or {})
        said = extra.get("range") or _range(info, hint)
        yield SettingField(field.name, hint, info.default, info.description or "", said, extra.get("unit", ""))


def _is_file(info: FieldInfo) -> bool:
    return _MADE in info.metadata


def _range(info: FieldInfo, hint: Any) -> str:
    """Return the limits of a number, or the choices, in words."""
    if typing.get_origin(hint) is Literal:
        return " | ".join(typing.get_args(hint))
    limits = {sign: getattr(part, sign) for part in info.metadata for sign in _SIGNS if hasattr(part, sign)}
    low = next(((_SIGNS[sign], limits[sign]) for sign in ("ge", "gt") if sign in limits), None)
    high = next(((_SIGNS[sign], limits[sign]) for sign in ("le", "lt") if sign in limits), None)
    if low and high:
        return f"in {'[' if low[0] == '>=' else '('}{low[1]}, {high[1]}{']' if high[0] == '<=' else ')'}"
    return " ".join(map(str, low or high or ()))


def _explained(error: ValidationError, planner: str, kind: type) -> BayesHuntError:
    """Return the error of one line for the first thing that is wrong."""
    first = error.errors(include_url=False)[0]
    raised = first.get("ctx", {}).get("error")
    if isinstance(raised, BayesHuntError):
        return raised
    name = str(first["loc"][0]) if first["loc"] else ""
    field = next((f for f in settings_fields(kind) if f.name == name), None)
    if field is None:
        names = [known.name for known in settings_fields(kind)]
        return InputError(f"{planner}: has no setting {name!r}{did_you_mean(name, names)}")
    return InputError(f"{planner}: {name} must be {_expected(field)}, got {shown(first['input'])}")


def _expected(field: SettingField) -> str:
    """Return what a setting takes, in words: "a whole number >= 1"."""
    hint = field.hint
    if isinstance(hint, types.UnionType) or typing.get_origin(hint) is typing.Union:
        hint = next(part for part in typing.get_args(hint) if part is not types.NoneType)
    if typing.get_origin(hint) is Literal:
        return f"one of {', '.join(typing.get_args(hint))}"
    if hint not in _WORDS:
        return "a function" if typing.get_origin(hint) is not None else f"a {getattr(hint, '__name__', 'value')}"
    if hint is float and not field.unit:
        return f"a number {field.range.replace('>= ', 'of at least ')}".rstrip()
    return f"{field.unit or _WORDS[hint]} {field.range}".rstrip()
