"""replay, report: pages to look at, from files that hunt and evaluate wrote."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bayeshunt.cli.app import app
from bayeshunt.cli.options import Json, Model, Quiet, settings_of, tell
from bayeshunt.cli.outputs import out_file


@app.command(short_help="Write a page that plays a recorded hunt.")
def replay(
    episode: Annotated[Path, typer.Argument(help="Episode made by bayeshunt hunt --out.", show_default=False)],
    out: Annotated[Path, out_file("Page (HTML) to write.", "pages", ".html")],
    model: Annotated[
        Path | None, typer.Option(help="Its model: draws where reactive and prediction expect their gait to lead.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Write a page that plays a recorded hunt, offline, in any browser.

    Example:  bayeshunt replay hunt.parquet --out hunt.html
    """
    from bayeshunt.episodes.episode import Episode
    from bayeshunt.experiments.store.export import another_model
    from bayeshunt.models.formats.interchange import open_model
    from bayeshunt.views.pages.commands import model_option
    from bayeshunt.views.pages.replay import write_replay
    from bayeshunt.views.terminal import terminal

    forward = None if model is None else open_model(model)
    hunt = Episode.load(episode)
    difference = None if forward is None else another_model(hunt.provenance.get("model"), forward, "the hunt was")
    warnings = [] if difference is None else [difference]
    write_replay(hunt, out, model=forward, source=model_option(model))
    for warning in warnings:
        terminal.say(f"warning: {warning}")
    tell(
        {"out": str(out), "bytes": out.stat().st_size, "warnings": warnings},
        as_json,
        f"{out}: open it in a browser to play the hunt",
    )


@app.command(short_help="Write a page about an evaluation, with hunts to play.")
def report(
    results: Annotated[Path, typer.Argument(help="Folder made by bayeshunt evaluate --out.", show_default=False)],
    out: Annotated[Path, out_file("Page (HTML) to write.", "pages", ".html")],
    model: Model = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Write a page with the table and figures of an evaluation, and hunts to play.

    The hunts of its gallery are made again from their seeds; without --model the model is learned
    again from the settings and the seed, as evaluate does.

    Example:  bayeshunt report results --out report.html
    """
    from bayeshunt.experiments.store.export import load_results
    from bayeshunt.models.formats.interchange import open_model
    from bayeshunt.views.pages.report import write_report
    from bayeshunt.views.terminal import terminal

    frame = load_results(results)
    forward = None if model is None else open_model(model, settings_of(frame, results).robot.gaits)
    total = len(frame[["planner", "arena"]].drop_duplicates())
    with terminal.progress_bar("replaying", total, quiet=quiet or as_json) as advance:
        name = None if model is None else str(model)
        warnings = write_report(frame, out, model=forward, model_path=name, progress=advance)
    for warning in warnings:
        terminal.say(f"warning: {warning}")
    facts = {"out": str(out), "bytes": out.stat().st_size, "hunts": len(frame), "warnings": warnings}
    tell(facts, as_json, f"{out}: {len(frame)} hunts; open it in a browser")
