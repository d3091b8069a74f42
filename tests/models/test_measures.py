"""A model knows its robot's body and duration, or says that it does not; another robot's model is refused."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.config.loading import preset_names
from bayeshunt.config.plausibility import warn_of_other_motion
from bayeshunt.core.gaits import Gait, GaitRepertoire

NAMES = ("left", "right")
ROWS = pd.DataFrame({"gait": ["left", "right"] * 3, "distance": 0.3, "angle": 0.1, "heading": 0.0})
AXES = bh.EffectAxes.standard(0.35)


def test_names_alone_know_neither_body_nor_duration() -> None:
    gaits = GaitRepertoire.of(NAMES)
    assert (gaits.body_length, gaits.duration) == (None, None)
    assert repr(gaits) == "<GaitRepertoire: 2 gaits>"
    for measure in ("body_length", "duration"):
        with pytest.raises(bh.InputError, match=r"give GaitRepertoire\(gaits, body_length=metres, duration=seconds\)"):
            gaits.need(measure)
    with pytest.raises(bh.InputError, match=r"give axes= or GaitRepertoire\(gaits, body_length=, duration=\)$"):
        bh.ForwardModel.fit(ROWS, NAMES)
    with pytest.raises(bh.InputError, match=r"^the bins need a body length"):
        bh.ForwardModel.empty(NAMES)


def test_bins_say_what_body_they_were_made_for(tmp_path) -> None:
    model = bh.ForwardModel.fit(ROWS, NAMES, axes=AXES)
    assert (model.gaits.body_length, model.gaits.duration) == (0.35, None)
    assert bh.ForwardModel.empty(NAMES, axes=AXES).update(ROWS) == model
    custom = bh.EffectAxes(AXES.distance, AXES.angle, AXES.heading)
    assert custom == AXES
    unknown = bh.ForwardModel.fit(ROWS, NAMES, axes=custom)
    assert unknown.gaits.body_length is None
    for one in (model, unknown):
        one.save(tmp_path / "model.json")
        back = bh.ForwardModel.load(tmp_path / "model.json")
        assert back == one
        assert (back.gaits.body_length, back.gaits.duration) == (one.gaits.body_length, None)
        assert str(one)
        assert one._repr_html_()


def test_what_is_given_stands() -> None:
    given = GaitRepertoire.of(NAMES, body_length=0.2, duration=1.5)
    model = bh.ForwardModel.fit(ROWS, given, axes=AXES)
    assert model.gaits == given


def test_a_table_says_which_robot_made_it() -> None:
    frame = bh.babble("car", 60, 0)
    names = sorted(set(frame["gait"]))
    model = bh.ForwardModel.fit(frame, names)
    car = bh.load_robot("car")
    assert (model.gaits.body_length, model.gaits.duration) == (car.body.diameter, car.gait_duration)
    frame.attrs = {}
    with pytest.raises(bh.InputError, match="the bins need a body length"):
        bh.ForwardModel.fit(frame, names)


@pytest.mark.parametrize("planner", ["planning", "intercept", "frugal", "prediction"])
def test_who_needs_a_measure_says_so(planner: str) -> None:
    model = bh.ForwardModel.fit(ROWS, NAMES, axes=bh.EffectAxes(AXES.distance, AXES.angle, AXES.heading))
    situation = bh.Situation(prey=bh.Polar(0.3, 0.2, 0.1), prey_model=bh.PreyModel())
    with pytest.raises(bh.InputError, match=r"(gaits do not say|planner's model says) .*: give GaitRepertoire"):
        bh.make_planner(planner, model).plan(situation, rng=np.random.default_rng(0))


# --- another robot ---------------------------------------------------------------------------------


def test_differences_name_the_quantity_and_both_values() -> None:
    mine = GaitRepertoire((Gait("a", (0.1, 0.1)), Gait("b", (0.1, 0.0))), 0.057, 3.328)
    for other, says in (
        (replace(mine, duration=1.0), "X holds a gait for 3.328 s, Y for 1 s"),
        (replace(mine, body_length=0.35), "X has a body of 0.057 m, Y of 0.35 m"),
        (replace(mine, gaits=(mine[0], Gait("b", (0.2, 0.0)))), "X commands gait 'b' as 0.1, 0, Y as 0.2, 0"),
        (replace(mine, gaits=(mine[0], Gait("b", (0.1,)))), "X commands gait 'b' as 0.1, 0, Y as 0.1"),
        (replace(mine, gaits=mine.gaits[:1]), "X has the gaits a, b; Y has a"),
        (replace(mine, gaits=mine.gaits[::-1]), "X has the gaits a, b; Y has b, a"),
    ):
        assert mine.difference(other, "X", "Y") == says
    assert mine.difference(replace(mine, duration=3.328 * (1 + 1e-9)), "X", "Y") is None
    for unknown in (GaitRepertoire.of(["a", "b"]), replace(mine, duration=None, body_length=None)):
        assert mine.difference(unknown, "X", "Y") is None
        assert unknown.difference(mine, "X", "Y") is None


def others() -> dict[str, tuple[bh.RobotSettings, str]]:
    """Robots with the Khepera's gait names, and how each differs from it."""
    khepera = bh.load_robot("khepera")
    facts = khepera.model_dump()
    faster = [{**gait, "left": 0.5 * gait["left"]} for gait in facts["gait"]]
    return {
        "duration": (khepera.model_copy(update={"gait_duration": 1.0}), "holds a gait for 1 s, khepera for 3.328 s"),
        "commands": (bh.RobotSettings.model_validate({**facts, "gait": faster}), "commands gait 'straight' as "),
        "body": (
            bh.RobotSettings.model_validate({**facts, "body": {**facts["body"], "diameter": 0.08}}),
            "has a body of 0.08 m, khepera of 0.057 m",
        ),
    }


