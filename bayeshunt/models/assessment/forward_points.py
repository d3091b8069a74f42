"""The point of a table's cell, backed off: medians of poses by key, each drawn towards those of a coarser key."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bayeshunt.core.geometry import FloatArray, Polar
from bayeshunt.core.statistics import spatial_median

__all__ = ["points"]

#: Weight [rows] of the coarser key, and of all rows together, which are hardly a guess at what one gait does.
BACKOFF, _EVERYONE = 2.0, 0.5
_ROUNDS = 50  # of the spatial median


def points(
    keys: Sequence[np.ndarray],
    asked: Sequence[np.ndarray],
    outcomes: Polar[FloatArray],
    *,
    backoff: float = BACKOFF,
) -> Polar[FloatArray]:
    """Return the backed-off point of each asked key: Polar of arrays [M].

    keys: for each level, coarse to fine, whole numbers [N] of the rows; asked: likewise [M]. outcomes: Polar [N].
    The finest known level counts most: ``(n m + w p) / (n + w)`` of its own spatial median m and the level above p;
    w is ``backoff``, for the coarsest level at most half a row.
    """
    places = np.asarray(outcomes.forward + 1j * outcomes.right)
    facing = np.exp(1j * np.asarray(outcomes.heading))
    count = len(asked[0])
    place, face = np.full(count, _median(places)), np.full(count, _median(facing))
    for depth, (level, mine) in enumerate(zip(keys, asked, strict=True)):
        above = backoff if depth else min(backoff, _EVERYONE)
        for key in np.unique(mine):
            rows = level == key
            number = int(rows.sum())
            if not number:
                continue
            here = mine == key
            weight = number / (number + above)
            place[here] = weight * _median(places[rows]) + (1 - weight) * place[here]
            face[here] = weight * _median(facing[rows]) + (1 - weight) * face[here]
    return Polar.from_cartesian(place.real, place.imag, np.angle(face))


def _median(values: FloatArray) -> complex:
    """Spatial median of complex values [N]."""
    return complex(spatial_median(values, axis=0, rounds=_ROUNDS))
