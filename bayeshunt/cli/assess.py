"""assess, score: is the model any good, what does the paper's assumption cost, and what does it foresee?"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from bayeshunt.cli import ingest
from bayeshunt.cli.app import app
from bayeshunt.cli.options import Json, Quiet, Seed, asked_backoff, gaits_of
from bayeshunt.cli.outputs import out_figure, out_file, out_folder, say_written
from bayeshunt.core.errors import InputError

__all__ = ["assess", "score"]

_BINS = "(default: the model's, or {})"


@app.command(short_help="Is the model any good? Scores, tests, other structures.")
@ingest.reads_logs
def assess(
    data: Annotated[Path, typer.Argument(help="Babbling table made by bayeshunt babble.", show_default=False)],
    model: Annotated[Path | None, typer.Option(help="Model file: its bins and structure, its own scores too.")] = None,
    folds: Annotated[int, typer.Option(help="Folds of the cross-validation.")] = 5,
    seed: Seed = 0,
    prior: Annotated[float, typer.Option(help="Dirichlet pseudo-count per cell of every table fitted.")] = 0.03,
    structure: Annotated[
        list[str] | None, typer.Option(help="Compare with this structure; may be given several times. Default: all.")
    ] = None,
    backoff: Annotated[
        float | None,
        typer.Option(
            help="Of previous_gait: rows that a gait's own table is worth after each gait; 0: the prior alone.",
            show_default="the model's, or 5",
        ),
    ] = None,
    permutations: Annotated[int, typer.Option(help="Shuffles of each independence test.")] = 999,
    distance_bin: Annotated[float | None, typer.Option(help="Distance bin [body lengths] " + _BINS.format(0.1))] = None,
    angle_bins: Annotated[int | None, typer.Option(help="Angle bins " + _BINS.format(36))] = None,
    heading_bins: Annotated[int | None, typer.Option(help="Heading bins " + _BINS.format(36))] = None,
    auto_bins: Annotated[
        bool, typer.Option("--auto-bins", help="Bins of the highest held-out density, chosen by these rows.")
    ] = False,
    robot: Annotated[str | None, typer.Option(help="Robot preset or TOML, if the table does not say.")] = None,
    asked: Any = None,
    csv: Annotated[Path | None, out_folder("Write every table as CSV into this folder.")] = None,
    out: Annotated[Path | None, out_figure("Write the reliability diagram: a .png or .svg file.")] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Score held-out predictions, test the naive Bayes assumption, and compare other structures.

    Warns where the tables foresee worse than ignoring the gait does, and where other bins would do much better.

    Example:  bayeshunt assess babbling.parquet --folds 5 --out reliability.png;
    bayeshunt assess log.csv --time-step 1 --gaits 9 --auto-bins
    """
    from bayeshunt.config.loading import recorded_gaits
    from bayeshunt.data.babbling_table import PROVENANCE_KEY
    from bayeshunt.models.assessment.assess import assess as run
    from bayeshunt.models.formats.interchange import open_model
    from bayeshunt.views.terminal import terminal

    frame, notes = ingest.babbled(data, asked)
    for note in () if as_json else notes:
        terminal.say(note)
    forward = None if model is None else open_model(model)
    known = None if robot is None else gaits_of(robot, [frame.attrs.get(PROVENANCE_KEY)])
    if known is None and forward is None:
        known = recorded_gaits(frame)
    axes = _axes(frame, known, forward, (distance_bin, angle_bins, heading_bins), auto_bins)
    with terminal.progress_bar("assessing", None, quiet=quiet or as_json):
        result = run(
            frame, known, model=forward, folds=folds, seed=seed, prior=prior, axes=axes,
            structures=structure or None, permutations=permutations,
            backoff=asked_backoff(backoff),
        )  # fmt: skip
    if out is not None:
        from bayeshunt.views.figures.assessment import reliability
        from bayeshunt.views.figures.style import write

        write(reliability(result), out)
    if csv is not None:
        _write_tables(result, csv)
    if as_json:
        typer.echo(json.dumps({**result.to_dict(), "out": None if out is None else str(out)}))
        return
    from bayeshunt.views.terminal.assessment import assessment_tables

    assessment_tables(result)
    say_written(out, csv)


