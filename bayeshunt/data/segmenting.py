"""From logs to babbling tables: a log is cut into windows of one time-step, each a gait and where it led.

The tables are those of :mod:`bayeshunt.data.babbling_table` with the commands beside (``command_0``, ...). Their record
holds the repertoire, so that models need no robot file.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from bayeshunt.core.arguments import checked
from bayeshunt.core.checks import check_number
from bayeshunt.core.errors import DataError, InputError, did_you_mean
from bayeshunt.core.geometry import wrap
from bayeshunt.data.command_gaits import AUTO, HELD, NamedGaits, gaits_of_commands, is_column
from bayeshunt.data.logs import command_columns
from bayeshunt.data.plausibility import warn_body_length, warn_time_step
from bayeshunt.data.text_tables import as_numbers
from bayeshunt.data.track_report import round_down
from bayeshunt.files.parquet import PROVENANCE_KEY

__all__ = ["gaits_from_log", "gaits_from_windows"]

#: Radians that no window turns: a turn and a half either way is likelier a column in degrees.
_MOST_TURN = 3 * np.pi
#: A hold may end one sample early, and a quarter more for a clock that jitters; at most this much of a time-step.
_SAMPLES, _EARLY = 1.25, 0.25


@checked
def gaits_from_windows(
    frame: pd.DataFrame,
    command: Sequence[str] = ("cmd_left", "cmd_right"),
    pose: Sequence[str] = ("x", "y", "yaw"),
    time_step: float | None = None,
    gaits: int | str = 25,
    seed: int = 0,
    *,
    body_length: float | None = None,
    run: str | None = None,
    drop: bool = False,
) -> pd.DataFrame:
    """Return the babbling table of rows that already are one window each: a command, and the pose after it.

    command: columns of the command, one for each actuator. pose: columns of x forward, y left [m] and yaw
        [rad counter-clockwise] after the window, in the frame at its start.
    time_step: seconds of a window. gaits: a number of clusters of the command, "auto" (the number whose mean poses
        foresee held-out rows best), "held" (each distinct command), or the name of a column that names them.
        seed: of the clusters.
    body_length: metres; by default bins are made for a typical step. run: a column that changes where the rows
        no longer follow each other; by default all were executed in order. It bounds ``previous_gait``.
    drop: leave out rows without numbers (counted in the record) instead of raising.

    One row out per row in, same order and index; other columns are kept. Raises DataError that names a bad row.
    """
    if not isinstance(frame, pd.DataFrame):
        raise DataError(f"windows: expected a pandas DataFrame, got {type(frame).__name__}")
    command = (command,) if isinstance(command, str) else tuple(command)
    if len(pose) != 3:
        raise InputError(f"pose: expected three columns x, y, yaw, got {', '.join(map(str, pose))}")
    named = is_column(gaits)
    for name in (*command, *pose, *([gaits] if named else []), *([run] if run else [])):
        if name not in frame.columns:
            raise DataError(f"windows: column {name!r} is missing; the table has {', '.join(map(str, frame.columns))}"
                            f"{_near(gaits, frame) if name == gaits else ''}")  # fmt: skip
    step = _time_step(time_step)
    values = np.stack([as_numbers(frame[name]) for name in (*command, *pose)], axis=1)
    good = np.isfinite(values).all(axis=1)
    if not drop and not good.all():
        row = int(np.flatnonzero(~good)[0])
        name = (*command, *pose)[int(np.flatnonzero(~np.isfinite(values[row]))[0])]
        raise DataError(f"windows: row {row}: {name} is {frame[name].iloc[row]!r}; expected a finite number (drop=True "
                        "leaves such rows out)")  # fmt: skip
    if not good.any():
        raise DataError("windows: no row holds a command and a pose")
    kept, values = frame[good], values[good]
    follows = np.diff(np.flatnonzero(good)) == 1
    if run is not None:
        follows &= kept[run].to_numpy()[1:] == kept[run].to_numpy()[:-1]
    commands, moved = values[:, : len(command)], values[:, len(command) :]
    found = gaits_of_commands(commands, gaits, kept[gaits] if named else None, seed=seed, source="windows", moved=moved)
    taken = {*command, *pose, "gait", "distance", "angle", "heading", "previous_gait"}
    others = kept[[name for name in kept.columns if name not in taken and not str(name).startswith("command_")]]
    table = _table(found, commands, moved, follows, kept.index)
    dropped = {"no numbers": int((~good).sum())} if not good.all() else {}
    return _with_record(table.join(others), found, moved, step, body_length, frame.attrs, dropped, [])


@checked
def gaits_from_log(
    log: pd.DataFrame,
    time_step: float | None = None,
    gaits: int | str = 25,
    seed: int = 0,
    *,
    body_length: float | None = None,
) -> pd.DataFrame:
    """Return the babbling table of a log made by :func:`bayeshunt.read_log`, cut into windows of ``time_step`` seconds.

    Where commands are held for a time-step (within one sample) or longer, windows lie within one command, from its
    onset on, and what is left of a hold before the next onset is left out; otherwise they follow each other, and the
    command of a window is its mean.
    gaits, seed, body_length: as for :func:`gaits_from_windows`. ``previous_gait`` is known only where the window before
    ends where this one begins, or lies in the same hold.
    """
    _check_log(log)
    step = _time_step(time_step)
    names = command_columns(log.columns)
    named = is_column(gaits)
    if named and gaits not in log.columns:
        raise DataError(f"log: column {gaits!r} is missing; the log has {', '.join(map(str, log.columns))}"
                        f"{_near(gaits, log)}")  # fmt: skip
    holds = _holds(log, [*names, str(gaits)] if named else names, step)
    starts, lost = _windows(log, holds, step)
    if not len(starts):
        raise DataError(f"log: no unbroken run (or hold of a command) is as long as one time-step of {step:g} s")
    moved, commands, rows = _measured(log, names, starts, step, held=holds is not None)
    column = log[gaits].iloc[rows].reset_index(drop=True) if named else None
    found = gaits_of_commands(commands, gaits, column, seed=seed, moved=moved)
    begun, run, hold = starts["time"].to_numpy(), starts["run"].to_numpy(), starts["hold"].to_numpy()
    touching = np.abs(np.diff(begun) - step) < 1e-6 * step + 1e-9
    next_hold = np.diff(hold) == 1  # the hold between was not lost
    follows = (run[1:] == run[:-1]) & (touching | (np.diff(hold) == 0) | next_hold)
    table = _table(found, commands, moved, follows, pd.RangeIndex(len(starts)))
    table.insert(0, "step", np.arange(len(table)))
    table["time"], table["run"] = begun, run
    return _with_record(table, found, moved, step, body_length, log.attrs, lost, _held_note(holds))


def _near(gaits: int | str, table: pd.DataFrame) -> str:
    """How an error about ``gaits`` ends: "auto", "held", or a column, that was likely meant."""
    return did_you_mean(gaits, [AUTO, HELD, *map(str, table.columns)], listed=False)


def _time_step(value: float | None) -> float:
    step = check_number(value, "time_step", "the seconds of one window")
    if step <= 0:
        raise InputError(f"time_step: expected the seconds of one window, > 0, got {value}")
    warn_time_step(step)
    return step


def _check_log(log: Any) -> None:
    if not isinstance(log, pd.DataFrame):
        raise DataError(f"log: expected a pandas DataFrame made by bayeshunt.read_log, got {type(log).__name__}")
    for name in ("time", "x", "y", "yaw", "run", "command_0"):
        if name not in log:
            raise DataError(f"log: column {name!r} is missing; read it with bayeshunt.read_log")


def _holds(log: pd.DataFrame, names: list[str], step: float) -> np.ndarray | None:
    """The number [N] of the hold that each row belongs to; None if commands are not held for a time-step."""
    values, run = log[names].to_numpy(), log["run"].to_numpy()
    change = (values[1:] != values[:-1]).any(axis=1) | (run[1:] != run[:-1])
    hold = np.concatenate([[0], np.cumsum(change)])
    found = _pieces(log, hold, step)
    lasts = found.lasts
    long = lasts >= 0.95 * step - found.early
    return hold if lasts[long].sum() > 0.5 * lasts.sum() and lasts.sum() > 0 else None


class _Pieces(NamedTuple):
    """Unbroken pieces of a log: their first rows and the rows after them, how long they last, and may fall short [s].

    A command holds until the next one comes: a piece lasts up to the first row of the next one in the same run.
    ``early`` is about one sample, as logs are no finer, but no more than the run still goes on after the piece.
    """

    first: np.ndarray
    after: np.ndarray
    lasts: np.ndarray
    early: np.ndarray


def _pieces(log: pd.DataFrame, piece: np.ndarray, step: float) -> _Pieces:
    time, run = log["time"].to_numpy(dtype=float), log["run"].to_numpy()
    first = np.flatnonzero(np.concatenate([[True], piece[1:] != piece[:-1]]))
    after = np.concatenate([first[1:], [len(log)]])
    following = np.minimum(after, len(log) - 1)
    goes_on = (after < len(log)) & (run[following] == run[first])
    lasts = np.where(goes_on, time[following], time[after - 1]) - time[first]
    gaps = np.diff(time)[run[1:] == run[:-1]]
    sample = float(np.median(gaps)) if gaps.size else 0.0
    spare = log.groupby("run")["time"].transform("max").to_numpy(dtype=float)[first] - time[first] - lasts
    return _Pieces(first, after, lasts, np.minimum(spare, min(_SAMPLES * sample, _EARLY * step)))


def _windows(log: pd.DataFrame, holds: np.ndarray | None, step: float) -> tuple[pd.DataFrame, dict[str, int]]:
    """Columns time, run, hold of each window's start; rows of the log that no window covers, by reason."""
    run = log["run"].to_numpy()
    piece = run if holds is None else holds
    time = log["time"].to_numpy()
    parts, lost = [], 0
    for number, (a, b, lasts, early) in enumerate(zip(*_pieces(log, piece, step), strict=True)):
        count = int((lasts + early) / step + 1e-6)
        lost += int((time[a:b] > time[a] + count * step + 1e-9).sum()) if count else int(b - a)
        if count:
            parts.append(pd.DataFrame({"time": time[a] + step * np.arange(count), "run": run[a], "hold": number}))
    found = pd.concat(parts, ignore_index=True) if parts else pd.DataFrame(columns=["time", "run", "hold"])
    return found, {"rows outside any whole window": lost} if lost else {}


