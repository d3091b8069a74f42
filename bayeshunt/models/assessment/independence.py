"""Does the data contradict the network? Tests of conditional independence given the gait.

The statistic is ``G = 2 sum n log(n n_z / (n_x n_y)) = 2 N I(X; Y | Z)``. Its chi-square distribution
holds where expected counts are large; tables of 36 bins are sparse, so the p-value to go by is that of
a permutation test: Y is shuffled among the rows of the same gait, which makes independence true and
leaves everything else as it is. ``p = (1 + shuffles with at least this G) / (1 + shuffles)``.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pandas as pd

from bayeshunt.core.bins import EFFECTS
from bayeshunt.models.assessment.rows import CodedRows
from bayeshunt.models.tables.structures import PREVIOUS

__all__ = ["g_statistic", "independence", "permuted"]

#: Relative slack when a shuffle's G is compared with the data's: equal tables may round differently.
_SLACK = 1e-9


def independence(rows: CodedRows, permutations: int, seeds: np.random.SeedSequence) -> pd.DataFrame:
    """Test every pair of effects, and each effect with the gait before, for independence given the gait.

    permutations: shuffles per test, >= 1. seeds: one stream is spawned for each test.

    Columns: x, y; g; degrees (of freedom, seen states only); p_chi2; p_permutation;
    information_bits, I(X; Y | Gait) in the data; information_chance_bits, its mean over the shuffles;
    sparse, the share of seen cells' expected counts below 5, where chi-square should not be trusted.
    """
    pairs = list(combinations(EFFECTS, 2))
    if rows.has_previous:
        pairs += [(effect, PREVIOUS) for effect in EFFECTS]
    streams = seeds.spawn(len(pairs))
    records = [
        _test(rows, x, y, permutations, np.random.default_rng(s)) for (x, y), s in zip(pairs, streams, strict=True)
    ]
    return pd.DataFrame(records)


def _test(rows: CodedRows, x: str, y: str, permutations: int, rng: np.random.Generator) -> dict[str, object]:
    from scipy.stats import chi2

    counts = rows.count().tabulate(("Gait", x, y))  # [Z, X, Y]
    g = g_statistic(counts)
    chance = permuted(rows, x, y, permutations, rng)
    degrees = int(((np.any(counts, axis=2).sum(axis=1) - 1) * (np.any(counts, axis=1).sum(axis=1) - 1)).clip(0).sum())
    expected = _expected(counts)
    bits = 1.0 / (2.0 * len(rows.codes) * np.log(2.0))
    return {
        "x": x,
        "y": y,
        "g": g,
        "degrees": degrees,
        "p_chi2": float(chi2.sf(g, degrees)) if degrees else 1.0,
        "p_permutation": float((1 + (chance >= g * (1.0 - _SLACK)).sum()) / (1 + permutations)),
        "information_bits": g * bits,
        "information_chance_bits": float(chance.mean()) * bits,
        "sparse": float((expected[expected > 0] < 5).mean()),
    }


def g_statistic(counts: np.ndarray) -> float:
    """Return G of counts [Z, X, Y]: 0 if X and Y are independent in every stratum Z."""
    seen = counts > 0
    return float(2.0 * np.sum(counts[seen] * np.log(counts[seen] / _expected(counts)[seen])))


def _expected(counts: np.ndarray) -> np.ndarray:
    """Expected counts [Z, X, Y] under independence: n_x n_y / n in each stratum."""
    x, y = counts.sum(axis=2, keepdims=True), counts.sum(axis=1, keepdims=True)
    totals = x.sum(axis=1, keepdims=True)
    found: np.ndarray = np.divide(x * y, totals, out=np.zeros(counts.shape), where=totals > 0)
    return found


def permuted(rows: CodedRows, x: str, y: str, permutations: int, rng: np.random.Generator) -> np.ndarray:
    """Return G [permutations] of tables in which Y is shuffled within each gait."""
    sizes = rows.sizes
    order = np.argsort(rows.column("Gait"), kind="stable")
    gait, first, shuffled = (rows.column(name)[order] for name in ("Gait", x, y))
    starts = np.flatnonzero(np.r_[True, gait[1:] != gait[:-1]])
    strata = np.split(shuffled, starts[1:])  # views: shuffling them shuffles the whole
    stratum = (gait * sizes[x] + first) * sizes[y]
    # Margins stay as they are, so only the sum of n log n over cells changes.
    counts = rows.count().tabulate(("Gait", x, y))
    rest = sum(sign * _n_log_n(part) for sign, part in _margins(counts))
    results = np.empty(permutations)
    for k in range(permutations):
        for part in strata:
            rng.shuffle(part)
        results[k] = 2.0 * (_n_log_n(np.bincount(stratum + shuffled)) + rest)
    return results


def _margins(counts: np.ndarray) -> list[tuple[int, np.ndarray]]:
    return [(1, counts.sum(axis=(1, 2))), (-1, counts.sum(axis=2)), (-1, counts.sum(axis=1))]


def _n_log_n(counts: np.ndarray) -> float:
    seen = counts[counts > 0]
    return float(np.sum(seen * np.log(seen)))
