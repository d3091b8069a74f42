"""What every planner is, knows, needs and can be set to: read from its class and settings, kept nowhere else.

A docstring says of the literature ``Reference: ...`` or ``(paper, ...)``. That of a planner of a user's own, whose
settings are keyword arguments, says of each ``name: meaning, range.`` at the start of a line or a sentence (several
names may share one meaning: ``one, two: meaning``).
"""

from __future__ import annotations

import inspect
import os
import re
import types
import typing
from collections.abc import Iterator
from typing import Any, Literal, NamedTuple

from bayeshunt.core.arguments import checked
from bayeshunt.planners.cost import Cost
from bayeshunt.planners.info import FUTURE
from bayeshunt.planners.registry import Factory, find_planner, is_ab_initio, is_shipped, made_by
from bayeshunt.planners.settings import settings_fields

__all__ = ["BABBLED", "PlannerFacts", "Setting", "describe_planner", "summarise"]

#: Default of a room that a planner learns by babbling in its arena.
BABBLED = "babbled"
_PAPER = "Oses, Hoffmann and Koene (HAIS 2010)"
_TYPES = {int: "whole number", float: "number", bool: "true or false", str: "text", types.NoneType: "none"}
_NUMBER = r"-?\d+(?:\.\d+)?"
#: A range as docstrings write it: ">= 1", "> 0", "in [0, 1)", "0 < one < other".
_RANGE = re.compile(
    rf"[,:]? ?((?:in [\[(]{_NUMBER}, {_NUMBER}[\])])|(?:[<>]=? {_NUMBER})|(?:{_NUMBER} <=? \w+(?: <=? \w+)*))"
)

#: Sentences that a page has in another place, or that are for programmers.
_SAID_ELSEWHERE = re.compile(r"(?:^|(?<=\.)\s)(?:Reference: .*|``rng`` [^.]*\.)", re.DOTALL)


class Setting(NamedTuple):
    """One setting of a planner.

    kind: "number", "whole number", "true or false", "text", "file" or what else it takes. range: as its
    docstring says it, "" if it says none. default: its value; "required" if there is none; "babbled" for a
    room that is learned in the arena before the hunts.
    """

    name: str
    kind: str
    range: str
    default: Any
    meaning: str


class PlannerFacts(NamedTuple):
    """What is known of a planner.

    summary: one line. details: the rest of what its docstring says, without its settings. reference: "" if it
    names none. ab_initio: whether it learns all it knows within the run. shipped: False for one that was
    registered here. needs: setting and command that makes its file, of every file it cannot do without.
    needs_future: whether it is told the prey's future.
    """

    name: str
    summary: str
    details: str
    reference: str
    ab_initio: bool
    shipped: bool
    needs: dict[str, str]
    needs_future: bool
    settings: tuple[Setting, ...]


@checked
def describe_planner(name: str) -> PlannerFacts:
    """Return what is known of a registered planner; InputError for another name."""
    entry = find_planner(name)
    kind, info = made_by(entry.factory), entry.info
    settings = _typed(entry.typed) if entry.typed is not None else _signed(entry.factory, kind, entry.settings)
    if info.prepare is not None:
        settings = tuple(s._replace(default=BABBLED) if s.name == info.prepare else s for s in settings)
    own = inspect.cleandoc(kind.__doc__ or "")
    return PlannerFacts(
        name=name,
        summary=summarise(kind),
        details=_details(own, tuple(s.name for s in settings)),
        reference=_reference(own),
        ab_initio=is_ab_initio(name),
        shipped=is_shipped(name),
        needs={s.name: info.maker or _maker(s.meaning) for s in settings if s.kind == "file" and s.default != BABBLED},
        needs_future=FUTURE in info.needs,
        settings=settings,
    )


def _typed(kind: type) -> tuple[Setting, ...]:
    """Return the settings that a class of settings declares."""
    return tuple(_setting(f.name, f.hint, f.default, f.meaning, f.range) for f in settings_fields(kind))


def _signed(factory: Factory, kind: Any, accepted: tuple[str, ...] | None) -> tuple[Setting, ...]:
    """Return the settings that somebody's own factory takes by keyword, with what its docstrings say of them."""
    fields = {key: value for key, value in _fields(factory) if accepted is None or key in accepted}
    meanings = _meanings([text for place in (kind, factory) for text in _docstrings(place)], tuple(fields))
    settings = []
    for name, (hint, default) in fields.items():
        said = meanings.get(name, [""])
        limits = next(filter(None, map(_RANGE.search, said)), None)
        words = re.findall(r'"([^"]+)"', said[0]) if _kind(hint) == "text" else []
        range_ = limits[1] if limits else " | ".join(words)
        settings.append(_setting(name, hint, default, _RANGE.sub("", said[0], count=1), range_))
    return tuple(settings)


