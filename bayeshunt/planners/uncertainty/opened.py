"""The trace of a search: every sequence with what it would see, and how much it would learn of where the prey is."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from bayeshunt.core.geometry import FloatArray
from bayeshunt.core.statistics import entropy
from bayeshunt.planners.interception import pairs

if TYPE_CHECKING:
    from bayeshunt.planners.uncertainty.weighing import Weighing

__all__ = ["trace"]


def trace(gaits: tuple[str, ...], weighing: Weighing, body: float) -> pd.DataFrame:
    """Return one row per sequence, as of the other planners that look two gaits ahead, and what it would see.

    value_s: expected time of capture [s] and the price of what is not seen. in_view: P(the prey is found at least once
    on the way). information: expected bits that the looks tell about which square of a body length the prey is in
    at the end of the first step. lost_s: price that is expected to be paid for not seeing it.
    """
    frame = pairs.trace(gaits, weighing.pairs, weighing.futures, weighing.homing, weighing.spread, weighing.charge)
    outlook = weighing.outlook()
    values, pair_values = weighing.values(outlook)
    count = len(gaits)
    first = int(values.argmin())
    chosen = np.zeros(1 + count + count * count, dtype=bool)
    chosen[[0, 1 + first, 1 + count + first * count + int(pair_values[first].argmin())]] = True
    missed = 1.0 - weighing.sight.first
    both = (missed[:, None] * (1.0 - weighing.sight.second)).reshape(-1, missed.shape[1])
    missing = np.concatenate([np.ones((1, missed.shape[1])), missed, both])
    weights = weighing.futures.weights
    escaped = (1.0 - outlook.second[:, :, -1]).reshape(-1, len(weights))
    lost = np.full(len(frame), np.nan)
    lost[1 + count :] = (both * escaped * weighing.lost()) @ weights
    return frame.assign(
        value_s=np.concatenate([[values.min()], values, pair_values.ravel()]),
        chosen=chosen,
        in_view=np.clip(1.0 - missing @ weights, 0.0, 1.0),
        information=_information(weighing, missing, body),
        lost_s=lost,
    )


def _information(weighing: Weighing, missing: FloatArray, body: float) -> FloatArray:
    """Bits told by looks that miss future k with probability ``missing`` [N, K]: entropy before, less that after.

    A prey that is found is known to the square; one that is not leaves the entropy of those that would be missed.
    """
    times = weighing.pairs.times
    places = np.stack([part[:, 0] for part in weighing.futures.at(times[len(times) // 2 - 1 :][:1])], axis=1)
    _, square = np.unique(np.floor(places / body).astype(int), axis=0, return_inverse=True)
    member = np.eye(int(square.max()) + 1)[square.ravel()]  # [K, squares]
    weights = weighing.futures.weights
    left = (missing * weights) @ member
    unseen = left.sum(axis=1)
    after = [
        float(entropy(row / total)) * total if total > 0.0 else 0.0 for row, total in zip(left, unseen, strict=True)
    ]
    told: FloatArray = np.maximum(float(entropy(weights @ member)) - np.array(after), 0.0)
    return told
