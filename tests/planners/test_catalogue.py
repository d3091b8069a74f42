"""What is said of planners is what their code does: every setting has a meaning, every range is kept."""

import re

import pytest

from bayeshunt.core.errors import InputError
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.planners import registry
from bayeshunt.planners.catalogue import describe_planner
from bayeshunt.planners.registry import make_planner, planner_names

SHIPPED = [name for name in planner_names() if registry.is_shipped(name)]
SETTINGS = [(name, setting) for name in SHIPPED for setting in describe_planner(name).settings]


@pytest.mark.parametrize("name", SHIPPED)
def test_every_planner_says_what_it_is_and_what_each_setting_means(name):
    facts = describe_planner(name)
    assert len(facts.summary) > 20
    assert "`" not in facts.summary + facts.details
    accepted = registry.find_planner(name)[1]
    assert [s.name for s in facts.settings] == list(accepted)
    for setting in facts.settings:
        assert len(setting.meaning) >= 1, f"{name}.{setting.name} has no meaning"
        if setting.kind.split(" or ")[0] in ("number", "whole number"):
            assert setting.range, f"{name}.{setting.name} has no range"


def test_the_facts_of_a_planner_that_needs_a_file():
    facts = describe_planner("memory_place")
    assert (facts.ab_initio, facts.needs) == (False, {"tables": "bayeshunt remember"})
    assert describe_planner("reference").needs == {"table": "bayeshunt reference"}
    walls = describe_planner("intercept_walls")  # babbles in the arena where it is given no file
    assert (walls.ab_initio, walls.needs, walls.settings[0][:4]) == (True, {}, ("room", "file", "", "babbled"))
    assert describe_planner("omniscient").needs_future
    assert not describe_planner("intercept").needs_future
    assert describe_planner("intercept").ab_initio
    assert "Zarchan" in describe_planner("proportional_navigation").reference
    assert describe_planner("planning").reference.startswith("Oses, Hoffmann and Koene")


def just_outside(text):
    """Values just outside a range as docstrings write it."""
    if bound := re.fullmatch(r"(>=?) (\S+)", text):
        return [float(bound[2]) - (1 if bound[1] == ">=" else 0)]
    if ends := re.fullmatch(r"in ([\[(])(\S+), (\S+)([\])])", text):
        return [float(ends[2]) - (ends[1] == "["), float(ends[3]) + (ends[4] == "]")]
    return []


NEEDED = {"intercept_walls": {"room": RoomModel.empty()}}


@pytest.mark.parametrize(
    ("name", "setting", "value"),
    [
        pytest.param(name, s, value, id=f"{name}-{s.name}-{value:g}")
        for name, s in SETTINGS
        if not describe_planner(name).needs
        for value in just_outside(s.range)
    ],
)
def test_what_is_outside_a_range_is_refused(khepera_model, name, setting, value):
    given = int(value) if setting.kind.startswith("whole") else value
    with pytest.raises(InputError, match=setting.name):
        make_planner(name, khepera_model, **{setting.name: given}, **NEEDED.get(name, {}))


def test_a_planner_of_ones_own(monkeypatch):
    monkeypatch.setattr(registry, "_REGISTRY", dict(registry._REGISTRY))

    class Mine:
        """Runs in circles (paper, appendix).

        It does so for ever.

        radius: of the circle [m], > 0. ``rng`` is not used.
        """

        name = "mine"

        def __init__(self, model, *, radius: float = 0.5, loud=False):
            self.radius = radius

    registry.register_planner("mine", Mine)
    registry.register_planner("bare", lambda model, **anything: Mine(model))
    facts = describe_planner("mine")
    assert (facts.summary, facts.details) == ("Runs in circles", "It does so for ever.")
    assert not facts.shipped
    radius, loud = facts.settings
    assert radius == ("radius", "number", "> 0", 0.5, "of the circle [m]")
    assert (loud.kind, loud.default, loud.meaning) == ("any", False, "")
    assert describe_planner("bare").settings == ()
    with pytest.raises(InputError, match="did you mean 'mine'"):
        describe_planner("mime")
