"""Rows of a babbling table into whole numbers: counted cells, and summed poses in fixed point.

Letters: N rows, G gaits, K counted cells, P part-way poses of a gait.
A large table is worked through in parts that fit into the processor's cache: whole numbers add up to
the same bits whatever the parts.
"""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pandas as pd

from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.errors import DataError
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.data import babbling_table
from bayeshunt.models.counting.cells import count_numbers, number_cells

__all__ = ["SCALE", "tally_rows"]

#: Fixed point: units per metre, and per unit of cosine or sine.
SCALE = 1e9
#: Rows of a part: their intermediate arrays, half a megabyte each, stay in the cache.
_PART_ROWS = 1 << 16


def tally_rows(
    frame: pd.DataFrame, gaits: GaitRepertoire, axes: EffectAxes
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the counted cells [K, 4], sorted, the count of each [K] and the summed poses [G, P + 1, 4], all int64.

    frame: a validated babbling table. axes: they must reach the farthest row.
    Raises DataError for an unknown gait, or a pose too far away for exact sums.
    """
    effects = [frame[axis.name.lower()].to_numpy(dtype=float) for axis in axes]
    poses = _poses(frame)
    numbers, shape = np.empty(len(frame), dtype=np.int64), (len(gaits), *axes.shape)
    sums = np.zeros((len(gaits), len(poses), 4), dtype=np.int64)
    for part, codes in _parts(frame["gait"], gaits):
        bins = [axis.index(values[part]) for axis, values in zip(axes, effects, strict=True)]
        numbers[part] = number_cells([codes, *bins], shape)
        sums += _pose_sums([[values[part] for values in pose] for pose in poses], codes, len(gaits), len(frame))
    return *count_numbers(numbers, shape), sums


def _parts(names: pd.Series, gaits: GaitRepertoire) -> Iterator[tuple[slice, np.ndarray]]:
    """Yield the rows of each part and the codes of their gaits.

    A thread looks up the names of the parts to come: Arrow does so beside numpy, whose own short steps
    would only wait for each other on several threads.
    """
    parts = [slice(start, start + _PART_ROWS) for start in range(0, len(names), _PART_ROWS)]

    def codes(part: slice) -> np.ndarray:
        return babbling_table.gait_codes(names.iloc[part], gaits, first_row=part.start)

    if len(parts) == 1:
        yield parts[0], codes(parts[0])
        return
    with ThreadPoolExecutor(1) as pool:
        yield from zip(parts, pool.map(codes, parts), strict=True)


def _poses(frame: pd.DataFrame) -> list[list[np.ndarray]]:
    """Return the columns of each part-way pose (forward, right, heading), then of the final one (polar)."""
    columns = babbling_table.path_columns(frame.columns)
    names = [columns[start : start + 3] for start in range(0, len(columns), 3)]
    return [[frame[n].to_numpy(dtype=float) for n in pose] for pose in (*names, ["distance", "angle", "heading"])]


def _pose_sums(poses: list[list[np.ndarray]], codes: np.ndarray, gaits: int, total: int) -> np.ndarray:
    """Return int64 [G, P + 1, 4]: fixed-point sums of the part-way poses and of the final pose, by gait.

    total: rows of the whole table: their sum must not overflow either.
    """
    sums = np.empty((gaits, len(poses), 4), dtype=np.int64)
    for point, pose in enumerate(poses):
        # Contiguous copies: numpy may round sine and cosine differently on strided data.
        one, two, heading = (np.ascontiguousarray(values) for values in pose)
        if point == len(poses) - 1:
            one, two = one * _cos(two), one * _sin(two)
        for part, values in enumerate((one, two, _cos(heading), _sin(heading))):
            sums[:, point, part] = _exact_sums(values, codes, gaits, total)
    return sums


# Single precision is good to 1e-7 (0.02 micrometres on a gait's 0.2 m) and eight times faster.
def _cos(radians: np.ndarray) -> np.ndarray:
    return np.cos(radians.astype(np.float32))


def _sin(radians: np.ndarray) -> np.ndarray:
    return np.sin(radians.astype(np.float32))


def _exact_sums(values: np.ndarray, codes: np.ndarray, gaits: int, total: int) -> np.ndarray:
    """Return int64 [G]: the sum of ``values`` [N], of either precision, in multiples of 1e-9, by gait.

    Raises DataError if ``total`` such rows could overflow.
    """
    farthest = max(float(values.max()), -float(values.min())) * SCALE
    if farthest * total >= 2.0**62:
        raise DataError(f"a pose lies {farthest / SCALE:g} m away: too far for exact sums")
    fixed = np.multiply(values, SCALE, dtype=np.float64)
    np.rint(fixed, out=fixed)
    # Sums of whole numbers are exact in float64 while they stay below 2^53: add up that many rows at a time.
    chunk = max(1, int(2.0**53 / (farthest + 1.0)))
    if chunk < 1000:
        return _sums_of_integers(fixed.astype(np.int64), codes, gaits)
    sums = np.zeros(gaits, dtype=np.int64)
    for start in range(0, len(values), chunk):
        part = slice(start, start + chunk)
        sums += np.bincount(codes[part], weights=fixed[part], minlength=gaits).astype(np.int64)
    return sums


def _sums_of_integers(fixed: np.ndarray, codes: np.ndarray, gaits: int) -> np.ndarray:
    """Return int64 [G], the sums of int64 ``fixed`` [N] by gait: slow, for poses that are very far away."""
    sums = np.zeros(gaits, dtype=np.int64)
    np.add.at(sums, codes, fixed)
    return sums
