"""figures, export: the paper's figures as files, the tables as CSV."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from bayeshunt.cli.app import app
from bayeshunt.cli.options import (
    Config,
    Json,
    Model,
    Overrides,
    Preset,
    Quiet,
    Seed,
    count_hunts,
    load_or_learn,
    read_experiment,
    say_chosen,
    settings_of,
    tell,
)
from bayeshunt.cli.outputs import out_file, out_folder
from bayeshunt.core.errors import InputError

__all__ = ["export", "figures"]


@app.command(short_help="Draw the figures of the paper, as PNG and SVG.")
def figures(
    out: Annotated[Path, out_folder("Folder for the figures, each as PNG and SVG.")],
    model: Model = None,
    results: Annotated[
        Path | None,
        typer.Option(help="Results folder of evaluate --out, with its own settings; by default the hunts are run now."),
    ] = None,
    preset: Preset = None,
    config: Config = None,
    overrides: Overrides = None,
    runs: Annotated[int | None, typer.Option(help="Runs per bearing when hunts are run now.")] = None,
    seed: Seed = 0,
    jobs: Annotated[int, typer.Option(help="Worker processes; -1 for one per core.")] = -1,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Draw the figures of the paper from a model, two hunts and the results of an evaluation.

    Example:  bayeshunt figures --out figures --results results
    """
    from bayeshunt.experiments.run import runner
    from bayeshunt.experiments.store import export
    from bayeshunt.views import figures as drawing
    from bayeshunt.views.terminal import terminal

    runner.check_jobs(jobs)
    if results is not None and overrides:
        raise InputError("--set changes hunts that are run now; --results brings its own settings: leave one out")
    hunts = None if results is None else export.load_results(results)
    settings = (
        runner.experiment_settings(read_experiment(preset, config, overrides, model), runs)
        if hunts is None
        else settings_of(hunts, results)
    )
    folder = export.check_output_folder(out)
    forward = load_or_learn(model, settings, seed, quiet=quiet or as_json)
    if hunts is None:
        hunts = _run(settings, forward, seed, jobs, quiet or as_json)
    elif (difference := export.another_model(hunts.attrs.get("model"), forward)) is not None:
        terminal.say(f"warning: {difference}")
    planned, learned = _hunts(settings, forward, seed)
    written = drawing.save_all(drawing.paper_figures(forward, planned, learned, hunts, settings), folder)
    names = [path.name for path in written]
    tell({"out": str(out), "experiment": settings.name, "files": names}, as_json, _listed(out, names))
    if results is None and not as_json:
        say_chosen(settings, preset, config, model)


def _run(settings: Any, model: Any, seed: int, jobs: int, quiet: bool) -> Any:
    """Every hunt of the protocol, with a progress bar."""
    from bayeshunt.experiments.run import runner
    from bayeshunt.views.terminal import terminal

    total = count_hunts(settings, settings.planners, None)
    with terminal.progress_bar("hunting", total, quiet=quiet) as advance:
        return runner.evaluate(settings, seed=seed, jobs=jobs, model=model, progress=advance)


def _hunts(settings: Any, model: Any, seed: int) -> tuple[Any, Any]:
    """A hunt that plans, in the open if there is one, and a long one whose prey meets walls if there are any."""
    from bayeshunt.episodes.loop import hunt
    from bayeshunt.experiments.preparation import own_settings
    from bayeshunt.planners.registry import make_planner

    arenas, thetas = settings.arenas, settings.protocol.thetas
    unwalled = next((name for name, arena in arenas.items() if not arena.walled), next(iter(arenas)))
    walled = next((name for name, arena in arenas.items() if arena.walled), unwalled)
    theta = thetas[min(1, len(thetas) - 1)]
    planned, learned = (
        hunt(settings, make_planner(name, model, **own_settings(settings, name)), arena=arena, theta=theta, seed=seed)
        for name, arena in (("planning", unwalled), ("reactive", walled))
    )
    return planned, learned


@app.command(short_help="Write every table of a model as CSV.")
def export(
    model: Annotated[
        Path, typer.Argument(help="Model file made by bayeshunt fit, or a network (.xmlbif, .bif).", show_default=False)
    ],
    out: Annotated[Path, out_folder("Folder for the CSV files.")],
    xmlbif: Annotated[
        Path | None,
        out_file("Also export the network as XMLBIF, its labels beside it.", "networks", ".xmlbif", within_out=True),
    ] = None,
    page: Annotated[
        Path | None,
        out_file("Also write the network as a page on which a click sets evidence.", "pages", ".html", within_out=True),
    ] = None,
    as_json: Json = False,
) -> None:
    """Write every table of a model as CSV: probability, count and 95 % interval of each cell.

    Example:  bayeshunt export model.json --out tables --xmlbif tables/model.xmlbif --page tables/network.html
    """
    from bayeshunt.experiments.store.export import check_output_folder
    from bayeshunt.models.formats.interchange import open_model
    from bayeshunt.models.formats.xmlbif import labels_path

    forward = open_model(model)
    names = [path.name for path in forward.to_csv(check_output_folder(out))]
    lines = [_listed(out, names)]
    if xmlbif is not None:
        forward.to_xmlbif(xmlbif)
        lines += [str(xmlbif), f"{labels_path(xmlbif)}: what its states are called"]
    if page is not None:
        from bayeshunt.models.inference.network import Network

        Network(forward).save(page)
        lines.append(f"{page}: open it in a browser; a click on a state sets evidence")
    facts = {"out": str(out), "files": names, **{k: v and str(v) for k, v in (("xmlbif", xmlbif), ("page", page))}}
    tell(facts, as_json, "\n".join(lines))


def _listed(folder: Path, names: list[str]) -> str:
    """The files of a folder, one line for those that differ in their ending alone: "name.png, .svg"."""
    endings: dict[str, list[str]] = {}
    for name in names:
        stem, _, ending = name.rpartition(".")
        endings.setdefault(stem, []).append(ending)
    files = "file" if len(names) == 1 else "files"
    return "\n".join([f"{folder}: {len(names)} {files}", *(f"  {k}.{', .'.join(v)}" for k, v in endings.items())])
