"""Counts and probabilities: the arithmetic every table of this project shares.

Letters: N[i, j] counts of child state i under parent state j; a the Dirichlet pseudo-count per
cell; K the number of child states. Columns of a CPT sum to 1 (child axis first, as pgmpy prints).
"""

from __future__ import annotations

import numpy as np

from bayeshunt.core.errors import ZeroCountError
from bayeshunt.core.geometry import FloatArray

__all__ = ["credible_interval", "entropy", "normalise", "spatial_median"]

_NO_DISTANCE = 1e-9  # added to distances, so that a value at the median itself has a weight


def normalise(counts: np.ndarray, prior: float = 0.0, *, name: str = "table") -> np.ndarray:
    """Return the posterior-mean CPT of ``counts`` [K, J] under a symmetric Dirichlet prior.

    ``P[i, j] = (N[i, j] + a) / (sum_i N[i, j] + K a)``; with ``a = 0`` the maximum-likelihood table.

    Raises ZeroCountError where a column holds no count and no prior: there is no probability to give.
    """
    weights = np.asarray(counts, dtype=float) + prior
    totals = weights.sum(axis=0, keepdims=True)
    if np.any(totals <= 0):
        empty = np.flatnonzero(np.atleast_1d(totals.squeeze(0) <= 0))
        raise ZeroCountError(f"{name}: nothing counted in column(s) {empty.tolist()} and the prior is 0")
    cpt: np.ndarray = weights / totals
    return cpt


def entropy(probabilities: np.ndarray, axis: int = 0) -> np.ndarray:
    """Return the Shannon entropy [bit] along ``axis``; 0 log 0 counts as 0."""
    p = np.asarray(probabilities, dtype=float)
    logs = np.log2(np.where(p > 0, p, 1.0))
    bits: np.ndarray = -(p * logs).sum(axis=axis)
    return bits


def credible_interval(
    counts: np.ndarray, prior: np.ndarray | float = 0.0, *, level: float = 0.95
) -> tuple[np.ndarray, np.ndarray]:
    """Return lower and upper bounds [K, J] of each cell's equal-tailed Dirichlet credible interval.

    The marginal of a Dirichlet cell is Beta(N + a, sum N + K a - N - a) (Gelman et al., Bayesian Data
    Analysis, 3rd ed., section 3.4). A maximum-likelihood table (prior 0) has no posterior of its own:
    each cell then gets the Jeffreys interval against all other cells together, Beta(N + 1/2,
    sum N - N + 1/2), with the lower bound 0 where nothing was counted and the upper 1 where everything
    was, so that it holds the cell's own share (Brown, Cai and DasGupta, Interval estimation for a binomial
    proportion, Statistical Science 16, 2001). A half in every one of K cells would add K / 2 rows that
    nobody saw, and push the interval off the very probability that it belongs to.
    """
    from scipy.stats import beta

    observed = np.asarray(counts, dtype=float)
    others = observed.sum(axis=0, keepdims=True) - observed
    if isinstance(prior, np.ndarray):  # pseudo-counts of each cell
        own, rest = observed + prior, others + (prior.sum(axis=0, keepdims=True) - prior)
    elif prior > 0:
        own, rest = observed + prior, others + (len(observed) - 1) * prior
    else:
        own, rest = observed + 0.5, others + 0.5
    # A table of one state leaves nothing to doubt, and Beta(a, 0) is no distribution.
    tail, alone = (1.0 - level) / 2.0, rest <= 0
    rest, never = np.where(alone, 1.0, rest), own <= 0  # neither counted nor expected: it is 0 for sure
    own = np.where(never, 1.0, own)
    low = np.where(alone, 1.0, beta.ppf(tail, own, rest))
    high = np.where(alone, 1.0, beta.ppf(1.0 - tail, own, rest))
    if isinstance(prior, np.ndarray):
        return np.where(never, 0.0, low), np.where(never, 0.0, high)
    if prior > 0:
        return low, high
    return np.where(observed == 0, 0.0, low), np.where(others == 0, 1.0, high)


def spatial_median(values: FloatArray, *, axis: int, rounds: int) -> FloatArray:
    """Return the places with the least mean distance to complex ``values`` along ``axis``, in ``rounds`` of Weiszfeld.

    Source: E. Weiszfeld, Sur le point pour lequel la somme des distances de n points donnés est minimum, Tohoku
    Mathematical Journal 43 (1937). The unit is that of the values.
    """
    found = values.mean(axis=axis)
    for _ in range(rounds):
        weight = 1.0 / (np.abs(values - np.expand_dims(found, axis)) + _NO_DISTANCE)
        found = (weight * values).sum(axis=axis) / weight.sum(axis=axis)
    return np.asarray(found)
