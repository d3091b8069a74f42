"""Tables that can be right but hardly are: in degrees or millimetres, where radians and metres are meant."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.errors import warn
from bayeshunt.core.gaits import GaitRepertoire

__all__ = ["warn_body_length", "warn_implausible", "warn_time_step"]

#: More distance bins than this are finer than any gait needs.
_MOST_BINS = 1000
#: A gait may carry the body this many times as far as its command says: noise, and bodies that roll on.
_SLACK = 2.0
#: A body is hardly this many times as long as its farthest gait, and a gait hardly lasts so many seconds.
_MOST_BODY, _LONGEST = 20.0, 100.0


def warn_implausible(frame: pd.DataFrame, gaits: GaitRepertoire, axes: EffectAxes, *, source: str = "table") -> None:
    """Issue a DataWarning of one line, with the fix, if a valid babbling table looks like one of other units.

    Looked for: distances beyond what the fastest command can drive in one gait, more than 1,000 distance bins,
    and angles in neither (-pi, pi] nor [0, 2 pi), or all beyond pi.
    """
    if frame.empty:
        return
    farthest = float(frame["distance"].to_numpy(dtype=float).max())
    bins, reach = farthest / axes.distance.width, _reach(gaits)
    problem = ""
    if reach is not None and farthest > _SLACK * reach + axes.distance.width:
        problem = f"{farthest:g} m in one gait, but the fastest command drives {reach:.3g} m in {gaits.duration:g} s"
    elif bins > _MOST_BINS:
        problem = f"the farthest row, {farthest:g} m, makes {math.ceil(bins):,} distance bins"
    if problem:
        warn(
            f"{source}: {problem}; if distances are in millimetres, convert them: frame['distance'] / 1000; "
            "else give the robot's own speeds, gait_duration and body, or wider bins"
        )
    for column in ("angle", "heading"):
        angles = frame[column].to_numpy(dtype=float)  # however they are stored
        if _odd(angles):
            warn(
                f"{source}: {column} goes to {np.abs(angles).max():g} rad, beyond half a turn; if the column is "
                f"in degrees, convert it: numpy.radians(frame[{column!r}]); else wrap it to (-pi, pi]"
            )


def warn_body_length(body_length: float | None, farthest: float) -> None:
    """Issue a DataWarning if no gait of a log goes beyond a twentieth of the body length [m] given for it."""
    if body_length is not None and 0 < _MOST_BODY * farthest < body_length:
        warn(
            f"body_length: {body_length:g} m, but no gait goes beyond {farthest:.3g} m, which is less than one "
            f"distance bin; if it is in millimetres, give {body_length / 1000:g}"
        )


def warn_time_step(seconds: float) -> None:
    """Issue a DataWarning if a gait, or a step of tracks, is said to last 100 s or more."""
    if seconds >= _LONGEST:
        warn(f"time_step: one of {seconds:g} s; if it is in milliseconds, give {seconds / 1000:g}")


def _odd(angles: np.ndarray) -> bool:
    """Whether angles [rad] keep to neither convention, or all lie beyond half a turn."""
    low, high, slight = angles.min(), angles.max(), 1e-6
    if low >= 0 and high <= 2 * math.pi + slight:  # [0, 2 pi)
        return bool(low > math.pi + slight)
    return bool(low < -math.pi - slight or high > math.pi + slight)


def _reach(gaits: GaitRepertoire) -> float | None:
    """Metres that the fastest command drives a body in one gait; None if commands are not two speeds or steerings."""
    commands = [getattr(gait, "command", ()) for gait in gaits]
    if not all(len(command) == 2 for command in commands):
        return None
    fastest = max(max(map(abs, command)) for command in commands)
    return fastest * gaits.duration if fastest > 0 and gaits.duration else None
