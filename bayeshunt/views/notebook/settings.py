"""What a robot, its gaits, an experiment and a planner look like in print and in a notebook."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Sequence
from typing import NamedTuple

from bayeshunt.config.schema import BodySettings, ExperimentSettings, RobotSettings
from bayeshunt.config.schema.drives import find_drive
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.core.units import degrees, length, speed
from bayeshunt.planners.api import Shown
from bayeshunt.planners.catalogue import summarise
from bayeshunt.views.notebook.html import Html, card, facts, row, table
from bayeshunt.views.terminal.texts import align, clean

_WIDTH = 100  # columns of running text, at most


class Sheet(NamedTuple):
    """One thing to show: a title, facts by name, and a table (no columns: none)."""

    title: str
    pairs: list[tuple[str, str]]
    columns: tuple[str, ...] = ()
    rows: Sequence[Sequence[str]] = ()

    def text(self) -> str:
        """Return it as lines of text."""
        width = max((len(name) for name, _ in self.pairs), default=0)
        lines = textwrap.wrap(self.title, _WIDTH) + [f"{name:<{width}}  {value}" for name, value in self.pairs]
        left = set(range(len(self.columns))) if self.columns[1:] == ("command",) else {0}
        return "\n".join([*lines, *(["", *align(self.columns, self.rows, left=left)] if self.rows else [])])

    def html(self) -> Html:
        """Return it as a display of its own."""
        body = table(self.columns, [row(cells[0], cells[1:]) for cells in self.rows]) if self.rows else None
        title, _, subtitle = self.title.partition(": ")
        return card(title, subtitle, facts(self.pairs), body)


def robot(shown: RobotSettings) -> Sheet:
    """Return a robot: its body, its noise, and a row per gait."""
    body, noise = shown.body, shown.noise
    if not isinstance(body, BodySettings):
        return _registered(shown)
    car = body.drive == "car"
    name, span = ("wheelbase", body.wheelbase) if car else ("axle", body.axle)
    steering = f"steering ±{degrees(body.max_steering)} at {degrees(body.max_steering_rate)}/s"
    limits = [f"acceleration {speed(body.max_acceleration)}²", f"traction {speed(body.max_traction)}²"]
    pairs = [
        ("body", f"disc of {length(body.diameter)}, {name} {length(span)}, {body.drive} drive"),
        ("limits", ", ".join([*limits, steering] if car else limits)),
        ("noise", f"slip ±{100 * noise.slip:g} %, drift {100 * noise.drift_sd:g} % over {noise.drift_time:g} s"),
        ("top speed", speed(shown.top_speed)),
        ("time-step", f"{shown.gait_duration:g} s, held by every gait"),
    ]
    columns = ("gait", "speed mm/s", "steering °") if car else ("gait", "left mm/s", "right mm/s")
    rows = []
    for gait in shown.gait:
        one, other = (gait.speed, gait.steering) if car else (gait.left, gait.right)
        second = math.degrees(other or 0.0) if car else 1000 * (other or 0.0)
        rows.append((clean(gait.name), f"{1000 * (one or 0.0):.1f}", f"{second:.1f}"))
    return Sheet(f"Robot {clean(shown.name)}: {shown.description or 'no description'}", pairs, columns, rows)


def _registered(shown: RobotSettings) -> Sheet:
    """A robot whose kind of body was registered: what its own settings say, and its commands as they are."""
    body, noise = shown.body, shown.noise
    own = {name: value for name, value in body.model_dump().items() if name not in ("drive", "diameter")}
    pairs = [
        ("body", f"disc of {length(body.diameter)}, {body.drive} drive"),
        ("its settings", ", ".join(f"{clean(name)} {value}" for name, value in own.items() if value is not None)),
        ("noise", f"slip ±{100 * noise.slip:g} %, drift {100 * noise.drift_sd:g} % over {noise.drift_time:g} s"),
        ("time-step", f"{shown.gait_duration:g} s, held by every gait"),
    ]
    keys = find_drive(body.drive).commands
    columns = ("gait", *map(clean, keys)) if keys else ("gait", "command")
    rows = []
    for gait in shown.gaits:
        values = [f"{value:g}" for value in gait.command]
        rows.append((clean(gait.name), *(values if keys else [", ".join(values)])))
    return Sheet(f"Robot {clean(shown.name)}: {shown.description or 'no description'}", pairs, columns, rows)


def gaits(shown: GaitRepertoire) -> Sheet:
    """Return a repertoire: a row per gait, with its command in the body's own units."""
    pairs = [
        ("body length", "unknown" if shown.body_length is None else length(shown.body_length)),
        ("time-step", "unknown" if shown.duration is None else f"{shown.duration:g} s, held by every gait"),
    ]
    rows = [(clean(gait.name), ", ".join(f"{value:g}" for value in gait.command)) for gait in shown]
    return Sheet(f"Gaits: {len(shown)}, in the order of every table", pairs, ("gait", "command"), rows)


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
        (name, f"{length(a.width)} x {length(a.height)}" if a.walled else "no walls")
        for name, a in shown.arenas.items()
    ]
    return Sheet(f"Experiment {clean(shown.name)}: {shown.note or 'no note'}", pairs, ("arena", "size"), rows)


def _speed_of(robot: RobotSettings) -> str:
    known = robot.known_top_speed
    return "top speed not said" if known is None else f"top speed {speed(known)}"


def planner(shown: Shown) -> Sheet:
    """Return a planner: what it does and what it was set to."""
    rows = [(name, str(value)) for name, value in shown.chosen().items()]
    known = getattr(shown, "gaits", ())
    pairs = [("gaits", ", ".join(map(clean, known)))] if known else []
    return Sheet(f"Planner {shown.name}: {summarise(type(shown))}", pairs, ("setting", "value"), rows)


#: How each class is shown.
SHEETS: dict[type, Callable[..., Sheet]] = {
    RobotSettings: robot,
    GaitRepertoire: gaits,
    ExperimentSettings: experiment,
    Shown: planner,
}
