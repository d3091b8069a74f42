"""Counts and probabilities against numbers worked out by hand."""

import numpy as np
import pytest

from bayeshunt.core.errors import ZeroCountError
from bayeshunt.core.statistics import credible_interval, entropy, normalise

COUNTS = np.array([[3, 0], [1, 5]])


def test_maximum_likelihood_by_hand():
    np.testing.assert_array_equal(normalise(COUNTS), [[0.75, 0.0], [0.25, 1.0]])


def test_dirichlet_by_hand():
    np.testing.assert_allclose(normalise(COUNTS, 1.0), [[4 / 6, 1 / 7], [2 / 6, 6 / 7]], rtol=1e-15)


def test_an_empty_column_is_an_error_not_a_uniform():
    with pytest.raises(ZeroCountError, match=r"Distance.*\[1\]"):
        normalise(np.array([[3, 0], [1, 0]]), name="Distance")


def test_entropy_in_bits():
    np.testing.assert_allclose(entropy(np.array([[0.5, 1.0], [0.5, 0.0]])), [1.0, 0.0])


def test_credible_interval_of_a_uniform_prior_and_no_data():
    # Beta(1, 1) is uniform: its central 95 % runs from 0.025 to 0.975
    low, high = credible_interval(np.zeros((2, 1)), 1.0)
    np.testing.assert_allclose(low, 0.025)
    np.testing.assert_allclose(high, 0.975)


def test_credible_interval_holds_the_mean_and_narrows():
    few, many = credible_interval(COUNTS, 1.0), credible_interval(100 * COUNTS, 1.0)
    mean = normalise(COUNTS, 1.0)
    assert (few[0] < mean).all()
    assert (mean < few[1]).all()
    assert (many[1] - many[0] < few[1] - few[0]).all()


def test_credible_interval_without_a_prior_holds_the_share_in_tall_tables():
    # 129 of 200 in one of 36 bins: the interval must lie around 0.645, and be that of a plain proportion.
    counts = np.zeros((36, 1))
    counts[3], counts[4] = 129, 71
    low, high = credible_interval(counts)
    assert low[3, 0] < 0.645 < high[3, 0]
    np.testing.assert_allclose([low[3, 0], high[3, 0]], [0.5769, 0.7090], atol=5e-4)
    one = credible_interval(np.array([[1.0]]))
    assert 0 < one[0][0, 0] < one[1][0, 0] == 1, "one row of one kind is no certainty"
    certain = credible_interval(np.array([[7.0]]), 0.5)
    assert (certain[0][0, 0], certain[1][0, 0]) == (1.0, 1.0), "a table of one state has nothing to doubt"


def test_credible_interval_without_a_prior_holds_shares_of_none_and_all():
    low, high = credible_interval(np.array([[0, 5, 0], [20, 15, 0]]))
    assert low[0, 0] == 0.0
    assert high[1, 0] == 1.0
    # Beta(20.5, 0.5) at 2.5 %, and its mirror image: what was not seen may still be
    np.testing.assert_allclose([low[1, 0], high[0, 0]], [1 - 0.1166, 0.1166], atol=5e-4)
    assert 0 < low[0, 1] < 0.25 < high[0, 1] < 1
    np.testing.assert_array_equal([low[:, 2], high[:, 2]], [[0, 0], [1, 1]])  # nothing counted, nothing known
    low, _ = credible_interval(np.array([[0], [20]]), 1.0)
    assert low[0, 0] > 0, "with a prior the probability is above 0 and so is its interval"
