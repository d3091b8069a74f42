"""evaluate, status: the whole experiment, and how far it is."""

from __future__ import annotations

import json
import shlex
from pathlib import Path
from typing import Annotated

import typer

from bayeshunt.cli.app import app
from bayeshunt.cli.options import (
    Arenas,
    Config,
    Jobs,
    Json,
    Model,
    Overrides,
    Planners,
    Preset,
    Quiet,
    Runs,
    Seed,
    check_names,
    count_hunts,
    read_experiment,
    say_chosen,
)
from bayeshunt.cli.outputs import out_folder
from bayeshunt.cli.stopping import stoppable
from bayeshunt.core.errors import InputError

__all__ = ["evaluate", "status"]


@app.command(short_help="Run the paper's experiment: its table beside ours.")
def evaluate(
    model: Model = None,
    preset: Preset = None,
    config: Config = None,
    overrides: Overrides = None,
    planner: Planners = None,
    arena: Arenas = None,
    structure: Annotated[
        str | None,
        typer.Option(help="Of the model that is learned: naive (the paper), tan, joint, previous_gait or learned."),
    ] = None,
    runs: Runs = None,
    seed: Seed = 0,
    jobs: Jobs = -1,
    scheduler: Annotated[
        str | None, typer.Option(help="Work on a dask cluster: local, or an address such as tcp://host:8786.")
    ] = None,
    out: Annotated[
        Path | None, out_folder("Folder of the results. Every hunt is kept as it ends; the same line goes on.")
    ] = None,
    per_theta: Annotated[bool, typer.Option("--per-theta", help="Show every bearing, not just the totals.")] = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Run the paper's experiment and print its table beside ours.

    Without --model the robot babbles and the model is fitted first. With --out, an evaluation that was
    stopped, by whatever, goes on from where it was when the same line is given again.

    Example:  bayeshunt evaluate --runs 100 --seed 0 --out results
    """
    from bayeshunt.experiments.run import runner
    from bayeshunt.experiments.store import export
    from bayeshunt.models.formats.interchange import open_model
    from bayeshunt.views.terminal import terminal

    if structure is not None:
        if model is not None:
            raise InputError("--structure: the model given with --model has its own; choose one")
        overrides = [*(overrides or ()), f"model.structure={structure}"]
    settings = runner.experiment_settings(read_experiment(preset, config, overrides, model), runs)
    planners = check_names(settings, planner, arena)
    runner.check_jobs(jobs)
    forward = None if model is None else open_model(model, settings.robot.gaits)
    total = count_hunts(settings, planners, arena)
    with stoppable(lambda: _kept(out)), terminal.progress_bar("hunting", total, quiet=quiet or as_json) as advance:
        results = runner.evaluate(
            settings, seed=seed, jobs=jobs, planners=planners, arenas=arena, model=forward, out=out,
            scheduler=scheduler, progress=advance, say=terminal.say,
        )  # fmt: skip
    facts = export.summary(results, settings, seed)
    if as_json:
        typer.echo(json.dumps(facts))
        return
    terminal.success_table(facts, per_theta=per_theta)
    say_chosen(settings, preset, config, model)
    if out is not None:
        page = f"bayeshunt report {shlex.quote(str(out))} --out report.html"
        terminal.say(f"every hunt and the summary are in {out}; next: {page}")


@app.command(short_help="Show how far an evaluation is.")
def status(
    folder: Annotated[Path, typer.Argument(help="Folder given to evaluate --out.", show_default=False)],
    as_json: Json = False,
) -> None:
    """Show how far an evaluation is: hunts ended, rate and time left. It may be running; nothing is disturbed.

    Example:  bayeshunt status results
    """
    from bayeshunt.experiments.store.status import status as read

    found = read(folder)
    if as_json:
        typer.echo(json.dumps(found.to_dict()))
        return
    from bayeshunt.views.terminal import terminal

    terminal.status_table(found)


def _kept(out: Path | None) -> str:
    """What an evaluation that was stopped leaves behind."""
    from bayeshunt.experiments.store.database import DATABASE_FILE
    from bayeshunt.experiments.store.status import status as read

    if out is None:
        return "nothing is kept without --out"
    if not (out / DATABASE_FILE).exists():
        return f"nothing is in {out} yet; give the same line again to start anew"
    found = read(out)
    return f"{found.ended} of {found.planned} hunts are kept in {out}; give the same line again to go on"
