"""Planners and their settings are checked before any work, in Python and on the command line alike."""

from __future__ import annotations

from typing import ClassVar

import pytest

import bayeshunt as bh
from bayeshunt.planners import registry
from bayeshunt.planners.api import Plan
from bayeshunt.planners.registry import make_planner

MEANT = "^unknown planner 'planing'; did you mean 'planning'"


@pytest.fixture(autouse=True)
def clean_registry(monkeypatch):
    monkeypatch.setattr(registry, "_REGISTRY", dict(registry._REGISTRY))


@pytest.fixture
def no_work(monkeypatch):
    """Babbling is work: whoever begins to fails."""

    def babbles(*_, **__):
        raise AssertionError("work began")

    for module in (
        "experiments.protocol.babble", "experiments.studies.references.babble", "experiments.preparation.explore"
    ):  # fmt: skip
        monkeypatch.setattr(f"bayeshunt.{module}", babbles)


ENTRIES = {
    "evaluate": lambda s: bh.evaluate(s, runs=1, arenas="open"),
    "sweep": lambda s: bh.sweep(s, {"prey.speed": [0.04]}, runs=1),
    "tradeoff": lambda s: bh.tradeoff(s, runs=1),
    "remember": lambda s: bh.remember(s, runs=1),
    "reference": lambda s: bh.reference(s),
    "learn_room": lambda s: bh.learn_room(s, arena="open"),
}


@pytest.mark.parametrize("entry", ENTRIES)
@pytest.mark.parametrize(
    ("key", "value", "says"),
    [
        ("planner.planing.depth", 2, MEANT),
        ("planner.planning.dept", 2, "planner 'planning' has no setting 'dept'; did you mean 'depth'"),
        ("planner.zzz.depth", 2, "^unknown planner 'zzz'; expected one of reactive"),
    ],
)
def test_a_misspelt_section_is_refused(entry, key, value, says, no_work):
    with pytest.raises(bh.InputError, match=says):
        ENTRIES[entry](bh.load_experiment("paper", {key: value}))


def test_a_hunt_refuses_a_misspelt_section(khepera_model):
    with pytest.raises(bh.InputError, match=MEANT):
        bh.hunt(bh.load_experiment("paper", {"planner.planing.depth": 2}), make_planner("reactive", khepera_model))


def test_a_sweep_refuses_a_misspelt_axis(no_work):
    with pytest.raises(bh.InputError, match=MEANT):
        bh.sweep("paper", {"planner.planing.depth": [1, 5]}, runs=1)


def test_a_section_of_a_registered_planner_is_known(khepera_model):
    class Mine:
        name = "mine"

        def __init__(self, model, *, gait="straight"):
            self.gait = gait

        def plan(self, situation, *, rng):
            return Plan(self.gait)

    settings = bh.load_experiment("paper", {"planner.mine.gait": "spin right"})
    with pytest.raises(bh.InputError, match="unknown planner 'mine'"):
        bh.evaluate(settings, runs=1, arenas="open", model=khepera_model)
    bh.register_planner("mine", Mine)
    results = bh.evaluate(settings, runs=1, planners="mine", arenas="open", model=khepera_model)
    assert (results["distance"] < 0.03 * results["time"]).all()  # it spins, it does not go straight


@pytest.mark.parametrize("entry", ["hunt", "remember"])
def test_a_bound_does_not_hunt(entry, khepera_model, no_work):
    calls = {
        "hunt": lambda: bh.hunt("paper", make_planner("kinematic_limit", khepera_model)),
        "remember": lambda: bh.remember("paper", planner="kinematic_limit", runs=1),
    }
    with pytest.raises(bh.InputError, match="kinematic_limit is a bound that no gaits reach"):
        calls[entry]()


def test_a_tradeoff_shows_a_bound_beside():
    settings = bh.load_experiment("paper", {"protocol.thetas": [0.0], "model.babbling_steps": 300})
    frame = bh.tradeoff(settings, {"transitions": [0.0]}, runs=1, planners=["kinematic_limit", "omniscient"])
    bound, told, _ = frame.to_dict("records")
    assert bound["success"] == 1.0
    assert bound["planning_ms"] == bound["mean_planning_s"] == 0.0
    assert 0 < bound["mean_time_s"] < told["mean_time_s"]


