"""Every public callable, with arguments of the wrong kind: one line that names the argument, never a raw error."""

import functools
import inspect
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd

import bayeshunt as bh
from bayeshunt.models.tables.structures import NAIVE

#: Plain pairs, triples and classes of a physics engine: what they hold is checked where it is used.
LEFT_OUT = {"Drive", "Explorer", "Polar", "Pose"}
#: Callables that work for seconds with arguments of the right kind: only those of the wrong kind are tried.
SLOW = {
    "evaluate",
    "sweep",
    "tradeoff",
    "write_report",
    "remember",
    "reference",
    "learn_room",
    "hunt",
    "assess",
    "routes",
}
#: Arguments that take whatever there is, or are looked at where they are used.
TAKEN = {"Gait name", "PreyModel conditions", "wrap angle", "InverseModel.after previous_gait"}
#: What a message calls an argument, where that is plainer than its name.
CALLED = {
    "path": "expected the name of a",
    "experiment": "expected the name of a preset",
    "robot": "expected the name of a preset",
    "assess frame": "table",
    "make_planner model": "planner 'reactive'",
    "register_reader factory": "a class or function that makes a reader",
    "register_prey behaviour": "a class that is made from a Context",
    "GaitRepertoire.index name": "gait",
    "InverseModel.posterior distance": "target",
    "InverseModel.posterior angle": "target",
    "Axis.index values": "Distance",
    "Polar.from_cartesian heading": "angle",
}
WRONG = {"None": None, "a number": 1.5, "text": "zz", "a list": [object()], "an object": object()}


def _method(make, name, /, **arguments):
    return getattr(make(), name)(**arguments)


