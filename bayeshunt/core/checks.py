"""Arguments of the wrong kind: refused in one line that names them, before anything is done with them.

Public functions call these first, so that a text where a number belongs is an InputError and not a
complaint of Python from somewhere inside. Names of files have theirs in :mod:`bayeshunt.files.atomic`.
"""

from __future__ import annotations

import math
from numbers import Integral, Real
from typing import Any

import numpy as np

from bayeshunt.core.errors import InputError, shown, warn
from bayeshunt.core.geometry import Polar

__all__ = [
    "FULL_TURN",
    "LEAST_PSEUDO_COUNT",
    "MOST_PSEUDO_COUNT",
    "beyond_a_turn",
    "check_bearings",
    "check_generator",
    "check_kind",
    "check_number",
    "check_numbers",
    "check_polar",
    "check_positive",
    "check_pseudo_count",
    "check_radians",
    "check_whole",
    "conforms",
    "warn_of_degrees",
]


def check_kind(value: Any, name: str, kind: type, expected: str) -> None:
    """Raise InputError unless ``value`` is a ``kind``; ``expected`` says it in words."""
    if not isinstance(value, kind):
        raise InputError(f"{name}: expected {expected}, got {shown(value)}")


#: What was found of a class and a protocol.
_conforming: dict[tuple[type, type], bool] = {}


def conforms(thing: object, protocol: type) -> bool:
    """Return ``isinstance(thing, protocol)``, looked at once per class: asking a protocol takes as long as a decision.

    protocol: a runtime-checkable one; a class keeps its promises in all its instances or in none.
    """
    key = type(thing), protocol
    found = _conforming.get(key)
    if found is None:
        found = _conforming[key] = isinstance(thing, protocol)
    return found


def check_whole(value: Any, name: str, least: int) -> None:
    """Raise InputError unless ``value`` is a whole number (of Python or NumPy) of at least ``least``."""
    if type(value) is int and value >= least:
        return
    if isinstance(value, bool) or not isinstance(value, Integral) or value < least:
        raise InputError(f"{name}: expected a whole number of at least {least}, got {shown(value)}")


def check_number(value: Any, name: str, expected: str = "a finite number") -> float:
    """Return ``value`` as a float; InputError unless it is a finite number (of Python or NumPy), no text, no truth."""
    if type(value) is float and math.isfinite(value):  # most are
        return value
    if isinstance(value, bool) or not isinstance(value, Real) or not math.isfinite(value):
        raise InputError(f"{name}: expected {expected}, got {shown(value)}")
    return float(value)


def check_positive(value: Any, name: str, unit: str) -> float:
    """Return ``value`` as a float; InputError unless it is a finite number above 0, of ``unit`` ("metres")."""
    if type(value) is float and 0 < value < math.inf:
        return value
    if isinstance(value, bool) or not isinstance(value, Real) or not 0 < float(value) < math.inf:
        raise InputError(f"{name} must be positive {unit}, got {shown(value)}")
    return float(value)


#: Pseudo-counts beyond these would overflow, or multiply to 0, in the tables' arithmetic.
LEAST_PSEUDO_COUNT, MOST_PSEUDO_COUNT = 1e-50, 1e9


def check_pseudo_count(value: Any, name: str) -> float:
    """Return a Dirichlet pseudo-count as a float; InputError unless it is 0, or from 1e-50 to 1e9."""
    if isinstance(value, bool) or not isinstance(value, Real):
        raise InputError(f"{name} is {shown(value)}; expected a pseudo-count >= 0")
    number = float(value)
    if not (math.isfinite(number) and number >= 0):
        raise InputError(f"{name} is {value}; expected a finite pseudo-count >= 0")
    if number and not LEAST_PSEUDO_COUNT <= number <= MOST_PSEUDO_COUNT:
        raise InputError(
            f"{name} is {number:g}; expected 0, or a pseudo-count from {LEAST_PSEUDO_COUNT:g} to {MOST_PSEUDO_COUNT:g}"
        )
    return number


#: One full turn [rad], rounded up: a number beyond it is likelier one of degrees than a direction.
FULL_TURN = 6.2832


def check_radians(value: Any, name: str, turns: int = 1) -> float:
    """Return ``value`` [rad] as a float; InputError unless it is a finite number of at most ``turns`` either way.

    For angles that people type: who reads degrees in every table types degrees sooner or later.
    """
    angle = check_number(value, name, "a finite number of radians")
    if abs(angle) > turns * FULL_TURN:
        raise InputError(f"{name}: {beyond_a_turn(angle, turns)}")
    return angle


def beyond_a_turn(angle: float, turns: int = 1) -> str:
    """Return what is wrong with an angle of more than ``turns`` full turns, and the fix."""
    return (
        f"expected radians from -{2 * turns} pi to {2 * turns} pi, got {angle:g}; "
        f"if that is in degrees, give {math.radians(angle):.4g} (degrees x pi / 180)"
    )


def warn_of_degrees(theta: float, name: str) -> None:
    """Issue a DataWarning of one line if a direction [rad], at a start, is of more than two turns.

    It is none of :func:`check_radians`: odometry need not be wrapped, and later a robot may have turned so often.
    """
    if abs(theta) > 2 * FULL_TURN:
        warn(f"{name}: theta is {theta:g} rad at the start; if that is in degrees, convert it: math.radians(theta)")


def check_numbers(values: Any, name: str) -> np.ndarray:
    """Return ``values`` as float64; InputError unless they are numbers in a regular array (NaN may be among them)."""
    try:
        array = np.asarray(values)
        if array.dtype.kind in "iuf":
            return array.astype(float, copy=False)
        if array.dtype.kind == "O" and all(_is_number(value) for value in array.flat):
            return array.astype(float)
    except (TypeError, ValueError):  # their messages speak of Python
        raise InputError(f"{name}: expected numbers, got {shown(values)}") from None
    kind = {"b": "truth values", "U": "text", "S": "bytes", "c": "complex numbers", "M": "dates"}.get(array.dtype.kind)
    what = f"{shown(values)} of {kind}" if kind and array.ndim else shown(values)
    raise InputError(f"{name}: expected numbers, got {what}")


def _is_number(value: Any) -> bool:
    return isinstance(value, Real) and not isinstance(value, (bool, np.bool_))


def check_bearings(values: np.ndarray, name: str, turns: int = 1) -> None:
    """Raise InputError if an angle [rad] of an array is beyond ``turns``, as :func:`check_radians`; NaN passes."""
    far = np.abs(values) > turns * FULL_TURN
    if far.any():
        raise InputError(f"{name}: {beyond_a_turn(float(values[far].flat[0]), turns)}")


def check_polar(value: Any, name: str) -> None:
    """Raise InputError unless ``value`` is a Polar of finite numbers with its angles within one turn.

    For what people hand in; poses made by the program itself need no check.
    """
    check_kind(value, name, Polar, "a Polar")
    check_number(value.distance, f"{name}.distance", "a finite number of metres")
    for part in ("angle", "heading"):
        check_radians(getattr(value, part), f"{name}.{part}")


def check_generator(rng: Any) -> None:
    """Raise InputError unless ``rng`` is a NumPy generator."""
    if not isinstance(rng, np.random.Generator):
        raise InputError(f"rng must be a numpy.random.Generator, got {shown(rng)}")
