"""sweep, tradeoff: what the results owe to a setting, and what a quicker catch costs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from bayeshunt.cli.app import app
from bayeshunt.cli.options import (
    Arenas,
    Config,
    Jobs,
    Json,
    Overrides,
    Planners,
    Preset,
    Quiet,
    Runs,
    Seed,
    check_names,
    complete_planner,
    count_hunts,
    read_experiment,
    toml_value,
)
from bayeshunt.cli.outputs import out_folder
from bayeshunt.cli.stopping import stoppable
from bayeshunt.core.errors import ConfigError, InputError

__all__ = ["sweep", "tradeoff"]


@app.command(short_help="Vary settings: success and catch time, with a figure.")
def sweep(
    axis: Annotated[
        list[str] | None,
        typer.Option(help="What to vary (default: speed_ratio): speed_ratio, gait_duration, noise, slip, "
                     "babbling_steps, gaits, max_transitions or a key such as prey.speed; NAME, or NAME=VALUE,VALUE, "
                     "with values such as 0.05, or +5% of the settings' own. "
                     "May be given several times."),
    ] = None,
    grid: Annotated[Path | None, typer.Option(help="Your own grid: a TOML file with NAME = [VALUES].")] = None,
    preset: Preset = None,
    config: Config = None,
    overrides: Overrides = None,
    planner: Planners = None,
    arena: Arenas = None,
    runs: Runs = None,
    seed: Seed = 0,
    jobs: Jobs = -1,
    out: Annotated[
        Path | None, out_folder("Folder for the table, the figure and every hunt; the same line goes on.")
    ] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:  # fmt: skip
    """Vary settings and show success and catch time with their intervals, as a table and a figure.

    Example:  bayeshunt sweep --axis speed_ratio --arena open --runs 20 --out speed
    --planner prediction --planner planning --planner kinematic_limit
    """
    from bayeshunt.experiments.run import runner
    from bayeshunt.experiments.store import export
    from bayeshunt.experiments.studies.sweep import at_point, combinations
    from bayeshunt.experiments.studies.sweep import sweep as run
    from bayeshunt.views.terminal import terminal

    settings = read_experiment(preset, config, overrides)
    planners = check_names(settings, planner, arena)
    runner.check_jobs(jobs)
    chosen = _grid(axis, grid)
    points = [at_point(settings, values, runs) for values in combinations(chosen)]
    if out is not None:
        export.check_output_folder(out)
    total = sum(count_hunts(point, planners, arena) for point in points)
    with stoppable(lambda: _kept(out)), terminal.progress_bar("sweeping", total, quiet=quiet or as_json) as advance:
        frame = run(
            settings, chosen, runs=runs, seed=seed, jobs=jobs, planners=planners, arenas=arena, out=out,
            progress=advance,
        )  # fmt: skip
    files = [] if out is None else _write(frame, out)
    if as_json:
        typer.echo(json.dumps(_facts(frame, files)))
        return
    terminal.sweep_table(frame)
    for path in files:
        terminal.say(f"{path}")


def _kept(out: Path | None) -> str:
    """What a sweep that was stopped leaves behind."""
    if out is None:
        return "nothing is kept without --out"
    return f"the hunts that ended are kept in {out}; give the same line again to go on"


@app.command(short_help="Weigh catch time against distance and changes of gait.")
def tradeoff(
    vary: Annotated[
        list[str] | None,
        typer.Option(help="Weight to vary: distance, transitions, planning or energy; NAME, or NAME=VALUE,VALUE,..."),
    ] = None,
    preset: Preset = None,
    config: Config = None,
    overrides: Overrides = None,
    planner: Annotated[
        list[str] | None,
        typer.Option(help="Planner to show beside; may be given several times.", autocompletion=complete_planner),
    ] = None,
    arena: Annotated[str, typer.Option(help="Arena of the settings.")] = "open",
    runs: Runs = None,
    seed: Seed = 0,
    jobs: Jobs = -1,
    out: Annotated[Path | None, out_folder("Folder for the table and the figure.")] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Weigh the time of the catch against distance, changes of gait and planning (planner frugal).

    The weights stand in the settings: [planner.frugal] time, distance, transitions, planning, energy.

    Example:  bayeshunt tradeoff --vary transitions --vary distance=0,50,200 --runs 20 --out costs
    """
    from bayeshunt.experiments.run import runner
    from bayeshunt.experiments.store import export
    from bayeshunt.experiments.studies import tradeoff as costs
    from bayeshunt.views.terminal import terminal

    settings = read_experiment(preset, config, overrides)
    beside = check_names(settings, planner or ["prediction", "planning"], [arena])
    runner.check_jobs(jobs)
    varied = _varied(vary)
    if out is not None:
        export.check_output_folder(out)
    cases = len(beside) + sum(len(values) for values in varied.values())
    total = len(settings.protocol.thetas) * (settings.protocol.runs if runs is None else max(runs, 0)) * cases
    with terminal.progress_bar("weighing", total, quiet=quiet or as_json) as advance:
        frame = costs.tradeoff(
            settings, varied, runs=runs, seed=seed, jobs=jobs, planners=beside, arena=arena, progress=advance
        )
    files = [] if out is None else _write_tradeoff(frame, out)
    if as_json:
        typer.echo(json.dumps(_facts(frame, files)))
        return
    terminal.tradeoff_table(frame)
    for path in files:
        terminal.say(f"{path}")


