"""From any file of a robot to a babbling table: logs, rows that are windows, and tables that are there already."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.errors import DataError, InputError
from bayeshunt.data import babbling_table
from bayeshunt.data.log_columns import find_columns, lengths, radians_of
from bayeshunt.data.logs import read_log, read_table
from bayeshunt.data.plausibility import warn_body_length
from bayeshunt.data.segmenting import gaits_from_log, gaits_from_windows
from bayeshunt.data.text_tables import as_numbers, read_bytes
from bayeshunt.data.track_report import round_down
from bayeshunt.data.tracks import COLUMNS as TRACKS
from bayeshunt.files.parquet import PROVENANCE_KEY

__all__ = ["Held", "LogOptions", "babbling_from", "needs_ingesting"]


@dataclass(frozen=True)
class LogOptions:
    """How a log is to be read, and cut: the options of ``bayeshunt ingest log``; None: by name, or the default.

    time_step: seconds of a window. gaits: clusters, "auto", "held", or a column. pose: columns of x, y, yaw.
    command: columns. time: column. time_unit, unit, angle: what they are in. body_length: metres. seed: of clusters.
    commands: a file that holds the commands, with a clock of its own; offset: seconds to add to that clock.
    """

    time_step: float | None = None
    gaits: int | str = 25
    pose: tuple[str, ...] | None = None
    command: tuple[str, ...] | None = None
    time: str | None = None
    time_unit: str | None = None
    unit: str | None = None
    angle: str | None = None
    body_length: float | None = None
    seed: int = 0
    commands: Path | None = None
    offset: float = 0.0


class Held:
    """A babbling table in memory, with what streaming asks of one in a file (``babbling_table.Batches``)."""

    def __init__(self, frame: pd.DataFrame, name: str) -> None:
        self.name, self.rows, self._frame = name, len(frame), frame
        self.provenance: dict[str, Any] = frame.attrs.get(PROVENANCE_KEY, {})

    def of(self, gaits: Any = None) -> Any:
        """Yield the table once; DataError for a gait that is not among ``gaits``."""
        babbling_table.validate(self._frame, gaits, source=self.name)
        yield self._frame


def needs_ingesting(path: str | os.PathLike[str]) -> bool:
    """Return whether a file is no babbling table with a record yet: text, a ROS bag, or Parquet of another program."""
    if Path(path).is_dir():
        return (Path(path) / "metadata.yaml").is_file()  # a rosbag2 is a folder
    if not read_bytes(path, "a babbling table or a log").startswith(b"PAR1"):
        # what ends as Parquet is damaged Parquet, not a log
        return Path(path).suffix.lower() not in (".parquet", ".pq")
    table = babbling_table.Batches(path)
    return not ({"robot", "repertoire"} & set(table.provenance))


def babbling_from(paths: Sequence[str | os.PathLike[str]], options: LogOptions) -> pd.DataFrame:
    """Return one babbling table of one robot's files, all of one kind; its record says how they were read.

    Raises DataError that names file and column, InputError for what has to be said (``--time-step``, units).
    """
    if options.commands is not None and len(paths) > 1:
        raise InputError(
            f"--commands {options.commands}: goes with one log; give {len(paths)} logs one after the other"
        )
    try:
        tables = [read_table(path) for path in paths]
    except DataError as error:
        raise DataError(f"{error}; or give a table made by: bayeshunt babble") from None
    for path, table in zip(paths, tables, strict=True):
        if set(TRACKS) <= set(table.columns):
            raise DataError(f"{os.fspath(path)}: tracks of people or animals, not of a robot's gaits; "
                            "give them to bayeshunt prey fit")  # fmt: skip
    if all(set(babbling_table.COLUMNS) <= set(table.columns) for table in tables):
        frames = [_numbered(table, os.fspath(path)) for table, path in zip(tables, paths, strict=True)]
        return _with_repertoire(pd.concat(frames, ignore_index=True), options, [Path(p).name for p in paths])
    if options.time_step is None:
        raise InputError(f"{os.fspath(paths[0])}: say how long a gait is held: --time-step, in seconds")
    clocks = [_has_clock(table, path, options) for table, path in zip(tables, paths, strict=True)]
    if all(clocks):
        return _of_logs(paths, options)
    if any(clocks):
        raise DataError(f"{os.fspath(paths[clocks.index(False)])}: no column of time, unlike the other files")
    windows = [_windows(table, os.fspath(path), options) for table, path in zip(tables, paths, strict=True)]
    frame = pd.concat([part for part, _ in windows], ignore_index=True)
    frame.attrs = {PROVENANCE_KEY: {"notes": windows[0][1]}}
    names = tuple(name for name in frame.columns if name.startswith("told_"))
    gaits = options.gaits
    return gaits_from_windows(
        frame, names, ("x", "y", "yaw"), options.time_step, gaits, options.seed, body_length=options.body_length,
        run="file" if len(paths) > 1 else None, drop=True,
    )  # fmt: skip


def _has_clock(table: pd.DataFrame, path: Any, options: LogOptions) -> bool:
    if options.commands is not None:
        return True
    found = find_columns(list(table.columns), options.time, options.pose, options.command, os.fspath(path))
    return found["time"] is not None


def _of_logs(paths: Sequence[str | os.PathLike[str]], options: LogOptions) -> pd.DataFrame:
    logs, first = [], 0
    for path in paths:
        log = read_log(
            path, options.commands, offset=options.offset,
            time=options.time, pose=options.pose, command=options.command, time_unit=options.time_unit,
            unit=options.unit, angle=options.angle,
        )  # fmt: skip
        log["run"] += first
        first = int(log["run"].max()) + 1
        logs.append(log)
    whole = pd.concat(logs, ignore_index=True)
    records = [log.attrs[PROVENANCE_KEY] for log in logs]
    reasons = sorted({reason for record in records for reason in record["dropped"]})
    whole.attrs = {PROVENANCE_KEY: {
        "source": [record["source"] for record in records] if len(records) > 1 else records[0]["source"],
        "notes": list(dict.fromkeys(note for record in records for note in record["notes"])),
        "dropped": {reason: sum(record["dropped"].get(reason, 0) for record in records) for reason in reasons},
    }}  # fmt: skip
    return gaits_from_log(whole, options.time_step, options.gaits, options.seed, body_length=options.body_length)


def _windows(table: pd.DataFrame, source: str, options: LogOptions) -> tuple[pd.DataFrame, list[str]]:
    """Rows that are one window each, in SI units, and notes of how they were read."""
    found = find_columns(list(table.columns), None, options.pose, options.command, source)
    x, y, yaw = found["pose"]
    metres, said_unit = lengths([x, y], options.unit, source)
    turn, said_angle = radians_of(as_numbers(table[yaw]), yaw, options.angle, source)
    moved = {"x": as_numbers(table[x]) * metres, "y": as_numbers(table[y]) * metres, "yaw": turn}
    told = {f"told_{i}": as_numbers(table[name]) for i, name in enumerate(found["command"])}
    others = {name: table[name].to_numpy() for name in table.columns if name not in {x, y, yaw, *found["command"]}}
    frame = pd.DataFrame({**others, **moved, **told, "file": source})
    said = f"no column of time: every row is a window; pose = {x}, {y}, {yaw}; command = {', '.join(found['command'])}"
    return frame, [said, said_unit, said_angle]


def _numbered(table: pd.DataFrame, source: str) -> pd.DataFrame:
    """A babbling table of text or of another program, its numbers as numbers."""
    frame = table.copy()
    for name in (*babbling_table.COLUMNS[1:], *babbling_table.path_columns(frame.columns)):
        numbers = as_numbers(frame[name])
        lost = np.flatnonzero(np.isnan(numbers) & frame[name].notna().to_numpy())
        if lost.size:
            text = frame[name].iloc[lost[0]]
            raise DataError(f"{source}: row {lost[0]}: {name} is {text!r}; expected a finite number")
        frame[name] = numbers
    babbling_table.validate(frame, source=source)
    frame["gait"] = frame["gait"].astype(str)
    if "previous_gait" in frame:
        frame["previous_gait"] = frame["previous_gait"].astype(str).where(frame["previous_gait"].notna(), None)
    return frame


def _with_repertoire(frame: pd.DataFrame, options: LogOptions, names: list[str]) -> pd.DataFrame:
    """The table with a record of its gaits, in the order in which they first appear."""
    body = options.body_length
    reach = float(np.median(frame["distance"]))
    warn_body_length(body, float(frame["distance"].max()))
    frame.attrs[PROVENANCE_KEY] = {
        "repertoire": {
            "gaits": [{"name": name, "command": []} for name in dict.fromkeys(frame["gait"])],
            "body_length": round_down(max(reach, 1e-6)) if body is None else float(body), "duration": options.time_step,
        },
        "body_length_given": body is not None, "source": {"file": names[0] if len(names) == 1 else names},
        "notes": ["a babbling table: gait, distance, angle and heading, clockwise"], "dropped": {},
    }  # fmt: skip
    return frame
