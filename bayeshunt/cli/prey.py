"""prey: the behaviours of simulated prey; models of recorded ones, fitted and scored."""

from __future__ import annotations

import inspect
import json
import shlex
from pathlib import Path
from typing import Annotated, Any

import typer

from bayeshunt.cli.app import app
from bayeshunt.cli.options import Json, Quiet, Seed, tell
from bayeshunt.cli.outputs import out_figure, out_file, say_written
from bayeshunt.core.errors import InputError

__all__ = ["behaviours_of_prey", "fit_prey", "follow_prey", "prey", "score"]

prey = typer.Typer(rich_markup_mode=None, context_settings={"help_option_names": ["-h", "--help"]})
app.add_typer(prey, name="prey", short_help="List the behaviours of prey; fit and score models of recorded prey.")

_NONE = "none"


@prey.callback(invoke_without_command=True)
def behaviours_of_prey(context: typer.Context, as_json: Json = False) -> None:
    """List the behaviours a prey may have; --plugin adds your own.

    Example:  bayeshunt evaluate --set prey.behaviour=evader
    """
    if context.invoked_subcommand is not None:
        return
    from bayeshunt.views.terminal import catalogue
    from bayeshunt.worlds.prey.behaviours import behaviours

    said = {name: (inspect.getdoc(made) or "").split("\n\n")[0] for name, made in behaviours().items()}
    rows = [(name, text.replace("\n", " ")) for name, text in said.items()]
    if as_json:
        typer.echo(json.dumps([{"behaviour": name, "description": text} for name, text in rows]))
        return
    notes = ["Choose one: --set prey.behaviour=NAME, or behaviour = \"NAME\" under [prey] in a settings file.",
             "What else a prey can be set to: the keys prey.* of bayeshunt settings"]  # fmt: skip
    catalogue.names_table(("behaviour", "what it does"), rows, notes)


@prey.command("fit", short_help="Fit a prey model to recorded tracks.")
def fit_prey(
    files: Annotated[list[Path], typer.Argument(help="Tracks made by bayeshunt ingest tracks.", show_default=False)],
    out: Annotated[Path, out_file("Prey model (JSON) to write.", "prey models", ".json")],
    time_step: Annotated[float | None, typer.Option(help="Seconds of one transition; default: those of a row.")] = None,
    standing: Annotated[float | None, typer.Option(help="Slower than this [m/s] is standing.")] = None,
    given: Annotated[str, typer.Option(help="Transitions by this too: speed, or none.")] = "speed",
    residual_of: Annotated[str, typer.Option(help="Count what this misses: constant_velocity, stands or none.")] = (
        "constant_velocity"
    ),
    seen: Annotated[int, typer.Option(help="Places that are known, the present one included.")] = 8,
    steps: Annotated[int, typer.Option(help="Places that are foreseen at once.")] = 12,
    csv: Annotated[
        Path | None, out_file("Write every cell, its count and its 95 % interval, as CSV.", "tables of cells", ".csv")
    ] = None,
    as_json: Json = False,
) -> None:
    """Fit a model of how recorded people or animals move.

    Example:  bayeshunt prey fit tracks.parquet --time-step 0.8 --out prey.json
    """
    from bayeshunt.data.transitions import transitions
    from bayeshunt.files.atomic import write_text
    from bayeshunt.models.target.prey import PreyModel

    frame = _tracks(files)
    rows = transitions(frame, time_step, standing, seen=seen, steps=steps)
    model = PreyModel.fit(rows, _or_none(given), _or_none(residual_of))
    model.save(out)
    if csv is not None:
        write_text(csv, model.cpt().to_csv())
    step = float(rows["time_step"].iloc[0])
    facts = {
        "out": str(out), "transitions": model.observations, "time_step": step, "cells": len(model.counts),
        "given": _or_none(given), "residual_of": _or_none(residual_of),
    }  # fmt: skip
    tell(facts, as_json, "\n".join([_counted(facts, frame), *_next_of(files, out, step, frame)]))
    if not as_json:
        say_written(csv)


def _counted(facts: dict[str, Any], frame: Any) -> str:
    """What was counted, and why there may be more transitions than steps."""
    from bayeshunt.data.steps import native_step

    native, step = native_step(frame), facts["time_step"]
    lines = f"{facts['out']}: {facts['transitions']} transitions of {step:g} s in {facts['cells']} cells, " \
            f"from {len(frame)} rows"  # fmt: skip
    if step > 1.5 * native:
        lines += f" {native:.3g} s apart: each row starts one, so they overlap"
    if facts["transitions"] > len(frame):
        lines += "; rows missing for up to a time-step were filled in on a straight line"
    return lines


def _next_of(files: list[Path], out: Path, step: float, frame: Any) -> list[str]:
    """How good it is: on these tracks, parts held out; on others, as it is."""
    on = " ".join(f"--on {shlex.quote(str(path))}" for path in files)
    split = "" if frame["id"].nunique() > 1 else " --split time"
    return [
        f"next: bayeshunt prey score {on} --time-step {step:g}{split}   (parts held out in turn)",
        f"or, with recordings that it has not counted: bayeshunt prey score {shlex.quote(str(out))} --on THOSE.parquet",
    ]


