"""assess: is the model any good, and what does the paper's assumption cost?"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from bayeshunt.cli.app import app
from bayeshunt.cli.options import Json, Quiet, Seed
from bayeshunt.cli.outputs import out_figure
from bayeshunt.core.errors import InputError

_BINS = "(default: the model's, or {})"


@app.command(short_help="Is the model any good? Scores, tests, other structures.")
def assess(
    data: Annotated[Path, typer.Argument(help="Babbling table made by bayeshunt babble.", show_default=False)],
    model: Annotated[Path | None, typer.Option(help="Model file: its bins and structure, its own scores too.")] = None,
    folds: Annotated[int, typer.Option(help="Folds of the cross-validation.")] = 5,
    seed: Seed = 0,
    prior: Annotated[float, typer.Option(help="Dirichlet pseudo-count per cell of every table fitted.")] = 0.03,
    structure: Annotated[
        list[str] | None, typer.Option(help="Compare with this structure; may be given several times. Default: all.")
    ] = None,
    permutations: Annotated[int, typer.Option(help="Shuffles of each independence test.")] = 999,
    distance_bin: Annotated[float | None, typer.Option(help="Distance bin [body lengths] " + _BINS.format(0.1))] = None,
    angle_bins: Annotated[int | None, typer.Option(help="Angle bins " + _BINS.format(36))] = None,
    heading_bins: Annotated[int | None, typer.Option(help="Heading bins " + _BINS.format(36))] = None,
    robot: Annotated[str | None, typer.Option(help="Robot preset or TOML, if the table does not say.")] = None,
    out: Annotated[Path | None, out_figure("Write the reliability diagram: a .png or .svg file.")] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Score held-out predictions, test the naive Bayes assumption, and compare other structures.

    Example:  bayeshunt assess babbling.parquet --folds 5 --out reliability.png
    """
    from bayeshunt.config.loading import load_robot, recorded_gaits
    from bayeshunt.data import babbling_table
    from bayeshunt.data.ingesting import LogOptions, babbling_from, needs_ingesting
    from bayeshunt.models.assessment.assess import assess as run
    from bayeshunt.models.formats.interchange import open_model
    from bayeshunt.views.terminal import terminal

    frame = (
        babbling_from([data], LogOptions()) if data.exists() and needs_ingesting(data) else babbling_table.load(data)
    )
    forward = None if model is None else open_model(model)
    gaits = None if robot is None else load_robot(robot).gaits
    if gaits is None and forward is None:
        gaits = recorded_gaits(frame)
    widths = (distance_bin, angle_bins, heading_bins)
    axes = _axes(frame, gaits, forward, widths)
    with terminal.progress_bar("assessing", None, quiet=quiet or as_json):
        result = run(
            frame, gaits, model=forward, folds=folds, seed=seed, prior=prior, axes=axes,
            structures=structure or None, permutations=permutations,
        )  # fmt: skip
    if out is not None:
        from bayeshunt.views.figures.assessment import write

        write(result, out)
    if as_json:
        typer.echo(json.dumps({**result.to_dict(), "out": None if out is None else str(out)}))
        return
    from bayeshunt.views.terminal.assessment import assessment_tables

    assessment_tables(result)


def _axes(frame: Any, gaits: Any, model: Any, widths: tuple[float | None, int | None, int | None]) -> Any:
    """Axes of the bins asked for, or None if none was."""
    from bayeshunt.config.loading import recorded_gaits
    from bayeshunt.core.bins import EffectAxes

    if all(width is None for width in widths):
        return None
    if model is not None:
        raise InputError("--model brings its own bins: leave out --distance-bin, --angle-bins and --heading-bins")
    body_length = (gaits if gaits is not None else recorded_gaits(frame)).body_length
    names = ("distance_bin", "angle_bins", "heading_bins")
    given: dict[str, Any] = {name: width for name, width in zip(names, widths, strict=True) if width is not None}
    if not all(width > 0 for width in given.values()):
        raise InputError("bins: expected a width or numbers above 0")
    return EffectAxes.standard(body_length, **given)
