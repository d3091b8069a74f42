"""replay, report: pages to look at, from files that hunt and evaluate wrote."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from bayeshunt.cli.app import app
from bayeshunt.cli.options import Json, Model, check_parent, tell


@app.command()
def replay(
    episode: Annotated[Path, typer.Argument(help="Episode made by bayeshunt hunt --out.", show_default=False)],
    out: Annotated[Path, typer.Option(help="Page (HTML) to write.")],
    model: Annotated[
        Path | None, typer.Option(help="Its model: draws where reactive and prediction expect their gait to lead.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Write a page that plays a recorded hunt, offline, in any browser.

    Example:  bayeshunt replay hunt.parquet --out hunt.html
    """
    from bayeshunt.episode import Episode
    from bayeshunt.models.forward import ForwardModel
    from bayeshunt.views.commands import model_option
    from bayeshunt.views.replay import write_replay

    check_parent(out)
    forward = None if model is None else ForwardModel.load(model)
    write_replay(Episode.load(episode), out, model=forward, source=model_option(model))
    tell({"out": str(out), "bytes": out.stat().st_size}, as_json, f"{out}: open it in a browser to play the hunt")
