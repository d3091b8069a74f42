"""What a hunt costs: one cost for every planner that searches, worth nothing unless it is asked for."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from planner_cases import BODY, STEP, WHEELS, babble, situations

import bayeshunt as bh
from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import Polar, Pose
from bayeshunt.experiments.preparation import check_planners, own_settings, prepare_planner
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.planners.cost import LEAST_GAIN, Charges, Cost
from bayeshunt.planners.interception.bouncing import Walls
from bayeshunt.planners.interception.charging import near_walls
from bayeshunt.planners.search.rollouts import GaitTree

SEARCHING = ["planning", "intercept", "belief", "search"]
DEAR = {"slow": 5.0, "slow right": 5.0, "slow left": 5.0, "hard right": 5.0, "hard left": 5.0}


@pytest.fixture(scope="module")
def measured():
    """All ten gaits; slow ones and hard turns cost 5 J, the others 1 J."""
    names = list(WHEELS)
    frame = babble(names, 1500, seed=5)
    frame["energy"] = frame["gait"].map(DEAR).fillna(1.0)
    gaits = bh.GaitRepertoire(tuple(bh.Gait(n, WHEELS[n]) for n in names), body_length=BODY, duration=STEP)
    return bh.ForwardModel.fit(frame, gaits)


def decide(planner, case):
    return planner.plan(case, rng=np.random.default_rng(0))


@pytest.mark.parametrize("name", SEARCHING)
def test_dear_changes_are_avoided(name, model):
    room = {"room": RoomModel.empty()} if name == "search" else {}
    cases = [replace(case, previous_gait="slow", pose=Pose(0.0, 0.0, 0.0)) for case in situations(8)]
    cheap, dear = (bh.make_planner(name, model, **room, **given) for given in ({}, {"cost": {"transitions": 1e3}}))
    changed = [sum(a != b for a, b in pairwise(["slow", *decide(cheap, case).gaits])) for case in cases]
    assert sum(changed) > 4
    assert all(set(decide(dear, case).gaits) == {"slow"} for case in cases)


@pytest.mark.parametrize("name", ["planning", "intercept"])
def test_dear_gaits_are_avoided(name, measured):
    cases = situations(12)
    cheap, dear = (bh.make_planner(name, measured, **given) for given in ({}, {"cost": Cost(energy=1e3)}))
    used = [{gait for case in cases for gait in decide(planner, case).gaits} for planner in (cheap, dear)]
    assert used[0] & set(DEAR)
    assert not used[1] & set(DEAR)


def test_planning_that_costs_more_than_there_is_to_gain_stops_at_once(model):
    for case in situations(4):
        far, near = (decide(bh.make_planner("planning", model, **given), case)
                     for given in ({}, {"cost": {"planning": 1e9}}))  # fmt: skip
        assert near.nodes == 1 + len(model.gaits) < far.nodes


def test_what_is_charged_by_hand(measured):
    charges = Charges(measured, Cost(time=2.0, transitions=3.0, energy=0.5))
    fast, slow = measured.gaits.index("straight"), measured.gaits.index("slow")
    assert charges.speed == pytest.approx(0.0576, rel=0.02)
    assert charges.per_second == pytest.approx(2.0 + 0.5 * 1.0 / STEP)
    assert charges.beyond_fastest[fast, fast] == pytest.approx(0.0)
    assert charges.beyond_fastest[fast, slow] == pytest.approx(3.0 + 0.5 * (5.0 - 1.0))
    assert charges.beyond_fastest[-1, slow] == pytest.approx(0.5 * (5.0 - 1.0))  # what went before is not known
    steps = np.arange(4.0)
    for share in (0.0, 0.5, 1.5):  # of the hunter's speed: standing, slower, faster
        gone = 1.0 + share * charges.speed * STEP * steps
        gained = charges.speed * max(1.0 - share, LEAST_GAIN)
        path = Polar(gone, 0.0 * steps, 0.0 * steps)
        assert charges.metres_of(path) == pytest.approx(gained / charges.per_second)


def test_costs_add_up_along_sequences():
    tree = GaitTree.grow(3, 3, 1)
    table = np.random.default_rng(0).random((4, 3))
    for before in (-1, 2):
        total = tree.along(table, before)
        for node in range(1, len(tree.steps), 7):
            gaits, at = [], node
            while at:
                gaits.append(int(tree.gaits[at]))
                at = int(tree.parents[at])
            whole = [before, *reversed(gaits)]
            assert total[node] == pytest.approx(sum(table[a, b] for a, b in pairwise(whole)))


@pytest.mark.parametrize("changes", [0, 2])
def test_lazy_and_compiled_plans_weigh_alike(changes, measured):
    how = {"depth": 4, "max_transitions": changes, "cost": {"energy": 0.2, "transitions": 1.0}}
    lazy, compiled = (bh.make_planner("planning", measured, rollouts=r, **how) for r in ("lazy", "compiled"))
    for case in situations(6):
        one, other = (decide(planner, replace(case, previous_gait="left")) for planner in (lazy, compiled))
        assert one.gaits == other.gaits
        assert one.value == pytest.approx(other.value, rel=1e-9)


def test_time_alone_is_what_it_was(model):
    for name in ("planning", "intercept"):
        plain, said = bh.make_planner(name, model), bh.make_planner(name, model, cost=Cost())
        for case in situations(3):
            assert decide(plain, case).value == decide(said, case).value


def test_a_wall_is_near_within_a_body(model):
    planner = bh.make_planner("intercept", model)
    ahead = Walls(((1.0, 0.0),), (0.1,), 0.0)
    first, second = near_walls(ahead, Pose(0.0, 0.0, 0.0), planner.pairs, BODY)
    straight = model.gaits.index("straight")
    reached = planner.pairs.first[0, straight, :, 0]
    assert (first[straight] == (0.1 - reached < BODY)).all()
    assert first[straight].any()
    assert not near_walls(ahead, Pose(0.0, 0.0, np.pi), planner.pairs, BODY)[0][straight].any()
    assert second.shape == (len(model.gaits), *first.shape)


def test_clearance_keeps_away_from_a_wall(model):
    """A wall beside the straight way to a prey that stands still: the second near it costs more than the way round."""
    room = RoomModel(np.array([[0.0, 1.0]]), np.array([0.04]), np.array([2.0]), np.array([9]))
    case = replace(situations(1)[0], prey=Polar(0.5, 0.0, 0.0), pose=Pose(0.0, 0.0, 0.0), transitions=())
    near, far = (bh.make_planner("intercept_walls", model, room=room, cost={"clearance": c}) for c in (0.0, 50.0))
    assert decide(near, case).gait == "straight"
    assert "right" in decide(far, case).gait  # the wall is on the left


def test_the_experiments_cost_is_every_planners():
    own = {"planner.planning.cost.energy": 0.5, "planner.frugal.transitions": 7.0}
    settings = bh.load_experiment("legs", {"cost.energy": 0.2, "cost.time": 2.0, **own})
    assert own_settings(settings, "intercept")["cost"] == Cost(time=2.0, energy=0.2)
    assert own_settings(settings, "planning")["cost"] == Cost(time=2.0, energy=0.5)
    frugal = own_settings(settings, "frugal")
    assert (frugal["time"], frugal["energy"], frugal["transitions"]) == (2.0, 0.3, 7.0)  # energy: the preset's own
    assert "cost" not in own_settings(settings, "reactive")
    slow = bh.load_experiment(settings, {"protocol.thinking": "nodes", "protocol.seconds_per_node": 0.02})
    assert own_settings(slow, "intercept")["cost"].seconds_per_node == 0.02


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"cost.enrgy": 1.0}, "cost: has no setting 'enrgy'; did you mean 'energy'"),
        ({"cost.energy": -1.0}, "energy must be"),
        ({"cost.time": 0.0}, "standing still"),
        ({"planner.planning.cost.energy": "dear"}, "energy must be"),
    ],
)
def test_wrong_weights(given, said):
    with pytest.raises(InputError, match=said):
        check_planners(bh.load_experiment("legs", given), ["planning"])


def test_energy_needs_rows_that_say_it(model):
    settings = bh.load_experiment("paper", {"cost.energy": 1.0})
    with pytest.raises(InputError, match="do not say what gaits cost"):
        prepare_planner("planning", model, settings, {}, "open")
