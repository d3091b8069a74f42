"""settings: every key of a settings file."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from bayeshunt.cli.app import app
from bayeshunt.cli.options import Json


@app.command(short_help="List every key of a settings file.")
def settings(
    name: Annotated[str, typer.Argument(help="experiment or robot")] = "experiment",
    as_json: Json = False,
) -> None:
    """List every key of a settings file with its unit, range and default."""
    from bayeshunt.config.loading import describe

    rows = describe(name)
    if as_json:
        typer.echo(json.dumps(rows))
        return
    from bayeshunt.views.terminal import terminal

    terminal.settings_table(rows)