@pytest.mark.parametrize("kind", ["duration", "commands", "body"])
def test_a_model_of_another_robot_is_refused_before_any_step(kind: str, tmp_path, bayeshunt) -> None:
    robot, says = others()[kind]
    model = bh.ForwardModel.fit(bh.babble(robot, 200, 0), robot.gaits, 0.03)
    with pytest.raises(bh.InputError, match=f"^the model's robot {says}.*; fit a model of this robot$"):
        bh.evaluate("paper", model=model, planners="reactive", runs=1)
    with pytest.raises(bh.InputError, match=f"^the planner's robot {says}"):
        bh.hunt("paper", bh.make_planner("planning", model), arena="open")
    episode = bh.hunt("paper", _Straight(), arena="open")
    with pytest.raises(bh.InputError, match=f"^the model's robot {says}"):
        bh.write_replay(episode, tmp_path / "page.html", model=model)
    model.save(tmp_path / "model.json")
    episode.save(tmp_path / "hunt.parquet")
    for command in (
        ("evaluate", "--preset", "paper", "--runs", "1", "--planner", "reactive", "--model", "model.json"),
        ("hunt", "--preset", "paper", "--planner", "reactive", "--model", "model.json"),
        ("replay", "hunt.parquet", "--model", "model.json", "--out", "page.html"),
    ):
        out, err = bayeshunt(*command, status=2)
        assert f"the model's robot {says}" in " ".join(err.split()), command
        assert not out
    assert not (tmp_path / "page.html").exists()


@pytest.mark.parametrize("kind", ["duration", "commands", "body"])
def test_a_table_of_another_robot_is_refused(kind: str, tmp_path, bayeshunt) -> None:
    robot, says = others()[kind]
    khepera, frame = bh.load_robot("khepera"), bh.babble(robot, 120, 0)
    own = bh.ForwardModel.fit(bh.babble(khepera, 120, 0), khepera.gaits, 0.03)
    says = f"^the table's robot {says.replace('khepera', 'X')}.*; give a table of this robot, or the gaits of "
    for work, whose in (
        (lambda: bh.ForwardModel.fit(frame, khepera.gaits, 0.03), "the gaits given"),
        (lambda: bh.Learning(frame, khepera.gaits), "the gaits given"),
        (lambda: bh.assess(frame, khepera.gaits), "the gaits given"),
        (lambda: bh.assess(frame, model=own), "the model's robot"),
        (lambda: own.update(frame), "the model's robot"),
    ):
        with pytest.raises(bh.InputError, match=says.replace("X", whose)):
            work()
    bh.save_dataset(frame, tmp_path / "table.parquet")
    for command in (("fit", "table.parquet", "--out", "model.json"), ("assess", "table.parquet")):
        out, err = bayeshunt(*command, "--robot", "khepera", status=2)
        assert "the table's robot" in err, command
        assert not out
    assert not (tmp_path / "model.json").exists()
    some = robot.gaits.names[2:0:-1]  # its own gaits, by name, in any choice and order
    assert bh.ForwardModel.fit(frame[frame["gait"].isin(some)], some, 0.03).gaits.duration == robot.gait_duration


@pytest.mark.parametrize("planner", ["pure_pursuit", "proportional_navigation", "frugal", "intercept", "reactive"])
def test_every_planner_with_a_model_is_held_to_its_robot(planner: str) -> None:
    model = bh.ForwardModel.fit(bh.babble("car", 300, 0), bh.load_robot("car").gaits, 0.03)
    with pytest.raises(bh.InputError, match=r"^the planner's robot has the gaits .*; khepera has "):
        bh.hunt("paper", bh.make_planner(planner, model), arena="open")


class _Straight:
    """A rule without a model: nobody can say that its robot is another."""

    name = "straight"

    def plan(self, situation: bh.Situation, *, rng: object) -> bh.Plan:
        return bh.Plan("straight")


# --- the same gaits, moved otherwise ---------------------------------------------------------------

