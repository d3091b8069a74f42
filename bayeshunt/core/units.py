"""Units that people read: data are in metres and radians, every text for people in millimetres and degrees.

Lengths of a metre and more are metres. Bins keep their names in tables and files ("-10 deg"); :func:`label` says
them as people read them.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

from bayeshunt.core.errors import did_you_mean

__all__ = ["bounds", "degrees", "in_unit", "label", "length", "objective", "speed", "theta", "true_minus", "unit_hint"]

#: What people call a unit, without the s of the plural.
_CALLED = {
    "degree": "deg", "°": "deg", "radian": "rad", "second": "s", "sec": "s", "millisecond": "ms", "msec": "ms",
    "microsecond": "us", "µ": "us", "nanosecond": "ns", "metre": "m", "meter": "m", "centimetre": "cm",
    "centimeter": "cm", "millimetre": "mm", "millimeter": "mm", "pixel": "px", "bodie": "body",
}  # fmt: skip
_BIN_IN_DEGREES = re.compile(r"(-?[\d.]+) deg")


def length(metres: float) -> str:
    """Return a length with its unit: whole millimetres from 10 mm on, metres from 1 m on; "" for NaN."""
    if math.isnan(metres):
        return ""
    metres += 0.0  # never "-0 mm"
    if abs(metres) >= 0.9995:
        return f"{metres:.3g} m"
    return f"{1000 * metres:.0f} mm" if abs(metres) >= 0.01 else f"{1000 * metres:.2g} mm"


def in_unit(largest: float, unit: str = "m") -> tuple[float, str]:
    """Return how a column of lengths is shown whose largest is given: times what, and the unit: (1000.0, "mm").

    Metres below one are millimetres; other units (px, body lengths) stay.
    """
    return (1000.0, "mm") if unit == "m" and abs(largest) < 0.9995 else (1.0, unit)


def degrees(radians: float, digits: int = 0) -> str:
    """Return an angle with its sign of degree, to at most ``digits`` decimals; "" for NaN, never "-0°"."""
    return "" if math.isnan(radians) else f"{round(math.degrees(radians), digits) + 0.0:g}°"


def speed(metres_per_second: float) -> str:
    """Return a speed with its unit."""
    return f"{1000 * metres_per_second:g} mm/s"


def theta(bearing: float) -> str:
    """Return a first bearing of the prey [rad]: in degrees, and as the paper and ``--theta`` name it."""
    return f"{degrees(bearing)} (theta {bearing:g})"


def label(bin_name: str) -> str:
    """Return the name of a bin as people read it: "-10 deg" becomes "-10°"; others stay."""
    return _BIN_IN_DEGREES.sub(r"\1°", bin_name) if _BIN_IN_DEGREES.fullmatch(bin_name) else bin_name


def bounds(low: float, high: float) -> str:
    """Return the interval of a probability to two decimals, rounded outwards so that what lies inside does in print."""
    return f"{math.floor(100 * low + 1e-9) / 100:g} to {math.ceil(100 * high - 1e-9) / 100:g}"


def unit_hint(word: str, known: Iterable[str]) -> str:
    """Return how an error about an unknown unit ends: "; did you mean 'deg'?", or else the units that there are."""
    names, plain = list(known), str(word).strip().lower()
    meant = plain if plain in names else _CALLED.get(plain.rstrip("s"))
    return f"; did you mean {meant!r}?" if meant in names else did_you_mean(word, names)


def true_minus(text: str) -> str:
    """Return ``text`` with a true minus before numbers: for pages and figures, which have one in every typeface."""
    return re.sub(r"(?<![\w.])-(?=[\d.])", "−", text)


def objective(value: float, name: str) -> tuple[float, str]:
    """Return a plan's value and what it is, for people: one in metres, ``name [m]``, becomes ``name [mm]``."""
    return (1000 * value, f"{name.removesuffix('[m]')}[mm]") if name.endswith("[m]") else (value, name)
