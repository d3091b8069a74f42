"""What a user should know of his tracks before he counts anything: how many, how broken, how smooth, which bins."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pandas as pd

from bayeshunt.core.arguments import checked
from bayeshunt.data.steps import Run, median_step, native_step, runs
from bayeshunt.data.transitions import STANDING_SHARE

__all__ = ["TrackReport", "round_down", "track_report"]


class TrackReport(NamedTuple):
    """Facts of a table of tracks. Lengths are metres, or the unit of the tracks.

    ids: individuals. rows. runs: unbroken pieces. gaps: places where rows are missing within a track.
    time_step: seconds from row to row. standing: share of steps below a tenth of the median one.
    median_step: of those that move. roughness: mean change of acceleration over mean change of speed: near 2 in
        tracks with independent errors, below 0.7 in tracks that were smoothed. smoothed: whether it is below.
    suggested_time_step: seconds: the shortest whose steps are five times the jitter or more.
    suggested_bin: of Distance, a tenth of such a step, but not finer than the jitter of a place.
    suggested_turns: bins of Angle and Heading.
    """

    ids: int
    rows: int
    runs: int
    gaps: int
    time_step: float
    standing: float
    median_step: float
    roughness: float
    smoothed: bool
    suggested_time_step: float
    suggested_bin: float
    suggested_turns: int

    def __str__(self) -> str:
        """A fact a line, numbers to four digits."""
        return "\n".join(f"{name}: {f'{v:.4g}' if isinstance(v, float) else v}" for name, v in self._asdict().items())


@checked
def track_report(tracks: pd.DataFrame) -> TrackReport:
    """Return the facts of a table of tracks; DataError if it is none."""
    found, native = runs(tracks), native_step(tracks)
    steps = np.concatenate([np.abs(np.diff(run.places)) for run in found])
    middle = median_step(found)
    second, third = (_changes(found, order) for order in (2, 3))
    roughness = third / second if second > 0 else math.nan
    # A jitter of s in every row makes second differences of about 2.4 s; smoothed tracks show none.
    jitter = second / 2.4 * min(max(roughness - 0.7, 0.0), 1.0) if second > 0 else 0.0
    times = max(1, math.ceil(5 * jitter / middle)) if middle > 0 else 1
    keys = [tracks["scene"], tracks["id"]] if "scene" in tracks else ["id"]
    ids = tracks.groupby(keys, sort=False).ngroups
    return TrackReport(
        ids=ids, rows=len(tracks), runs=len(found), gaps=max(len(found) - ids, 0), time_step=native,
        standing=float((steps < STANDING_SHARE * middle).mean()), median_step=middle, roughness=roughness,
        smoothed=bool(roughness < 0.7), suggested_time_step=round(times * native, 6),
        suggested_bin=round_down(max(times * middle / 10, jitter)), suggested_turns=72,
    )  # fmt: skip


def _changes(found: list[Run], order: int) -> float:
    """Mean length of the differences of ``order`` along the runs."""
    every = np.concatenate([np.abs(np.diff(run.places, order)) for run in found])
    return float(every.mean()) if every.size else 0.0


def round_down(value: float) -> float:
    """Return the largest of 1, 2 or 5 times a power of ten that is not above ``value``; 1 for 0."""
    if not value > 0:
        return 1.0
    power = math.floor(math.log10(value))
    unit = 10.0**power
    return float(f"{next(m for m in (5, 2, 1) if m * unit <= value * (1 + 1e-9) or m == 1) * unit:.12g}")
