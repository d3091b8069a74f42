"""How well the hunters hunt, in the world; seeds that no constant was chosen on and no result is reported on."""

from __future__ import annotations

import pytest

from bayeshunt.experiments.explorations import learn_room
from bayeshunt.experiments.protocol import hunt_seed, learn_model
from bayeshunt.experiments.scores import wilson_interval
from bayeshunt.hunting import run_hunt
from bayeshunt.planners.registry import make_planner
from bayeshunt.settings import load_experiment

SEED, RUNS = 500, 20  # 140 hunts a cell


@pytest.fixture(scope="module")
def learned():
    settings = load_experiment("paper")
    model = learn_model(settings, SEED)
    return settings, model, learn_room(settings, seed=SEED, model=model)


def hunts(learned, name, arena, **given):
    """Return the caught runs, all runs and the mean time."""
    settings, model, room = learned
    planner = make_planner(name, model, **({"room": room} if name == "intercept_walls" else {}), **given)
    found = [
        run_hunt(settings, planner, arena, theta, hunt_seed(SEED, index, run))
        for index, theta in enumerate(settings.protocol.thetas)
        for run in range(RUNS)
    ]
    return sum(result.caught for result in found), len(found), sum(result.time for result in found) / len(found)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "arena", "success", "time"),
    [
        ("intercept", "open", 0.98, 20.5),
        ("intercept", "walled", 0.99, 15.0),
        ("intercept_room", "open", 0.98, 20.5),
        ("intercept_room", "walled", 0.99, 15.0),
        ("intercept_walls", "walled", 0.995, 12.0),
        ("belief", "open", 0.98, 20.5),
        ("belief", "walled", 0.99, 15.0),
    ],
)
def test_success_and_time(learned, name, arena, success, time):
    """The upper bound of success must reach the aim; the mean time may exceed it by two standard errors."""
    caught, runs, mean = hunts(learned, name, arena)
    assert wilson_interval(caught, runs)[1] >= success
    assert caught / runs >= success - 0.03
    assert mean <= time + 2.0 * 14.0 / runs**0.5  # catch times spread by about 14 s


@pytest.mark.slow
def test_the_prior_on_the_prey_pays_in_the_open(learned):
    with_prior, without = (hunts(learned, "intercept", "open", prior=prior)[2] for prior in (True, False))
    assert with_prior < without - 3.0
