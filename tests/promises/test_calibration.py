"""Simulation-based calibration: the tables' intervals and ``sample`` mean what they say.

Talts et al., "Validating Bayesian inference algorithms with simulation-based calibration" (2018):
draw the truth from the prior, data from the truth, and look where the truth lies in the posterior;
over many replicates its place is uniform.
"""

import numpy as np
import pytest
from model_cases import frame_of, small_axes

from bayeshunt.core import statistics
from bayeshunt.models.body.forward import ForwardModel

pytestmark = pytest.mark.slow

REPLICATES = 1000
GROUPS = 20  # of equal probability


def p_value(places):
    """Chi-square p of places in [0, 1) being uniform."""
    from scipy.stats import chisquare

    return chisquare(np.bincount((np.asarray(places) * GROUPS).astype(int), minlength=GROUPS)).pvalue


def test_dirichlet_intervals(figure):
    rng = np.random.default_rng(7)
    levels = np.arange(1, GROUPS) / GROUPS
    found = {}
    for prior in (0.5, 1.0, 3.0):
        places = []
        for _ in range(REPLICATES):
            bins = int(rng.integers(2, 12))
            truth = rng.dirichlet(np.full(bins, prior))
            counts = rng.multinomial(int(rng.integers(1, 200)), truth)[:, None]
            cell = int(rng.integers(bins))
            # In how many of the nested intervals does the truth not lie?
            intervals = (statistics.credible_interval(counts, prior, level=level) for level in levels)
            inside = [low[cell, 0] <= truth[cell] <= high[cell, 0] for low, high in intervals]
            assert inside == sorted(inside), "intervals must be nested"
            places.append((GROUPS - 1 - sum(inside)) / GROUPS)
        found[prior] = p_value(places)
    assert min(found.values()) > 0.001, found
    shown = ", ".join(f"prior {prior:g}: p = {p:.3f}" for prior, p in found.items())
    figure(f"e. Dirichlet intervals, {REPLICATES} replicates each: {shown}")


def test_samples(figure):
    """A model learned from samples of another one: the truth's place in its posterior is uniform."""
    from scipy.stats import beta

    rng = np.random.default_rng(8)
    axes = small_axes(5, 6, 4)
    places = {name: [] for name in ("Distance", "Angle", "Heading")}
    for _ in range(REPLICATES):
        truth, drawn = random_truth(axes, rng), int(rng.integers(5, 60))
        poses = truth.sample("b", drawn, rng=rng)
        for name, values in zip(places, poses, strict=True):
            axis = axes[name]
            counts = np.bincount(axis.index(values), minlength=axis.bins)
            cell = int(rng.integers(axis.bins))
            p = truth.probabilities(name)[cell, 1]
            rest = axis.bins - 1 + drawn - counts[cell]
            places[name].append(min(beta.cdf(p, 1 + counts[cell], rest), 1 - 1e-12))
    found = {name: p_value(some) for name, some in places.items()}
    assert min(found.values()) > 0.001, found
    shown = ", ".join(f"{name}: p = {p:.3f}" for name, p in found.items())
    figure(f"e. sample, {REPLICATES} replicates: {shown}")


def random_truth(axes, rng):
    """A model whose tables are, to within one part in 10,000, a draw from the flat Dirichlet."""
    cells = []
    parts = [rng.dirichlet(np.ones(axis.bins)) for axis in axes]
    columns = [np.repeat(np.arange(len(p)), np.diff(np.round(np.r_[0, np.cumsum(p)] * 10_000).astype(int)))
               for p in parts]  # fmt: skip
    for row in zip(*(rng.permutation(column) for column in columns), strict=True):
        cells.append(("b", *(int(i) for i in row)))
    cells.append(("a", axes.distance.bins - 1, 0, 0))  # so that every distance bin is there
    return ForwardModel.empty(["a", "b"], axes=axes).update(frame_of(cells, axes))