@pytest.mark.parametrize("name", ["reference", "memory", "memory_place", "memory_previous"])
@pytest.mark.parametrize("entry", ["evaluate", "sweep", "tradeoff", "remember"])
def test_a_planner_without_its_file_is_refused_first(entry, name, no_work):
    settings = bh.load_experiment("paper", {"planners": [name]})
    calls = {
        **ENTRIES,
        "tradeoff": lambda s: bh.tradeoff(s, runs=1, planners=[name]),
        "remember": lambda s: bh.remember(s, planner=name, runs=1),
    }
    with pytest.raises(bh.InputError, match=f'^{name}: needs the setting tables?; make it with "bayeshunt re'):
        calls[entry](settings)


@pytest.mark.parametrize("entry", [bh.evaluate, bh.sweep, bh.tradeoff])
def test_one_planner_and_one_arena_may_be_given_as_text(entry, no_work):
    with pytest.raises(bh.InputError, match=r"unknown planner 'reactiv'; did you mean 'reactive'\?"):
        entry("paper", planners="reactiv")
    with pytest.raises(bh.InputError, match=r"^planners: expected a name or a list of names, got 3$"):
        entry("paper", planners=3)
    arena = "arena" if entry is bh.tradeoff else "arenas"
    with pytest.raises(bh.InputError, match="unknown arena 'opn'"):
        entry("paper", planners="reactive", **{arena: "opn"})


class Faulty:
    """A planner with a fault."""

    name = "faulty"
    plans: ClassVar = {
        "text": lambda situation: "straight",
        "none": lambda situation: None,
        "raises": lambda situation: 1 / 0,
        "stranger": lambda situation: Plan("straigth"),
        "missing": lambda situation: situation.nonsense,
    }

    def __init__(self, model=None, *, fault="text"):
        self.fault = fault

    def plan(self, situation, *, rng):
        return self.plans[self.fault](situation)


@pytest.mark.parametrize(
    ("fault", "says"),
    [
        ("text", r"^planner 'faulty': plan\(\) returned 'straight', expected a Plan: return bayeshunt\.Plan\(gait\)$"),
        ("none", r"^planner 'faulty': plan\(\) returned None, expected a Plan"),
        ("raises", r"^planner 'faulty' failed to plan: ZeroDivisionError: .* \(test_planner_checks\.py, line \d+\)$"),
        ("stranger", "^planner 'faulty' chose the gait 'straigth', .*did you mean 'straight'"),
        ("missing", "^planner 'faulty' failed to plan: AttributeError: .*nonsense"),
    ],
)
@pytest.mark.parametrize("entry", ["hunt", "evaluate"])
def test_a_faulty_planner_is_named(entry, fault, says, khepera_model):
    bh.register_planner("faulty", Faulty)
    settings = bh.load_experiment("paper", {"planner.faulty.fault": fault})
    calls = {
        "hunt": lambda: bh.hunt("paper", Faulty(fault=fault)),
        "evaluate": lambda: bh.evaluate(settings, runs=1, planners="faulty", arenas="open", model=khepera_model),
    }
    with pytest.raises(bh.InputError, match=says):
        calls[entry]()


def test_what_is_no_planner_is_refused_before_the_hunt(khepera_model):
    class Nameless:
        def plan(self, situation, *, rng):
            raise AssertionError("the hunt began")

    for given, says in (
        ("planning", "planner: expected one made by make_planner.*got 'planning'"),
        (None, "planner: expected one made by make_planner.*got None"),
        (Faulty, "planner: expected one made by make_planner.*got the class Faulty"),
        (Nameless(), "planner of class Nameless has no name"),
    ):
        with pytest.raises(bh.InputError, match=says):
            bh.hunt("paper", given)


def test_a_factory_that_fails_is_named(khepera_model):
    bh.register_planner("broken", lambda model: model.nonsense)
    bh.register_planner("text", lambda model: "straight")
    with pytest.raises(bh.InputError, match=r"planner 'broken' cannot be made: AttributeError: .*nonsense"):
        make_planner("broken", khepera_model)
    with pytest.raises(bh.InputError, match="planner 'text': its factory does not return a planner"):
        make_planner("text", khepera_model)


def test_a_registered_planner_needs_no_name_to_be_evaluated(khepera_model):
    class Nameless:
        def __init__(self, model):
            pass

        def plan(self, situation, *, rng):
            return Plan("straight")

    bh.register_planner("nameless", Nameless)
    results = bh.evaluate("paper", runs=1, planners="nameless", arenas="open", model=khepera_model)
    assert set(results["planner"]) == {"nameless"}
