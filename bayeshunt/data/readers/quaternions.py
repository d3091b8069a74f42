"""Headings of logs that hold attitudes as quaternions: x, y, z, w, as ROS and most filters write them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.data.text_tables import as_numbers, same_name

__all__ = ["with_yaw", "yaw_of"]

#: What the names of the four columns have in common ends in one of these.
_STEMS = ("q", "quat", "quaternion", "orientation", "rotation", "rot", "attitude")
#: A quaternion whose length is off by more is none.
_OFF = 0.05


def yaw_of(x: Any, y: Any, z: Any, w: Any) -> Any:
    """Return the yaw [rad counter-clockwise] of a unit quaternion, of numbers or arrays."""
    return np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def with_yaw(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table with a column of the yaw [rad counter-clockwise] of its first quaternion, or as it is.

    The column is called "yaw (of ...)" after the four it is made from; NaN where they are no unit quaternion.
    """
    plain = {same_name(name): name for name in reversed(list(table.columns))}
    for key in plain:
        names = [plain.get(key[:-1] + axis) for axis in "xyzw"]
        if not key.endswith("w") or not key[:-1].endswith(_STEMS) or None in names:
            continue
        x, y, z, w = (as_numbers(table[name]) for name in names)
        whole = np.abs(np.sqrt(x * x + y * y + z * z + w * w) - 1) < _OFF
        return table.assign(**{f"yaw (of {', '.join(map(str, names))})": np.where(whole, yaw_of(x, y, z, w), np.nan)})
    return table
