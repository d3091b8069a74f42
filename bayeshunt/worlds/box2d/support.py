"""Who bears a walking body: the load on each foot, and how far off the feet that are down the load lies."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from scipy.optimize import nnls

__all__ = ["Support", "supports"]

#: Shares of the weight on each foot; the centre of pressure seen from the centre of mass, ahead and left, and how much
#: is missing for want of any foot [body lengths].
Support = tuple[tuple[float, ...], tuple[float, float, float]]

#: How far off the load is while no foot is down [body lengths].
FLIGHT = 0.5
#: Weight of "shares add up to one" and of "shares are alike" against "the load lies over its feet".
_SUM, _ALIKE = 1e3, 1e-2


@lru_cache(maxsize=32)
def supports(feet: tuple[tuple[float, float], ...]) -> tuple[Support, ...]:
    """Return the support for every set of feet that are down, by its number: bit i is foot i.

    feet: x, y from the centre of mass [body lengths]. The shares are those, none negative, whose centre of pressure
    comes nearest to the centre of mass (non-negative least squares).
    """
    return tuple(_support(feet, [i for i in range(len(feet)) if number >> i & 1]) for number in range(2 ** len(feet)))


def _support(feet: Sequence[tuple[float, float]], down: list[int]) -> Support:
    loads = np.zeros(len(feet))
    if not down:
        return tuple(loads.tolist()), (0.0, 0.0, FLIGHT)
    places = np.array([feet[i] for i in down]).T
    count = len(down)
    rows = np.vstack([places, np.full((1, count), _SUM), _ALIKE * np.eye(count)])
    shares, _ = nnls(rows, np.array([0.0, 0.0, _SUM, *[0.0] * count]))
    shares = shares / shares.sum()
    loads[down] = shares
    ahead, left = (places @ shares).tolist()
    return tuple(loads.tolist()), (ahead, left, 0.0)
