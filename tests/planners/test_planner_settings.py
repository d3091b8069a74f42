"""Settings of planners are typed: every wrong value is one line that names it, wherever it is given."""

from __future__ import annotations

import copy
import dataclasses
import math
import pickle

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.planners import registry
from bayeshunt.planners.api import Plan
from bayeshunt.planners.catalogue import describe_planner
from bayeshunt.planners.interception.intercept import InterceptSettings
from bayeshunt.planners.paper.planning import PlanningSettings
from bayeshunt.planners.registry import check_sections, find_planner, make_planner, planner_names
from bayeshunt.planners.settings import Count, Number, planner_settings, setting, settings_fields

KINDS = {name: find_planner(name).typed for name in planner_names() if find_planner(name).typed}
TYPED = [(name, field) for name, kind in KINDS.items() for field in settings_fields(kind)]


@pytest.mark.parametrize(("name", "field"), [pytest.param(n, f, id=f"{n}-{f.name}") for n, f in TYPED])
def test_a_value_of_another_kind_is_named(name, field, khepera_model):
    if describe_planner(name).needs or field.name == "room":
        return  # a file is checked when it is read
    for wrong in ([1], "far" if field.name not in ("order", "rollouts") else 3, math.nan, math.inf):
        with pytest.raises(bh.InputError, match=f"^{name}: {field.name} must be "):
            check_sections({name: {field.name: wrong}})


@pytest.mark.parametrize("name", KINDS)
def test_numbers_of_numpy_are_numbers_and_truths_are_none(name):
    kind = find_planner(name).typed
    for field in settings_fields(kind):
        if isinstance(field.default, (int, float)) and not isinstance(field.default, bool):
            made = kind(**{field.name: np.array([field.default])[0]})
            assert type(getattr(made, field.name)) is type(field.default)
            with pytest.raises(bh.InputError, match=f"{field.name} must be .*got True"):
                kind(**{field.name: True})


def test_settings_are_values():
    one, other = PlanningSettings(depth=3), PlanningSettings(depth=3)
    assert one == other
    assert dataclasses.replace(one, depth=4) == PlanningSettings(depth=4)
    assert pickle.dumps(one)
    assert copy.deepcopy(one) == one
    with pytest.raises(dataclasses.FrozenInstanceError):
        one.depth = 5
    assert PlanningSettings(3, None).expansions is None
    assert InterceptSettings().catch_distance is None


@pytest.mark.parametrize(
    ("section", "says"),
    [
        ({"planning": {"depth": 0}}, "^planning: depth must be a whole number >= 1, got 0$"),
        ({"planning": {"order": "depth-first"}}, "^planning: order must be one of best-first, breadth-first, got"),
        ({"belief": {"hazard": 2}}, r"^belief: hazard must be a number in \[0, 1\], got 2$"),
        ({"intercept_room": {"error": 0.5}}, r"^intercept_room: error must be a number in \(0, 0.5\), got 0.5$"),
        ({"intercept_room": {"nearest": 30.0}}, "^intercept_room: expected nearest < farthest, got 30 and 18$"),
        ({"frugal": {"time": 0.0}}, "^cost: time or distance must cost something"),
        ({"intercept": {"prior": "yes"}}, "^intercept: prior must be true or false, got 'yes'$"),
    ],
)
def test_a_wrong_section_is_refused_before_any_work(section, says):
    with pytest.raises(bh.InputError, match=says):
        check_sections(section)
    ((name, settings),) = section.items()
    key, value = next(iter(settings.items()))
    with pytest.raises(bh.InputError, match=says):
        bh.evaluate(bh.load_experiment("paper", {f"planner.{name}.{key}": value}), runs=1, planners="reactive")


def test_every_typed_setting_says_its_meaning_and_default():
    for name, field in TYPED:
        told = next(s for s in describe_planner(name).settings if s.name == field.name)
        assert told.meaning == field.meaning
        assert told.range == field.range
        kind = find_planner(name).typed
        if told.kind != "file":
            assert kind(**{field.name: field.default}) == kind()


def test_typed_settings_of_ones_own(monkeypatch, khepera_model):
    monkeypatch.setattr(registry, "_REGISTRY", dict(registry._REGISTRY))

    @planner_settings("circles")
    class Circles:
        """How it runs."""

        radius: Number = setting(0.5, "of the circle", unit="metres", gt=0)
        laps: Count = setting(2, "before it stops", ge=1, le=9)

    class Runner:
        """Runs in circles."""

        name = "circles"

        def __init__(self, model, **given):
            self.settings = Circles(**given)

        def plan(self, situation, *, rng):
            return Plan("spin left")

    bh.register_planner("circles", Runner, settings=Circles)
    assert [tuple(s) for s in describe_planner("circles").settings] == [
        ("radius", "number", "> 0", 0.5, "of the circle"),
        ("laps", "whole number", "in [1, 9]", 2, "before it stops"),
    ]
    assert make_planner("circles", khepera_model, laps=3).settings == Circles(laps=3)
    for given, says in (
        ({"laps": 10}, r"circles: laps must be a whole number in \[1, 9\], got 10"),
        ({"radius": -1.0}, "circles: radius must be metres > 0, got -1.0"),
        ({"radios": 1.0}, "planner 'circles' has no setting 'radios'; did you mean 'radius'"),
    ):
        with pytest.raises(bh.InputError, match=says):
            make_planner("circles", khepera_model, **given)
        with pytest.raises(bh.InputError, match=says):
            check_sections({"circles": given})
