"""planners, robots, presets, settings: what there is to choose from."""

from __future__ import annotations

import json
from typing import Annotated, Any

import typer

from bayeshunt.cli.app import app
from bayeshunt.cli.options import Json, complete_planner, complete_robot
from bayeshunt.core.errors import InputError

__all__ = ["Toml", "planners", "presets", "robots", "settings"]

Toml = Annotated[bool, typer.Option("--toml", help="Print its settings file, to start your own from.")]


@app.command(short_help="List the planners, or show one and its settings.")
def planners(
    name: Annotated[
        str | None, typer.Argument(help="Planner to show.", show_default=False, autocompletion=complete_planner)
    ] = None,
    as_json: Json = False,
) -> None:
    """List the planners: what each does, whether it is ab initio, what it needs; or show one and its settings.

    Example:  bayeshunt planners intercept;
    bayeshunt evaluate --planner intercept --set planner.intercept.hazard=0.2
    """
    from bayeshunt.planners.catalogue import describe_planner
    from bayeshunt.planners.registry import planner_names
    from bayeshunt.views.terminal import catalogue

    found = [describe_planner(known) for known in ([name] if name is not None else planner_names())]
    if as_json:
        facts = [{**f._asdict(), "settings": [s._asdict() for s in f.settings]} for f in found]
        typer.echo(json.dumps(facts if name is None else facts[0]))
    elif name is None:
        catalogue.planners_table(found)
    else:
        catalogue.planner_page(found[0])


@app.command(short_help="List the robots that ship, or show one.")
def robots(
    name: Annotated[
        str | None,
        typer.Argument(help="Robot preset or TOML file to show.", show_default=False, autocompletion=complete_robot),
    ] = None,
    as_toml: Toml = False,
    as_json: Json = False,
) -> None:
    """List the robots that ship, or show one: its body, its noise and its gaits.

    Example:  bayeshunt robots khepera --toml > mine.toml; bayeshunt babble --robot ./mine.toml --out b.parquet
    """
    from bayeshunt.config.loading import load_robot, preset_names
    from bayeshunt.views.terminal import catalogue

    if name is not None:
        _show(load_robot(name), as_toml, as_json)
        return
    found = {known: load_robot(known) for known in preset_names("robots")}
    rows = [(n, r.body.drive, str(len(r.gait)), r.description or r.name) for n, r in found.items()]
    if as_json:
        keys = ("robot", "drive", "gaits", "description")
        typer.echo(json.dumps([{**dict(zip(keys, row, strict=True)), "gaits": int(row[2])} for row in rows]))
        return
    note = "Show one, or start your own from it: bayeshunt robots NAME [--toml]. Every key: bayeshunt settings robot"
    catalogue.names_table(("robot", "drive", "gaits", "what it is"), rows, [note])


@app.command(short_help="List the experiments that ship, or show one.")
def presets(
    name: Annotated[str | None, typer.Argument(help="Experiment to show.", show_default=False)] = None,
    as_toml: Toml = False,
    as_json: Json = False,
) -> None:
    """List the experiments that ship, or show one: robot, prey, arenas, protocol and planners.

    Example:  bayeshunt presets paper --toml > mine.toml; bayeshunt evaluate --config mine.toml
    """
    from bayeshunt.config.loading import load_experiment, preset_names
    from bayeshunt.views.terminal import catalogue

    if name is not None:
        _show(load_experiment(name), as_toml, as_json)
        return
    found = {known: load_experiment(known) for known in preset_names()}
    if as_json:
        typer.echo(json.dumps([{"preset": known, "note": s.note} for known, s in found.items()]))
        return
    note = "Show one, or start your own from it: bayeshunt presets NAME [--toml]. Every key: bayeshunt settings"
    catalogue.names_table(("preset", "what it is"), [(known, s.note) for known, s in found.items()], [note])


@app.command(short_help="List every key of a settings file.")
def settings(
    name: Annotated[str, typer.Argument(help="experiment or robot")] = "experiment",
    as_json: Json = False,
) -> None:
    """List every key of a settings file with its unit, range and default.

    Example:  bayeshunt settings;  bayeshunt settings robot
    """
    from bayeshunt.config.loading import describe

    rows = describe(name)
    if as_json:
        typer.echo(json.dumps(rows))
        return
    from bayeshunt.views.terminal import terminal

    terminal.settings_table(rows)


def _show(settings: Any, as_toml: bool, as_json: bool) -> None:
    """Print settings as text, as TOML or as JSON."""
    from bayeshunt.views.pages.commands import to_toml

    if as_toml and as_json:
        raise InputError("--toml and --json: choose one")
    if as_json:
        typer.echo(settings.model_dump_json())
    else:
        typer.echo(to_toml(settings).rstrip() if as_toml else str(settings))
