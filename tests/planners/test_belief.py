"""Belief: P(captured by t) against an independent simulation, and the resampling of the prey's futures."""

from __future__ import annotations

import numpy as np
import pytest
from planner_cases import BODY, STEP, situations

from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import Polar
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.planners.api import Situation
from bayeshunt.planners.interception.belief import belief
from bayeshunt.planners.interception.lookahead import gait_paths, look_ahead


def situation(distance, angle, heading):
    seen = tuple(Polar(0.16, 0.0, h) for h in (0.1, -0.1))
    return Situation(Polar(distance, angle, heading), PreyModel(), body_length=BODY, time_step=STEP, transitions=seen)


@pytest.fixture(scope="module")
def planner(model):
    return belief(model, samples=64, blocks=2)


def simulated_chance(model, case, gaits, speed, runs, rng):
    """P(captured within two steps) of a hunter drawn from the forward model, step by step, in plain loops."""
    straight = model.gaits.index("straight")
    paths = gait_paths(model)
    share = np.arange(1, paths.shape[1] + 1) / paths.shape[1]
    reach, caught = 1.02 * BODY, 0
    own = [model.sample("straight", runs, rng=rng), *(model.sample(gait, runs, rng=rng) for gait in gaits)]
    mean = float(np.mean(own[0].distance))
    bearing = np.arctan2(paths[straight, -1, 1], paths[straight, -1, 0])
    for run in range(runs):
        drift, quick = own[0].angle[run] - bearing, own[0].distance[run] / mean
        x = y = heading = 0.0
        hit = False
        for step, gait in enumerate(gaits):
            path = paths[model.gaits.index(gait)]
            end = Polar(*(part[run] for part in own[1 + step]))
            off = np.array([end.forward, end.right]) - path[-1, :2]
            for point in range(len(share)):
                ahead, right = path[point, :2] + share[point] * off
                at = x + np.cos(heading) * ahead - np.sin(heading) * right
                across = y + np.sin(heading) * ahead + np.cos(heading) * right
                time = (step + share[point]) * STEP
                way = case.prey.heading + drift
                px = case.prey.forward + speed * quick * time * np.cos(way)
                py = case.prey.right + speed * quick * time * np.sin(way)
                hit = hit or bool(np.hypot(at - px, across - py) <= reach)
            x, y = at, across
            heading += end.heading
        caught += hit
    return caught / runs


UNCERTAIN = [
    ((0.28, 0.35, 2.6), ("hard right", "straight")),
    ((0.28, 0.35, 2.6), ("hard right", "slow")),
    ((0.2, 0.0, 3.1), ("hard right", "left")),
]


@pytest.mark.parametrize(("prey", "gaits"), UNCERTAIN)
def test_capture_probability_against_simulation(model, prey, gaits):
    """A prey that does not turn, where the capture is uncertain."""
    case = situation(*prey)
    many = belief(model, samples=2000, blocks=1, hazard=0.0)
    known = many.prior.learn(case.transitions)
    assert known.hazard == 0.0
    trace = many.plan(case, rng=np.random.default_rng(0)).trace
    found = trace.loc[trace["gaits"] == ", ".join(gaits), "capture_probability"].item()
    truth = simulated_chance(model, case, gaits, known.speed / STEP, 1000, np.random.default_rng(7))
    assert 0.05 < truth < 0.95
    assert found == pytest.approx(truth, abs=4.0 * np.sqrt(truth * (1 - truth) * (1 / 1000 + 1 / 2000)))


def test_futures_are_resampled_in_proportion(planner):
    case = situation(0.3, 0.2, 1.0)
    whole, drawn = planner.futures(case), planner.samples[0].futures(planner.futures(case))
    assert len(drawn.weights) == 64
    assert drawn.weights.sum() == pytest.approx(1.0)
    never = np.isinf(drawn.starts[:, 1]).mean()
    assert never == pytest.approx(whole.weights[0], abs=1 / 64)
    early = (drawn.starts[:, 1] < STEP).mean()
    assert early == pytest.approx(whole.weights[(whole.starts[:, 1] < STEP)].sum(), abs=1 / 64)


def test_without_prey_noise_the_paths_are_those_of_the_turn_table(model):
    calm, case = belief(model, prey_noise=0.0, hazard=0.1), situation(0.3, 0.2, 1.0)
    whole, drawn = calm.futures(case), calm.samples[1].futures(calm.futures(case))
    known = {
        tuple(np.round(np.concatenate(path), 9)) for path in zip(*whole.at(np.array([1.0, 4.0, 9.0])), strict=True)
    }
    found = {
        tuple(np.round(np.concatenate(path), 9)) for path in zip(*drawn.at(np.array([1.0, 4.0, 9.0])), strict=True)
    }
    assert found <= known
    assert len(found) > 3


def test_curves_rise_and_the_expected_time_is_their_integral(planner):
    case = situation(0.12, 0.0, 3.1)
    futures = planner.samples[0].futures(planner.futures(case))
    outlook = look_ahead(planner.samples[0].pairs, futures, planner.homing, 0.0)
    assert set(np.unique(outlook.second)) == {0.0, 1.0}
    assert (np.diff(outlook.second, axis=2) >= 0).all()
    sure = outlook.second[:, :, -1].all(axis=-1)
    assert sure.any()
    g, h = np.argwhere(sure)[0]
    curve = np.concatenate([outlook.first[g], outlook.second[g, h]])  # [2 P, S]
    integral = (1.0 - curve).sum(axis=0) * planner.samples[0].pairs.times[0]
    assert outlook.time[g, h].tolist() == pytest.approx(integral.tolist())


def test_decisions_follow_the_generator_and_the_bank(model, planner):
    case = situations(1, seed=4)[0]
    values = {planner.plan(case, rng=np.random.default_rng(seed)).value for seed in range(12)}
    assert len(values) == 2  # one per block
    again = belief(model, samples=64, blocks=2)
    assert (
        again.plan(case, rng=np.random.default_rng(3)).value == planner.plan(case, rng=np.random.default_rng(3)).value
    )
    other = belief(model, samples=64, blocks=2, bank_seed=1)
    assert other.plan(case, rng=np.random.default_rng(3)).value not in values


@pytest.mark.parametrize(
    "wrong", [{"samples": 1}, {"blocks": 0}, {"bank_seed": -1}, {"prey_noise": -0.5}, {"hazard": 2}]
)
def test_wrong_settings_are_named(model, wrong):
    with pytest.raises(InputError, match=next(iter(wrong))):
        belief(model, **wrong)