def _measured(
    log: pd.DataFrame, names: list[str], starts: pd.DataFrame, step: float, *, held: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pose [W, 3] after each window in the frame at its start, its command [W, A], and the row where it starts.

    held: the command is that of the first row, though a window may reach a sample into the next hold; else the mean.
    """
    moved, commands, rows = np.zeros((len(starts), 3)), np.zeros((len(starts), len(names))), np.zeros(len(starts), int)
    for run, windows in starts.groupby("run", sort=False):
        at = np.flatnonzero(log["run"].to_numpy() == run)
        part = log.iloc[at]
        time, begin = part["time"].to_numpy(), windows["time"].to_numpy(dtype=float)
        x, y, yaw = (
            np.stack([np.interp(t, time, part[name].to_numpy()) for t in (begin, begin + step)])
            for name in ("x", "y", "yaw")
        )
        ahead = ((x[1] - x[0]) + 1j * (y[1] - y[0])) * np.exp(-1j * yaw[0])
        moved[windows.index] = np.stack([ahead.real, ahead.imag, yaw[1] - yaw[0]], axis=1)
        first = np.searchsorted(time, begin - 1e-9)
        last = np.maximum(np.searchsorted(time, begin + step - 1e-9), first + 1)
        sums = np.vstack([np.zeros(len(names)), np.cumsum(part[names].to_numpy(dtype=float), axis=0)])
        mean = (sums[last] - sums[first]) / (last - first)[:, None]
        values = part[names].to_numpy(dtype=float)
        same = np.array([held or bool((values[a:b] == values[a]).all()) for a, b in zip(first, last, strict=True)])
        commands[windows.index] = np.where(same[:, None], values[np.minimum(first, len(part) - 1)], mean)
        rows[windows.index] = at[np.minimum(first, len(part) - 1)]
    return moved, commands, rows


def _held_note(holds: np.ndarray | None) -> list[str]:
    return (
        ["commands are held: windows lie within one"] if holds is not None else ["commands change: windows take means"]
    )


def _table(
    found: NamedGaits, commands: np.ndarray, moved: np.ndarray, follows: np.ndarray, index: pd.Index
) -> pd.DataFrame:
    x, y, yaw = moved.T
    before = np.full(len(found.labels), None, dtype=object)
    before[1:][follows] = found.labels[:-1][follows]
    columns = {
        "gait": found.labels, "distance": np.hypot(x, y), "angle": np.asarray(wrap(-np.arctan2(y, x))),
        "heading": np.asarray(wrap(-yaw)), "previous_gait": before,
    }  # fmt: skip
    table = pd.DataFrame(columns, index=index).astype({"gait": str})
    for i in range(commands.shape[1]):
        table[f"command_{i}"] = commands[:, i]
    return table


def _with_record(
    table: pd.DataFrame, found: NamedGaits, moved: np.ndarray, step: float, body_length: float | None,
    attrs: Any, dropped: dict[str, int], notes: list[str],
) -> pd.DataFrame:  # fmt: skip
    """The table with its record: repertoire, time-step, body length, and where it came from."""
    reach = float(np.median(np.hypot(moved[:, 0], moved[:, 1])))
    body = round_down(max(reach, 1e-6)) if body_length is None else check_number(body_length, "body_length", "metres")
    if not body > 0:
        raise InputError(f"body_length: expected metres > 0, got {body_length}")
    warn_body_length(body_length, float(np.hypot(moved[:, 0], moved[:, 1]).max()))
    before = attrs.get(PROVENANCE_KEY, {})
    turned = np.abs(moved[:, 2])
    warn = ["warning: windows turn by more than a turn and a half: are the headings in degrees?"]
    table.attrs[PROVENANCE_KEY] = {
        **{key: value for key, value in before.items() if key not in ("notes", "dropped")},
        "repertoire": {"gaits": [{"name": g.name, "command": list(g.command)} for g in found.gaits],
                       "body_length": body, "duration": step},
        "body_length_given": body_length is not None,
        "notes": [*before.get("notes", []), *notes, *([found.fewer] if found.fewer else []),
                  *(warn if np.median(turned) > _MOST_TURN else [])],
        "dropped": {**before.get("dropped", {}), **dropped},
    }  # fmt: skip
    return table
