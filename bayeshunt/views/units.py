"""Units that people read: data are in metres and radians, every text for people in millimetres and degrees."""

from __future__ import annotations

import math


def millimetres(metres: float) -> str:
    """Return a length as whole millimetres with its unit; "" where there is none (NaN)."""
    return "" if math.isnan(metres) else f"{1000 * metres:.0f} mm"


def degrees(radians: float) -> str:
    """Return an angle as whole degrees with its sign of degree; never "-0°"."""
    text = f"{math.degrees(radians):.0f}°"
    return "0°" if text == "-0°" else text


def objective(value: float, name: str) -> tuple[float, str]:
    """Return a plan's value and what it is, for people: one in metres, ``name [m]``, becomes ``name [mm]``."""
    return (1000 * value, f"{name.removesuffix('[m]')}[mm]") if name.endswith("[m]") else (value, name)
