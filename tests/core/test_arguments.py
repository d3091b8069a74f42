"""Arguments of the wrong kind: one line that names them, from their type hints, in public functions and values."""

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh

FRAME = pd.DataFrame({"gait": ["a", "b"], "distance": [0.1, 0.2], "angle": [0.0, -1.0], "heading": [3.0, 0.0]})
AXES = bh.EffectAxes.standard(0.1)
SETTINGS = bh.load_experiment("paper")
POSE, POLAR = bh.Pose(0.0, 0.0, 0.0), bh.Polar(1.0, 0.0, 0.0)

CALLS = {
    "PreyModel": ("axes", lambda: bh.PreyModel(0.35)),
    "PreyModel.merge": ("other", lambda: bh.PreyModel(AXES).merge(3)),
    "fit axes": ("axes", lambda: bh.ForwardModel.fit(FRAME, ["a", "b"], axes=36)),
    "fit structure": ("structure", lambda: bh.ForwardModel.fit(FRAME, ["a", "b"], axes=AXES, structure=3)),
    "empty": ("axes", lambda: bh.ForwardModel.empty(["a"], axes="x")),
    "write_report": ("results", lambda: bh.write_report("results", "x.html")),
    "write_replay": ("episode", lambda: bh.write_replay("episode.parquet", "x.html")),
    "save_results": ("settings", lambda: bh.save_results(FRAME, "paper", 0, "out")),
    "summarise": ("results", lambda: bh.summarise("results", SETTINGS)),
    "wilson": ("runs", lambda: bh.wilson_interval(1, "2")),
    "save_dataset": ("frame", lambda: bh.save_dataset("x", "y.parquet")),
    "relative": ("other", lambda: POSE.relative((1, 1, 0))),
    "pose compose": ("seen", lambda: POSE.compose((1, 1, 0))),
    "compose": ("other", lambda: POLAR.compose(None)),
    "seen_from": ("observer", lambda: POLAR.seen_from("x")),
    "numbers inside": ("other", lambda: POSE.relative(bh.Pose("a", "b", "c"))),
    "wrap": ("angle", lambda: bh.wrap("x")),
    "repertoire": ("gaits", lambda: bh.GaitRepertoire(("a", "b"))),
    "repertoire of text": ("gaits", lambda: bh.GaitRepertoire("ab")),
    "gait": ("command", lambda: bh.Gait("a", 3)),
    "gait command": ("command", lambda: bh.Gait("a", ("x", 1))),
    "load_results": ("folder", lambda: bh.load_results(None)),
    "read_log": ("path", lambda: bh.read_log(3)),
    "read_tracks": ("path", lambda: bh.read_tracks(3, rate=1.0, unit="m")),
    "overrides": ("overrides", lambda: bh.load_experiment("paper", ["protocol.runs"])),
    "babble progress": ("progress", lambda: bh.babble("khepera", 5, 0, progress=3)),
    "evaluate progress": ("progress", lambda: bh.evaluate("paper", runs=1, progress=3)),
    "evaluate say": ("say", lambda: bh.evaluate("paper", runs=1, say="x")),
    "sweep grid": ("grid", lambda: bh.sweep("paper", 3)),
    "tradeoff vary": ("vary", lambda: bh.tradeoff("paper", 3)),
    "planner needs": ("needs", lambda: bh.PlannerInfo(needs=None)),
    "axis": ("width", lambda: bh.Axis("Distance", [0, 0.1], 3)),
    "axis bins": ("bins", lambda: bh.Axis("Distance", 0.1, "3")),
    "axis name": ("name", lambda: bh.Axis(3, 0.1, 3)),
    "full turn": ("bins", lambda: bh.Axis.full_turn("Angle", 3.5)),
    "axes": ("distance", lambda: bh.EffectAxes(1, 2, 3)),
    "standard": ("body_length", lambda: bh.EffectAxes.standard("x")),
    "structure name": ("name", lambda: bh.Structure(3, ())),
    "structure edges": ("edges", lambda: bh.Structure("naive", None)),
    "structure edge": ("edges", lambda: bh.Structure("naive", ("Gait",))),
    "turn model": ("prior_speed", lambda: bh.TurnModel(None)),
    "turn model hazard": ("prior_hazard", lambda: bh.TurnModel(1.0, prior_hazard="x")),
    "turn model turns": ("prior_turns", lambda: bh.TurnModel(1.0, prior_turns=np.array(["x"]))),
    "turn model speeds": ("speeds", lambda: bh.TurnModel(1.0, speeds=(object(),))),
    "futures": ("seen", lambda: bh.PreyModel(AXES).futures("x", 1, 1, rng=np.random.default_rng(0))),
    "evidence": ("distance_bins", lambda: bh.ForwardModel.empty(["a"], 1.0, axes=AXES).evidence("x", 0)),
    "evidence number": ("angle_bins", lambda: bh.ForwardModel.empty(["a"], 1.0, axes=AXES).evidence(0, 1.5)),
    "extended": ("bins", lambda: AXES.distance.extended("x")),
    "axes extended": ("distance_bins", lambda: AXES.extended(None)),
    "from_cartesian": ("forward", lambda: bh.Polar.from_cartesian(None, 1.0)),
    "check_planner": ("planner", lambda: bh.check_planner(None, ["a"], [], 0)),
    "check_world arena": ("arena", lambda: bh.check_world("box2d", arena="zz")),
    "check_world seed": ("seed", lambda: bh.check_world("box2d", seed="x")),
    "check_body seed": ("seed", lambda: bh.check_body("khepera", seed=None)),
    "check_prey seed": ("seed", lambda: bh.check_prey("straight", seed=1.5)),
    "check_sensor seed": ("seed", lambda: bh.check_sensor("exact", seed=None)),
    "check_tracker seed": ("seed", lambda: bh.check_tracker("exact", seed="x")),
    "remember seed": ("seed", lambda: bh.remember(SETTINGS, runs=1, seed=None)),
    "remember progress": ("progress", lambda: bh.remember(SETTINGS, runs=1, progress="x")),
    "reference seed": ("seed", lambda: bh.reference(SETTINGS, seed="x")),
    "reference progress": ("progress", lambda: bh.reference(SETTINGS, progress=3)),
    "save_results seed": ("seed", lambda: bh.save_results(FRAME, SETTINGS, "x", "out")),
    "standard bins": ("angle_bins", lambda: bh.EffectAxes.standard(0.1, angle_bins=[36])),
}


@pytest.mark.parametrize("case", CALLS)
def test_the_argument_is_named_in_one_line(case):
    name, call = CALLS[case]
    with pytest.raises(bh.InputError) as caught:
        call()
    message = str(caught.value)
    assert name in message
    assert "\n" not in message
    assert "expected" in message


def test_numbers_of_numpy_are_numbers_and_signatures_stay():
    import inspect

    assert bh.wilson_interval(np.int64(1), np.int32(2)) == bh.wilson_interval(1, 2)
    assert list(inspect.signature(bh.ForwardModel.fit).parameters)[:3] == ["frame", "gaits", "prior"]
    assert bh.Axis("Distance", np.float64(0.1), np.int64(3)).bins == 3


def test_an_exported_network_is_named_as_one(tmp_path):
    model = bh.ForwardModel.empty(["a"], 1.0, axes=AXES)
    with pytest.raises(bh.InputError, match="networks are XMLBIF, not Parquet"):
        model.to_xmlbif(tmp_path / "n.parquet")