MOVED = "noise.slip 0.1, not 0.3 in khepera: it will move otherwise than the model says"


def test_a_robot_that_moves_otherwise_is_warned_of_wherever_its_model_is_used(khepera_model, tmp_path, bayeshunt):
    """A model may be tried on another floor, so it is no error."""
    slippery = bh.load_experiment("paper", {"robot.noise.slip": 0.3})
    planner = bh.make_planner("reactive", khepera_model)
    says = f"^the model's robot has {MOVED}; fit a model of this robot, unless "
    with pytest.warns(bh.DataWarning, match=says):
        episode = bh.hunt(slippery, planner, arena="open")
    with pytest.warns(bh.DataWarning, match=says):
        bh.write_replay(episode, tmp_path / "page.html", model=khepera_model)
    with pytest.warns(bh.DataWarning, match=says):
        assert len(bh.evaluate(slippery, model=khepera_model, planners="reactive", arenas="open", runs=1)) == 7
    khepera_model.save(tmp_path / "model.json")
    command = "hunt --preset paper --planner reactive --model model.json --replay page.html --set robot.noise.slip=0.3"
    _, err = bayeshunt(*command.split())
    assert " ".join(err.split()).count(MOVED) == 1


def test_rows_of_a_robot_that_moves_otherwise_are_warned_of_wherever_they_meet_a_model(
    khepera_model, tmp_path, bayeshunt
):
    slippery = bh.load_experiment("paper", {"robot.noise.slip": 0.3}).robot
    rows = bh.babble(slippery, 40, seed=0)
    other = bh.ForwardModel.fit(rows, slippery.gaits, prior=0.03)
    own = bh.babble(bh.load_robot("khepera"), 1, seed=0)
    says = r"robot has noise\.slip 0\.3, not 0\.1 in the model's: they move otherwise; use those of one robot, unless "
    for what, call in (
        ("table", lambda: khepera_model.update(rows)),
        ("table", lambda: bh.assess(rows, model=khepera_model, structures=["naive"], folds=2, permutations=9)),
        ("planner", lambda: bh.Hunter(bh.make_planner("reactive", other), model=khepera_model)),
    ):
        with pytest.warns(bh.DataWarning, match=f"^the {what}'s {says}"):
            call()
    bh.save_dataset(rows, tmp_path / "table.parquet")
    for command in (("fit", "table.parquet", "--out", "model.json", "--prior", "0.1"), ("assess", "table.parquet")):
        _, err = bayeshunt(*command, "--robot", "khepera")
        assert "the table's robot has noise.slip 0.3, not 0.1 in khepera" in " ".join(err.split()), command
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        khepera_model.update(own)
        bh.Hunter(bh.make_planner("reactive", khepera_model), model=khepera_model)


def test_a_room_is_not_learned_with_a_model_of_another_robot() -> None:
    car = bh.ForwardModel.fit(bh.babble("car", 60, 0), bh.load_robot("car").gaits, 0.03)
    for work in (lambda: bh.learn_room("paper", model=car, steps=1), lambda: bh.remember("paper", model=car)):
        with pytest.raises(bh.InputError, match=r"^the model's gaits .* are not those of robot 'khepera'"):
            work()


def test_every_difference_is_named_and_what_is_not_known_is_none(khepera_model) -> None:
    changes = {"robot.body.axle": 0.06, "robot.body.max_traction": 1.0}
    with pytest.warns(
        bh.DataWarning, match=r"has body\.axle 0\.052, not 0\.06, body\.max_traction 3, not 1 in khepera:"
    ):
        bh.hunt(bh.load_experiment("paper", changes), bh.make_planner("reactive", khepera_model), arena="open")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        bh.hunt("paper", bh.make_planner("reactive", khepera_model), arena="open")
        for provenance in ({}, {"sources": [{}, {"robot": {"name": "x", "body": None}}, None]}):
            silent = bh.ForwardModel(khepera_model.joint, provenance=provenance)
            bh.hunt(bh.load_experiment("paper", changes), bh.make_planner("reactive", silent), arena="open")


def test_settings_in_groups_are_compared_one_by_one() -> None:
    robot = bh.load_robot("hexapod")
    model = bh.ForwardModel.fit(bh.babble(robot, 60, seed=0), robot.gaits, prior=0.03)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warn_of_other_motion(model.provenance, robot)
    other = bh.load_experiment("legs", {"robot": "hexapod", "robot.body.legs.friction": 0.5}).robot
    with pytest.warns(bh.DataWarning, match=r"has body\.legs\.friction 0\.8, not 0\.5 in hexapod:"):
        warn_of_other_motion(model.provenance, other)


def test_no_robot_moves_otherwise_than_its_own_record() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for robot in map(bh.load_robot, preset_names("robots")):
            warn_of_other_motion({"sources": [{"robot": robot.model_dump(mode="json")}]}, robot)