@prey.command("score", short_help="Score a prey model on other tracks, beside baselines.")
def score(
    model: Annotated[
        Path | None, typer.Argument(help="Prey model made by prey fit; without it, models are fitted to folds.")
    ] = None,
    on: Annotated[list[Path] | None, typer.Option("--on", help="Tracks to score on; may be repeated.")] = None,
    time_step: Annotated[float | None, typer.Option(help="Seconds a step; default: the model's, or a row's.")] = None,
    seen: Annotated[int, typer.Option(help="Places that are known.")] = 8,
    steps: Annotated[int, typer.Option(help="Places that are foreseen.")] = 12,
    split: Annotated[str, typer.Option(help="What is held out: individual, scene or time.")] = "individual",
    seed: Seed = 0,
    out: Annotated[Path | None, out_file("Write the table as CSV.", "tables of scores", ".csv")] = None,
    figure: Annotated[Path | None, out_figure("Draw it: a .png or .svg file.")] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Score forecasts: error, best of 20, energy, density and coverage, beside standing still and constant velocity.

    Example:  bayeshunt prey score prey.json --on other.parquet;  bayeshunt prey score --on all.parquet --split scene
    """
    from bayeshunt.files.atomic import write_text
    from bayeshunt.models.assessment.prey_scores import score_prey
    from bayeshunt.models.target.prey import PreyModel
    from bayeshunt.views.terminal import terminal
    from bayeshunt.views.terminal.scores import scores_table

    if not on:
        raise InputError("prey score: nothing to score on; give tracks with --on")
    models: dict[str, Any] | None = None
    if model is not None:
        fitted = PreyModel.load(model)
        step = None if fitted.conditions is None else fitted.conditions.time_step
        time_step = time_step if time_step is not None else step
        models = {"stands": "stands", "constant_velocity": "constant_velocity", str(model): fitted}
    frame = _tracks(on)
    if not (quiet or as_json):
        terminal.say(f"scoring forecasts of {steps} steps on {len(frame)} rows; this may take a minute")
    with terminal.progress_bar("scoring", None, quiet=quiet or as_json):
        table = score_prey(frame, models, seen, steps, time_step, split, seed)
    if out is not None:
        write_text(out, table.to_csv(index=False))
    unit = "m" if "unit" not in frame or frame["unit"].isna().all() else str(frame["unit"].dropna().iloc[0])
    if figure is not None:
        from bayeshunt.views.figures.scores import prey_scores
        from bayeshunt.views.figures.style import write

        write(prey_scores(table, unit), figure)
    if as_json:
        typer.echo(json.dumps(json.loads(table.to_json(orient="records"))))
        return
    scores_table(table, unit)
    say_written(out, figure)


@prey.command("follow", short_help="Follow recorded walkers: catch them, keep them company.")
def follow_prey(
    folder: Annotated[Path, typer.Argument(help="Folder of tracks, a file a scene.", show_default=False)],
    rate: Annotated[float | None, typer.Option(help="Rows (frames) per second of files that do not say.")] = None,
    unit: Annotated[str | None, typer.Option(help="Unit of x and y in them: m, cm, mm.")] = None,
    scene: Annotated[
        list[str] | None, typer.Option(help="File whose walkers are followed; may be repeated. Default: all.")
    ] = None,
    walkers: Annotated[int, typer.Option(min=1, help="Walkers followed, in all.")] = 200,
    model: Annotated[
        list[str] | None,
        typer.Option(
            help="counts (the paper's), table (of other people), constant_velocity, conditioned. Default: all."
        ),
    ] = None,
    planner: Annotated[str, typer.Option(help="Planner that follows, the same for all.")] = "planning",
    band: Annotated[str, typer.Option(help="Distances that are company, NEAR,FAR [m].")] = "0.5,2.5",
    seed: Seed = 0,
    out: Annotated[Path | None, out_file("Write every hunt as CSV.", "tables of hunts", ".csv")] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Follow people: a hunter of a person's size and pace after recorded walkers, one prey model after the other.

    Models are compared in pairs, on the same walkers; table and conditioned are learned from the other scenes.

    Example:  bayeshunt prey follow recordings --rate 2.5 --unit m --scene zara01.txt --walkers 50
    """
    from bayeshunt.experiments.studies import following
    from bayeshunt.files.atomic import write_text
    from bayeshunt.views.terminal import terminal
    from bayeshunt.views.terminal.scores import following_table

    ends = _band(band)
    chosen = list(model or following.MODELS)
    people = _scenes(folder, rate, unit)
    with terminal.progress_bar("following", walkers * len(chosen), quiet=quiet or as_json) as advance:
        hunts = following.follow(
            people, scene, walkers, planner=planner, models=chosen, seed=seed, band=ends, progress=advance
        )
    if out is not None:
        write_text(out, hunts.to_csv(index=False))
    table = following.summary(hunts)
    if as_json:
        typer.echo(json.dumps(json.loads(table.to_json(orient="records"))))
        return
    following_table(table, ends)
    say_written(out)


def _band(text: str) -> tuple[float, float]:
    try:
        near, far = (float(part) for part in text.split(","))
    except ValueError:
        raise InputError(f"--band {text}: expected NEAR,FAR, two distances in metres") from None
    return near, far


def _scenes(folder: Path, rate: float | None, unit: str | None) -> Any:
    """Every table of tracks in a folder, a scene a file."""
    import pandas as pd

    from bayeshunt.data import tracks

    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder; give one with recordings of people, a file a scene")
    files = sorted(path for path in folder.iterdir() if path.suffix.lower() in (".txt", ".csv", ".parquet"))
    if not files:
        raise InputError(f"{folder}: holds no .txt, .csv or .parquet file of tracks")
    parts = [tracks.load(path) if path.suffix == ".parquet" else tracks.read_tracks(path, rate, unit) for path in files]
    return pd.concat([part.assign(scene=path.name) for part, path in zip(parts, files, strict=True)], ignore_index=True)


def _tracks(files: list[Path]) -> Any:
    import pandas as pd

    from bayeshunt.data import tracks

    parts = [tracks.load(path) for path in files]
    return parts[0] if len(parts) == 1 else pd.concat(parts, ignore_index=True)


def _or_none(name: str) -> str | None:
    return None if name == _NONE else name
