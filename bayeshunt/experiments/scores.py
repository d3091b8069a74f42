"""What a set of hunts adds up to: success with its interval, mean catch time, per bearing and in all."""

from __future__ import annotations

import math
from typing import Any

import pandas as pd

from bayeshunt.config import ExperimentSettings

#: 97.5 % quantile of the standard normal distribution.
_Z95 = 1.959963984540054


def wilson_interval(successes: int, runs: int) -> tuple[float, float]:
    """Return the 95 % Wilson score interval of a success rate; (0, 1) for no runs.

    Reference: E. B. Wilson, J. Am. Stat. Assoc. 22 (1927), 209-212.
    """
    if runs == 0:
        return 0.0, 1.0
    p, z2 = successes / runs, _Z95 * _Z95
    centre = p + z2 / (2 * runs)
    spread = _Z95 * math.sqrt(p * (1 - p) / runs + z2 / (4 * runs * runs))
    scale = 1 + z2 / runs
    low = 0.0 if successes == 0 else (centre - spread) / scale
    high = 1.0 if successes == runs else (centre + spread) / scale
    return low, high


def summarise(results: pd.DataFrame, settings: ExperimentSettings) -> list[dict[str, Any]]:
    """Return one row per planner, arena and bearing, and one with ``theta`` None for their total.

    results: one row per hunt, as :func:`bayeshunt.evaluate` returns it. Times of missed hunts
    count as the time limit. ``paper_success`` is the published share of the total, or None.
    """
    rows = []
    for (planner, arena), hunts in results.groupby(["planner", "arena"], sort=False):
        published = settings.published.get(str(planner), {}).get(str(arena))
        theta: Any
        for theta, some in hunts.groupby("theta", sort=True):
            rows.append(_row(planner, arena, float(theta), some, None))
        rows.append(_row(planner, arena, None, hunts, published))
    return rows


def _row(planner: Any, arena: Any, theta: float | None, hunts: pd.DataFrame, published: float | None) -> dict[str, Any]:
    runs, caught = len(hunts), int(hunts["caught"].sum())
    low, high = wilson_interval(caught, runs)
    return {
        "planner": str(planner),
        "arena": str(arena),
        "theta": theta,
        "runs": runs,
        "caught": caught,
        "success": caught / runs,
        "ci_low": low,
        "ci_high": high,
        "mean_time_s": math.fsum(hunts["time"]) / runs,
        "paper_success": published,
    }
