"""The clock of a log: seconds from whatever was written, rows that contradict it left out, unbroken runs numbered."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pandas as pd

from bayeshunt.core.errors import InputError
from bayeshunt.core.units import unit_hint
from bayeshunt.data.text_tables import as_numbers

__all__ = ["TIME_UNITS", "Clock", "seconds_of", "unbroken"]

#: Seconds of one unit of time.
TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}

#: Numbers between these seconds since 1970 (2001 and 2100) tell their unit by their size.
_EPOCH = (1e9, 4.1e9)
#: So many usual time-steps without a row break a run.
_BREAK = 5.0
#: So many rows in a row that go back are a clock that was set, fewer are strays.
_STRAYS = 5


class Clock(NamedTuple):
    """The time of each row: ``seconds`` [N] after ``start`` (NaN where there is none), and a note of how it was read.

    start: seconds of the clock's own zero, an epoch or midnight, so that two files can be put together; 0 where the
    numbers are small, and are taken as they stand.
    """

    seconds: np.ndarray
    note: str
    start: float = 0.0


def seconds_of(values: pd.Series, unit: str | None, source: str, *, slowest: float = 2.0) -> Clock:
    """Return the time of each row of a column.

    unit: "s", "ms", "us" or "ns"; None: the column's name, its size or its steps must show it; slowest: longest usual
    step [s]. Times of day and dates are read.
    Raises InputError for another unit, or if nothing shows it.
    """
    if unit is not None and unit not in TIME_UNITS:
        raise InputError(f"{source}: unknown unit of time {unit!r}{unit_hint(unit, TIME_UNITS)}")
    if pd.api.types.is_datetime64_any_dtype(values.dtype):
        return _from_first(_since_epoch(values), "time: dates, seconds since the first")
    numbers = as_numbers(values)
    if not np.isfinite(numbers).any() and values.notna().any():
        clock = _clock(values)
        if not np.isfinite(clock).any():
            raise InputError(
                f"{source}: column {values.name!r} holds no times; expected numbers, times of day or dates"
            )
        return _from_first(clock, "time: read from text, seconds since the first")
    if unit is None:
        unit, why = _guessed(str(values.name), numbers, source, slowest)
    else:
        why = "as given"
    first = numbers[np.isfinite(numbers)][:1]
    start = float(first[0]) if first.size and abs(first[0]) > 1e8 else 0.0  # epochs: keep the digits
    return Clock((numbers - start) * TIME_UNITS[unit], f"time in {unit} ({why})", start * TIME_UNITS[unit])


def _guessed(name: str, numbers: np.ndarray, source: str, slowest: float) -> tuple[str, str]:
    lower = name.lower().rstrip("])")
    for unit in ("ns", "us", "ms"):
        if lower.endswith(unit) and not lower[: -len(unit)].endswith(tuple("abcdefghijklmnopqrstuvwxyz")):
            return unit, "as its name says"
    if any(word in lower for word in ("milli", "msec")):
        return "ms", "as its name says"
    finite = numbers[np.isfinite(numbers)]
    for unit in ("ns", "us", "ms"):
        if finite.size and all(_EPOCH[0] < end * TIME_UNITS[unit] < _EPOCH[1] for end in (finite.min(), finite.max())):
            return unit, "an epoch, as its size says"
    gaps = np.diff(finite)
    gaps = gaps[gaps > 0]
    usual = float(np.median(gaps)) if gaps.size else 0.0
    if usual > slowest and not lower.endswith(("_s", " s", "[s", "(s", "sec", "seconds")):
        raise InputError(
            f"{source}: column {name!r} steps by {usual:g}; say its unit: time_unit= (--time-unit s|ms|us|ns)"
        )
    return "s", "the default"


def _clock(values: pd.Series) -> np.ndarray:
    """Seconds of dates (since 1970) or times of day (since midnight) written as text; NaN where neither can be read."""
    text = values.astype("string").str.strip()
    spans = pd.to_timedelta(text.where(text.str.count(":") == 2), errors="coerce")
    if spans.notna().mean() > 0.5:
        return np.asarray(spans.dt.total_seconds().to_numpy(dtype=float, na_value=np.nan))
    return _since_epoch(pd.to_datetime(text, errors="coerce", utc=True, format="ISO8601"))


def _since_epoch(stamps: pd.Series) -> np.ndarray:
    since = (stamps - pd.Timestamp(0, tz=stamps.dt.tz)).dt.total_seconds()
    return np.asarray(since.to_numpy(dtype=float, na_value=np.nan))


def _from_first(seconds: np.ndarray, note: str) -> Clock:
    known = seconds[np.isfinite(seconds)]
    start = float(known[0]) if known.size else 0.0
    return Clock(seconds - start, note, start)


def unbroken(time: np.ndarray) -> tuple[np.ndarray, dict[str, int]]:
    """Return the run [N] that each row belongs to (-1: left out), and how many rows were left out for which reason.

    time: finite seconds [N] in the order of the log. A row at a time that was there already is left out; a few rows
    that go back are strays and are left out; a clock that goes back for good begins a new run, so does a gap of more
    than five usual steps.
    """
    run = np.zeros(len(time), dtype=np.int64)
    dropped = {"time stands twice": 0, "time goes back": 0}
    start, number = 0, 0
    while start < len(time):
        piece = time[start:]
        best = np.maximum.accumulate(piece)
        late = np.concatenate([[False], piece[1:] <= best[:-1]])
        stop = _clock_was_set(late)
        mine = slice(start, start + stop)
        twice = late[:stop] & (piece[:stop] == best[:stop])
        dropped["time stands twice"] += int(twice.sum())
        dropped["time goes back"] += int((late[:stop] & ~twice).sum())
        run[mine] = np.where(late[:stop], -1, number)
        start, number = start + stop, number + 1
    return _cut_at_gaps(time, run), {reason: count for reason, count in dropped.items() if count}


def _clock_was_set(late: np.ndarray) -> int:
    """Where more than a few rows on end come late: there the clock was set; the length if nowhere."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], late.astype(np.int8), [0]])))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        if last - first > _STRAYS:
            return int(first)
    return len(late)


def _cut_at_gaps(time: np.ndarray, run: np.ndarray) -> np.ndarray:
    kept = np.flatnonzero(run >= 0)
    gaps, same = np.diff(time[kept]), np.diff(run[kept]) == 0
    usual = float(np.median(gaps[same])) if same.any() else 0.0
    cut = ~same | (gaps > _BREAK * usual)
    numbers = np.full(len(run), -1, dtype=np.int64)
    numbers[kept] = np.concatenate([[0], np.cumsum(cut)]) if len(kept) else []
    return numbers