def _write_tables(result: Any, folder: Path) -> None:
    from bayeshunt.files.atomic import write_text

    folder.mkdir(parents=True, exist_ok=True)
    for name in ("variables", "structures", "confusion", "independence", "reliability"):
        table = getattr(result, name)
        write_text(folder / f"{name}.csv", table.to_csv(index=table.index.name is not None))


def _axes(frame: Any, gaits: Any, model: Any, widths: tuple[float | None, int | None, int | None], auto: bool) -> Any:
    """Axes of the bins asked for, or None if none was."""
    from bayeshunt.config.loading import recorded_gaits
    from bayeshunt.core.bins import EffectAxes

    if all(width is None for width in widths) and not auto:
        return None
    if model is not None:
        raise InputError("--model brings its own bins: leave out --distance-bin, --angle-bins, --heading-bins, "
                         "--auto-bins")  # fmt: skip
    if auto:
        return "auto"
    body_length = (gaits if gaits is not None else recorded_gaits(frame)).body_length
    names = ("distance_bin", "angle_bins", "heading_bins")
    given: dict[str, Any] = {name: width for name, width in zip(names, widths, strict=True) if width is not None}
    if not all(width > 0 for width in given.values()):
        raise InputError("bins: expected a width or numbers above 0")
    return EffectAxes.standard(body_length, **given)


@app.command(short_help="Score the pose after a gait, beside simple kinematics.")
@ingest.reads_logs
def score(
    data: Annotated[Path, typer.Argument(help="Babbling table, or a log, of one robot.", show_default=False)],
    model: Annotated[
        list[str] | None,
        typer.Option(
            help="stays, unicycle, unicycle_lag, table, previous_gait or residual; may be repeated. Default: all."
        ),
    ] = None,
    folds: Annotated[int, typer.Option(help="Folds of the cross-validation.")] = 5,
    folds_by: Annotated[
        str | None, typer.Option(help="Column whose values stay together, such as the number of a held command.")
    ] = None,
    seed: Seed = 0,
    asked: Any = None,
    out: Annotated[Path | None, out_file("Write the table as CSV.", "tables of scores", ".csv")] = None,
    figure: Annotated[Path | None, out_figure("Draw it: a .png or .svg file.")] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Score the pose after a gait as models foresee it that have not counted it.

    Clusters of the command are found anew in each fold's training rows.

    Example:  bayeshunt score log.csv --time-step 1 --gaits 25 --folds-by run --figure scores.png
    """
    from bayeshunt.data.command_gaits import AUTO
    from bayeshunt.data.logs import command_columns
    from bayeshunt.files.atomic import write_text
    from bayeshunt.models.assessment.forward_scores import COMMANDED, MODELS, score_forward
    from bayeshunt.views.terminal import terminal
    from bayeshunt.views.terminal.scores import forward_table

    frame, notes = ingest.babbled(data, asked)
    for note in () if as_json else notes:
        terminal.say(note)
    commands = command_columns(frame.columns)
    chosen = model or [name for name in MODELS if commands or name not in COMMANDED]
    number: Any = asked.gaits if commands and (isinstance(asked.gaits, int) or asked.gaits == AUTO) else None
    with terminal.progress_bar("scoring", None, quiet=quiet or as_json):
        table = score_forward(frame, number, chosen, folds_by, folds, seed)
    if out is not None:
        write_text(out, table.to_csv(index=False))
    if figure is not None:
        from bayeshunt.views.figures.scores import forward_scores
        from bayeshunt.views.figures.style import write

        write(forward_scores(table), figure)
    if as_json:
        typer.echo(json.dumps(json.loads(table.to_json(orient="records"))))
        return
    forward_table(table, folds_by)
    say_written(out, figure)
