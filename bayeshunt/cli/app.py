"""The application object that the command modules hang their commands on."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["app", "root"]

app = typer.Typer(
    name="bayeshunt",
    help="""A robot babbles to learn what its body can do, learns how its prey moves, and hunts it by asking
    probability tables that anyone can open.

    The main job, the paper's experiment in one command:  bayeshunt evaluate

    Example:  bayeshunt doctor;  bayeshunt evaluate --runs 5

    Step by step:  bayeshunt babble --out b.parquet;  bayeshunt fit b.parquet --out model.json;
    bayeshunt query model.json --distance 0.1 --angle 0.5;  bayeshunt hunt --planner planning --arena open""",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


@app.callback(invoke_without_command=True)
def root(
    version: Annotated[bool, typer.Option("--version", help="Print the version and exit.", is_eager=True)] = False,
    plugin: Annotated[
        list[Path] | None,
        typer.Option(help="Python file of your own that registers prey or planners; it is run. May be repeated."),
    ] = None,
) -> None:
    """Print the version if asked; run the plugins."""
    if plugin:
        from bayeshunt.experiments.run.plugins import load_plugin

        for path in plugin:
            load_plugin(path)
    if version:
        from importlib.metadata import version as installed

        typer.echo(f"bayeshunt {installed('bayeshunt')}")
        raise typer.Exit
