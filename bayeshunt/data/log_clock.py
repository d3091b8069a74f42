"""The clock of a log: seconds from whatever was written, rows that contradict it left out, unbroken runs numbered."""

from __future__ import annotations

import numpy as np
import pandas as pd

from bayeshunt.core.errors import InputError
from bayeshunt.core.units import unit_hint
from bayeshunt.data.text_tables import as_numbers

__all__ = ["TIME_UNITS", "seconds_of", "unbroken"]

#: Seconds of one unit of time.
TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}

#: So many usual time-steps without a row break a run.
_BREAK = 5.0
#: So many rows in a row that go back are a clock that was set, fewer are strays.
_STRAYS = 5


def seconds_of(values: pd.Series, unit: str | None, source: str, *, slowest: float = 2.0) -> tuple[np.ndarray, str]:
    """Return the time [s] of each row (NaN where there is none) and a note of how it was read.

    unit: "s", "ms", "us" or "ns"; None: the column's name or its steps must show it; slowest: longest usual step [s].
    Times of day and dates are read.
    Raises InputError for another unit, or if nothing shows it.
    """
    if unit is not None and unit not in TIME_UNITS:
        raise InputError(f"{source}: unknown unit of time {unit!r}{unit_hint(unit, TIME_UNITS)}")
    if pd.api.types.is_datetime64_any_dtype(values.dtype):
        return _from_start(values), "time: dates, seconds since the first"
    numbers = as_numbers(values)
    if not np.isfinite(numbers).any() and values.notna().any():
        clock = _clock(values)
        if not np.isfinite(clock).any():
            raise InputError(
                f"{source}: column {values.name!r} holds no times; expected numbers, times of day or dates"
            )
        return clock, "time: read from text, seconds since the first"
    if unit is None:
        unit, why = _guessed(str(values.name), numbers, source, slowest)
    else:
        why = "as given"
    first = numbers[np.isfinite(numbers)][:1]
    shifted = numbers - first if first.size and abs(first[0]) > 1e8 else numbers  # epochs: keep the digits
    return shifted * TIME_UNITS[unit], f"time in {unit} ({why})"


def _guessed(name: str, numbers: np.ndarray, source: str, slowest: float) -> tuple[str, str]:
    lower = name.lower().rstrip("])")
    for unit in ("ns", "us", "ms"):
        if lower.endswith(unit) and not lower[: -len(unit)].endswith(tuple("abcdefghijklmnopqrstuvwxyz")):
            return unit, "as its name says"
    if any(word in lower for word in ("milli", "msec")):
        return "ms", "as its name says"
    gaps = np.diff(numbers[np.isfinite(numbers)])
    gaps = gaps[gaps > 0]
    usual = float(np.median(gaps)) if gaps.size else 0.0
    if usual > slowest and not lower.endswith(("_s", " s", "[s", "(s", "sec", "seconds")):
        raise InputError(
            f"{source}: column {name!r} steps by {usual:g}; say its unit: time_unit= (--time-unit s|ms|us)"
        )
    return "s", "the default"


def _clock(values: pd.Series) -> np.ndarray:
    """Seconds since the first of dates or times of day written as text; NaN where neither can be read."""
    text = values.astype("string").str.strip()
    spans = pd.to_timedelta(text.where(text.str.count(":") == 2), errors="coerce")
    if spans.notna().mean() > 0.5:
        total = spans.dt.total_seconds().to_numpy(dtype=float, na_value=np.nan)
        return np.asarray(total - total[np.isfinite(total)][0])
    return _from_start(pd.to_datetime(text, errors="coerce", utc=True, format="ISO8601"))


def _from_start(stamps: pd.Series) -> np.ndarray:
    if not stamps.notna().any():
        return np.full(len(stamps), np.nan)
    since = (stamps - stamps.dropna().iloc[0]).dt.total_seconds()
    return np.asarray(since.to_numpy(dtype=float, na_value=np.nan))


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
