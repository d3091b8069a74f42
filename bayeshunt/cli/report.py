"""replay, report: pages to look at, from files that hunt and evaluate wrote."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bayeshunt.cli.app import app
from bayeshunt.cli.options import Json, Model, Quiet, settings_of, tell
from bayeshunt.cli.outputs import Video, out_file, write_film

__all__ = ["replay", "report"]


@app.command(short_help="Write a page that plays recorded hunts.")
def replay(
    episodes: Annotated[
        list[Path],
        typer.Argument(help="Episodes made by bayeshunt hunt --out; more than one play in step.", show_default=False),
    ],
    out: Annotated[Path, out_file("Page (HTML) to write.", "pages", ".html")],
    model: Annotated[
        Path | None,
        typer.Option(
            help="Their model: draws where gaits were expected to lead, and opens posteriors down to the babbled rows."
        ),
    ] = None,
    video: Video = None,
    as_json: Json = False,
) -> None:
    """Write a page that plays recorded hunts with all that was considered, offline, in any browser.

    Example:  bayeshunt replay hunt.parquet --out hunt.html;
    bayeshunt replay planning.parquet reactive.parquet --out both.html
    """
    from bayeshunt.episodes.episode import Episode
    from bayeshunt.experiments.store.export import another_model
    from bayeshunt.models.formats.interchange import open_model
    from bayeshunt.views.pages.commands import model_option
    from bayeshunt.views.pages.replay import write_replay
    from bayeshunt.views.terminal import terminal

    forward = None if model is None else open_model(model)
    hunts = [Episode.load(episode) for episode in episodes]
    models = [] if forward is None else [hunt.provenance.get("model") for hunt in hunts]
    found = [another_model(made, forward, "the hunt was") for made in models]  # type: ignore[arg-type]
    warnings = list(dict.fromkeys(difference for difference in found if difference is not None))
    write_replay(hunts, out, model=forward, source=model_option(model))
    for warning in warnings:
        terminal.say(f"warning: {warning}")
    words = f"{out}: open it in a browser to play {'the hunt' if len(hunts) == 1 else f'{len(hunts)} hunts in step'}"
    if video is not None:
        words += f"\n{write_film(hunts[0], video)}"
    facts = {
        "out": str(out),
        "bytes": out.stat().st_size,
        **({"video": str(video)} if video else {}),
        "warnings": warnings,
    }
    tell(facts, as_json, words)


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
