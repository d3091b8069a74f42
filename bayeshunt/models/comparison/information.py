"""How much one more row of a gait is expected to tell of its tables."""

from __future__ import annotations

import math

import numpy as np

__all__ = ["expected_bits"]


def expected_bits(counts: np.ndarray, pseudo: float) -> np.ndarray:
    """Return the bits [G] that one more row of each column of ``counts`` [K, G] is expected to tell of it.

    Of a column Dirichlet(w), w = counts + pseudo, W = sum w, the expected information is ``H(w / W) - E H(theta)``,
    with ``E H(theta) = psi(W + 1) - sum_k w_k / W psi(w_k + 1)`` (D. Wolpert and D. Wolf, Physical Review E 52, 1995).
    """
    from scipy.special import psi, xlogy

    weights = counts + pseudo
    total = weights.sum(axis=0)
    shares = weights / total
    nats = -xlogy(shares, shares).sum(axis=0) - psi(total + 1) + (shares * psi(weights + 1)).sum(axis=0)
    bits: np.ndarray = nats / math.log(2)
    return bits
