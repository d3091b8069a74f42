"""ingest: recordings of other people's robots and animals become tables that the models take."""

from __future__ import annotations

import functools
import inspect
import shlex
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from bayeshunt.cli.app import app
from bayeshunt.cli.options import Json, Seed, tell
from bayeshunt.cli.outputs import out_file
from bayeshunt.core.errors import InputError
from bayeshunt.core.units import length, unit_hint

__all__ = [
    "Angle",
    "BodyLength",
    "Cite",
    "Command",
    "Commands",
    "Gaits",
    "Licence",
    "Offset",
    "Pose",
    "Time",
    "TimeStep",
    "TimeUnit",
    "Unit",
    "babbled",
    "ingest",
    "ingest_log",
    "ingest_tracks",
    "log_options",
    "pairs",
    "reads_logs",
    "recorded_notes",
]

TimeStep = Annotated[float | None, typer.Option(help="A log: seconds of one window, the time that a gait is held.")]
Gaits = Annotated[
    str,
    typer.Option(
        help="A log: number of clusters of the command, auto (what foresees best), held (each command), or a column."
    ),
]
Pose = Annotated[str | None, typer.Option(help="A log: columns of the pose, X,Y,YAW.")]
Command = Annotated[str | None, typer.Option(help="A log: columns of the command, for example LEFT,RIGHT.")]
Commands = Annotated[
    Path | None, typer.Option(help="A log of poses: the file of the commands, with a clock of its own.")
]
Offset = Annotated[float, typer.Option(help="Seconds to add to the clock of --commands.")]
Time = Annotated[str | None, typer.Option(help="A log: column of the time.")]
TimeUnit = Annotated[str | None, typer.Option(help="A log: unit of the time, s, ms, us or ns.")]
Unit = Annotated[str | None, typer.Option(help="A log: unit of x and y, m, cm or mm.")]
Angle = Annotated[str | None, typer.Option(help="A log: unit of the heading, rad or deg; counter-clockwise.")]
BodyLength = Annotated[float | None, typer.Option(help="Length of the body [m], the unit of the default bins.")]

Licence = Annotated[str | None, typer.Option(help="Licence of the recording, kept in the table's record.")]
Cite = Annotated[str | None, typer.Option(help="How to cite the recording, kept in the table's record.")]


#: Rows of a gait that fill its tables tolerably.
_FEW = 20


def log_options(
    time_step: TimeStep = None, gaits: Gaits = "25", pose: Pose = None, command: Command = None, time: Time = None,
    time_unit: TimeUnit = None, unit: Unit = None, angle: Angle = None, body_length: BodyLength = None,
    commands: Commands = None, offset: Offset = 0.0,
) -> Any:  # fmt: skip
    """Return the options as ``data.ingesting.LogOptions``; InputError for a pose of other than three columns."""
    from bayeshunt.data.ingesting import LogOptions

    columns = _names(pose)
    if columns is not None and len(columns) != 3:
        raise InputError(f"--pose {pose}: expected three columns, X,Y,YAW")
    number: int | str = int(gaits) if gaits.lstrip("+-").isdigit() else gaits
    if isinstance(number, int) and number < 1:
        raise InputError(f"--gaits {gaits}: expected a number of at least 1, auto, held, or a column")
    return LogOptions(
        time_step, number, columns, _names(command), time, time_unit, unit, angle, body_length,
        commands=commands, offset=offset,
    )  # fmt: skip


