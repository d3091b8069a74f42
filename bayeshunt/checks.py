"""Arguments of the wrong kind: refused in one line that names them, before anything is done with them.

Public functions call these first, so that a text where a number belongs is an InputError and not a
complaint of Python from somewhere inside. Names of files have theirs in :mod:`bayeshunt.files`.
"""

from __future__ import annotations

import math
from numbers import Integral, Real
from typing import Any

import numpy as np

from bayeshunt.errors import InputError, shown


def check_kind(value: Any, name: str, kind: type, expected: str) -> None:
    """Raise InputError unless ``value`` is a ``kind``; ``expected`` says it in words."""
    if not isinstance(value, kind):
        raise InputError(f"{name}: expected {expected}, got {shown(value)}")


def check_whole(value: Any, name: str, least: int) -> None:
    """Raise InputError unless ``value`` is a whole number (of Python or NumPy) of at least ``least``."""
    if isinstance(value, bool) or not isinstance(value, Integral) or value < least:
        raise InputError(f"{name}: expected a whole number of at least {least}, got {shown(value)}")


def check_number(value: Any, name: str, expected: str = "a finite number") -> float:
    """Return ``value`` as a float; InputError unless it is a finite number (of Python or NumPy), no text, no truth."""
    if isinstance(value, bool) or not isinstance(value, Real) or not math.isfinite(value):
        raise InputError(f"{name}: expected {expected}, got {shown(value)}")
    return float(value)


def check_numbers(values: Any, name: str) -> np.ndarray:
    """Return ``values`` as float64; InputError unless they are numbers in a regular array (NaN may be among them)."""
    try:
        return np.asarray(values, dtype=float)
    except (TypeError, ValueError):  # their messages speak of Python
        raise InputError(f"{name}: expected numbers, got {shown(values)}") from None


def check_generator(rng: Any) -> None:
    """Raise InputError unless ``rng`` is a NumPy generator."""
    if not isinstance(rng, np.random.Generator):
        raise InputError(f"rng must be a numpy.random.Generator, got {shown(rng)}")
