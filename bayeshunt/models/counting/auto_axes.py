"""Bins chosen by the data: those whose held-out density is highest, one axis at a time.

In the paper's structure the effects are independent given the gait: the log-density of a row is a sum over the axes,
and each axis can be chosen for itself. A density (nats per m rad2), unlike a probability, compares over bins.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.bins import EFFECTS, ENERGY, Axis, EffectAxes
from bayeshunt.core.errors import InputError, did_you_mean
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.core.geometry import FloatArray
from bayeshunt.data import babbling_table
from bayeshunt.models.counting.energy import energy_of

__all__ = ["auto_axes", "chosen_axes", "density_losses", "with_energy"]

_FOLDS = 5
_TURNS = (6, 8, 9, 10, 12, 15, 18, 20, 24, 30, 36, 45, 60, 72, 90, 120, 180, 360)
#: Widths of distance bins, as shares of the median distance.
_SHARES = (0.01, 0.02, 0.03, 0.05, 0.07, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.75, 1.0, 1.25)
#: Pseudo-count per cell while bins are compared; between 0.01 and 0.1 it hardly matters.
_PRIOR = 0.03
_SMALLEST = 1e-6  # m


def auto_axes(frame: pd.DataFrame, gaits: GaitRepertoire) -> EffectAxes:
    """Return the bins with the least held-out density log-loss of a babbling table, five folds of rows in order.

    The table is cut into five blocks: rows beside each other are often alike, and must not tell of each other.
    Raises DataError for a table that is none.
    """
    babbling_table.validate(frame)
    codes = babbling_table.gait_codes(frame["gait"], gaits)
    chosen = []
    for name in ("Distance", "Angle", "Heading"):
        values = frame[name.lower()].to_numpy(dtype=float)
        losses = [(density_losses(values, codes, axis), i, axis) for i, axis in enumerate(_candidates(name, values))]
        chosen.append(min(losses)[2])
    return EffectAxes(*chosen, body_length=gaits.body_length)


def chosen_axes(axes: EffectAxes | str | None, frame: pd.DataFrame, gaits: Any) -> EffectAxes | None:
    """Return axes as given, or for "auto" those of :func:`auto_axes`; InputError for another text."""
    if not isinstance(axes, str):
        return axes
    if axes != "auto":
        raise InputError(f"axes: expected EffectAxes or 'auto', got {axes!r}")
    return auto_axes(frame, GaitRepertoire.of(gaits))


def with_energy(
    axes: EffectAxes, effects: Iterable[str] | None, frame: pd.DataFrame, gaits: GaitRepertoire
) -> EffectAxes:
    """Return the axes of the effects asked for: Energy gets bins of the highest held-out density, or none.

    effects: Distance, Angle and Heading, and perhaps Energy, in any order; None: as the axes have it.
    Raises InputError for other effects, DataError for rows that do not say their energy.
    """
    if effects is None:
        return axes
    names = [effects] if isinstance(effects, str) else list(effects)
    for name in names:
        if name not in (*EFFECTS, ENERGY):
            raise InputError(f"effects: unknown effect {name!r}{did_you_mean(name, (*EFFECTS, ENERGY))}")
    if len(set(names)) != len(names) or not set(EFFECTS) <= set(names):
        raise InputError(f"effects: expected {', '.join(EFFECTS)}, each once, and perhaps Energy; got {names}")
    if ENERGY not in names:
        return replace(axes, energy=None)
    if axes.energy is not None:
        return axes
    babbling_table.validate(frame)
    values, codes = energy_of(frame), babbling_table.gait_codes(frame["gait"], gaits)
    middle = max(float(np.median(values)), float(np.mean(values)) / 10, _SMALLEST)
    made = [Axis.linear(ENERGY, float(f"{share * middle:.2g}")) for share in _SHARES]
    best = min((density_losses(values, codes, axis), i) for i, axis in enumerate(made))[1]
    return replace(axes, energy=made[best])


def _candidates(name: str, values: FloatArray) -> Iterator[Axis]:
    if name != "Distance":
        yield from (Axis.full_turn(name, bins) for bins in _TURNS)
        return
    middle = max(float(np.median(values)), float(np.mean(values)) / 10, _SMALLEST)
    yield from (Axis.linear(name, float(f"{share * middle:.3g}")) for share in _SHARES)


def density_losses(values: FloatArray, gaits: np.ndarray, axis: Axis) -> float:
    """Return the mean held-out -log density of one effect given the gait, in nats per metre, radian or joule.

    values: [N]. gaits: whole numbers [N]. Tables are smoothed by 0.03 a cell.
    """
    bins = axis.index(values)
    number = axis.bins if axis.circular else int(bins.max()) + 1
    counts = np.zeros((number, int(gaits.max()) + 1))
    np.add.at(counts, (bins, gaits), 1.0)
    losses = []
    for block in np.array_split(np.arange(len(values)), min(_FOLDS, len(values))):
        left = counts.copy()
        np.subtract.at(left, (bins[block], gaits[block]), 1.0)
        share = (left[bins[block], gaits[block]] + _PRIOR) / (left.sum(axis=0)[gaits[block]] + number * _PRIOR)
        losses.append(-np.log(share / axis.width))
    return float(np.concatenate(losses).mean())