def reads_logs(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command the options of :func:`log_options` in place of its argument ``asked``, which is what they say."""
    own, ours = inspect.signature(command, eval_str=True), inspect.signature(log_options, eval_str=True).parameters

    @functools.wraps(command)
    def given(**options: Any) -> None:
        asked = log_options(**{name: options.pop(name) for name in ours})
        command(asked=asked, **options)

    options = [
        each
        for argument in own.parameters.values()
        for each in (ours.values() if argument.name == "asked" else (argument,))
    ]
    given.__dict__["__signature__"] = own.replace(parameters=options)
    given.__annotations__ = {each.name: each.annotation for each in options}  # typer reads both
    return given


def _names(text: str | None) -> tuple[str, ...] | None:
    return None if text is None else tuple(part.strip() for part in text.split(",") if part.strip())


def babbled(data: Path, asked: Any) -> tuple[Any, list[str]]:
    """Return the babbling table of a file, a log made into one, and what there is to say of that."""
    from bayeshunt.data import babbling_table
    from bayeshunt.data.ingesting import babbling_from, needs_ingesting

    if not (data.exists() and needs_ingesting(data)):
        return babbling_table.load(data), []
    frame = babbling_from([data], asked)
    return frame, recorded_notes(frame.attrs["bayeshunt"], data)


def recorded_notes(record: dict[str, Any], path: Path) -> list[str]:
    """Return what was read, guessed and left out, a line each, from the record of a babbling table."""
    lines = [f"{shlex.quote(str(path))}: {note}" for note in record.get("notes", [])]
    lines += [f"left out: {count} ({reason})" for reason, count in record.get("dropped", {}).items()]
    if record.get("body_length_given") is False:
        length = record["repertoire"]["body_length"]
        lines.append(f"body length not given: bins are made as for one of {length:g} m (--body-length)")
    return lines


ingest = typer.Typer(
    help="""Read recordings: tracks of people and animals, logs of robots.

    Example:  bayeshunt ingest tracks mine.csv --unit m --out tracks.parquet""",
    no_args_is_help=True,
    rich_markup_mode=None,
)
app.add_typer(ingest, name="ingest", short_help="Read recordings: tracks of people and animals, logs of robots.")


def pairs(given: list[str] | None, option: str) -> dict[str, str]:
    """Return ``MEANING=NAME`` options as a dict; InputError for another shape."""
    found = {}
    for text in given or ():
        key, equals, value = text.partition("=")
        if not (key.strip() and equals and value.strip()):
            raise InputError(f"{option} {text}: expected MEANING=NAME, for example {option} x=pos_x")
        found[key.strip()] = value.strip()
    return found


@ingest.command("tracks", short_help="Tracks of people or animals.")
def ingest_tracks(
    files: Annotated[list[Path], typer.Argument(help="Files of tracks, of any known format.", show_default=False)],
    out: Annotated[Path, out_file("Parquet file to write.", "tables", ".parquet")],
    rate: Annotated[float | None, typer.Option(help="Rows (frames) per second; wins over what the file says.")] = None,
    unit: Annotated[str | None, typer.Option(help="Unit of x and y: m, cm, mm, px or body.")] = None,
    scale: Annotated[float | None, typer.Option(help="Metres of one pixel, or of one body.")] = None,
    y: Annotated[str | None, typer.Option(help="Where y points: up or down (images).")] = None,
    keypoint: Annotated[str | None, typer.Option(help="Body part to follow; default: the weighted centroid.")] = None,
    columns: Annotated[
        list[str] | None, typer.Option(help="Name a column, MEANING=NAME (x, y, id, time, frame, heading, confidence).")
    ] = None,
    least_confidence: Annotated[float, typer.Option(help="Leave out rows of less confidence.")] = 0.0,
    angle: Annotated[str, typer.Option(help="Unit of the heading column: rad or deg.")] = "rad",
    reader: Annotated[str | None, typer.Option(help="Format, where the file does not show it.")] = None,
    licence: Licence = None,
    cite: Cite = None,
    as_json: Json = False,
) -> None:
    """Read tracks into one table and say what they are: gaps, standing, steps, and bins that suit them.

    Example:  bayeshunt ingest tracks zara.txt --rate 2.5 --unit m --out tracks.parquet
    """
    import pandas as pd

    from bayeshunt.data import tracks
    from bayeshunt.data.track_report import track_report

    if angle not in ("rad", "deg"):
        raise InputError(f"--angle {angle}: unknown unit{unit_hint(angle, ('rad', 'deg'))}")
    parts = [
        tracks.read_tracks(
            path, rate, unit, scale, y, columns=pairs(columns, "--columns"), keypoint=keypoint,
            least_confidence=least_confidence, degrees=angle == "deg", reader=reader,
        )
        for path in files
    ]  # fmt: skip
    records = [part.attrs["bayeshunt"] for part in parts]
    table = parts[0] if len(parts) == 1 else pd.concat(parts, ignore_index=True)
    table.attrs = {"bayeshunt": {"sources": records, **_said_of_it(licence, cite)}}
    report = track_report(table)
    tracks.save(table, out)
    facts = {"out": str(out), **report._asdict(), "unit": _length_unit(table), "sources": records}
    tell(facts, as_json, _said(facts, records))


@ingest.command("log", short_help="A log of a robot, or a table of windows.")
@reads_logs
def ingest_log(
    files: Annotated[list[Path], typer.Argument(help="CSV, Parquet or ROS bag, of one robot.", show_default=False)],
    out: Annotated[Path, out_file("Babbling table to write.", "tables", ".parquet")],
    asked: Any = None,
    seed: Seed = 0,
    licence: Licence = None,
    cite: Cite = None,
    as_json: Json = False,
) -> None:
    """Cut a log into windows of one time-step, name the gaits by their commands, and write the babbling table.

    Example:  bayeshunt ingest log log.csv --time-step 1 --gaits 25 --out babbling.parquet
    """
    from bayeshunt.data import babbling_table
    from bayeshunt.data.ingesting import babbling_from

    table = babbling_from(files, replace(asked, seed=seed))
    record = table.attrs["bayeshunt"]
    record.update(_said_of_it(licence, cite))
    babbling_table.save(table, out)
    facts = {"out": str(out), "rows": len(table), "gaits": len(record["repertoire"]["gaits"]), **record}
    lines = [*recorded_notes(record, files[0]), f"{out}: {len(table)} rows of {facts['gaits']} gaits{_few(table)}"]
    tell(
        facts,
        as_json,
        "\n".join([*lines, f"next: bayeshunt fit {shlex.quote(str(out))} --prior 0.03 --out model.json"]),
    )


def _few(table: Any) -> str:
    """What a reader should know about gaits of few rows; "" where there are enough."""
    counts = table["gait"].value_counts()
    if counts.median() >= _FEW:
        return ""
    return (f"; {counts.min()} to {counts.max()} rows a gait are few for tables of 36 angles: drive on, take "
            "fewer gaits, or wider bins (fit --auto-bins)")  # fmt: skip


def _said_of_it(licence: str | None, cite: str | None) -> dict[str, str]:
    return {key: value for key, value in (("licence", licence), ("citation", cite)) if value}


def _length_unit(table: Any) -> str:
    units = sorted(set(table["unit"].dropna())) if "unit" in table else []
    return units[0] if len(units) == 1 else ("m" if not units else "mixed")


def _said(facts: dict[str, Any], records: list[dict[str, Any]]) -> str:
    unit, out = facts["unit"], shlex.quote(facts["out"])
    step = _size(facts["median_step"], unit)
    said: dict[str, list[str]] = {}
    for r in records:
        said.setdefault(f"read as {r['reader']}; " + "; ".join(r["notes"]) + _claimed(r), []).append(r["file"])
        for why, n in r["dropped"].items():
            said.setdefault(f"left out {n} rows: {why}", []).append(r["file"])
    lines = [f"{_together(named)}: {what}" for what, named in said.items()]
    smooth = "smoothed" if facts["smoothed"] else "not smoothed"
    lines += [
        f"{facts['out']}: {facts['rows']} rows of {facts['ids']} individuals, {facts['gaps']} gaps, "
        f"{facts['time_step']:.4g} s from row to row",
        f"standing {100 * facts['standing']:.0f} % of the steps; median step of the others "
        f"{step}; the tracks look {smooth} (roughness {facts['roughness']:.2f})",
        f"time-step: {facts['suggested_time_step']:g} s or more, so that a step is five times the jitter; with twelve "
        "steps, a twelfth of the time to be foreseen",
        f"bins: {_size(facts['suggested_bin'], unit)} of distance at that step, {facts['suggested_turns']} of a turn: "
        "about a tenth of a step, and not finer than the jitter; prey fit chooses its own, finer ones",
        f"next: bayeshunt prey fit {out} --time-step {facts['suggested_time_step']:g} --out prey.json",
    ]
    return "\n".join(lines)


def _size(value: float, unit: str) -> str:
    return length(value) if unit == "m" else f"{value:.3g} {unit}"


def _together(files: list[str]) -> str:
    """Names of files of which the same is said."""
    return ", ".join(files) if len(files) < 3 else f"{files[0]} and {len(files) - 1} more, to {files[-1]}"


def _claimed(record: dict[str, Any]) -> str:
    claims = ", ".join(f"{key} {value:g}" if isinstance(value, float) else f"{key} {value}"
                       for key, value in record["claims"].items())  # fmt: skip
    return f"; the file says: {claims}" if claims else ""
