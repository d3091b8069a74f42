"""Logs of robots: where the body was and what it was told, from any table, as one frame in SI units.

Columns: ``time`` [s], ``x``, ``y`` [m], ``yaw`` [rad counter-clockwise, unwrapped along a run], ``command_0``,
``command_1``, ... as logged, and ``run``, the number of the unbroken run. Other columns are kept under their names.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.arguments import checked
from bayeshunt.core.checks import check_number
from bayeshunt.core.errors import DataError, InputError
from bayeshunt.data.log_clock import seconds_of, unbroken
from bayeshunt.data.log_columns import find_columns, lengths, radians_of
from bayeshunt.data.readers.quaternions import with_yaw
from bayeshunt.data.text_tables import as_numbers, read_text_table
from bayeshunt.files import parquet
from bayeshunt.files.records import digest_of_file

__all__ = ["command_columns", "read_log", "read_table"]

_EXPECTED = "a log of a robot"


@checked
def read_log(
    path: str | os.PathLike[str],
    commands: str | os.PathLike[str] | None = None,
    *,
    time: str | None = None,
    pose: Sequence[str] | None = None,
    command: Sequence[str] | None = None,
    time_unit: str | None = None,
    unit: str | None = None,
    angle: str | None = None,
    offset: float = 0.0,
    reader: str | None = None,
) -> pd.DataFrame:
    """Read a log: CSV of any separator, Parquet, or a ROS bag (``pip install ".[ros]"``).

    commands: a second file that holds the commands, with a clock of its own; offset: seconds to add to that clock.
        Each pose gets the last command before it.
    time, pose (x, y, yaw), command (one name or more): columns, where their names do not show it.
    time_unit: "s", "ms", "us", "ns"; unit: of x and y, "m", "cm", "mm"; angle: "rad" or "deg"; by default as the
        columns' names say, else SI units, and refused where that cannot be.
    reader: "text", "parquet" or "ros"; by default by the file's ending.

    Rows that hold no pose, come twice or go back in time are left out and counted; what was done stands in
    ``attrs["bayeshunt"]``. Raises DataError that names the column that is missing, InputError for a unit to be said.
    """
    source = os.fspath(path)
    check_number(offset, "offset", "seconds")
    table = read_table(path, reader)
    found = find_columns(list(table.columns), time, pose, command, source, with_command=commands is None)
    if found["time"] is None:
        raise DataError(f"{source}: no column of time found among {', '.join(table.columns)}; name it: time= (--time)")
    clock = seconds_of(table[found["time"]], time_unit, source)
    log, notes = _log(table, found, clock.seconds, unit, angle, source)
    dropped = {"no time": int((~np.isfinite(log["time"])).sum())}
    log = log[np.isfinite(log["time"].to_numpy())].reset_index(drop=True)
    if commands is not None:
        log, said = _with_commands(log, commands, command, time_unit, offset - clock.start)
        notes.append(said)
    kept, lost = _clean(log)
    if kept.empty:
        raise DataError(f"{source}: no row has a time, a pose and a command")
    kept.attrs[parquet.PROVENANCE_KEY] = {
        "source": {"file": Path(source).name, "sha256": digest_of_file(source),
                   "columns": {k: v for k, v in found.items() if v}},
        "notes": [clock.note, *notes, *_broken(kept), *_turning(kept)],
        "dropped": {k: v for k, v in {**dropped, **lost}.items() if v},
    }  # fmt: skip
    return kept


def read_table(path: str | os.PathLike[str], reader: str | None = None) -> pd.DataFrame:
    """Return the table in a file, columns by name, and the yaw of a quaternion; DataError in one line if it is none."""
    ending = Path(path).suffix.lower()
    kind = reader or ("ros" if ending in (".bag", ".mcap", ".db3") or Path(path).is_dir() else "")
    if kind == "ros":
        from bayeshunt.data.readers.ros import read_bag

        return read_bag(Path(path))
    if kind not in ("", "text", "parquet"):
        raise InputError(f"unknown reader {reader!r}: expected text, parquet or ros")
    if kind == "parquet" or ending in (".parquet", ".pq"):
        table: pd.DataFrame = parquet.read(path, what="a log", fix=f"give {_EXPECTED}")[0].to_pandas()
        table.columns = pd.Index([str(name) for name in table.columns])
        return with_yaw(table)
    return with_yaw(read_text_table(path, _EXPECTED))


def command_columns(columns: Iterable[Any]) -> list[str]:
    """Return the columns command_0, command_1, ... of a log or a babbling table, in order."""
    names = set(columns)
    found: list[str] = []
    while f"command_{len(found)}" in names:
        found.append(f"command_{len(found)}")
    return found


def _log(
    table: pd.DataFrame, found: dict[str, Any], seconds: np.ndarray, unit: str | None, angle: str | None, source: str
) -> tuple[pd.DataFrame, list[str]]:
    """The log's own columns in SI units, other columns after them, and notes."""
    x, y, yaw = found["pose"]
    metres, said_unit = lengths([x, y], unit, source)
    turn, said_angle = radians_of(as_numbers(table[yaw]), yaw, angle, source)
    columns: dict[str, Any] = {
        "time": seconds, "x": as_numbers(table[x]) * metres, "y": as_numbers(table[y]) * metres, "yaw": turn,
    }  # fmt: skip
    for i, name in enumerate(found["command"]):
        columns[f"command_{i}"] = as_numbers(table[name])
    used = {found["time"], x, y, yaw, *found["command"]}
    others = {name: table[name].to_numpy() for name in table.columns if name not in used and name not in columns}
    said = f"pose = {x}, {y}, {yaw}" + (f"; command = {', '.join(found['command'])}" if found["command"] else "")
    return pd.DataFrame({**columns, **others}), [said, said_unit, said_angle]


