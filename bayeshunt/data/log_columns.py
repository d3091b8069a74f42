"""Which column of a log is what, and in which unit: by name where it shows, else asked for."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from bayeshunt.core.errors import DataError, InputError, did_you_mean, warn
from bayeshunt.core.units import unit_hint
from bayeshunt.data.text_tables import same_name, says_unit
from bayeshunt.data.tracks import UNITS

__all__ = ["find_columns", "lengths", "radians_of"]

_TIME = ("time", "t", "timestamp", "stamp", "times", "timems", "timeus", "timens", "times", "timesec", "sec", "secs",
         "seconds", "ms", "elapsed", "clock", "timestampms", "timestampus", "timestampns", "stampns", "datetime",
         "date", "rostime", "tms", "ts", "millis", "utc")  # fmt: skip
_POSE: tuple[tuple[str, ...], ...] = (
    ("x", "posx", "xpos", "positionx", "posex", "odomx", "xforward", "icpx", "gtx", "px", "xworld", "posexm"),
    ("y", "posy", "ypos", "positiony", "posey", "odomy", "yleft", "icpy", "gty", "py", "yworld", "poseym"),
    ("yaw", "theta", "heading", "phi", "psi", "angle", "orientation", "th", "rotz", "poseyaw", "posetheta", "odomyaw",
     "yawccw", "icpyaw", "gtyaw", "rz", "direction", "posephi", "orientationz"),
)  # fmt: skip
_PAIRS = (
    ("cmdleft", "cmdright"), ("commandleft", "commandright"), ("leftcmd", "rightcmd"), ("leftcommand", "rightcommand"),
    ("ucmdleft", "ucmdright"), ("cmdl", "cmdr"), ("cmdv", "cmdw"), ("vcmd", "wcmd"), ("vleft", "vright"),
    ("left", "right"), ("leftspeed", "rightspeed"), ("speedleft", "speedright"), ("leftwheel", "rightwheel"),
    ("wheelleft", "wheelright"), ("ul", "ur"), ("vl", "vr"), ("l", "r"), ("linearx", "angularz"),
    ("cmdlinear", "cmdangular"), ("linear", "angular"), ("throttle", "steering"), ("v", "w"), ("v", "omega"),
    ("u0", "u1"), ("u1", "u2"), ("cmd0", "cmd1"), ("command0", "command1"), ("motorleft", "motorright"),
)  # fmt: skip
#: Names of what was told, and of what odometry measured: a gait must come from a command.
_TOLD = re.compile(r"cmd|command", re.IGNORECASE)
_MEASURED = re.compile(r"twist\.twist|odom|measured|actual|encoder", re.IGNORECASE)
#: So much from row to row [rad] is likelier degrees.
_LEAP = 0.3
#: So much from one row to the next [rad], three turns, no body turns.
_FARTHEST_LEAP = 6 * math.pi
#: Endings of names that say the unit of an angle.
_ANGLES = {"deg": ("deg", "degrees", "degree", "°"), "rad": ("rad", "radians")}
#: Endings of names that say a unit.
_ENDINGS = ("rads", "radps", "mps", "ms", "mms", "cms", "deg", "degrees", "rad", "radians", "mm", "cm", "m")


def find_columns(
    names: list[str], time: str | None, pose: Sequence[str] | None, command: Sequence[str] | None, source: str,
    *, with_pose: bool = True, with_command: bool = True,
) -> dict[str, Any]:  # fmt: skip
    """Return the columns of "time" (None if there is none), "pose" [3] and "command" [A]: given, or found by name.

    Raises DataError that names what cannot be found and how to say it, InputError for a pose of other than three.
    """
    pose = None if pose is None else tuple(pose)
    command = (command,) if isinstance(command, str) else None if command is None else tuple(command)
    if pose is not None and len(pose) != 3:
        raise InputError(f"pose: expected three columns x, y, yaw, got {', '.join(pose)}")
    for name in (time, *(pose or ()), *(command or ())):
        if name is not None and name not in names:
            raise DataError(f"{source}: column {name!r} is missing; the table has {', '.join(names)}"
                            f"{did_you_mean(name, names, listed=False)}")  # fmt: skip
    plain: dict[str, str] = {}
    for name in sorted(names, key=lambda name: not _TOLD.search(name)):  # of two that fit, the one that says "command"
        for key in _keys(name):
            plain.setdefault(key, name)
    found: dict[str, Any] = {"time": time or next((plain[key] for key in _TIME if key in plain), None)}
    found["pose"] = pose or (_pose(plain) if with_pose else ())
    used = {found["time"], *found["pose"]}
    found["command"] = command or (_command(plain, names, used) if with_command else ())
    _check_found(found, names, source, with_command=with_command)
    return found


def _check_found(found: dict[str, Any], names: list[str], source: str, *, with_command: bool) -> None:
    """Raise one DataError for all that has to be named: the pose, the command, or both."""
    axes = [repr(axis) for axis, name in zip(("x", "y", "yaw"), found["pose"], strict=False) if name is None]
    lacking = {f"column {', '.join(axes)} of the pose": "pose=(x, y, yaw) (--pose X,Y,YAW)"} if axes else {}
    if with_command and not found["command"]:
        other = "" if axes else ", or give their file: --commands FILE"
        lacking["columns of the command"] = f"command=(left, right) (--command L,R){other}"
    if lacking:
        own = [name for name in names if not name.startswith("yaw (of ")]
        raise DataError(f"{source}: no {' nor '.join(lacking)} found among {', '.join(own)}; "
                        f"name them: {' and '.join(lacking.values())}")  # fmt: skip


def _keys(name: str) -> list[str]:
    """What a name may be known by: itself, itself without a unit at its end, and the last two of its parts."""
    whole = same_name(name)
    parts = name.lower().replace("[", "_").replace("(", "_").replace(" ", "_").rstrip("])").split("_")
    parts = [part for part in parts if part]
    while len(parts) > 1 and (parts[-1] in _ENDINGS or parts[-1] in ("s", "us", "ns", "sec")):
        parts = parts[:-1]
    branches = [part for part in re.split(r"[./]", name) if part]  # field.pose.pose.position.x is a position.x
    return list(dict.fromkeys([whole, same_name("".join(parts)), same_name("".join(branches[-2:]))]))


def _pose(plain: dict[str, str]) -> tuple[str | None, ...]:
    return tuple(next((plain[key] for key in known if key in plain), None) for known in _POSE)


def _command(plain: dict[str, str], names: list[str], used: set[Any]) -> tuple[str, ...]:
    used = used | {name for name in names if _MEASURED.search(name)}
    for pair in _PAIRS:
        if all(key in plain and plain[key] not in used for key in pair):
            return tuple(plain[key] for key in pair)
    marks = ("command", "cmd", "action")
    return tuple(n for n in names if same_name(n).startswith(marks) and n not in used) or tuple(
        n for n in names if same_name(n).endswith(marks) and n not in used
    )


def lengths(names: Sequence[str], unit: str | None, source: str) -> tuple[float, str]:
    """Return metres of one unit of ``names`` and a note of why: as given, as the names end, or metres.

    Issues a DataWarning where the names say another unit than the one given.
    """
    known = {name: metres for name, metres in UNITS.items() if metres is not None}
    said = next((name for name in known if all(says_unit(column, name) for column in names)), None)
    if unit is not None:
        if unit not in known:
            raise InputError(f"{source}: unknown unit {unit!r}{unit_hint(unit, known)}")
        if said not in (None, unit):
            warn(f"{source}: columns {', '.join(names)} say {said} by their names, but are read in {unit} as given; "
                 f"if the names are right: unit='{said}' (--unit {said})")  # fmt: skip
        return known[unit], f"lengths in {unit} (as given)"
    if said is not None:
        return known[said], f"lengths in {said} (as the columns' names say)"
    return 1.0, "lengths in m (the default)"


def radians_of(values: np.ndarray, name: str, angle: str | None, source: str) -> tuple[np.ndarray, str]:
    """Return headings [N] in radians and a note of how they were read: as given, as the name ends, or radians.

    Raises InputError for another unit, and for what would be turns on end in radians where no unit is said; issues a
    DataWarning where one is said all the same, and where the name says another unit than the one given.
    """
    if angle is not None and angle not in _ANGLES:
        raise InputError(f"{source}: unknown unit of angles {angle!r}{unit_hint(angle, _ANGLES)}")
    said = next((unit for unit, words in _ANGLES.items() if any(says_unit(name, word) for word in words)), None)
    if angle is not None and said not in (None, angle):
        warn(f"{source}: column {name!r} says {said} by its name, but is read in {angle} as given; "
             f"if the name is right: angle='{said}' (--angle {said})")  # fmt: skip
    elif (angle or said) != "deg":
        _check_radians(values[np.isfinite(values)], name, angle or said, source)
    if "deg" in (angle, None if angle else said):
        return np.radians(values), "heading in degrees (" + ("as given" if angle else "as its name says") + ")"
    return values, "heading in radians (" + ("as given" if angle else "the default") + "), counter-clockwise"


def _check_radians(values: np.ndarray, name: str, said: str | None, source: str) -> None:
    """Raise InputError for headings that span as degrees do where no unit is ``said``; warn where radians are."""
    jump = np.abs(np.diff(values))
    if not jump.size:
        return
    reach, farthest = float(np.abs(values).max()), float(jump.max())
    wraps_at_a_turn = bool(((jump > 300) & (jump <= 360)).any())
    turning = jump[jump > 0]
    # an unwrapped heading in radians may reach far, but hardly leaps from row to row
    leaps = bool(turning.size and np.median(turning) > _LEAP) and reach > 4 * math.pi
    if said is None and (wraps_at_a_turn or leaps):
        raise InputError(f"{source}: column {name!r} reaches {reach:g}: degrees or radians? "
                         "say it: angle= (--angle rad|deg)")  # fmt: skip
    if wraps_at_a_turn or leaps or farthest > _FARTHEST_LEAP:
        warn(f"{source}: column {name!r} is read in radians, but reaches {reach:g} and jumps by {farthest:g} from one "
             "row to the next; if it is in degrees: angle='deg' (--angle deg)")  # fmt: skip
