"""Degrees and millimetres: refused where they cannot be meant, warned of where they hardly can."""

import math
import warnings

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.config.loading import preset_names

ROBOT = bh.load_robot("khepera")


def test_what_ships_and_what_babbling_makes_is_not_warned_of(khepera_frame):
    with warnings.catch_warnings():
        warnings.simplefilter("error", bh.DataWarning)
        bh.ForwardModel.fit(khepera_frame, ROBOT.gaits)
        for name in preset_names():
            bh.load_experiment(name)
        for name in preset_names("robots"):
            bh.load_robot(name)
        turned = khepera_frame.assign(angle=np.mod(khepera_frame["angle"], 2 * math.pi))  # another convention
        bh.ForwardModel.fit(turned, ROBOT.gaits, prior=0.1)


@pytest.mark.parametrize(
    ("column", "change", "says"),
    [
        ("distance", lambda d: d * 1000, r"m in one gait, but the fastest command drives .* / 1000"),
        ("heading", lambda h: np.full(len(h), 8.0), r"heading goes to 8 rad.*numpy\.radians\(frame\['heading'\]\)"),
        ("heading", lambda h: np.full(len(h), 4.0), r"heading goes to 4 rad"),
        ("angle", lambda a: a * 2.5, r"angle goes to .* rad, beyond half a turn"),
    ],
)
def test_a_table_in_other_units_is_warned_of_with_the_fix(khepera_frame, column, change, says):
    frame = khepera_frame.head(300)
    frame = frame.assign(**{column: change(frame[column].to_numpy())})
    with pytest.warns(bh.DataWarning, match=rf"^table: .*{says}") as caught:
        bh.ForwardModel.fit(frame, ROBOT.gaits, prior=0.1)
    assert caught[0].filename == __file__
    assert all("\n" not in str(w.message) for w in caught)


def test_many_distance_bins_are_warned_of_where_no_command_is_known(khepera_frame):
    frame = khepera_frame.head(100).assign(distance=lambda f: f["distance"] * 1000)
    with pytest.warns(bh.DataWarning, match=r"makes [\d,]+ distance bins.*in millimetres"):
        bh.ForwardModel.fit(frame, sorted(frame["gait"].unique()), prior=0.1, axes=bh.EffectAxes.standard(0.057))


@pytest.mark.parametrize(
    ("key", "value", "says"),
    [
        ("robot.body.diameter", 57, r"robot\.body\.diameter: 57 m, but no gait .*give 0\.057"),
        ("robot.gait_duration", 3328, r"robot\.gait: .*gait_duration is in ms"),
        ("robot.body.axle", 52, r"robot\.body\.axle: 52 m.*give 0\.052"),
        ("prey.speed", 48, r"prey\.speed: 48 m/s .*give 0\.048"),
        ("prey.body.diameter", 57, r"prey\.body\.diameter: 57 m.*give 0\.057"),
        ("prey.sensor_range", 60, r"prey\.sensor_range: 60 m"),
        ("prey.turn_rate", 46, r"prey\.turn_rate: 46 rad/s.*degrees"),
        ("prey.turn_sd", 45, r"prey\.turn_sd: 45 rad/s.*degrees"),
        ("robot.body.max_steering_rate", 115, r"robot\.body\.max_steering_rate: 115 rad/s.*degrees"),
        ("arenas.open.width", 1200, r"arenas\.open\.width: 1200 m"),
        ("protocol.catch_distance", 100, r"protocol\.catch_distance: 100 bodies, and the prey starts at 5"),
    ],
)
def test_settings_in_other_units_are_warned_of_with_the_fix(key, value, says):
    with pytest.warns(bh.DataWarning, match=f"^preset 'paper': {says}") as caught:
        bh.load_experiment("paper", {key: value})
    assert len(caught) == 1


