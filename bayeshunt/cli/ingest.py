"""ingest: recordings of other people's robots and animals become tables that the models take."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated, Any

import typer

from bayeshunt.cli.app import app
from bayeshunt.cli.options import Json, tell
from bayeshunt.cli.outputs import out_file
from bayeshunt.core.errors import InputError

ingest = typer.Typer(
    help="Read recordings: tracks of people and animals, logs of robots.", no_args_is_help=True, rich_markup_mode=None
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
    as_json: Json = False,
) -> None:
    """Read tracks into one table and say what they are: gaps, standing, steps, and bins that suit them.

    Example:  bayeshunt ingest tracks zara.txt --rate 2.5 --unit m --out tracks.parquet
    """
    import pandas as pd

    from bayeshunt.data import tracks
    from bayeshunt.data.track_report import track_report

    if angle not in ("rad", "deg"):
        raise InputError(f"--angle {angle}: expected rad or deg")
    parts = [
        tracks.read_tracks(
            path, rate, unit, scale, y, columns=pairs(columns, "--columns"), keypoint=keypoint,
            least_confidence=least_confidence, degrees=angle == "deg", reader=reader,
        )
        for path in files
    ]  # fmt: skip
    records = [part.attrs["bayeshunt"] for part in parts]
    table = parts[0] if len(parts) == 1 else pd.concat(parts, ignore_index=True)
    table.attrs = {"bayeshunt": {"sources": records}}
    report = track_report(table)
    tracks.save(table, out)
    facts = {"out": str(out), **report._asdict(), "unit": _length_unit(table), "sources": records}
    tell(facts, as_json, _said(facts, records))


def _length_unit(table: Any) -> str:
    units = sorted(set(table["unit"].dropna())) if "unit" in table else []
    return units[0] if len(units) == 1 else ("m" if not units else "mixed")


def _said(facts: dict[str, Any], records: list[dict[str, Any]]) -> str:
    unit, out = facts["unit"], shlex.quote(facts["out"])
    lines = [f"{r['file']}: read as {r['reader']}; " + "; ".join(r["notes"]) + _claimed(r) for r in records]
    lines += [f"{r['file']}: left out {n} rows: {why}" for r in records for why, n in r["dropped"].items()]
    smooth = "smoothed" if facts["smoothed"] else "not smoothed"
    lines += [
        f"{facts['out']}: {facts['rows']} rows of {facts['ids']} individuals, {facts['gaps']} gaps, "
        f"{facts['time_step']:.4g} s from row to row",
        f"standing {100 * facts['standing']:.0f} % of the steps; median step of the others "
        f"{facts['median_step']:.3g} {unit}; the tracks look {smooth} (roughness {facts['roughness']:.2f})",
        f"suggested: time-step {facts['suggested_time_step']:g} s, distance bins of {facts['suggested_bin']:g} {unit}, "
        f"{facts['suggested_turns']} bins of a turn",
        f"next: bayeshunt prey fit {out} --out prey.json",
    ]
    return "\n".join(lines)


def _claimed(record: dict[str, Any]) -> str:
    claims = ", ".join(f"{key} {value:g}" if isinstance(value, float) else f"{key} {value}"
                       for key, value in record["claims"].items())  # fmt: skip
    return f"; the file says: {claims}" if claims else ""
