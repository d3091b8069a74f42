"""The hunter of a prey that may react: which of the two it believes, and what it then does."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from planner_cases import BODY, STEP, situations

import bayeshunt as bh
from bayeshunt.core.geometry import Polar, Pose
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.planners.api import Situation
from bayeshunt.planners.registry import make_planner

RUN = 2.8 * BODY
STRAIGHT, LEFT, RIGHT = (Polar(RUN, half, 2 * half) for half in (0.0, -0.66, 0.66))


def decide(planner, case):
    return planner.plan(case, rng=np.random.default_rng(0))


def seen(motions, places, prey=None):
    """A prey that has just made ``motions``, the hunter at ``places`` before each, as the prey had it."""
    return Situation(
        Polar(5 * BODY, 0.0, 0.0) if prey is None else prey, PreyModel(), body_length=BODY, time_step=STEP,
        transitions=tuple(motions), approaches=tuple(places), pose=Pose(0.0, 0.0, 0.0), step=len(motions),
    )  # fmt: skip


BEHIND, ASIDE = Polar(4 * BODY, math.pi, 0.0), Polar(4 * BODY, 1.9, 0.0)


def test_a_prey_that_goes_straight_goes_its_own_way_and_one_that_weaves_reacts(model):
    planner = make_planner("intercept_evader", model)
    before = planner.reacting(seen([], []))
    assert before == 0.2
    straight = [planner.reacting(seen([STRAIGHT] * n, [BEHIND] * n)) for n in range(5)]
    assert straight == sorted(straight, reverse=True)
    assert straight[-1] < 0.05
    weaving = [planner.reacting(seen([LEFT, RIGHT] * n, [BEHIND, ASIDE] * n)) for n in range(1, 4)]
    assert weaving == sorted(weaving)
    assert weaving[-1] > 0.95


def test_without_the_hunters_places_or_a_chance_of_reacting_it_is_intercept(model):
    plain = make_planner("intercept", model)
    for case in situations(6):
        case = replace(case, pose=Pose(0.0, 0.0, 0.0), transitions=(STRAIGHT, LEFT))
        for evader in (make_planner("intercept_evader", model), make_planner("intercept_evader", model, reacts=0.0)):
            one, other = decide(plain, case), decide(evader, case)
            assert (one.gait, one.value) == (other.gait, other.value)


def test_it_foresees_where_a_prey_turns_that_always_does_the_same(model):
    """A prey that has always turned left with the hunter behind it: it will, whatever ``intercept`` makes of it."""
    case = seen([LEFT, RIGHT, LEFT, RIGHT, LEFT, RIGHT], [BEHIND, ASIDE] * 3)
    plan = decide(make_planner("intercept_evader", model), case)
    path = plan.predicted_prey
    assert path.heading[1] - path.heading[0] == pytest.approx(-1.32, abs=0.05)
    assert path.distance[0] == pytest.approx(5 * BODY)
    told = case.prey.compose(LEFT)
    assert (path.forward[1], path.right[1]) == pytest.approx((told.forward, told.right), abs=0.002)


def test_the_table_of_a_decision_shows_both_hypotheses(model):
    case = seen([LEFT, STRAIGHT], [BEHIND, ASIDE])
    planner = make_planner("intercept_evader", model)
    plan = decide(planner, case)
    table = plan.trace
    reacts = planner.reacting(case)
    assert 0.01 < reacts < 0.99
    mixed = (1 - reacts) * table["own_way_s"] + reacts * table["reacting_s"]
    assert table["value_s"][1:].to_numpy() == pytest.approx(mixed[1:].to_numpy())
    assert table["value_s"][0] == plan.value
    assert table.loc[table["chosen"] & (table["T"] == 1), "gait"].tolist() == [plan.gait]
    assert table.loc[table["chosen"] & (table["T"] == 2), "gaits"].tolist() == [", ".join(plan.gaits)]


def test_a_hunt_tells_where_the_hunter_was(khepera_model):
    episode = bh.hunt("paper", make_planner("intercept", khepera_model), arena="open", theta=1.0, seed=0)
    last = episode.situations[-1]
    assert len(last.approaches) == len(last.transitions) == len(episode.situations) - 1 > 3
    poses = [(case.pose, case.pose.compose(case.prey)) for case in episode.situations]
    for (own, prey), (_, later), moved, place in zip(poses, poses[1:], last.transitions, last.approaches, strict=False):
        assert place == pytest.approx(prey.relative(own))
        assert moved == pytest.approx(prey.relative(later))


@pytest.mark.slow
@pytest.mark.parametrize("arena", ["open", "walled"])
def test_it_catches_what_the_paper_lets_it_hunt(arena, khepera_model):
    """No worse than ``intercept`` by more than chance, against a prey that does not mind it."""
    found = {}
    for name in ("intercept", "intercept_evader"):
        planner = make_planner(name, khepera_model)
        times = [
            bh.hunt("paper", planner, arena=arena, theta=theta, seed=seed).time
            for theta, seed in itertools.product((-2.0, 0.0, 2.0), range(1000, 1010))
        ]
        found[name] = np.mean(times)
    assert found["intercept_evader"] <= found["intercept"] + 1.0
