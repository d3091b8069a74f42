"""Every planner by name, and the rules that all of them keep."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from planner_cases import situations

from bayeshunt.core.errors import BayesHuntError, InputError
from bayeshunt.core.geometry import Polar
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.planners import registry
from bayeshunt.planners.api import Plan, Planner, Situation
from bayeshunt.planners.conformance import check_planner, same_plan
from bayeshunt.planners.registry import check_hunts, make_planner, planner_names, register_planner


@pytest.fixture
def clean_registry(monkeypatch):
    monkeypatch.setattr(registry, "_REGISTRY", dict(registry._REGISTRY))


@pytest.mark.parametrize("name", planner_names(standalone=True))
def test_every_planner_conforms(name, model):
    planner = make_planner(name, model)
    assert isinstance(planner, Planner)
    assert planner.name == name
    cases = [*situations(4), *situations(2, seed=5, known=False)]
    check_planner(planner, model.gaits.names, cases, seed=1)


class Wrapped:
    """A planner with a fault put into it."""

    name = "wrapped"

    def __init__(self, model, fault):
        self.inner, self.fault, self.calls = make_planner("planning", model), fault, 0

    def plan(self, situation, *, rng):
        self.calls += 1
        found = self.inner.plan(situation, rng=rng)
        if self.fault == "memory":
            return replace(found, value=found.value + self.calls)
        if self.fault == "stranger":
            return replace(found, gait="fly", gaits=("fly",))
        if self.fault == "observes":
            situation.prey_model.observe(Polar(0.1, 0.0, 0.0))
        if self.fault == "rows":
            return replace(found, nodes=found.nodes + 1)
        if self.fault == "global":
            np.random.random()  # noqa: NPY002
        if self.fault == "nan":
            return replace(found, value=float("nan"))
        return found


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        ("memory", "not reproducible"),
        ("stranger", "outside the repertoire"),
        ("observes", "changed the situation"),
        ("rows", "trace has"),
        ("global", "global generator"),
        ("nan", "gives the value nan"),
    ],
)
def test_the_conformance_check_finds_faults(fault, message, model):
    with pytest.raises(BayesHuntError, match=f"'wrapped'.*{message}"):
        check_planner(Wrapped(model, fault), model.gaits.names, situations(2), seed=1)


def test_the_conformance_check_demands_rng(model):
    class Careless(Wrapped):
        def plan(self, situation, *, rng=None):
            return super().plan(situation, rng=rng or np.random.default_rng(0))

    check_planner(Wrapped(model, None), model.gaits.names, situations(2), seed=1)
    with pytest.raises(BayesHuntError, match="rng"):
        check_planner(Careless(model, None), model.gaits.names, situations(2), seed=1)


@pytest.mark.parametrize("name", planner_names(standalone=True))
def test_bad_requests_are_refused(name, model):
    planner = make_planner(name, model)
    with pytest.raises(InputError, match="Generator"):
        planner.plan(situations(1)[0], rng=7)
    with pytest.raises(InputError, match="Situation"):
        planner.plan(Polar(1.0, 0.0, 0.0), rng=np.random.default_rng(0))


@pytest.mark.parametrize("prey", [Polar(-0.1, 0.0, 0.0), Polar(0.1, float("nan"), 0.0), Polar(float("inf"), 0.0, 0.0)])
def test_an_impossible_prey_pose_is_refused(prey):
    with pytest.raises(InputError, match="prey pose"):
        Situation(prey, PreyModel())


@pytest.mark.parametrize("length", [0.0, -1.0, float("nan"), float("inf")])
def test_an_impossible_body_length_is_refused(length):
    with pytest.raises(InputError, match="body_length"):
        Situation(Polar(0.1, 0.0, 0.0), PreyModel(), body_length=length)


def test_unknown_planner(model):
    with pytest.raises(InputError, match="unknown planner 'planing'; did you mean 'planning'"):
        make_planner("planing", model)


@pytest.mark.parametrize(
    ("name", "setting", "hint"),
    [
        ("planning", "dept", "did you mean 'depth'"),
        ("planning", "zzz", "it has depth, expansions"),
        ("reactive", "depth", "it has none"),
    ],
)
def test_unknown_setting(name, setting, hint, model):
    with pytest.raises(InputError, match=f"planner '{name}' has no setting '{setting}'; {hint}"):
        make_planner(name, model, **{setting: 1})


def test_a_users_planner(clean_registry, model):
    class Always:
        name = "always"

        def __init__(self, model, *, gait="straight"):
            self.gait = gait

        def plan(self, situation, *, rng) -> Plan:
            return Plan(self.gait, (self.gait,), 0.0, "nothing", 0, lambda: None)

    register_planner("always", Always)
    assert planner_names()[-1] == "always"
    assert make_planner("always", model, gait="left").plan(None, rng=None).gait == "left"
    with pytest.raises(InputError, match="no setting 'gaits'; did you mean 'gait'"):
        make_planner("always", model, gaits="left")
    with pytest.raises(InputError, match="registered already"):
        register_planner("always", Always)
    with pytest.raises(InputError, match="needs a name"):
        register_planner(" ", Always)
    with pytest.raises(InputError, match="expected a function"):
        register_planner("other", 3)


PROBE = """
import json, sys
sys.path.insert(0, sys.argv[1])
import numpy as np
from planner_cases import WHEELS, fit, situations
from bayeshunt.planners.registry import make_planner, planner_names
model = fit(list(WHEELS), 400)
out = []
for name in planner_names(standalone=True):
    planner = make_planner(name, model)
    for i, s in enumerate(situations(5)):
        plan = planner.plan(s, rng=np.random.default_rng(i))
        out.append([name, plan.gaits, plan.value.hex(), plan.trace.to_csv()])
