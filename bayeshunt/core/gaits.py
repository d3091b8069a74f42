"""Gaits: the named motor commands a robot can hold for one time-step."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from numbers import Real
from typing import Any

import numpy as np

from bayeshunt.core import displays
from bayeshunt.core.checks import check_number
from bayeshunt.core.errors import InputError, shown

__all__ = ["GIVE_MEASURES", "Gait", "GaitRepertoire", "gait_name"]

#: How a robot that the package does not know tells its measures.
GIVE_MEASURES = "give GaitRepertoire(gaits, body_length=metres, duration=seconds)"
_WORDS = {"body_length": "body length", "duration": "duration, how long one is held"}
_TOLD = {
    "duration": "{mine} holds a gait for {own:.6g} s, {theirs} for {its:.6g} s",
    "body_length": "{mine} has a body of {own:.6g} m, {theirs} of {its:.6g} m",
}
#: Relative difference of two measures that are the same, written down with so many digits.
_ALIKE = 1e-6


@dataclass(frozen=True)
class Gait:
    """A named motor command.

    name: unique within a repertoire.
    command: what the body executes; its meaning and unit belong to the body (for a differential
        drive left and right wheel speed in m/s, for a car speed in m/s and steering in rad).
    """

    name: str
    command: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", gait_name(self.name))
        if not isinstance(self.command, (tuple, list, np.ndarray)):
            raise InputError(f"gait {self.name!r}: command: expected a tuple of numbers, got {shown(self.command)}")
        numbers = tuple(check_number(value, f"gait {self.name!r}: command") for value in self.command)
        object.__setattr__(self, "command", numbers)


def gait_name(label: Any) -> str:
    """Return the name of a gait as text: gait 1 is "1", whether a number of Python or of NumPy; bytes are UTF-8.

    Raises InputError for what is no name: nothing, a missing value, a list.
    """
    if isinstance(label, Gait):
        return label.name
    if isinstance(label, bytes):
        label = label.decode("utf-8", "replace")
    if isinstance(label, (str, bool, np.bool_)) or (isinstance(label, Real) and math.isfinite(label)):
        return str(label)
    raise InputError(f"gait: expected a name, got {shown(label)}; name gaits by text, for numbers use astype(str)")


@dataclass(frozen=True, repr=False)
class GaitRepertoire(displays.Displayed, Sequence[Gait]):
    """The gaits of one robot, in the order of every table's columns.

    body_length: metres, the unit of the default distance bins; None: unknown.
    duration: seconds that one gait is held: the time-step of every model; None: unknown.

    Whatever needs a measure that is unknown says so when it needs it, see :meth:`need`.
    """

    gaits: tuple[Gait, ...]
    body_length: float | None = None
    duration: float | None = None
    _positions: dict[str, int] = field(init=False, repr=False, compare=False, hash=False)

    def __post_init__(self) -> None:
        if isinstance(self.gaits, str) or not isinstance(self.gaits, Iterable):
            raise InputError(f"gaits: expected a tuple of Gait, got {shown(self.gaits)}; from names: GaitRepertoire.of")
        object.__setattr__(self, "gaits", tuple(self.gaits))
        for gait in self.gaits:
            if not isinstance(gait, Gait):
                raise InputError(f"gaits: expected Gait objects, got {shown(gait)}; from names: GaitRepertoire.of")
        names = [gait.name for gait in self.gaits]
        if not names:
            raise InputError("a gait repertoire needs at least one gait")
        repeated = sorted({name for name in names if names.count(name) > 1})
        if repeated:
            raise InputError(f"gait names must be unique, repeated: {', '.join(repeated)}")
        for name in ("body_length", "duration"):
            value = getattr(self, name)
            if value is not None and (not isinstance(value, Real) or not 0 < float(value) < math.inf):
                raise InputError(f"a gait repertoire needs {name} > 0, got {value!r}")
        object.__setattr__(self, "_positions", {name: i for i, name in enumerate(names)})

    @classmethod
    def of(cls, gaits: Any, **settings: float) -> GaitRepertoire:
        """Return ``gaits`` itself if it is a repertoire, a robot's repertoire, or one made of Gait objects or names."""
        if isinstance(gaits, cls):
            return gaits
        repertoire = getattr(gaits, "gaits", None)
        if isinstance(repertoire, cls):  # the settings of a robot
            return repertoire
        if isinstance(gaits, str) or not isinstance(gaits, Iterable):
            raise InputError(f"gaits: expected a robot's gaits, or a list of names, got {shown(gaits)}")
        return cls(tuple(g if isinstance(g, Gait) else Gait(g) for g in gaits), **settings)

    @property
    def names(self) -> tuple[str, ...]:
        """Gait names in table order."""
        return tuple(self._positions)

    def index(self, name: Any, *unused: Any) -> int:
        """Return the position of a gait given by name or as a Gait.

        Raises InputError if the repertoire has no such gait.
        """
        key = name.name if isinstance(name, Gait) else name
        try:
            if key in self._positions:
                return self._positions[key]
            return self._positions[gait_name(key)]
        except (KeyError, TypeError, InputError):
            raise InputError(f"unknown gait {key!r}: expected one of {', '.join(self.names)}") from None

    def number(self, gait: Any) -> int:
        """Return the position of a gait given by name, as a Gait, or by its position, 0 to G - 1.

        Raises InputError naming the gaits for anything else: a negative number, a bool, a fraction.
        """
        if type(gait) is int and 0 <= gait < len(self.gaits):  # as environments say it, step after step
            return gait
        if isinstance(gait, (str, Gait)):
            return self.index(gait)
        place = gait.item() if isinstance(gait, (np.ndarray, np.generic)) and np.size(gait) == 1 else gait
        if isinstance(place, int) and not isinstance(place, bool) and 0 <= place < len(self):
            return place
        raise InputError(
            f"gait: expected a name or a whole number from 0 to {len(self) - 1} ({', '.join(self.names)}), "
            f"got {shown(place)}"
        )

    def need(self, measure: str) -> float:
        """Return ``body_length`` [m] or ``duration`` [s]; InputError in one line if it is not known."""
        value: float | None = getattr(self, measure)
        if value is None:
            raise InputError(f"the gaits do not say their {_WORDS[measure]}: {GIVE_MEASURES}")
        return value

    def difference(self, other: GaitRepertoire, mine: str, theirs: str) -> str | None:
        """Return in one line how these gaits differ from another robot's; None if they do not.

        mine, theirs: what the line calls the two robots. Compared are names and their order, body length,
        duration and commands; what one of the two does not know (None, or no command) differs from nothing.
        """
        if self.names != other.names:
            return f"{mine} has the gaits {', '.join(self.names)}; {theirs} has {', '.join(other.names)}"
        for measure, told in _TOLD.items():
            own, its = getattr(self, measure), getattr(other, measure)
            if own is not None and its is not None and not math.isclose(own, its, rel_tol=_ALIKE):
                return told.format(mine=mine, theirs=theirs, own=own, its=its)
        for own, its in zip(self.gaits, other.gaits, strict=True):
            if own.command and its.command and own.command != its.command and not _close(own.command, its.command):
                commands = (", ".join(f"{v:.6g}" for v in gait.command) for gait in (own, its))
                return "{} commands gait {!r} as {}, {} as {}".format(mine, own.name, next(commands), theirs, *commands)
        return None

    def __repr__(self) -> str:
        facts = [f"{len(self)} gaits"]
        facts += [] if self.body_length is None else [f"body {1000 * self.body_length:g} mm"]
        facts += [] if self.duration is None else [f"each held {self.duration:g} s"]
        return f"<GaitRepertoire: {', '.join(facts)}>"

    def __getitem__(self, key: Any) -> Any:
        return self.gaits[self.index(key)] if isinstance(key, str) else self.gaits[key]

    def __contains__(self, gait: object) -> bool:
        """Return whether there is such a gait, given by name or as a Gait."""
        return gait in self.gaits if isinstance(gait, Gait) else isinstance(gait, str) and gait in self._positions

    def __len__(self) -> int:
        return len(self.gaits)

    def __iter__(self) -> Iterator[Gait]:
        return iter(self.gaits)


def _close(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    """Whether two commands are the same but for rounding."""
    return len(one) == len(other) and all(
        math.isclose(a, b, rel_tol=_ALIKE, abs_tol=1e-12) for a, b in zip(one, other, strict=True)
    )
