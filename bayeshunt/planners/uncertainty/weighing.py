"""What every pair of gaits is worth where the prey is not always seen. Letters: G gaits, K futures."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bayeshunt.core.geometry import FloatArray
from bayeshunt.planners.interception.futures import Futures
from bayeshunt.planners.interception.homing import Homing
from bayeshunt.planners.interception.lookahead import Charge, Outlook, PairPaths, look_ahead
from bayeshunt.planners.uncertainty.sight import Sight

__all__ = ["Price", "Weighing"]


class Price(NamedTuple):
    """What a future costs that is not seen: times to cross its distance from the middle; at most so many seconds."""

    crossings: float
    most: float


class Weighing:
    """One decision: what every pair of gaits is worth."""

    def __init__(
        self, pairs: PairPaths, futures: Futures, homing: Homing, spread: float, sight: Sight, price: Price,
        charge: Charge | None = None,
    ) -> None:  # fmt: skip
        self.pairs, self.futures, self.homing, self.spread = pairs, futures, homing, spread
        self.sight, self.price, self.charge = sight, price, charge

    def outlook(self) -> Outlook:
        """Return what every pair brings in every future."""
        return look_ahead(self.pairs, self.futures, self.homing, self.spread, self.charge)

    def lost(self) -> FloatArray:
        """Return what each future costs that is not seen [s, K]."""
        futures, price = self.futures, self.price
        forward, right = (part[:, 0] for part in futures.at(self.pairs.times[-1:]))
        far = np.hypot(forward - futures.weights @ forward, right - futures.weights @ right)
        lost: FloatArray = np.minimum(price.crossings * far / self.homing.top_speed, price.most)
        return lost

    def values(self, outlook: Outlook) -> tuple[FloatArray, FloatArray]:
        """Return the value of every first gait [G], and of every pair, chosen before anything is seen [G, G]."""
        weights, seen = self.futures.weights, self.sight.first
        escaped = 1.0 - outlook.second[:, :, -1]  # what is captured is not lost
        blind = outlook.time + self.lost() * (1.0 - self.sight.second) * escaped
        after = outlook.time @ np.swapaxes(self.sight.told, 1, 2)  # of a second gait, when it looks as in future k
        known = (seen * after.min(axis=1)) @ weights
        unseen = ((1.0 - seen) * weights)[:, None]
        shared = (blind * unseen).sum(axis=-1)
        every = (blind * ((1.0 - seen)[:, None] + 1e-9) * weights + outlook.time * seen[:, None] * weights).sum(axis=-1)
        return known + shared.min(axis=1), every
