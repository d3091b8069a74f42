"""Dirichlet back-off: where a context has few rows, its tables lean on those without the context.

``P(v | parent, context) ~ Dirichlet(s P(v | parent))``, whose mean given counts N is
``(N(v, parent, context) + s P(v | parent)) / (N(parent, context) + s)`` (MacKay and Peto, A hierarchical Dirichlet
language model, Natural Language Engineering 1, 1995). ``s`` is a number of rows: a context with s rows of its own
weighs as much as all that is known without it. Counts stay whole numbers, so that order never matters.
Letters: S states of v, J columns, P part-way poses.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from bayeshunt.core.checks import check_pseudo_count
from bayeshunt.core.errors import InputError

__all__ = ["PRIOR", "STRENGTH", "BackOff", "check_strength", "leaning_poses", "leaning_table"]

#: Pseudo-count per cell of the table that is leant on, where none is chosen: a row's worth in a column of 36 bins.
PRIOR = 0.03
#: Rows of back-off where none are chosen: of 2 to 40 the best for most bodies on wheels and legs.
STRENGTH = 5.0
#: Rows of back-off; "auto": :data:`STRENGTH` where there is a context, else none; None: none.
BackOff = float | str | None


def check_strength(value: Any) -> float:
    """Return a strength s [rows] as a float; InputError unless it is a pseudo-count above 0."""
    strength = check_pseudo_count(value, "backoff")
    if not strength > 0:
        raise InputError("backoff is 0; expected a number of rows > 0, or None for tables without back-off")
    return strength


def leaning_table(counts: np.ndarray, base: np.ndarray, strength: float) -> np.ndarray:
    """Return P(v | parent, context) [S, ...]: the Dirichlet mean of ``counts`` [S, ...] that leans on ``base``.

    base: P(v | parent), of a shape that broadcasts to that of the counts; its columns sum to 1.
    """
    weights = counts + strength * base
    return np.asarray(weights / (counts.sum(axis=0, keepdims=True) + strength))


def leaning_poses(
    sums: np.ndarray, rows: int, base_sums: np.ndarray, base_rows: int, strength: float, scale: float
) -> np.ndarray:
    """Return mean poses [P + 1, 3] that lean on others likewise: forward, right [m] and circular mean heading [rad].

    ``(n mean + s base mean) / (n + s)`` of forward, right, and the cosine and sine of the heading.
    sums: fixed-point sums [P + 1, 4] of these four over ``rows``, in units of 1 / scale; base_sums likewise, over
    ``base_rows`` > 0.
    """
    total = (sums + base_sums * (strength / base_rows)) / (scale * (rows + strength))
    forward, right, cosine, sine = total.T
    return np.column_stack([forward, right, np.arctan2(sine, cosine)])