def test_degrees_are_refused_wherever_an_angle_comes_in(khepera_frame):
    inverse = bh.InverseModel(bh.ForwardModel.fit(khepera_frame, ROBOT.gaits))
    prey = bh.PreyModel(bh.EffectAxes.standard(0.057))
    walls = khepera_frame.head(3).assign(interval=0, x=[0.0, 1, 2], y=[0.0, 1, 0], theta=[0.0, 90, 0])
    for call in (
        lambda: inverse.posterior(0.16, 30),
        lambda: inverse.posterior(0.16, 0.5, 30),
        lambda: inverse.posterior_many([0.16, 0.16], [0.5, -30]),
        lambda: prey.observe(bh.Polar(0.1, 90, 45)),
        lambda: prey.observe(bh.Polar(0.1, 0.5, 45)),
        lambda: bh.TurnModel(0.1).learn([bh.Polar(0.1, 0.0, 45.0)]),
        lambda: bh.RoomModel.fit(walls, inverse.model),
        lambda: bh.Network(inverse.model).posterior("Gait", evidence={"Angle": 30}),
        lambda: prey.update(pd.DataFrame({"distance": [0.1], "angle": [0.5], "heading": [45.0]})),
        lambda: bh.load_experiment("paper", {"protocol.thetas": [90.0]}),
        lambda: bh.Axis.full_turn("Angle", 36).index([0.5, 90.0]),
        lambda: bh.Axis.full_turn("Angle", 36).index(-90.0),
    ):
        with pytest.raises(bh.InputError, match=r"expected radians from -[24] pi to [24] pi, got -?\d+; if that"):
            call()


def test_a_robot_of_ones_own_that_starts_with_degrees_is_warned_of():
    with pytest.warns(bh.DataWarning, match=r"^own_pose: theta is 90 rad at the start; if that is in degrees"):
        bh.Babbler(ROBOT.gaits).record(bh.Pose(0.0, 0.0, 90.0))
    facts = {"prey": bh.Polar(0.3, 0.2, 0.1), "prey_model": bh.PreyModel()}
    with pytest.warns(bh.DataWarning, match=r"^pose: theta is -90 rad at the start; .*: math\.radians\(theta\)$"):
        bh.Situation(**facts, pose=bh.Pose(0.0, 0.0, -90.0))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        bh.Situation(**facts, pose=bh.Pose(0.0, 0.0, -90.0), step=40)  # by then it may have turned so often
        bh.Situation(**facts, pose=bh.Pose(0.0, 0.0, 12.5))


def test_a_target_in_millimetres_is_warned_of(khepera_model):
    inverse = bh.InverseModel(khepera_model)
    says = r"^target distance: 160 m, but the farthest learned coordinate ends at 0\.2\d* m; .*, give 0\.16$"
    for call in (lambda: inverse.posterior(160, 0.1), lambda: inverse.posterior_many([0.16, 160], 0.1)):
        with pytest.warns(bh.DataWarning, match=says):
            call()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert inverse.posterior(10.0, 0.1).beyond
        inverse.posterior_many([0.16, 10.0], 0.1)


def test_settings_are_warned_of_once_and_what_a_hunt_asks_of_them_is_not(khepera_model):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        settings = bh.load_experiment("paper", {"prey.speed": 48})
        planner = bh.make_planner("reactive", khepera_model)
        assert bh.hunt(settings, planner, arena="open").situations[-1].prey.distance > 50  # far off every table
        bh.evaluate(settings, runs=1, planners="reactive", arenas="open", model=khepera_model)
    assert [str(one.message).split(":")[0] for one in caught] == ["preset 'paper'"]
    with pytest.warns(bh.DataWarning, match=r"^settings 'paper': arenas\.open\.width"):  # another one is
        bh.load_experiment(settings, {"prey.speed": 0.05, "arenas.open.width": 1200})


def test_the_command_says_it_in_one_line(monkeypatch, capfd, tmp_path):
    from bayeshunt.cli import main

    path = tmp_path / "b.parquet"
    bh.save_dataset(bh.babble(ROBOT, 300, 0).assign(distance=lambda f: f["distance"] * 1000), path)
    line = ["bayeshunt", "fit", str(path), "--out", str(tmp_path / "m.json"), "--prior", "0.1", "-q"]
    monkeypatch.setattr("sys.argv", line)
    with warnings.catch_warnings(), pytest.raises(SystemExit) as left:
        main()
    err = capfd.readouterr().err
    assert left.value.code == 0
    assert err.startswith(f"bayeshunt: warning: {path}: ")
    assert err.count("\n") == 1
