"""Sheets of a robot, its gaits, an experiment and a planner."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from bayeshunt.config.schema import ArenaSettings, ExperimentSettings, RobotSettings
from bayeshunt.config.schema.drives import find_drive
from bayeshunt.config.schema.legs import LegGait, LeggedSettings
from bayeshunt.config.schema.mujoco import MujocoGait
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.core.units import degrees, length, speed
from bayeshunt.planners.api import Shown
from bayeshunt.planners.catalogue import summarise
from bayeshunt.views.sheets.sheet import Sheet, Table
from bayeshunt.views.terminal.text_tables import clean

__all__ = ["experiment", "gaits", "planner", "robot"]


def robot(shown: RobotSettings) -> Sheet:
    """Return a robot: its body, its noise, and a row per gait."""
    noise = shown.noise
    described, columns, rows = _BODIES.get(shown.body.drive, _registered)(shown)
    pairs = [
        *described,
        ("noise", f"slip ±{100 * noise.slip:g} %, drift {100 * noise.drift_sd:g} % over {noise.drift_time:g} s"),
        *([] if (top := shown.known_top_speed) is None else [("top speed", speed(top))]),
        ("time-step", f"{shown.gait_duration:g} s, held by every gait"),
    ]
    return Sheet(f"Robot {clean(shown.name)}", shown.description or "no description", pairs, [Table(columns, rows)])


#: Facts, column names and a row per gait.
_Body = tuple[list[tuple[str, str]], tuple[str, ...], Sequence[Sequence[str]]]


def _wheels(shown: RobotSettings) -> _Body:
    body, car = shown.body, shown.body.drive == "car"
    name, span = ("wheelbase", body.wheelbase) if car else ("axle", body.axle)
    steering = f"steering ±{degrees(body.max_steering)} at {degrees(body.max_steering_rate)}/s"
    limits = [f"acceleration {speed(body.max_acceleration)}²", f"traction {speed(body.max_traction)}²"]
    pairs = [
        ("body", f"disc of {length(body.diameter)}, {name} {length(span)}, {body.drive} drive"),
        ("limits", ", ".join([*limits, steering] if car else limits)),
    ]
    columns = ("gait", "speed mm/s", "steering °") if car else ("gait", "left mm/s", "right mm/s")
    rows = []
    for gait in shown.gait:
        one, other = (gait.speed, gait.steering) if car else (gait.left, gait.right)
        second = math.degrees(other or 0.0) if car else 1000 * (other or 0.0)
        rows.append((gait.name, f"{1000 * (one or 0.0):.1f}", f"{second:.1f}"))
    return pairs, columns, rows


def _on_legs(shown: RobotSettings) -> _Body:
    body = shown.body
    assert isinstance(body, LeggedSettings)
    legs = body.legs
    torque, rate = f"{legs.max_torque:g} N m", f"{degrees(legs.max_rate)}/s"
    pairs = [
        ("body", f"{length(body.body_length)} long, {1000 * (body.mass + len(legs.x) * legs.mass):g} g"),
        ("legs", f"{len(legs.x)} of {length(legs.length)}, {legs.joint} hips, servos of {torque} and {rate}"),
        ("ground", f"friction {legs.friction:g} ±{100 * legs.friction_spread:g} %, belly {legs.belly_friction:g}"),
    ]
    rows = []
    for gait in shown.gait:
        assert isinstance(gait, LegGait)
        strokes = (f"{math.degrees(stroke):.1f}" for stroke in gait.stroke)
        phases = " ".join(f"{100 * phase:.0f}" for phase in gait.phase)
        rows.append((gait.name, f"{gait.frequency:g}", f"{100 * gait.duty:.0f}", *strokes, phases))
    return pairs, ("gait", "steps Hz", "foot down %", "left °", "right °", "phases %"), rows


def _in_mujoco(shown: RobotSettings) -> _Body:
    body: Any = shown.body
    pairs = [
        ("body", f"{length(body.body_length)} long, MuJoCo model {clean(body.model)}"),
        ("servos", f"targets follow sines, at most {degrees(body.max_rate)}/s; friction {body.friction:g}"),
        ("falls", f"set upright after {body.fall_time:g} s beyond {degrees(body.fall_angle)}"),
    ]
    rows: list[tuple[str, ...]] = []
    for gait in shown.gait:
        assert isinstance(gait, MujocoGait)
        angles = (" ".join(f"{math.degrees(v):.0f}" for v in part) for part in (gait.amplitude, gait.offset))
        cycles = " ".join(f"{100 * phase:.0f}" for phase in gait.phase)
        rows.append((gait.name, " ".join(f"{hz:g}" for hz in dict.fromkeys(gait.frequency)), *angles, cycles))
    return pairs, ("gait", "Hz", "amplitude °", "offset °", "phases %"), rows


def _registered(shown: RobotSettings) -> _Body:
    """A robot whose kind of body was registered: what its own settings say, and its commands as they are."""
    body = shown.body
    own = {name: value for name, value in body.model_dump().items() if name not in ("drive", "diameter")}
    pairs = [
        ("body", f"disc of {length(body.diameter)}, {body.drive} drive"),
        ("its settings", ", ".join(f"{clean(name)} {value}" for name, value in own.items() if value is not None)),
    ]
    keys = find_drive(body.drive).commands
    rows = []
    for gait in shown.gaits:
        values = [f"{value:g}" for value in gait.command]
        rows.append((gait.name, *(values if keys else [", ".join(values)])))
    return pairs, ("gait", *map(clean, keys)) if keys else ("gait", "command"), rows


#: How the bodies that ship are described.
_BODIES: dict[str, Callable[[RobotSettings], _Body]] = {
    "differential": _wheels, "car": _wheels, "legs": _on_legs, "mujoco": _in_mujoco,
}  # fmt: skip


def gaits(shown: GaitRepertoire) -> Sheet:
    """Return a repertoire: a row per gait, with its command in the body's own units."""
    pairs = [
        ("body length", "unknown" if shown.body_length is None else length(shown.body_length)),
        ("time-step", "unknown" if shown.duration is None else f"{shown.duration:g} s, held by every gait"),
    ]
    rows = [(gait.name, ", ".join(f"{value:g}" for value in gait.command)) for gait in shown]
    table = Table(("gait", "command"), rows, words=frozenset({0, 1}))
    return Sheet("Gaits", f"{len(shown)}, in the order of every table", pairs, [table])