def _with_commands(
    log: pd.DataFrame, path: str | os.PathLike[str], command: Sequence[str] | None, time_unit: str | None, offset: float
) -> tuple[pd.DataFrame, str]:
    """The log with the last command before each pose, from a file with a clock of its own; ``offset`` [s] added."""
    source = os.fspath(path)
    table = read_table(path)
    found = find_columns(list(table.columns), None, None, command, source, with_pose=False)
    if found["time"] is None:
        raise DataError(f"{source}: no column of time found among {', '.join(table.columns)}")
    told = seconds_of(table[found["time"]], time_unit, source, slowest=30.0)  # they come when they change
    values = np.stack([as_numbers(table[name]) for name in found["command"]], axis=1)
    good = np.isfinite(told.seconds) & np.isfinite(values).all(axis=1)
    order = np.argsort(told.seconds[good], kind="stable")
    clock, values = told.seconds[good][order] + (told.start + float(offset)), values[good][order]
    if not len(clock) or clock[0] > log["time"].max() or clock[-1] < log["time"].min():
        raise DataError(f"{source}: its clock ({clock.min(initial=np.inf):g} to {clock.max(initial=-np.inf):g} s) does "
                        f"not meet the poses' ({log['time'].min():g} to {log['time'].max():g} s); "
                        "give offset= in seconds (--offset)")  # fmt: skip
    # a microsecond is no order: offsets round
    last = np.searchsorted(clock, log["time"].to_numpy() + 1e-6, side="right") - 1
    for i in range(values.shape[1]):
        log[f"command_{i}"] = np.where(last >= 0, values[np.maximum(last, 0), i], np.nan)
    return log, f"commands of {Path(source).name}: {', '.join(found['command'])}, the last before each pose"


def _clean(log: pd.DataFrame) -> tuple[pd.DataFrame, dict[str, int]]:
    """Rows with a pose and a command, in unbroken runs; and how many were left out for which reason."""
    pose = np.isfinite(log[["x", "y", "yaw"]].to_numpy(dtype=float)).all(axis=1)
    told = np.isfinite(log[command_columns(log.columns)].to_numpy(dtype=float)).all(axis=1)
    lost = {"no pose": int((~pose).sum()), "no command": int((pose & ~told).sum())}
    log = log[pose & told].reset_index(drop=True)
    run, late = unbroken(log["time"].to_numpy())
    log = log.assign(run=run)[run >= 0].reset_index(drop=True)
    log["yaw"] = log.groupby("run")["yaw"].transform(lambda yaw: np.unwrap(yaw.to_numpy()))
    return log, {**lost, **late}


def _broken(log: pd.DataFrame) -> list[str]:
    """How many unbroken runs there are, where there is more than one, and the longest gap between two."""
    time, run = log["time"].to_numpy(), log["run"].to_numpy()
    ends = np.flatnonzero(np.diff(run))
    if not ends.size:
        return []
    longest = float((time[ends + 1] - time[ends]).max())
    gap = f", the longest gap {longest:.3g} s" if longest > 0 else ""
    return [f"{ends.size + 1} unbroken runs{gap}: no window bridges one"]


def _turning(log: pd.DataFrame) -> list[str]:
    """A warning if the heading turns one way where the path turns the other: then it is likely clockwise."""
    if len(log) < 3:
        return []
    run = log["run"].to_numpy()
    same = run[1:] == run[:-1]
    moved = np.diff(log["x"].to_numpy()) + 1j * np.diff(log["y"].to_numpy())
    bend = np.angle(moved[1:] * np.conj(moved[:-1]))
    turned = np.diff(log["yaw"].to_numpy())
    size = np.abs(moved)
    clear = same[1:] & same[:-1] & (np.minimum(size[1:], size[:-1]) > np.median(size) * 0.5) & (np.abs(bend) < 1.5)
    if clear.sum() < 20:
        return []
    bends, turns = bend[clear], (turned[1:] + turned[:-1])[clear] / 2
    spread = float(bends.std() * turns.std())
    together = float(np.mean((bends - bends.mean()) * (turns - turns.mean())) / spread) if spread > 0 else 0.0
    if together < -0.5:
        return ["warning: the heading turns against the path: it may be clockwise, or y may point down; "
                "poses must be counter-clockwise"]  # fmt: skip
    return []
