"""Decisions that plan for noise: which samples there are, what is seen after the first step, who uses them."""

from __future__ import annotations

import numpy as np
import pytest
from planner_cases import WHEELS, fit, situations

from bayeshunt.planners.interception.belief import belief
from bayeshunt.planners.interception.intercept import intercept
from bayeshunt.planners.interception.lookahead import decide, look_ahead
from bayeshunt.planners.interception.sampling import Samples


@pytest.fixture(scope="module")
def slippery():
    return fit(list(WHEELS), rows=600, slip=0.4)


def test_first_outcomes_are_few_and_each_goes_on_in_as_many_ways(slippery):
    (samples,) = Samples.draw(slippery, 0.4, samples=25, blocks=1)
    assert np.bincount(samples.outcome).tolist() == [5] * 5
    for outcome in range(5):
        mine = samples.outcome == outcome
        first, second = samples.pairs.first_end[..., mine], samples.pairs.end[..., mine]
        assert (np.ptp(first, axis=-1) == 0).all()
        assert (np.ptp(second[0], axis=-1) > 0).all()
    assert len(np.unique(samples.pairs.first_end[0, 0])) == 5


def test_every_fifth_of_an_axis_has_a_fifth_of_the_samples(slippery):
    """Of the straight gait, the prey's pace has the quantiles of the outcomes themselves."""
    (few,), (many,) = (Samples.draw(slippery, 0.4, samples=n, blocks=1) for n in (64, 1024))
    shares = np.array([0.1, 0.3, 0.5, 0.7, 0.9])
    assert np.quantile(few.direction, shares).tolist() == pytest.approx(
        np.quantile(many.direction, shares).tolist(), abs=0.1
    )
    assert few.direction.mean() == pytest.approx(many.direction.mean(), abs=0.03)


def test_futures_of_different_outcomes_are_told_apart(slippery):
    (samples,) = Samples.draw(slippery, 0.4, samples=16, blocks=1)
    planner, case = intercept(slippery, hazard=0.0), situations(1, seed=3)[0]
    groups = samples.futures(planner.futures(case)).groups
    same = samples.outcome[:, None] == samples.outcome
    assert ((groups[:, None] == groups) <= same).all()


def test_deciding_again_after_the_first_step_is_never_dearer(slippery):
    planner, case = belief(slippery), situations(1, seed=5)[0]
    samples = planner.samples[0]
    futures = samples.futures(planner.futures(case))
    values, pairs = decide(look_ahead(samples.pairs, futures, planner.homing, 0.0), futures)
    assert (values <= pairs.min(axis=1) + 1e-12).all()
    assert values.mean() < pairs.min(axis=1).mean() - 0.1


def test_who_slips_plans_for_it_and_who_does_not_pays_nothing(slippery):
    case = situations(1, seed=4)[0]
    assert intercept(fit(list(WHEELS), rows=300, slip=0.02)).samples == ()
    planner = intercept(slippery)
    plans = {planner.plan(case, rng=np.random.default_rng(seed)).value for seed in range(12)}
    assert len(plans) == len(planner.samples) == 4
    assert (
        planner.plan(case, rng=np.random.default_rng(0)).value
        == belief(slippery).plan(case, rng=np.random.default_rng(0)).value
    )
    assert len(planner.plan(case, rng=np.random.default_rng(0)).trace) == 111
