"""What gaits cost: energy counted by gait and by the gait before, in whole numbers, so that order never matters.

Letters: G gaits, N rows. Row G of a table by the gait before holds the rows that no gait went before.
"""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from bayeshunt.core.bins import Axis
from bayeshunt.core.errors import DataError
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.data import babbling_table
from bayeshunt.models.counting.cells import MAX_DISTANCE_BINS

__all__ = [
    "COLUMN", "LEANING", "add_up", "count_energy", "energy_of", "energy_reached", "energy_table", "expected",
    "mean_interval", "nothing", "tally_energy",
]  # fmt: skip

#: The column of a babbling table [J].
COLUMN = "energy"
#: Fixed point: units per joule, and per joule squared.
_SUMS, _SQUARES = float(2**20), float(2**16)
#: Rows that a gait's own mean energy is worth after each gait, where the model says no other number.
LEANING = 5.0


def nothing() -> np.ndarray:
    """Return the tally of rows that do not say their energy: int64 [0, 0, 3]."""
    return np.zeros((0, 0, 3), dtype=np.int64)


def tally_energy(frame: pd.DataFrame, gaits: GaitRepertoire) -> np.ndarray:
    """Return int64 [G + 1, G, 3] by gait before and gait: rows, and fixed-point sums of energy and of its square.

    :func:`nothing` without the column. Raises DataError for energies too large for exact sums.
    """
    if COLUMN not in frame:
        return nothing()
    energy = frame[COLUMN].to_numpy(dtype=float)
    if float(np.abs(energy).max(initial=0.0)) ** 2 * _SQUARES * len(energy) >= 2.0**62:
        raise DataError(f"an energy of {float(np.abs(energy).max()):g} J is too large for exact sums")
    after = babbling_table.gait_codes(frame["gait"], gaits)
    before = np.full(len(frame), len(gaits))
    if "previous_gait" in frame:
        found = pd.Index(gaits.names, dtype=object).get_indexer(pd.Index(frame["previous_gait"], dtype=object))
        before = np.where(found < 0, len(gaits), found)
    tally = np.zeros((len(gaits) + 1, len(gaits), 3), dtype=np.int64)
    parts = (np.ones(len(energy)), np.rint(energy * _SUMS), np.rint(energy * energy * _SQUARES))
    np.add.at(tally, (before, after), np.stack(parts, axis=1).astype(np.int64))
    return tally


def energy_of(frame: pd.DataFrame) -> np.ndarray:
    """Return the energies [N] of a babbling table in joules, for bins; DataError unless every row says one >= 0."""
    if COLUMN not in frame:
        raise DataError(
            "Energy is to be a node, and the table has no column energy [J]: babble with a body that measures it, or "
            "fit without Energy"
        )
    energy = frame[COLUMN].to_numpy(dtype=float)
    wrong = ~(np.isfinite(energy) & (energy >= 0))
    if wrong.any():
        raise DataError(f"row {int(wrong.argmax())}: energy is {energy[wrong][0]}; expected joules >= 0")
    return energy


def energy_reached(frame: pd.DataFrame, axis: Axis) -> int:
    """Return the number of bins up to the dearest row; DataError for one absurdly dear."""
    energy = energy_of(frame)
    dearest = float(energy.max(initial=0.0))
    if not dearest < MAX_DISTANCE_BINS * axis.width:
        raise DataError(f"row {int(energy.argmax())}: energy is {dearest:g} J; the bins are {axis.width:g} J wide")
    return int(axis.index(dearest)) + 1


def count_energy(frame: pd.DataFrame, gaits: GaitRepertoire, axis: Axis) -> np.ndarray:
    """Return int64 [E, G]: rows in each bin of energy by gait; the axis must reach the dearest row."""
    counts = np.zeros((axis.bins, len(gaits)), dtype=np.int64)
    np.add.at(counts, (axis.index(energy_of(frame)), babbling_table.gait_codes(frame["gait"], gaits)), 1)
    return counts


def add_up(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return the tally of both."""
    return other if not one.size else one if not other.size else one + other


def expected(tally: np.ndarray, before: int | None, leaning: float) -> np.ndarray:
    """Return the mean energy [J] of every gait [G], after the gait number ``before`` if there is one.

    The mean after a gait leans on that of the gait at large, which is worth ``leaning`` rows. NaN for a gait that was
    never babbled.
    """
    rows, sums, _ = np.moveaxis(tally.sum(axis=0), -1, 0)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = sums / (_SUMS * rows)
    if before is None:
        return np.asarray(mean)
    own, own_sums = tally[before, :, 0], tally[before, :, 1] / _SUMS
    return np.asarray((own_sums + leaning * mean) / (own + leaning))


def mean_interval(tally: np.ndarray, level: float) -> tuple[np.ndarray, ...]:
    """Return rows, mean, low, high and standard deviation [J] of each cell [...] of a tally [..., 3].

    The interval of the mean is Student's; NaN for cells of no rows, and, but for the mean, of one.
    """
    from scipy.special import stdtrit  # scipy.stats takes half a second to import

    rows, sums, squares = (tally[..., i].astype(float) for i in range(3))
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = sums / (_SUMS * rows)
        others = np.where(rows > 1, rows - 1, math.nan)
        spread = np.sqrt(np.maximum(squares / _SQUARES - rows * mean * mean, 0.0) / others)
        half = stdtrit(np.maximum(rows - 1, 1), 0.5 + 0.5 * level) * spread / np.sqrt(rows)
    return tally[..., 0], mean, mean - half, mean + half, spread


def energy_table(tally: np.ndarray, names: tuple[str, ...], level: float) -> pd.DataFrame:
    """Return a row per gait, whatever went before (``previous_gait`` None), then one per pair that was babbled."""
    whole = np.concatenate([tally.sum(axis=0)[None], tally[:-1]])
    rows, *numbers = mean_interval(whole, level)
    before = pd.Series(np.repeat(np.array([None, *names], dtype=object), len(names)), dtype=object)  # None stays None
    frame = pd.DataFrame({"previous_gait": before, "gait": names * (len(names) + 1), "rows": rows.ravel()})
    for name, values in zip(("mean_j", "low_j", "high_j", "sd_j"), numbers, strict=True):
        frame[name] = values.ravel()
    return frame[(frame["rows"] > 0) | frame["previous_gait"].isna()].reset_index(drop=True)