def _varied(given: list[str] | None) -> dict[str, Any]:
    """The weights to vary and their values."""
    from bayeshunt.experiments.studies.tradeoff import VARIED

    varied: dict[str, Any] = {}
    for text in given or ["transitions"]:
        name, equals, values = text.partition("=")
        if name not in ("time", *VARIED) or not (equals or name in VARIED):
            raise InputError(f"--vary {text}: expected one of {', '.join(VARIED)}, or NAME=VALUE,VALUE,...")
        varied[name] = [toml_value(v.strip()) for v in values.split(",")] if equals else list(VARIED[name])
        for value in varied[name]:
            if isinstance(value, bool) or not isinstance(value, (int, float)):
                raise InputError(f"--vary {text}: {value!r} is not a number")
    return varied


def _write_tradeoff(frame: Any, folder: Path) -> list[Path]:
    """Write tradeoff.csv, tradeoff.json and the figure."""
    from bayeshunt.files.atomic import write_text
    from bayeshunt.views.figures.style import save
    from bayeshunt.views.figures.tradeoff import tradeoff_figure

    files = [folder / "tradeoff.csv", folder / "tradeoff.json"]
    write_text(files[0], frame.to_csv(index=False))
    write_text(files[1], json.dumps(_facts(frame, []), indent=1) + "\n")
    return files + save(tradeoff_figure(frame), folder, "tradeoff")


def _grid(axes: list[str] | None, path: Path | None) -> dict[str, Any]:
    """The grid of the options: ``--axis`` after what stands in the file."""
    from bayeshunt.experiments.studies.sweep import AXES

    grid: dict[str, Any] = {} if path is None else _read(path)
    for text in axes or ():
        name, equals, values = text.partition("=")
        if equals:
            listed = (
                toml_value(values) if values.startswith("[") else [toml_value(v.strip()) for v in values.split(",")]
            )
            grid[name.strip()] = listed
        elif name in AXES:
            grid[name] = list(AXES[name][1])
        else:
            raise InputError(f"--axis {text}: expected one of {', '.join(AXES)}, or NAME=VALUE,VALUE,...")
    return grid or {"speed_ratio": list(AXES["speed_ratio"][1])}


def _read(path: Path) -> dict[str, Any]:
    """Read a grid: ``NAME = [VALUES]``; a dotted name may be quoted or not."""
    import tomllib

    try:
        values = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read ({error.strerror or error})") from None
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise ConfigError(f"{path}: not valid TOML: {error}") from None
    grid = dict(_flatten(values, ""))
    for name, listed in grid.items():
        if not isinstance(listed, list):
            raise ConfigError(f"{path}: {name}: expected a list of values, got {listed!r}")
    return grid


def _flatten(values: dict[str, Any], prefix: str) -> Any:
    for name, value in values.items():
        if isinstance(value, dict):
            yield from _flatten(value, f"{prefix}{name}.")
        else:
            yield prefix + name, value


def _facts(frame: Any, files: list[Path]) -> dict[str, Any]:
    from importlib.metadata import version

    return {
        "rows": json.loads(frame.to_json(orient="records", double_precision=15)),
        **frame.attrs,
        "version": version("bayeshunt"),
        "files": [str(path) for path in files],
    }


def _write(frame: Any, folder: Path) -> list[Path]:
    """Write sweep.csv, sweep.json and, where it can be read, the figure."""
    from bayeshunt.files.atomic import write_text
    from bayeshunt.views.figures.style import save
    from bayeshunt.views.figures.sweep import sweep_figure
    from bayeshunt.views.terminal import terminal

    files = [folder / "sweep.csv", folder / "sweep.json"]
    write_text(files[0], frame.to_csv(index=False))
    write_text(files[1], json.dumps(_facts(frame, []), indent=1) + "\n")
    try:
        files += save(sweep_figure(frame), folder, "sweep")
    except InputError as error:
        terminal.say(f"no figure: {error}")
    return files
