"""Draws of Dirichlet tables that are the same every time, and spread evenly: a randomised Sobol sequence.

Every independent cell gets one coordinate of the sequence, put through its own quantile function, so that each cell's
draws are its distribution at evenly spaced levels, tails included. In logarithms throughout: with pseudo-counts far
below 1 a probability is often smaller than any float. Source: A. Owen, Scrambled net variance for integrals of smooth
functions, Annals of Statistics 25 (1997).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np

from bayeshunt.models.certainty.factors import log_sum

__all__ = ["draws_for", "log_beta", "log_dirichlet", "log_quantiles"]

_SEED = 20100  # of the scrambling: private, so that an answer's interval is always the same
_CELLS, _FEWEST, _MOST = 1 << 16, 1 << 9, 1 << 14
#: Levels u at which quantiles are worked out, as log u / (1 - u); in between they are interpolated.
_LEVELS = np.linspace(-18.0, 18.0, 145)
_STEP = float(_LEVELS[1] - _LEVELS[0])
#: Quantiles of parameters that were asked for, by their function; at most so many of each are kept, some 5 MB.
_KNOWN: dict[str, dict[tuple[float, ...], np.ndarray]] = {}
_MOST_KNOWN = 4096
_TINY = 1e-250  # below, the first term of the series is exact


def draws_for(cells: int) -> int:
    """Return how many draws are made of a table of so many independent cells: 512 to 16,384, a power of 2."""
    return min(max(1 << int(math.log2(_CELLS / max(cells, 1))), _FEWEST), _MOST) if cells < _CELLS else _FEWEST


def log_quantiles(own: np.ndarray, rest: np.ndarray, logits: np.ndarray) -> np.ndarray:
    """Return the log of the quantiles [C, L] of Beta(own, rest) [C], both > 0, at levels given as log u / (1 - u)."""
    from scipy.special import betaincinv, betaln

    a, b = own.reshape(-1, 1), rest.reshape(-1, 1)
    level = 1.0 / (1.0 + np.exp(-logits))
    with np.errstate(divide="ignore", under="ignore"):
        quantile = betaincinv(a, b, level)
        # I_x(a, b) = x^a / (a B(a, b)) for tiny x
        series = (np.log(level) + np.log(a) + betaln(a, b)) / a
        logs: np.ndarray = np.where(quantile > _TINY, np.log(quantile), np.minimum(series, 0.0))
    return logs


def log_beta(own: np.ndarray, rest: np.ndarray, first: int, dimensions: int) -> np.ndarray:
    """Return the log of draws [..., n] of Beta(own, rest), arrays [...] of parameters >= 0.

    first: coordinate of the sequence that the first cell uses; dimensions: of the sequence in all.
    0 where ``rest`` is 0 (the cell is certain), -inf where ``own`` is 0 (it never happens).
    """
    pairs = np.stack([np.where(own > 0, own, 1.0).ravel(), np.where(rest > 0, rest, 1.0).ravel()])
    table = _table(pairs, log_quantiles)
    drawn = _interpolate(table, first, dimensions).reshape(*own.shape, -1)
    drawn = np.where((rest > 0)[..., None], drawn, 0.0)
    return np.where((own > 0)[..., None], drawn, -np.inf)


def log_dirichlet(weights: np.ndarray, first: int, dimensions: int) -> np.ndarray:
    """Return the log of draws [K, ..., n] of a Dirichlet along the first axis, parameters [K, ...] >= 0."""
    table = _table(np.where(weights > 0, weights, 1.0).reshape(1, -1), _log_gamma)
    drawn = _interpolate(table, first, dimensions).reshape(*weights.shape, -1)
    drawn = np.where((weights > 0)[..., None], drawn, -np.inf)
    shares: np.ndarray = drawn - log_sum(drawn, 0)
    return shares


def _log_gamma(shape: np.ndarray, logits: np.ndarray) -> np.ndarray:
    """Log of the quantiles [C, L] of Gamma(shape) [C]."""
    from scipy.special import gammaincinv, gammaln

    a, level = shape.reshape(-1, 1), 1.0 / (1.0 + np.exp(-logits))
    with np.errstate(divide="ignore", under="ignore"):
        quantile = gammaincinv(a, level)
        series = (np.log(level) + gammaln(a + 1.0)) / a  # P(a, x) = x^a / Gamma(a + 1) for tiny x
        logs: np.ndarray = np.where(quantile > _TINY, np.log(quantile), series)
    return logs


def _table(parameters: np.ndarray, quantiles: Callable[..., np.ndarray]) -> np.ndarray:
    """Quantiles [C, L] at :data:`_LEVELS` for parameters [P, C]: cells without rows are alike, answers share cells."""
    keys = list(zip(*parameters.tolist(), strict=True))
    known = _KNOWN.setdefault(quantiles.__name__, {})
    if len(known) > _MOST_KNOWN:
        known.clear()
    if missing := list(dict.fromkeys(key for key in keys if key not in known)):
        known.update(zip(missing, quantiles(*np.array(missing).T, _LEVELS), strict=True))
    return np.array([known[key] for key in keys])


def _interpolate(table: np.ndarray, first: int, dimensions: int) -> np.ndarray:
    """Values [C, n] of quantile functions ``table`` [C, L] at the sequence's coordinates from ``first`` on."""
    below, share = _sequence(dimensions)
    chosen = slice(first, first + len(table))
    place = below[chosen] + np.arange(0, table.size, table.shape[1])[:, None]
    flat = table.ravel()
    low = flat.take(place, mode="clip")  # always inside: no need to look
    step = flat.take(place + 1, mode="clip") - low
    drawn: np.ndarray = low + share[chosen] * step
    return drawn


@lru_cache(maxsize=4)
def _sequence(dimensions: int) -> tuple[np.ndarray, np.ndarray]:
    """The randomised Sobol points as places in :data:`_LEVELS`: the level below [C, n] and the share above it."""
    from scipy.stats import qmc

    count = draws_for(dimensions)
    points = qmc.Sobol(max(dimensions, 1), rng=np.random.default_rng(_SEED)).random(count).T
    clear = np.clip(points, 1e-7, 1.0 - 1e-7)
    place = (np.log(clear) - np.log1p(-clear) - _LEVELS[0]) / _STEP
    below = place.astype(np.int64)
    return below, place - below