print(json.dumps(out))
"""


@pytest.mark.slow
def test_plans_do_not_depend_on_the_hash_seed():
    folder = Path(__file__).resolve().parent
    outputs = []
    for seed in ("0", "4242"):
        environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": str(folder.parents[1])}
        run = subprocess.run(
            [sys.executable, "-c", PROBE, str(folder)],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
        outputs.append(run.stdout.strip().splitlines()[-1])
    assert len(json.loads(outputs[0])) == 5 * len(planner_names(standalone=True))
    assert outputs[0] == outputs[1]


def test_a_plan_needs_no_more_than_its_gait(model, worker):
    class Rule:
        name = "rule"

        def plan(self, situation, *, rng):
            return Plan("straight")

    check_planner(Rule(), model.gaits.names, situations(2), seed=1)
    plan = Plan("straight")
    assert (plan.gaits, plan.nodes, plan.objective) == (("straight",), 1, "no value, a rule decides")
    assert plan.trace.to_dict("records") == [{"gait": "straight", "value": 0.0}]
    assert same_plan(worker(plan), plan)
    assert "no value, a rule decides" in str(plan)
    assert "straight" in plan._repr_html_()
    assert Plan("straight", ("straight", "left"), 0.2).gaits == ("straight", "left")


def test_a_deprecated_name_goes_on_working_and_says_what_to_write(model):
    with pytest.warns(DeprecationWarning, match="planner 'intercept_room' is deprecated: write \"intercept\".* in 0.3"):
        planner = make_planner("intercept_room", model, room_chance=0.2)
    assert planner.settings.room_chance == 0.2
    with pytest.warns(DeprecationWarning, match="intercept_room"):
        check_hunts("intercept_room")


def test_no_other_name_that_ships_is_deprecated(recwarn):
    for name in planner_names():
        if name not in ("intercept_room", "kinematic_limit"):
            check_hunts(name)
    assert not [one for one in recwarn if issubclass(one.category, DeprecationWarning)]
