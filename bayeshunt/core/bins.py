"""Discretisation: how a metre or a radian becomes a row of a table.

A distance axis is an open-ended grid: bins of one width starting at 0, as many as the data
reach. A circular axis cuts the full turn into equal bins, the middle one centred on 0.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from numbers import Integral
from typing import Any

import numpy as np

from bayeshunt.core.arguments import check_fields
from bayeshunt.core.checks import (
    FULL_TURN,
    beyond_a_turn,
    check_bearings,
    check_kind,
    check_number,
    check_numbers,
    check_whole,
)
from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import wrap

__all__ = ["EFFECTS", "ENERGY", "Axis", "EffectAxes"]

#: The three effect variables of the paper's network, in the order of every table and array.
EFFECTS = ("Distance", "Angle", "Heading")
#: What a gait costs [J]: a fourth effect, of models that were asked for it.
ENERGY = "Energy"


@dataclass(frozen=True)
class Axis:
    """One discretised variable.

    name: "Distance", "Angle", "Heading" or "Energy".
    width: bin width, metres (Energy: joules) or radians (circular).
    bins: number of bins, >= 1.
    circular: True for angles: the bins tile (-pi, pi] and one of them is centred on 0.
    """

    name: str
    width: float
    bins: int
    circular: bool = False

    def __post_init__(self) -> None:
        check_fields(self)
        if not (self.width > 0 and math.isfinite(self.width)):
            raise InputError(f"axis {self.name}: width must be positive, got {self.width}")
        if self.bins < 1:
            raise InputError(f"axis {self.name}: needs at least one bin, got {self.bins}")

    @classmethod
    def linear(cls, name: str, width: float, bins: int = 1) -> Axis:
        """Bins of ``width`` [m; Energy: J] from 0 upwards."""
        return cls(name, width, bins)

    @classmethod
    def full_turn(cls, name: str, bins: int) -> Axis:
        """``bins`` equal bins over the full turn, one centred on 0 rad."""
        check_kind(bins, "bins", Integral, "a whole number")
        return cls(name, 2.0 * math.pi / max(bins, 1), bins, circular=True)  # fewer than one bin is refused there

    @property
    def _first_edge(self) -> float:
        """Lower edge of bin 0: 0 m, or the edge that puts a bin centre on 0 rad."""
        return -self.width * (self.bins // 2 + 0.5) if self.circular else 0.0

    @cached_property
    def edges(self) -> np.ndarray:  # [bins + 1], metres or radians, increasing
        """Bin edges; for a circular axis the first and last are one full turn apart."""
        return _read_only(self._first_edge + self.width * np.arange(self.bins + 1))

    @cached_property
    def centres(self) -> np.ndarray:  # [bins], metres or radians in (-pi, pi]
        """Bin centres."""
        centres = self._first_edge + self.width * (np.arange(self.bins) + 0.5)
        if self.circular:
            centres = wrap(np.where(np.abs(centres) < 1e-12, 0.0, centres))
        return _read_only(np.asarray(centres, dtype=float))

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """One unique name per bin: "0-5.7 mm" for distances, "0-0.2 J" for energies, "-10 deg" (the centre)."""
        if self.circular:
            texts = [_trim(math.degrees(c)) for c in self.centres]
            return tuple(f"{'180' if text == '-180' else text} deg" for text in texts)  # the rounding of a centre on pi
        shown, unit = (self.edges, "J") if self.name == ENERGY else (self.edges * 1000.0, "mm")
        return tuple(f"{_trim(low)}-{_trim(high)} {unit}" for low, high in pairwise(shown))

    def index(self, values: Any) -> Any:
        """Return the bin index of each value; for a linear axis it may lie beyond ``bins - 1``.

        A scalar gives an int, an array an int64 array. The caller checks the upper end, because
        what lies beyond it is a fact (nothing was ever seen there), not a mistake.
        Raises InputError for what is not a finite number: it falls into no bin; and for an angle of over two turns,
        which is hardly one in radians.
        """
        if isinstance(values, float):
            if self.circular:
                if abs(values) > 2 * FULL_TURN and math.isfinite(values):
                    raise InputError(f"{self.name}: {beyond_a_turn(values, 2)}")
                values = wrap(values)
            try:
                index = math.floor((values - self._first_edge) / self.width)
            except (ValueError, OverflowError):
                raise InputError(f"{self.name}: expected a finite number, got {values}") from None
            return index % self.bins if self.circular else index
        array = check_numbers(values, self.name)
        if not np.isfinite(array).all():  # as whole numbers they would be bins
            raise InputError(f"{self.name}: expected finite numbers, got {array[~np.isfinite(array)].flat[0]}")
        if self.circular and array.size and max(array.max(), -array.min()) > 2 * FULL_TURN:
            check_bearings(array, self.name, 2)
        scaled = np.asarray(wrap(array) if self.circular else array.copy())
        scaled -= self._first_edge  # in place: a new array costs more than the arithmetic
        scaled /= self.width
        indices = np.floor(scaled, out=scaled).astype(np.int64)
        if self.circular:
            # the half bin beyond the seam belongs to bin 0; an integer modulo would cost five times more
            np.subtract(indices, self.bins, out=indices, where=indices >= self.bins)
        return indices if indices.ndim else int(indices)

    def extended(self, bins: int) -> Axis:
        """Return this axis with at least ``bins`` bins (linear axes only grow)."""
        check_whole(bins, "bins", 1)
        if self.circular or bins <= self.bins:
            return self
        return Axis(self.name, self.width, int(bins))


@dataclass(frozen=True)
class EffectAxes:
    """The axes of Distance, Angle and Heading, in that order.

    body_length: metres, where the distance bins were made for a body, else None; it distinguishes no axes.
    energy: bins of what a gait costs, where that is a node of the network too (:attr:`all` has it); None: it is none.
    """

    distance: Axis
    angle: Axis
    heading: Axis
    body_length: float | None = field(default=None, compare=False, repr=False, kw_only=True)
    energy: Axis | None = field(default=None, repr=False, kw_only=True)

    def __post_init__(self) -> None:
        check_fields(self)

    @classmethod
    def standard(
        cls, body_length: float | None, *, distance_bin: float = 0.1, angle_bins: int = 36, heading_bins: int = 36
    ) -> EffectAxes:
        """Axes for a body of ``body_length`` [m]; ``distance_bin`` is in body lengths.

        Raises InputError for a body length that is None, which is how a repertoire says that it knows none.
        """
        if body_length is None:
            raise InputError(
                "the bins need a body length, which the gaits do not say: "
                "give axes= or GaitRepertoire(gaits, body_length=, duration=)"
            )
        width = check_number(distance_bin, "distance_bin") * check_number(body_length, "body_length")
        check_kind(angle_bins, "angle_bins", Integral, "a whole number")
        check_kind(heading_bins, "heading_bins", Integral, "a whole number")
        return cls(
            Axis.linear("Distance", width),
            Axis.full_turn("Angle", angle_bins),
            Axis.full_turn("Heading", heading_bins),
            body_length=body_length,
        )

    def __iter__(self) -> Iterator[Axis]:
        return iter((self.distance, self.angle, self.heading))

    def __getitem__(self, name: str) -> Axis:
        for axis in self.all:
            if axis.name == name:
                return axis
        raise InputError(f"unknown variable {name!r}: expected one of {', '.join(axis.name for axis in self.all)}")

    @property
    def all(self) -> tuple[Axis, ...]:
        """The axes of all effects: the three and, where it is a node, Energy."""
        return (*self, *(() if self.energy is None else (self.energy,)))

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of bins of each axis."""
        return self.distance.bins, self.angle.bins, self.heading.bins

    def extended(self, distance_bins: int, energy_bins: int = 1) -> EffectAxes:
        """Return these axes with at least ``distance_bins`` distance bins, and so many of energy if it is a node."""
        check_whole(distance_bins, "distance_bins", 1)
        energy = None if self.energy is None else self.energy.extended(energy_bins)
        return replace(self, distance=self.distance.extended(distance_bins), energy=energy)

    def covering(self, other: EffectAxes) -> EffectAxes:
        """Return these axes with at least as many bins as ``other``."""
        return self.extended(other.distance.bins, 1 if other.energy is None else other.energy.bins)


def _read_only(array: np.ndarray) -> np.ndarray:
    array.setflags(write=False)
    return array


def _trim(value: float) -> str:
    """A short decimal without trailing zeros or a negative zero."""
    text = f"{value:.6f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text
