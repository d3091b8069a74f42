"""A target that is not a point: the mixture of the answers."""

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.core.errors import InputError

D, A, W = np.array([0.19, 0.1, 0.05]), np.array([0.0, 0.6, -1.0]), np.array([3.0, 1.0, 0.0])


@pytest.mark.parametrize(
    "samples",
    [
        bh.Polar(D, A, A),
        bh.Pose(D * np.cos(A), -D * np.sin(A), A),
        pd.DataFrame({"distance": D, "angle": A}),
        np.column_stack([D, A]),
    ],
)
def test_it_is_the_weighted_sum_of_the_answers(inverse, samples):
    answers = [inverse.posterior(d, a).probabilities for d, a in zip(D, A, strict=True)]
    found = inverse.posterior_of(samples, W)
    pd.testing.assert_series_equal(found, 0.75 * answers[0] + 0.25 * answers[1])
    equal = inverse.posterior_of(samples)
    np.testing.assert_allclose(equal, sum(answers) / 3, atol=1e-12)


@pytest.mark.parametrize(
    ("samples", "weights"),
    [
        (np.zeros((0, 2)), None),
        (np.zeros((3, 3)), None),
        ("here", None),
        (pd.DataFrame({"distance": D}), None),
        (np.column_stack([D, A]), [1.0, 2.0]),
        (np.column_stack([D, A]), [0.0, 0.0, 0.0]),
        (np.column_stack([D, A]), [1.0, -1.0, 1.0]),
        (np.column_stack([-D, A]), None),
    ],
)
def test_what_is_no_sample_is_refused(inverse, samples, weights):
    with pytest.raises(InputError):
        inverse.posterior_of(samples, weights)


def test_a_belief_is_asked_for_samples(inverse):
    class Belief:
        def sample(self, n, *, rng):
            assert n >= 100
            assert isinstance(rng, np.random.Generator)
            return bh.Pose(np.full(n, 0.19), np.zeros(n), np.zeros(n))

    expected = inverse.posterior(0.19, 0.0).probabilities
    pd.testing.assert_series_equal(inverse.posterior_of(Belief()), expected)
