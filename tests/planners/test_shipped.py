"""Every planner that ships keeps the rules, is sent to workers as it is, and is made from what its settings say."""

from __future__ import annotations

import copy
import importlib
import pickle
import pkgutil
from dataclasses import replace

import numpy as np
import pytest
from planner_cases import STEP, situations

import bayeshunt as bh
from bayeshunt import planners
from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.geometry import Polar, Pose
from bayeshunt.core.task import Task
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.models.target.memory import PreyMemory
from bayeshunt.planners.api import Future
from bayeshunt.planners.bounds.reference import ReferenceTable
from bayeshunt.planners.bounds.relative import Chase, Grid
from bayeshunt.planners.conformance import same_plan
from bayeshunt.planners.registry import is_shipped, make_planner, planner_info, planner_names

SHIPPED = [name for name in planner_names() if is_shipped(name)]
HUNTERS = [name for name in SHIPPED if planner_info(name).hunts]


def needed(name, model):
    """The settings that a planner cannot do without."""
    if name == "reference":
        ends = np.array([[float(p.forward), float(p.right), float(p.heading)] for p in map(model.predict, model.gaits)])
        grid = Grid(np.array([0.05, 0.3, 1.0]), 8, 8)
        prey = np.array([[[0.16, 0.0, 0.0]]])
        chase = Chase(ends[:, None, None], prey, duration=STEP, reach=1.02 * 0.057, closing=0.01)
        values = np.broadcast_to((grid.distances / 0.0576)[:, None, None], grid.shape).astype(np.float32)
        return {"table": ReferenceTable(values, grid, chase, model.gaits.names)}
    if name.startswith("memory"):
        memory = PreyMemory.empty(["pen"], EffectAxes.standard(0.057), 0.2, {})
        memory.observe_track("pen", [Pose(0.1 * i, 0.0, 0.0) for i in range(4)], [Polar(0.1, 0.0, 0.0)] * 4)
        return {"tables": memory}
    return {"room": RoomModel.empty()} if name == "intercept_walls" else {}


@pytest.fixture(scope="module")
def cases():
    seen = (Polar(0.15, 0.05, 0.1), Polar(0.16, -0.05, 0.0))
    times = np.linspace(0.0, 8 * STEP, 60)
    found = []
    for number, case in enumerate(situations(3)):
        gone = 0.048 * times
        ahead = case.prey.forward + gone * np.cos(case.prey.heading)
        across = case.prey.right + gone * np.sin(case.prey.heading)
        future = Future(times, Polar.from_cartesian(ahead, across, np.full(60, float(case.prey.heading))))
        transitions = seen[:number]
        found.append(
            replace(case, pose=Pose(0.0, 0.1, 0.3), future=future, transitions=transitions, task=Task(0.05814, 60.0))
        )
    return found


@pytest.mark.parametrize("name", HUNTERS)
def test_every_planner_that_ships_keeps_the_rules(name, model, cases):
    bh.check_planner(make_planner(name, model, **needed(name, model)), model.gaits.names, cases, seed=1)


@pytest.mark.parametrize("name", SHIPPED)
def test_a_planner_survives_pickling(name, model, cases):
    planner = make_planner(name, model, **needed(name, model))
    assert pickle.dumps(planner)
    again = copy.deepcopy(planner)  # by what is pickled
    assert repr(again) == repr(planner)
    if name in HUNTERS:
        one, other = (p.plan(cases[-1], rng=np.random.default_rng(3)) for p in (planner, again))
        assert same_plan(one, other)


def test_a_reference_for_another_catch_is_refused(model, cases):
    planner = make_planner("reference", model, **needed("reference", model))
    with pytest.raises(bh.InputError, match=r"table is for a catch at 0\.05814 m, this hunt's is at 0\.1 m"):
        planner.plan(replace(cases[0], task=Task(0.1)), rng=np.random.default_rng(0))


def test_every_module_says_what_it_is_and_what_it_offers():
    for found in pkgutil.walk_packages(planners.__path__, "bayeshunt.planners."):
        module = importlib.import_module(found.name)
        assert module.__doc__, found.name
        if not found.ispkg:
            assert all(hasattr(module, name) for name in module.__all__), found.name