def _cases():
    """Name -> (callable, arguments of the right kind)."""
    rng = np.random.default_rng(1)
    frame = pd.DataFrame(
        {
            "gait": ["a", "b"] * 20,
            "distance": np.r_[rng.uniform(0.05, 0.15, 40)],
            "angle": [0.0, -1.0] * 20,
            "heading": [3.0, 0.0] * 20,
        }
    )
    axes = bh.EffectAxes.standard(0.1)
    gaits = bh.GaitRepertoire((bh.Gait("a"), bh.Gait("b")), 0.1, 1.0)
    model = bh.ForwardModel.fit(frame, gaits, 0.1, axes=axes)
    inverse = bh.InverseModel(model)
    settings = bh.load_experiment(
        "paper", {"protocol.time_limit": 4.0, "planners": ("reactive",), "model.babbling_steps": 120}
    )
    robot = bh.load_robot("khepera")
    prey = bh.PreyModel(axes)
    prey.observe(bh.Polar(0.1, 0, 0))
    room = bh.RoomModel.empty()
    space = bh.FreeSpace.empty(0.03)
    pose = bh.Pose(0, 0, 0)
    polar = bh.Polar(1, 0, 0)
    planner = bh.make_planner("reactive", model)
    situation = bh.Situation(prey=polar, prey_model=prey, body_length=0.1)
    n = 60
    t = np.arange(n) * 0.1
    log = pd.DataFrame(
        {
            "run": "r",
            "time": t,
            "command_0": 1.0,
            "x": t * 0.1,
            "y": 0 * t,
            "yaw": 0 * t,
            "cmd_left": 0 * t + 1,
            "cmd_right": 0 * t,
            "left": np.repeat([1.0, 2, 1], 20),
            "right": 1.0,
        }
    )
    log.to_csv("log.csv", index=False)
    tracks = pd.DataFrame({"scene": "s", "id": "1", "time": np.tile(t, 1), "x": t * 0.1, "y": 0 * t, "theta": 0 * t})
    tracks.to_csv("tr.csv", index=False)
    model.save("m.json")
    model.to_xmlbif("m.xml")
    bh.save_dataset(frame, "f.parquet")
    prey.save("p.json")
    room.save("r.json")
    own = bh.ForwardModel.fit(bh.babble("khepera", 200, 0), robot.gaits, 0.1)
    hunting = bh.make_planner("reactive", own)
    episode = bh.hunt(settings, hunting, arena="open")
    episode.save("e.parquet")
    results = bh.evaluate(settings, runs=1, model=own, arenas=["open"])
    bh.save_results(results, settings, 0, "res")
    scores = bh.assess(frame, gaits, folds=2, permutations=5)
    environment = SimpleNamespace(unwrapped=SimpleNamespace(pursuit=bh.Pursuit(settings)))
    cases = {
        "Assessment": (
            bh.Assessment,
            {
                "settings": scores.settings,
                "variables": scores.variables,
                "reliability": scores.reliability,
                "gaits": scores.gaits,
                "confusion": scores.confusion,
                "independence": scores.independence,
                "structures": scores.structures,
                "found": scores.found,
                "given": scores.given,
                "notes": (),
            },
        ),
        "Axis": (bh.Axis, {"name": "Distance", "width": 0.1, "bins": 3, "circular": False}),
        "Babbler": (bh.Babbler, {"gaits": gaits, "seed": 0}),
        "DriveSettings": (
            bh.DriveSettings,
            {"drive": "x", "diameter": 0.1, "max_acceleration": 1.0, "max_traction": 1.0, "top_speed": 1.0},
        ),
        "EffectAxes": (
            bh.EffectAxes,
            {"distance": axes.distance, "angle": axes.angle, "heading": axes.heading, "body_length": 0.1},
        ),
        "Episode": (
            bh.Episode,
            {
                "caught": True,
                "time": 1.0,
                "frame": episode.frame,
                "trail": episode.trail,
                "provenance": episode.provenance,
                "plans": (),
                "situations": (),
            },
        ),
        "ExperimentSettings": (
            bh.ExperimentSettings,
            {k: getattr(settings, k) for k in type(settings).model_fields if k != "published"},
        ),
        "RobotSettings": (bh.RobotSettings, {k: getattr(robot, k) for k in type(robot).model_fields}),
        "ForwardModel": (
            bh.ForwardModel,
            {
                "joint": model.joint,
                "prior": 0.1,
                "gait_prior": "uniform",
                "provenance": {},
                "data": (),
                "structure": NAIVE,
                "backoff": None,
            },
        ),
        "Gait": (bh.Gait, {"name": "a", "command": (1.0, 2.0)}),
        "GaitRepertoire": (bh.GaitRepertoire, {"gaits": (bh.Gait("a"),), "body_length": 0.1, "duration": 1.0}),
        "Hunter": (
            bh.Hunter,
            {
                "planner": planner,
                "model": model,
                "sensing": None,
                "seed": 0,
                "prey_model": prey,
                "task": None,
                "gaits": gaits,
                "streams": None,
            },
        ),
        "InverseModel": (bh.InverseModel, {"model": model}),
        "Plan": (
            bh.Plan,
            {
                "gait": "a",
                "gaits": ("a",),
                "value": 0.0,
                "objective": "x",
                "nodes": 1,
                "make_trace": lambda: frame,
                "expansions": 0,
                "target": polar,
                "evidence_probability": 0.1,
                "support": 1,
                "posterior": np.ones(2) / 2,
                "prey_known": False,
                "predicted_prey": polar,
            },
        ),
        "PlannerInfo": (
            bh.PlannerInfo,
            {"ab_initio": True, "needs": (), "foresight": None, "prepare": None, "hunts": True, "maker": ""},
        ),
        "PreyModel": (bh.PreyModel, {"axes": axes, "conditions": None}),
        "RoomModel": (
            bh.RoomModel,
            {
                "normals": room.normals,
                "offsets": room.offsets,
                "lengths": room.lengths,
                "blocked": room.blocked,
                "provenance": {},
                "space": space,
            },
        ),
        "FreeSpace": (
            bh.FreeSpace,
            {"cell": 0.03, "origin": (0, 0), "visits": np.ones((2, 2), dtype=int), "hits": np.zeros((2, 2), dtype=int)},
        ),
        "Situation": (
            bh.Situation,
            {
                "prey": polar,
                "prey_model": prey,
                "body_length": 0.1,
                "time": 0.0,
                "step": 0,
                "previous_gait": None,
                "time_step": 1.0,
                "transitions": (),
                "pose": pose,
                "future": None,
                "task": situation.task,
            },
        ),
        "Structure": (bh.Structure, {"name": "naive", "edges": NAIVE.edges}),
        "TurnModel": (
            bh.TurnModel,
            {
                "prior_speed": 1.0,
                "prior_turns": np.array([1.0]),
                "prior_hazard": 0.1,
                "prior_steps": 4.0,
                "turn_weight": 0.5,
                "threshold": 0.4,
                "prior_drift": 0.1,
                "speeds": (),
                "turns": (),
                "drifts": (),
            },
        ),
        "assess": (
            bh.assess,
            {
                "frame": frame,
                "gaits": gaits,
                "model": None,
                "folds": 2,
                "seed": 0,
                "prior": 0.1,
                "axes": axes,
                "structures": ["naive"],
                "permutations": 5,
            },
        ),
        "babble": (
            bh.babble,
            {"robot": "khepera", "steps": 2, "seed": 0, "physics": None, "progress": None, "world": "box2d"},
        ),
        "check_body": (bh.check_body, {"robot": "khepera", "world": "box2d", "seed": 0}),
        "check_planner": (
            bh.check_planner,
            {"planner": planner, "gaits": ["a", "b"], "situations": [situation], "seed": 0},
        ),
        "check_prey": (bh.check_prey, {"behaviour": "straight", "experiment": settings, "seed": 0}),
        "check_prey_model": (bh.check_prey_model, {"name": "counts"}),
        "check_sensor": (bh.check_sensor, {"name": "exact", "seed": 0}),
        "check_tracker": (bh.check_tracker, {"name": "exact", "seed": 0}),
        "check_world": (bh.check_world, {"world": "box2d", "experiment": settings, "arena": "open", "seed": 0}),
        "describe_planner": (bh.describe_planner, {"name": "reactive"}),
        "evaluate": (
            bh.evaluate,
            {
                "experiment": settings,
                "runs": 1,
                "seed": 0,
                "jobs": 1,
                "planners": ["reactive"],
                "arenas": ["open"],
                "model": own,
                "out": None,
                "scheduler": None,
                "progress": None,
                "say": None,
            },
        ),
        "gaits_from_log": (
            bh.gaits_from_log,
            {"log": log, "time_step": 0.4, "gaits": 2, "seed": 0, "body_length": 0.1},
        ),
        "gaits_from_windows": (
            bh.gaits_from_windows,
            {
                "frame": log,
                "command": ("left", "right"),
                "pose": ("x", "y", "yaw"),
                "time_step": 0.1,
                "gaits": 2,
                "seed": 0,
                "body_length": 0.1,
                "run": None,
                "drop": False,
            },
        ),
        "hunt": (
            bh.hunt,
            {"experiment": settings, "planner": hunting, "arena": "open", "theta": 1.0, "seed": 0, "prey_model": None},
        ),
        "import_network": (bh.import_network, {"path": "m.xml", "gaits": gaits, "axes": model.axes}),
        "learn_room": (
            bh.learn_room,
            {"experiment": settings, "arena": "walled", "steps": 20, "seed": 0, "model": own, "progress": None},
        ),
        "load_dataset": (bh.load_dataset, {"path": "f.parquet"}),
        "load_experiment": (bh.load_experiment, {"experiment": "paper", "overrides": {}}),
        "load_results": (bh.load_results, {"folder": "res"}),
        "load_robot": (bh.load_robot, {"robot": "khepera"}),
        "make_planner": (bh.make_planner, {"name": "reactive", "model": model}),
        "planner_names": (bh.planner_names, {"standalone": False}),
        "read_log": (
            bh.read_log,
            {
                "path": "log.csv",
                "commands": None,
                "time": "time",
                "pose": ("x", "y", "yaw"),
                "command": ("left", "right"),
                "time_unit": "s",
                "unit": "m",
                "angle": "rad",
                "offset": 0.0,
                "reader": None,
            },
        ),
        "read_tracks": (
            bh.read_tracks,
            {
                "path": "tr.csv",
                "rate": None,
                "unit": "m",
                "scale": None,
                "y": None,
                "columns": {},
                "keypoint": None,
                "least_confidence": 0.0,
                "degrees": False,
                "reader": None,
            },
        ),
        "tracks": (
            bh.tracks,
            {
                "dataset": object(),
            },
        ),
        "reference": (
            bh.reference,
            {
                "experiment": settings,
                "seed": 0,
                "samples": 1,
                "angles": 4,
                "headings": 4,
                "cache": None,
                "progress": None,
            },
        ),
        "register_body": (
            bh.register_body,
            {"name": "zq1", "factory": lambda: 0, "commands": (), "settings": bh.DriveSettings, "speed": None},
        ),
        "register_planner": (
            bh.register_planner,
            {"name": "zq1", "factory": lambda m: 0, "settings": (), "info": None},
        ),
        **{
            k: (getattr(bh, k), {"name": "zq1", "factory": lambda: 0})
            for k in ("register_prey_model", "register_reader", "register_sensor", "register_tracker", "register_world")
        },
        "register_prey": (bh.register_prey, {"name": "zq1", "behaviour": lambda c: 0}),
        "remember": (
            bh.remember,
            {
                "experiment": settings,
                "arenas": ["open"],
                "planner": "reactive",
                "runs": 1,
                "seed": 0,
                "model": own,
                "progress": None,
            },
        ),
        "save_dataset": (bh.save_dataset, {"frame": frame, "path": "g.parquet", "provenance": {}}),
        "save_results": (bh.save_results, {"results": results, "settings": settings, "seed": 0, "folder": "res2"}),
        "score_forward": (
            bh.score_forward,
            {"frame": frame, "gaits": gaits, "models": ("stays",), "folds_by": None, "folds": 2, "seed": 0},
        ),
        "score_prey": (
            bh.score_prey,
            {
                "tracks": tracks,
                "models": ["stands"],
                "seen": 8,
                "steps": 12,
                "time_step": 0.2,
                "split": "time",
                "seed": 0,
                "most": 10,
            },
        ),
        "summarise": (bh.summarise, {"results": results, "settings": settings}),
        "sweep": (
            bh.sweep,
            {
                "experiment": settings,
                "grid": {"prey.speed": [0.05]},
                "runs": 1,
                "seed": 0,
                "jobs": 1,
                "planners": ["reactive"],
                "arenas": ["open"],
                "out": None,
                "progress": None,
            },
        ),
        "track_report": (bh.track_report, {"tracks": tracks}),
        "routes": (
            bh.routes,
            {
                "experiment": bh.load_experiment("portia", {"protocol.time_limit": 4.0}),
                "explored": (0,),
                "looks": (),
                "maps": 1,
                "runs": 1,
                "seed": 0,
                "model": None,
                "progress": None,
            },
        ),
        "tradeoff": (
            bh.tradeoff,
            {
                "experiment": settings,
                "vary": {"time": [1.0]},
                "runs": 1,
                "seed": 0,
                "jobs": 1,
                "planners": ("reactive",),
                "arena": "open",
                "progress": None,
            },
        ),
        "transitions": (bh.transitions, {"tracks": tracks, "time_step": 0.2, "standing": None, "seen": 8, "steps": 12}),
        "Task": (bh.Task, {"catch_distance": 0.1, "time_limit": 60.0}),
        "trace": (bh.trace, {"x": inverse.posterior(0.1, 0.0)}),
        "Pursuit": (
            bh.Pursuit,
            {"experiment": settings, "arena": "open", "theta": 1.0, "seed": 0, "prey_model": None, "foresight": 0.0},
        ),
        "Network": (bh.Network, {"model": model}),
        "compare": (bh.compare, {"a": model, "b": model}),
        "Learning": (bh.Learning, {"frame": frame, "gaits": gaits}),
        "policy_planner": (bh.policy_planner, {"predict": lambda situation: 0}),
        "planner_policy": (bh.planner_policy, {"planner": planner, "env": environment}),
        "wilson_interval": (bh.wilson_interval, {"successes": 1, "runs": 2}),
        "wrap": (bh.wrap, {"angle": 1.0}),
        "write_map": (bh.write_map, {"room": room, "path": "map.html"}),
        "write_replay": (bh.write_replay, {"episode": episode, "path": "e.html", "model": None, "source": ()}),
        "write_report": (
            bh.write_report,
            {"results": results, "path": "rep.html", "model": None, "model_path": None, "progress": None},
        ),
    }
    for cls, make, methods in [
        (
            "ForwardModel",
            lambda: model,
            {
                "after": {"previous_gait": "a"},
                "cells": {"variable": "Angle"},
                "counts": {"variable": "Angle"},
                "cpt": {"variable": "Angle"},
                "credible_interval": {"variable": "Angle", "level": 0.9},
                "empty": {
                    "gaits": gaits,
                    "prior": 0.1,
                    "axes": axes,
                    "gait_prior": "uniform",
                    "structure": "naive",
                    "backoff": None,
                },
                "evidence": {"distance_bins": [0], "angle_bins": [0], "heading_bins": None},
                "fit": {
                    "frame": frame,
                    "gaits": gaits,
                    "prior": 0.1,
                    "axes": axes,
                    "gait_prior": "uniform",
                    "structure": "naive",
                    "backoff": None,
                },
                "from_counts": {
                    "joint": model.joint,
                    "prior": 0.1,
                    "gait_prior": "uniform",
                    "structure": "naive",
                    "backoff": None,
                    "provenance": {},
                },
                "given": {"context": {}},
                "load": {"path": "m.json"},
                "loads": {"text": Path("m.json").read_text(), "name": "m"},
                "log_likelihood": {"rows": frame},
                "of_tables": {"gaits": gaits, "axes": axes, "structure": NAIVE, "tables": {}},
                "outcomes": {"uniforms": rng.uniform(size=(2, 6))},
                "over": {"source": model.source, "provenance": {}, "data": ()},
                "predict": {"gait": "a"},
                "probabilities": {"variable": "Angle"},
                "rows": {"variable": "Angle", "bin": 1, "gait": None},
                "sample": {"gait": "a", "n": 1, "rng": rng},
                "save": {"path": "n.json"},
                "table": {"variable": "Angle", "level": 0.9},
                "to_csv": {"folder": "csv"},
                "to_xmlbif": {"path": "n.xml"},
                "update": {"rows": frame},
                "with_data": {"frame": frame},
            },
        ),
        (
            "InverseModel",
            lambda: inverse,
            {
                "after": {"previous_gait": "a"},
                "posterior": {"distance": 0.1, "angle": 0.0, "heading": None, "snap": True},
                "posterior_many": {"distances": [0.1], "angles": [0.0]},
                "posterior_of": {"samples": [[0.1, 0.2]], "weights": None},
            },
        ),
        (
            "PreyModel",
            lambda: prey.copy(),
            {
                "fit": {"transitions": frame, "given": None, "residual_of": None, "axes": axes, "backoff": 25.0},
                "from_dict": {"record": prey.to_dict()},
                "futures": {"seen": np.zeros((9, 2)), "steps": 2, "n": 2, "rng": rng, "headings": None},
                "load": {"path": "p.json"},
                "log_likelihood": {"transitions": frame},
                "merge": {"other": prey},
                "observe": {"transition": polar},
                "predict": {"steps": 2},
                "predict_path": {"steps": 2},
                "sample_paths": {"steps": 2, "n": 2, "rng": rng},
                "save": {"path": "q.json"},
                "update": {"transitions": frame},
            },
        ),
        ("Structure", lambda: NAIVE, {"parents": {"variable": "Angle"}}),
        ("TurnModel", lambda: bh.TurnModel(1.0), {"learn": {"transitions": [polar]}}),
        (
            "FreeSpace",
            lambda: space,
            {
                "at": {"x": [0.0], "y": [0.0]},
                "empty": {"cell": 0.03},
                "of": {"cell": 0.03, "visited": np.zeros((1, 2)), "touched": np.zeros((0, 2))},
                "table": {"level": 0.9},
            },
        ),
        ("RoomModel", lambda: room, {"load": {"path": "r.json"}, "save": {"path": "s.json"}}),
        (
            "Hunter",
            lambda: bh.Hunter(planner, model),
            {"step": {"own_pose": pose, "seen": bh.Pose(1, 0, 0), "time": None, "future": None}},
        ),
        ("Babbler", lambda: bh.Babbler(gaits), {"record": {"own_pose": pose}}),
        ("Episode", lambda: episode, {"load": {"path": "e.parquet"}, "save": {"path": "e2.parquet"}}),
        (
            "GaitRepertoire",
            lambda: gaits,
            {"index": {"name": "a"}, "of": {"gaits": ["a"]}},
        ),
        (
            "Axis",
            lambda: axes.distance,
            {
                "extended": {"bins": 50},
                "full_turn": {"name": "Angle", "bins": 3},
                "index": {"values": [0.1]},
                "linear": {"name": "Distance", "width": 0.1, "bins": 2},
            },
        ),
        (
            "EffectAxes",
            lambda: axes,
            {
                "extended": {"distance_bins": 50},
                "standard": {"body_length": 0.1, "distance_bin": 0.1, "angle_bins": 3, "heading_bins": 3},
            },
        ),
        (
            "Polar",
            lambda: polar,
            {
                "compose": {"other": polar},
                "from_cartesian": {"forward": 1.0, "right": 1.0, "heading": 0.0},
                "seen_from": {"observer": polar},
            },
        ),
        ("Pose", lambda: pose, {"compose": {"seen": polar}, "relative": {"other": pose}}),
    ]:
        for m, kw in methods.items():
            cases[f"{cls}.{m}"] = (functools.partial(_method, make, m), kw)
    return cases


