"""Arguments of the wrong kind, refused by one mechanism: the type hints of public functions and values.

:func:`checked` wraps a function, :func:`check_fields` serves a dataclass from its ``__post_init__``. Both say in
one line which argument is wrong, before any work. Ranges are the function's own business; what a hint cannot
say in words (protocols, Any) passes.
"""

from __future__ import annotations

import builtins
import collections.abc as abc
import functools
import inspect
import os
import sys
import types
import typing
from collections.abc import Callable, Mapping
from dataclasses import fields
from numbers import Integral, Real
from operator import attrgetter
from typing import Any, ParamSpec, TypeVar

import numpy as np

from bayeshunt.core.errors import InputError, shown

__all__ = ["check_fields", "checked", "checked_but"]

P = ParamSpec("P")
R = TypeVar("R")


class _Rule(typing.NamedTuple):
    """What a hint takes, in words what that is, and types that are taken without another look."""

    accepts: Callable[[Any], bool]
    words: str
    kinds: frozenset[type] = frozenset()


def checked(function: Callable[P, R]) -> Callable[P, R]:
    """Return ``function`` with its arguments held to its type hints (but numbers): InputError names the wrong one."""
    return checked_but()(function)


def checked_but(*left: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Return :func:`checked` for a function that checks the arguments ``left`` itself, in better words."""
    # Numbers are left to the checks of their range inside, which say better what is expected.
    numbers = {f"{rule.words}{none}" for rule in (_PLAIN[float], _PLAIN[int]) for none in ("", " or None")}

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        names = [p.name for p in inspect.signature(function).parameters.values() if p.kind is not p.VAR_POSITIONAL]

        @functools.wraps(function)
        def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
            rules = _rules(function)
            for name, value in (*zip(names, args, strict=False), *kwargs.items()):
                rule = rules.get(name)
                if rule is None or type(value) in rule.kinds or rule.words in numbers or name in left:
                    continue
                if not rule.accepts(value):
                    raise InputError(f"{name}: expected {rule.words}, got {shown(value)}")
            return function(*args, **kwargs)

        return wrapper

    return decorate


def check_fields(value: Any) -> None:
    """Raise InputError that names the first field of a dataclass whose value is not of the kind that its hint says."""
    kind = type(value)
    if kind not in _fields:
        rules, given = _rules(kind), [field.name for field in fields(value) if field.init]
        named = [(name, rules[name]) for name in given if name in rules]
        _fields[kind] = _reader([name for name, _ in named]), named
    read, named = _fields[kind]
    for part, (name, rule) in zip(read(value), named, strict=True):
        if type(part) not in rule.kinds and not rule.accepts(part):
            raise InputError(f"{kind.__name__}: {name}: expected {rule.words}, got {shown(part)}")


class _Names(dict[str, Any]):
    """The names of a module; one that it imports for type checkers only means anything."""

    def __missing__(self, name: str) -> Any:
        return sys.modules.get("pandas", _Anything()) if name == "pd" else getattr(builtins, name, Any)


class _Anything:
    """A module that nobody has imported: nothing of it can be given, so whatever is given is not looked at."""

    def __getattr__(self, name: str) -> Any:
        return Any


#: Rules that were made, by function or class.
_known: dict[Any, dict[str, _Rule]] = {}
#: What reads the fields of a class that have a rule, all at once, and their names and rules.
_fields: dict[type, tuple[Callable[[Any], tuple[Any, ...]], list[tuple[str, _Rule]]]] = {}


def _reader(names: list[str]) -> Callable[[Any], tuple[Any, ...]]:
    """What gives the values of these fields of an object as a tuple."""
    if len(names) > 1:
        return attrgetter(*names)
    return lambda value: tuple(getattr(value, name) for name in names)


def _rules(owner: Any) -> dict[str, _Rule]:
    """The rules of a function's parameters or of a class's fields, made when first needed."""
    if owner in _known:
        return _known[owner]
    hints: dict[str, Any] = {}
    for base in reversed(getattr(owner, "__mro__", (owner,))):
        space = _Names(vars(sys.modules[base.__module__]))
        for name, hint in getattr(base, "__annotations__", {}).items():
            hints[name] = eval(hint, {}, space) if isinstance(hint, str) else hint
    found = {name: _rule(hint) for name, hint in hints.items() if name != "return"}
    return _known.setdefault(owner, {name: rule for name, rule in found.items() if rule is not None})


def _plain(words: str, accepts: Callable[[Any], bool], *kinds: type) -> _Rule:
    return _Rule(accepts, words, frozenset(kinds))


#: Kinds of one value: what is taken for the hint, and its words. NumPy's numbers count as Python's.
_PLAIN: dict[Any, _Rule] = {
    float: _plain("a number", lambda v: isinstance(v, Real) and not isinstance(v, (bool, np.bool_)), float, int),
    int: _plain("a whole number", lambda v: isinstance(v, Integral) and not isinstance(v, (bool, np.bool_)), int),
    bool: _plain("True or False", lambda v: isinstance(v, (bool, np.bool_)), bool),
    str: _plain("text", lambda v: isinstance(v, str), str),
    type(None): _plain("None", lambda v: v is None, type(None)),
    np.ndarray: _plain(
        "an array of numbers", lambda v: isinstance(v, (list, tuple)) or hasattr(v, "__array__"), np.ndarray
    ),
    os.PathLike: _plain("a path", lambda v: isinstance(v, os.PathLike)),
    abc.Callable: _plain("a function", callable),
    abc.Mapping: _plain("a dict", lambda v: isinstance(v, Mapping), dict),
    dict: _plain("a dict", lambda v: isinstance(v, Mapping), dict),
}
#: Kinds of many values.
_MANY = (abc.Iterable, abc.Sequence, abc.Collection, list, tuple)


def _rule(hint: Any) -> _Rule | None:
    """The rule of a type hint; None where anything may pass."""
    origin, args = typing.get_origin(hint), typing.get_args(hint)
    if origin is typing.Annotated:
        return _rule(args[0])
    if origin in (typing.Union, types.UnionType):
        return _either([_rule(option) for option in args])
    if origin is typing.Literal:
        return _Rule(lambda v: v in args, " or ".join(map(repr, args)))
    kind = origin or (type(None) if hint is None else hint)
    if kind in _PLAIN:
        return _PLAIN[kind]
    if kind in _MANY:
        return _many(args)
    if not isinstance(kind, type) or kind in (Any, object) or getattr(kind, "_is_protocol", False):
        return None
    article = "an" if kind.__name__[:1] in "AEIOU" else "a"
    return _Rule(lambda v: isinstance(v, kind), f"{article} {kind.__name__}", frozenset({kind}))


def _either(options: list[_Rule | None]) -> _Rule | None:
    rules = [rule for rule in options if rule is not None]
    if len(rules) < len(options):
        return None
    *most, last = dict.fromkeys(rule.words for rule in rules)
    words = f"{', '.join(most)} or {last}" if most else last
    return _Rule(
        lambda v: any(rule.accepts(v) for rule in rules), words, frozenset().union(*(rule.kinds for rule in rules))
    )


def _many(args: tuple[Any, ...]) -> _Rule:
    """A list, tuple, array or other iterable, never a text; the values of lists and tuples are looked at too."""
    each = _rule(str) if str in args[:1] else None  # other values are looked at where they are used
    of = "" if each is None else " of texts"

    def accepts(value: Any) -> bool:
        if isinstance(value, (str, bytes, Mapping)) or not isinstance(value, abc.Iterable):
            return False
        return each is None or not isinstance(value, (list, tuple)) or all(map(each.accepts, value))

    return _Rule(accepts, f"a list{of}")