def experiment(shown: ExperimentSettings) -> Sheet:
    """Return an experiment: who hunts whom, where, how often."""
    protocol, prey = shown.protocol, shown.prey
    bearings = ", ".join(degrees(theta) for theta in protocol.thetas)
    pairs = [
        (
            "robot",
            f"{shown.robot.name}, {len(shown.robot.gait)} gaits, {_speed_of(shown.robot)}",
        ),
        ("prey", f"{prey.behaviour}, {speed(prey.speed)}, starts {protocol.prey_distance:g} bodies away"),
        ("bearings", f"{bearings}; {protocol.runs} runs each"),
        ("a hunt", f"ends at {protocol.catch_distance:g} bodies (a catch) or after {protocol.time_limit:g} s"),
        ("learning", f"{shown.model.babbling_steps} gaits babbled, prior {shown.model.prior:g}"),
        ("planners", ", ".join(shown.planners)),
        *((f"set: {name}", ", ".join(f"{k} {v}" for k, v in chosen.items())) for name, chosen in shown.planner.items()),
    ]
    rows = [
        (name, (f"{length(a.width)} x {length(a.height)}" if a.walled else "no walls") + _obstacles(a))
        for name, a in shown.arenas.items()
    ]
    arenas = Table(("arena", "size"), rows)
    return Sheet(f"Experiment {clean(shown.name)}", shown.note or "no note", pairs, [arenas])


def _speed_of(robot: RobotSettings) -> str:
    known = robot.known_top_speed
    return "top speed not said" if known is None else f"top speed {speed(known)}"


def planner(shown: Shown) -> Sheet:
    """Return a planner: what it does and what it was set to."""
    rows = [(name, str(value)) for name, value in shown.chosen().items()]
    known = getattr(shown, "gaits", ())
    pairs = [("gaits", ", ".join(map(clean, known)))] if known else []
    settings = Table(("setting", "value"), rows) if rows else None
    return Sheet(f"Planner {shown.name}", summarise(type(shown)), pairs, [settings])


def _obstacles(arena: ArenaSettings) -> str:
    count = len(arena.obstacles)
    return f", {count} obstacle{'s' if count > 1 else ''}" if count else ""