def summarise(kind: Any) -> str:
    """Return in one line what a planner's class is; "" if it does not say."""
    first = inspect.cleandoc(kind.__doc__ or "").split("\n\n")[0]
    return re.sub(r" \(paper, .*?\)", "", _plain(" ".join(first.split()))).rstrip(".")


def _hints(thing: Any) -> dict[str, Any]:
    try:
        return typing.get_type_hints(thing)
    except (NameError, TypeError, AttributeError):  # somebody's own annotations that cannot be looked up
        return {}


def _fields(factory: Factory) -> Iterator[tuple[str, tuple[Any, Any]]]:
    """Yield (name, (annotation, default)) of every setting."""
    hints = _hints(factory.__init__ if isinstance(factory, type) else factory)  # type: ignore[misc]
    for parameter in list(inspect.signature(factory).parameters.values())[1:]:
        if parameter.kind in (parameter.POSITIONAL_OR_KEYWORD, parameter.KEYWORD_ONLY):
            yield parameter.name, (hints.get(parameter.name), parameter.default)


def _setting(name: str, hint: Any, default: Any, meaning: str, range: str) -> Setting:
    """Return a setting with its default in words where it is no plain value."""
    kind = _kind(hint)
    if default is inspect.Parameter.empty or (kind == "file" and default is None):
        default = "required"
    elif not isinstance(default, (bool, int, float, str, types.NoneType)):
        default = getattr(default, "__name__", str(default))
    return Setting(name, kind, range, default, meaning)


def _kind(hint: Any) -> str:
    """Return what a settings file may give for an annotation; "any" without one."""
    if typing.get_origin(hint) is Literal:
        return "text"
    options = typing.get_args(hint) or (hint,)
    if any(os.PathLike in (h, typing.get_origin(h)) for h in options):
        return "file"
    if hint is Cost:
        return "group"
    names = [_TYPES[h] for h in options if isinstance(h, type) and h in _TYPES]
    return " or ".join(names) or ("any" if hint is None else "Python only")


def _docstrings(place: Any) -> Iterator[str]:
    """Yield the docstrings of a class and of those that it is made from, or of a function."""
    for part in place.__mro__ if isinstance(place, type) else (place,):
        if part is not object and part is not None and part.__doc__:
            yield inspect.cleandoc(part.__doc__)


def _named(names: tuple[str, ...]) -> re.Pattern[str]:
    """What introduces settings in a docstring: their names and a colon, where a sentence begins."""
    one = "|".join(map(re.escape, names)) or r"(?!)"
    return re.compile(rf"(?:^|(?<=\. ))((?:{one})(?:, (?:{one}))*): ")


def _meanings(texts: list[str], names: tuple[str, ...]) -> dict[str, list[str]]:
    """Return what the docstrings say of each setting, in their order."""
    found: dict[str, list[str]] = {}
    for text in texts:
        for paragraph in re.split(r"\n\s*\n", text):
            parts = _named(names).split(" ".join(paragraph.split()))
            for listed, said in zip(parts[1::2], parts[2::2], strict=True):
                meaning = _plain(re.split(r"(?:^|(?<=\. ))(?:``rng``|Reference:) ", said)[0]).strip().rstrip(".")
                for name in listed.split(", "):
                    found.setdefault(name, []).append(meaning)
    return found


def _details(text: str, names: tuple[str, ...]) -> str:
    """Return the paragraphs after the first that do not list settings, name literature or speak of ``rng``."""
    kept = (_SAID_ELSEWHERE.sub("", paragraph).rstrip() for paragraph in re.split(r"\n\s*\n", text)[1:])
    return "\n\n".join(_plain(p) for p in kept if p and not _named(names).match(" ".join(p.split())))


def _reference(text: str) -> str:
    """Return the literature that a docstring names, "" if none."""
    flat = " ".join(text.split())
    if named := re.search(r"Reference: (.+?)\.(?= ``rng``|$)", flat):
        return named[1]
    paper = re.search(r"\(paper, (.+?)\)", flat)
    return f"{_PAPER}: {paper[1]}" if paper else ""


def _maker(meaning: str) -> str:
    """Return the command that makes a file, "" if its meaning names none."""
    named = re.search(r"bayeshunt \w+", meaning)
    return named[0] if named else ""


def _plain(text: str) -> str:
    """Return a docstring's text without its markup."""
    text = re.sub(r":\w+:`~?([^`]*\.)?([^`.]+)`", r"\2", text)
    return text.replace("``", "").replace("`", "")
