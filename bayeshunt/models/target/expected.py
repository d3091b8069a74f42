"""Expected counts: a transition of which only probabilities are known, as whole parts that add up in any order."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import FloatArray, Polar
from bayeshunt.models.target.speed_table import cell_codes

__all__ = ["PART", "count_parts", "expected_cells", "plain_count"]

#: Counts are whole numbers of 2**-10, so that expected counts too add up to the same bits in any order.
PART = 1 << 10


def expected_cells(
    axes: EffectAxes, transitions: Polar[FloatArray], weights: FloatArray
) -> Iterator[tuple[tuple[int, int, int], int]]:
    """Yield each (Distance, Angle, Heading) cell and its share of one transition, in whole parts of 2**-10.

    transitions: what it may have been, Polar of arrays [N]. weights: probabilities [N], any positive sum.
    Raises InputError unless all numbers are finite and some weight is positive.
    """
    distance, angle, heading, chance = (np.asarray(part, dtype=float) for part in (*transitions, weights))
    if not all(np.isfinite(part).all() for part in (distance, angle, heading, chance)):
        raise InputError("expected transitions: expected finite numbers")
    if (distance < 0).any() or (chance < 0).any() or not chance.sum() > 0.0:
        raise InputError("expected transitions: expected distances and weights >= 0, and some weight")
    codes, where = np.unique(cell_codes(axes, distance, angle, heading), return_inverse=True)
    shares = np.bincount(where, weights=chance)
    for code, parts in zip(codes.tolist(), _rounded(shares / shares.sum()).tolist(), strict=True):
        if parts:
            rest, turned = divmod(code, axes.heading.bins)
            far, bearing = divmod(rest, axes.angle.bins)
            yield (far, bearing, turned), parts


def plain_count(parts: int) -> int | float:
    """Return a count of 2**-10 as a number: a whole one where it is."""
    return parts / PART if parts % PART else parts // PART


def count_parts(count: float) -> int:
    """Return a stored count as whole parts of 2**-10; ValueError unless it is positive and made of them."""
    parts = count * PART if isinstance(count, (int, float)) and not isinstance(count, bool) else 0
    if not parts >= 1 or parts % 1:
        raise ValueError(f"count {count}")
    return int(parts)


def _rounded(shares: FloatArray) -> np.ndarray:
    """Shares [K] as whole parts of 2**-10 that sum to one: those with the largest remainders get one more."""
    exact = shares * PART
    parts = np.floor(exact).astype(np.int64)
    missing = PART - int(parts.sum())
    parts[np.argsort(parts - exact, kind="stable")[:missing]] += 1
    return parts
