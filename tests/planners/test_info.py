"""What sets a planner apart is said once, where it is registered; a user's own marks go on counting."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.episodes.loop import run_hunt
from bayeshunt.planners import registry
from bayeshunt.planners.api import Plan, Shown
from bayeshunt.planners.asking import Timed
from bayeshunt.planners.bounds.omniscient import Omniscient
from bayeshunt.planners.catalogue import describe_planner
from bayeshunt.planners.info import PlannerInfo
from bayeshunt.planners.registry import explores, info_of, is_ab_initio, make_planner, planner_info, planner_names


@pytest.fixture(autouse=True)
def clean_registry(monkeypatch):
    monkeypatch.setattr(registry, "_REGISTRY", dict(registry._REGISTRY))
    monkeypatch.setattr(registry, "_MADE", dict(registry._MADE))


class Straight:
    """Goes straight on, whatever it sees."""

    name = "straight"

    def __init__(self, model):
        self.gaits = model.gaits.names
        self.futures = []

    def plan(self, situation, *, rng):
        self.futures.append(situation.future)
        return Plan("straight")


def test_what_ships():
    marked = {name for name in planner_names() if not planner_info(name).ab_initio}
    assert marked == {"omniscient", "kinematic_limit", "reference", "memory", "memory_place", "memory_previous"}
    needy = {name: planner_info(name).needs for name in planner_names() if not planner_info(name).standalone}
    assert needy == {
        "omniscient": ("future",), "kinematic_limit": ("future",), "reference": ("table",), "memory": ("tables",),
        "memory_place": ("tables",), "memory_previous": ("tables",), "intercept_walls": ("room",),
    }  # fmt: skip
    assert [name for name in planner_names() if planner_info(name).prepare] == ["intercept_walls", "search", "detour"]
    assert [name for name in planner_names() if not planner_info(name).hunts] == ["kinematic_limit"]
    assert [explores("intercept_walls", given) for given in ((), {"room"})] == [True, False]
    assert [is_ab_initio("intercept_walls", given) for given in ((), {"room"})] == [True, False]


def test_a_planner_says_it_where_it_is_registered(khepera_model):
    info = PlannerInfo(ab_initio=False, needs=("future",), foresight=lambda planner: 2.0 * len(planner.gaits))
    bh.register_planner("told", Straight, info=info)
    facts = describe_planner("told")
    assert (facts.ab_initio, facts.needs_future) == (False, True)
    assert "told" not in planner_names(standalone=True)
    planner = make_planner("told", khepera_model)
    assert info_of(planner) == info_of(Timed(planner)) == info
    run_hunt(bh.load_experiment("paper", {"protocol.time_limit": 4.0}), planner, "open", 0.0, 1)
    assert all(future.times[-1] == pytest.approx(20.0, abs=0.1) for future in planner.futures)


def test_an_info_says_more_than_marks(khepera_model):
    class Marked(Straight):
        ab_initio = False

    bh.register_planner("marked", Marked, info=PlannerInfo())
    assert is_ab_initio("marked")


@pytest.mark.parametrize("made", ["class", "factory", "annotated"])
def test_marks_of_a_users_own_class_count_wherever_they_stand(made, khepera_model):
    """On the class, on the function that makes it, or on the class that the function says it returns."""

    class Mine(Straight):
        ab_initio, standalone, needs_future, foresight = False, False, True, 5.0

    def bare(model):
        return Mine(model)

    def annotated(model) -> Mine:
        return Mine(model)

    annotated.__annotations__["return"] = Mine
    bare.ab_initio = bare.standalone = False
    bare.needs_future = True
    bh.register_planner("mine", {"class": Mine, "factory": bare, "annotated": annotated}[made])
    info = planner_info("mine")
    assert (info.ab_initio, info.standalone) == (False, False)
    assert describe_planner("mine").needs_future
    assert not is_ab_initio("mine")
    planner = make_planner("mine", khepera_model)
    run_hunt(bh.load_experiment("paper", {"protocol.time_limit": 4.0}), planner, "open", 0.0, 1)
    assert all(future is not None and future.times[-1] >= 5.0 - 1e-9 for future in planner.futures)


def test_marks_of_one_planner_that_is_not_registered(khepera_model):
    planner = Straight(khepera_model)
    planner.needs_future, planner.foresight = True, 3.0
    bh.hunt(bh.load_experiment("paper", {"protocol.time_limit": 4.0}), planner, arena="open")
    assert planner.futures[0] is not None
    blind = Straight(khepera_model)
    bh.hunt(bh.load_experiment("paper", {"protocol.time_limit": 4.0}), blind, arena="open")
    assert blind.futures[0] is None


def test_a_planner_that_explores(khepera_model):
    class Walls(Straight):
        standalone, explores = False, True

        def __init__(self, model, *, room):
            super().__init__(model)

    bh.register_planner("walls", Walls)
    assert explores("walls")
    assert not explores("walls", {"room"})
    assert not is_ab_initio("walls", {"room"})
    assert describe_planner("walls").settings[0].default == "babbled"


def test_a_class_made_from_one_that_ships_is_like_it(khepera_model):
    class Mine(Omniscient):
        name = "mine"

    class Blind(Omniscient):
        name = "blind"
        needs_future = False

    assert info_of(Mine(khepera_model)).seconds(Mine(khepera_model)) == pytest.approx(4 * 3.328)
    assert not info_of(Blind(khepera_model)).seconds(Blind(khepera_model))
    bh.register_planner("mine", Mine)
    bh.register_planner("blind", Blind)
    assert (describe_planner("mine").needs_future, describe_planner("blind").needs_future) == (True, False)


def test_a_planner_still_tells_its_marks(khepera_model):
    planner = make_planner("omniscient", khepera_model)
    assert (planner.ab_initio, planner.standalone, planner.needs_future) == (False, False, True)
    assert Shown.info == PlannerInfo()


def test_an_info_is_sent_to_workers():
    for name in planner_names():
        assert pickle.dumps(planner_info(name))
        assert copy.deepcopy(planner_info(name)) == planner_info(name)


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"ab_initio": 1}, "ab_initio: expected True or False, got 1"),
        ({"needs": "table"}, "needs: expected a list of names of settings, got 'table'"),
        ({"foresight": 3.0}, "foresight: expected a function"),
        ({"prepare": "rooms"}, "nothing called 'rooms' can be prepared; did you mean 'room'"),
    ],
)
def test_a_wrong_info_is_named(wrong, says):
    with pytest.raises(bh.InputError, match=says):
        PlannerInfo(**wrong)


def test_a_registration_needs_an_info():
    with pytest.raises(bh.InputError, match="planner 'mine': info: expected a PlannerInfo, got 3"):
        bh.register_planner("mine", Straight, info=3)


def test_a_planner_is_timed(khepera_model):
    timed = Timed(make_planner("reactive", khepera_model))
    episode = bh.hunt("paper", timed, arena="open", theta=0.0, seed=0)
    assert len(timed.seconds) == len(episode.frame)
    assert np.isfinite(timed.seconds).all()
