"""Scores of sampled futures against the one that came: point errors, best of 20, energy, density and coverage.

Letters: N windows, K samples, S steps; places are complex, in the unit of the tracks.
"""

from __future__ import annotations

import numpy as np

from bayeshunt.core.geometry import FloatArray
from bayeshunt.core.statistics import spatial_median

__all__ = ["BEST_OF", "SCORES", "at_times", "sampled_scores"]

#: Names of the scores, as columns.
SCORES = ("ade", "fde", "best20_ade", "best20_fde", "energy", "nll", "cover50", "cover90")
#: Samples of which the best is taken.
BEST_OF = 20
_ROUNDS = 30  # of the spatial median
_FLAT = 0.001  # share of a uniform density over the whole area in the kernel density
_CHUNK = 16  # windows at a time: their samples stay in the cache


def at_times(steps: int) -> np.ndarray:
    """Return the steps [4] at which densities are scored: the first, a third, two thirds and the last."""
    return np.unique(np.maximum(np.round(np.array([1 / 12, 1 / 3, 2 / 3, 1.0]) * steps), 1).astype(np.int64) - 1)


def sampled_scores(
    samples: FloatArray, came: FloatArray, *, floor: float, area: float, scored: int | None = None
) -> FloatArray:
    """Return the scores [N, 8], in the order of :data:`SCORES`, of samples [N, K, S] for what came [N, S].

    ade, fde: mean and final error of the spatial median of all samples. best20: of the best of the first 20, each for
    itself. Of the first ``scored`` (None: all): energy, mean of E|X - y| - E|X - X'| / 2 over four times; nll, -log of
    a Gaussian kernel density (Silverman's bandwidth, at least ``floor``; 0.1 % uniform over ``area``) there; cover50,
    cover90, whether what came lies where the density is among the highest half, or nine tenths, of the samples' own.
    One sample (K = 1) is a point: nll and coverage are NaN.
    """
    parts = [
        _of_chunk(samples[i : i + _CHUNK], came[i : i + _CHUNK], floor, area, scored)
        for i in range(0, len(samples), _CHUNK)
    ]
    return np.concatenate(parts) if parts else np.zeros((0, len(SCORES)))


def _of_chunk(samples: FloatArray, came: FloatArray, floor: float, area: float, scored: int | None) -> FloatArray:
    point = samples[:, 0] if samples.shape[1] == 1 else spatial_median(samples, axis=1, rounds=_ROUNDS)
    error = np.abs(point - came)
    samples = samples[:, :scored]
    best = np.abs(samples[:, :BEST_OF] - came[:, None])
    densities = [_density(samples[:, :, t], came[:, t], floor, area) for t in at_times(came.shape[1])]
    best_mean, best_end = best.mean(axis=2).min(axis=1), best[:, :, -1].min(axis=1)
    return np.column_stack([error.mean(axis=1), error[:, -1], best_mean, best_end, np.mean(densities, axis=0)])


def _density(samples: FloatArray, came: FloatArray, floor: float, area: float) -> FloatArray:
    """Energy score, negative log density, in the half, in the nine tenths: [N, 4] at one time."""
    gap = np.abs(samples - came[:, None])
    number = samples.shape[1]
    if number == 1:
        nothing = np.full(len(samples), np.nan)
        return np.column_stack([gap[:, 0], nothing, nothing, nothing])
    pairs = np.abs(samples[:, :, None] - samples[:, None, :])
    energy = gap.mean(axis=1) - 0.5 * pairs.mean(axis=(1, 2))
    spread = np.sqrt((samples.real.var(axis=1) + samples.imag.var(axis=1)) / 2)
    width = np.maximum(spread * number ** (-1 / 6), floor)
    peak = 1.0 / (2 * np.pi * width**2)
    there = np.exp(-0.5 * (gap / width[:, None]) ** 2).mean(axis=1) * peak
    own = np.exp(-0.5 * (pairs / width[:, None, None]) ** 2).sum(axis=2) - 1.0  # without itself
    higher = (own / (number - 1) * peak[:, None] > there[:, None]).mean(axis=1)
    nll = -np.log((1 - _FLAT) * there + _FLAT / area)
    return np.column_stack([energy, nll, higher < 0.5, higher < 0.9])
