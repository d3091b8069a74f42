"""Drawing outcomes from CPTs by inverse CDF, vectorised. Letters: G gaits, K bins."""

from __future__ import annotations

import numpy as np

from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.checks import check_numbers
from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import FloatArray, Polar, wrap

__all__ = ["UNIFORMS", "check_uniforms", "cumulative", "draw"]

#: Random numbers that one outcome uses: three choose the bins, three the place inside them.
UNIFORMS = 6


def cumulative(table: np.ndarray) -> np.ndarray:
    """Return the CDF [G, K] of each column of a CPT [K, G]; every row ends at exactly 1."""
    sums = np.cumsum(table, axis=0)
    cdf = np.ascontiguousarray((sums / sums[-1]).T)
    cdf.setflags(write=False)
    return cdf


def draw(axes: EffectAxes, columns: tuple[np.ndarray, ...], uniforms: np.ndarray) -> Polar[FloatArray]:
    """Return the poses [...] that ``uniforms`` [..., 6] in [0, 1) choose.

    columns: the CDFs [K] of Distance, Angle and Heading under one gait.
    Places are uniform within a bin; a bin of probability 0 is never chosen.
    """
    values = []
    for i, (axis, column) in enumerate(zip(axes, columns, strict=True)):
        # "right" gives the first bin whose CDF exceeds u, so a bin without mass is skipped.
        bins = np.searchsorted(column, uniforms[..., i], side="right")
        values.append(axis.edges[0] + (bins + uniforms[..., 3 + i]) * axis.width)
    return Polar(values[0], np.asarray(wrap(values[1])), np.asarray(wrap(values[2])))


def check_uniforms(uniforms: np.ndarray) -> np.ndarray:
    """Return ``uniforms`` as float64 [..., 6]; raises InputError unless all lie in [0, 1)."""
    draws = check_numbers(uniforms, "uniforms")
    if draws.ndim < 1 or draws.shape[-1] != UNIFORMS or not np.all((draws >= 0) & (draws < 1)):
        raise InputError(f"uniforms must be an array [..., {UNIFORMS}] of numbers in [0, 1)")
    return draws