def _fits(annotation, wrong):
    """Whether a value of ``WRONG`` is of a kind that the annotation allows."""
    said = str(annotation)
    many = any(kind in said for kind in ("tuple", "list", "Sequence", "Iterable", "Array", "ndarray"))
    kinds = {"None": "None" in said, "a number": "float" in said.lower(), "text": "str" in said, "a list": many}
    return kinds.get(wrong, False)


def _fault(name, function, arguments, parameter, wrong, annotation):
    """What is wrong with the answer to a wrong argument; None if nothing is."""
    fits, called = _fits(annotation, wrong), CALLED.get(f"{name} {parameter}", parameter)
    if fits and (name in SLOW or wrong == "None" or (name.startswith("register") and parameter == "name")):
        return None
    try:
        function(**{**arguments, parameter: WRONG[wrong]})
    except bh.InputError as error:
        message = str(error)
        named = fits or any(words in message for words in (parameter, CALLED.get(parameter, parameter), called))
        return None if named and "\n" not in message else message
    except bh.BayesHuntError as error:
        return None if fits else str(error)
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    anything = annotation in (Any, "Any", inspect.Parameter.empty) or f"{name} {parameter}" in TAKEN
    return None if fits or anything or wrong == "None" else "was taken"


def test_every_argument_of_the_wrong_kind_is_named(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    cases, faults = _cases(), []
    errors = {
        name for name in bh.__all__ if isinstance(kind := getattr(bh, name), type) and issubclass(kind, Exception)
    }
    assert {name for name in bh.__all__ if callable(getattr(bh, name))} - errors - set(cases) == LEFT_OUT
    for name, (function, arguments) in cases.items():
        target = getattr(bh, name, None)
        if target is None:
            owner, method = name.split(".")
            target = getattr(getattr(bh, owner), method)
        parameters = inspect.signature(target).parameters
        for parameter in arguments:
            for wrong in WRONG:
                fault = _fault(name, function, arguments, parameter, wrong, parameters[parameter].annotation)
                if fault is not None:
                    faults.append(f"{name}({parameter}: {wrong}) {fault}")
    assert not faults, "\n".join(faults)
