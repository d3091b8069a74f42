"""Between two gaits the log-odds is a sum of independent terms, so its distribution is integrated instead of drawn.

``log P(1|e) / P(2|e) = log P(1)/P(2) + sum_v log P(v|1) - log P(v|2)``, every probability a Beta variable. A term is
held as its quantiles at fixed levels u, even in log u / (1 - u), where the trapezoid rule is accurate to the far tails.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from bayeshunt.models.certainty.draws import log_quantiles
from bayeshunt.models.certainty.factors import Factor

__all__ = ["can_integrate", "integrate"]

_LOGITS = np.linspace(-12.0, 12.0, 193)
_COARSE = 4
_LEVELS = 1.0 / (1.0 + np.exp(-_LOGITS))
_WEIGHTS = _LEVELS * (1.0 - _LEVELS) / (_LEVELS * (1.0 - _LEVELS)).sum()
_NOTHING = np.zeros(1)
#: Log-odds beyond this are certain: no float tells 1 / (1 + exp(-x)) from 0 or 1.
_SURE = 800.0
_CERTAIN, _HALVINGS = 40.0, 24


def can_integrate(parts: list[Factor]) -> bool:
    """Return whether there are two gaits and nothing but the gait is unknown."""
    return parts[0].probability.shape == (2,) and all(part.axes == ("Gait",) for part in parts)


def integrate(parts: list[Factor], levels: Sequence[float]) -> np.ndarray:
    """Return quantiles [levels, 2] of P(Gait | evidence)."""
    one, other = (_sum([_term(part, gait) for part in parts]) for gait in (0, 1))
    odds = _difference(one, other, np.array([*levels, *(1.0 - level for level in levels)]))
    first = 1.0 / (1.0 + np.exp(-odds))
    count = len(levels)
    return np.stack([first[:count], 1.0 - first[count:]], axis=1)


def _term(part: Factor, gait: int) -> np.ndarray:
    """Quantiles of the log of what one table says of a gait; of an estimated P(Gait), the log-odds for the first."""
    if not part.estimated:
        with np.errstate(divide="ignore"):
            set_: np.ndarray = np.maximum(np.log(part.probability[gait : gait + 1]), -_SURE)
        return set_
    weights = part.counts + part.pseudo
    if part.observed is not None:
        rest = np.delete(weights[:, gait], part.observed).sum()
        return _log(weights[part.observed, gait], rest)
    return _log(weights[0], weights[1]) - _log(weights[1], weights[0])[::-1] if gait == 0 else _NOTHING


def _sum(terms: list[np.ndarray]) -> np.ndarray:
    total = _NOTHING
    for term in terms[::-1]:  # the causes, which may be on both sides of 0, last
        total = _add(total, term)
    return total


def _difference(one: np.ndarray, other: np.ndarray, levels: np.ndarray) -> np.ndarray:
    """Quantiles [levels] of one - other, two independent variables, by bisection within +- ``_CERTAIN``."""
    if len(one) == len(other) == 1:
        sure: np.ndarray = np.clip(np.repeat(one - other, len(levels)), -_CERTAIN, _CERTAIN)
        return sure
    if _width(one) < _width(other):  # the narrow one is summed over, so that the steps of the wide one do not show
        return -_difference(other, one, 1.0 - levels)
    weights = _WEIGHTS if len(other) > 1 else np.ones(1)
    curve, ends = _curve(one, _LOGITS)
    low, high = np.full(len(levels), -_CERTAIN), np.full(len(levels), _CERTAIN)
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        # F(x) = sum over u of w(u) F_one(x + other(u))
        reached = 1.0 / (1.0 + np.exp(-curve(np.clip(middle[:, None] + other, *ends)))) @ weights
        low, high = np.where(reached < levels, middle, low), np.where(reached < levels, high, middle)
    return low


def _log(own: float, rest: float) -> np.ndarray:
    """Quantiles of the log of a Beta variable; one that is certain is a single value."""
    if own <= 0 or rest <= 0:
        return np.array([0.0 if own > 0 else -_SURE])
    quantiles: np.ndarray = log_quantiles(np.array([own]), np.array([rest]), _LOGITS)[0]
    return quantiles


def _add(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Quantiles of the sum of two independent variables."""
    if len(one) == 1 or len(other) == 1:
        moved: np.ndarray = one + other
        return moved
    if _width(one) < _width(other):
        one, other = other, one
    # where the quantiles about are, from the sums of every fourth value
    sums = np.sort((one[::_COARSE, None] + other[::_COARSE]).ravel())
    places = np.unique(np.r_[one[0] + other[0], sums[::_COARSE], one[-1] + other[-1]])
    # F(x) = sum over u of w(u) F_one(x - other(u))
    curve, ends = _curve(one, _LOGITS)
    logits = curve(np.clip(places[:, None] - other, *ends))
    levels = np.clip((1.0 / (1.0 + np.exp(-logits))) @ _WEIGHTS, _LEVELS[0], _LEVELS[-1])
    back, ends = _curve(np.log(levels / (1.0 - levels)), places)
    total: np.ndarray = back(np.clip(_LOGITS, *ends))
    return total


def _width(quantiles: np.ndarray) -> float:
    """How far the middle half spreads."""
    return float(np.interp([0.25, 0.75], _LEVELS, quantiles) @ [-1.0, 1.0]) if len(quantiles) > 1 else 0.0


def _curve(x: np.ndarray, y: np.ndarray) -> tuple[Callable[[np.ndarray], np.ndarray], tuple[float, float]]:
    """A monotone curve through points of non-decreasing x, and the ends between which it may be asked."""
    from scipy.interpolate import PchipInterpolator

    x = np.maximum.accumulate(x)  # rounding
    kept = np.r_[True, np.diff(x) > 0]
    if kept.sum() == 1:  # all in one place
        return partial(np.full_like, fill_value=float(np.median(y))), (float(x[0]), float(x[0]))
    return PchipInterpolator(x[kept], y[kept]), (float(x[0]), float(x[kept][-1]))
