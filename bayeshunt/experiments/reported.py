"""Reproduced beside reported: how likely a difference like this is if nothing differs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.config.schema.published import Published
from bayeshunt.core.errors import InputError
from bayeshunt.experiments.scores import as_evaluated, summarise

__all__ = ["compare", "fisher", "same_mean"]


def fisher(caught: int, runs: int, other_caught: int, other_runs: int) -> float:
    """Return the two-sided p-value of Fisher's exact test that two success rates are one.

    Raises InputError unless 0 <= caught <= runs and runs >= 1, of both.
    """
    from scipy.stats import fisher_exact  # half a second to import

    for some, all_ in ((caught, runs), (other_caught, other_runs)):
        if not 0 <= some <= all_ or all_ < 1:
            raise InputError(f"{some} caught of {all_} runs: expected 0 <= caught <= runs and at least one run")
    table = [[caught, runs - caught], [other_caught, other_runs - other_caught]]
    return float(fisher_exact(table).pvalue)


def same_mean(times: Sequence[float] | np.ndarray, mean: float, runs: int) -> tuple[float, float]:
    """Return z and the two-sided p-value of a mean of ``times`` [s] against another ``mean`` [s] of ``runs`` hunts.

    The spread of the other hunts is not known and taken to be that of ``times``:
    ``z = (m - mean) / (s sqrt(1 / n + 1 / runs))``, s the standard deviation of all n times. NaN if s is 0.
    """
    from scipy.stats import norm

    values = np.asarray(times, dtype=float)
    if values.size < 2 or runs < 1:
        raise InputError(f"{values.size} times against a mean of {runs} hunts: at least two and one are needed")
    error = float(values.std(ddof=1)) * math.sqrt(1 / values.size + 1 / runs)
    if error == 0.0:
        return math.nan, math.nan
    z = (math.fsum(values) / values.size - mean) / error
    return z, float(2 * norm.sf(abs(z)))


def compare(results: pd.DataFrame, settings: ExperimentSettings) -> list[dict[str, Any]]:
    """Return what was published of these hunts beside what they came to: a row per figure that was.

    Columns as in :func:`bayeshunt.experiments.scores.summarise` (planner, arena, theta or None, runs, caught, success,
    mean_time_s, paper_success), and ``paper_caught``, ``paper_runs``, ``paper_printed`` (the share as printed, where
    the counts give another), ``paper_mean_time_s``, ``p_success`` (Fisher's exact test), ``z_time`` and ``p_time``
    (z test of the mean times). None where something was not published, or there is nothing to test.
    """
    settings = as_evaluated(results, settings)
    bearings = list(settings.protocol.thetas)
    rows = []
    for row in summarise(results, settings):
        said = settings.reported(row["planner"], row["arena"])
        if said is not None and row["theta"] is not None:
            said = said.at(bearings.index(row["theta"])) if row["theta"] in bearings else None
        if said is None:
            continue
        chosen = (results["planner"] == row["planner"]) & (results["arena"] == row["arena"])
        times = results.loc[chosen if row["theta"] is None else chosen & (results["theta"] == row["theta"]), "time"]
        rows.append({name: row[name] for name in _SHARED} | _tested(row["caught"], times.to_numpy(), said))
    return rows


#: Columns of a comparison that are those of a summary.
_SHARED = ("planner", "arena", "theta", "runs", "caught", "success", "mean_time_s", "paper_success")


def _tested(caught: int, times: np.ndarray, said: Published) -> dict[str, Any]:
    """The published figures beyond the share, and the tests against them."""
    z_time = p_time = p_success = None
    if said.caught is not None and said.runs is not None:
        p_success = fisher(caught, len(times), said.caught, said.runs)
    if said.mean_time is not None and said.runs is not None and len(times) > 1:
        z, p = same_mean(times, said.mean_time, said.runs)
        z_time, p_time = (None, None) if math.isnan(z) else (z, p)
    return {
        "paper_caught": said.caught, "paper_runs": said.runs, "paper_printed": said.printed,
        "paper_mean_time_s": said.mean_time, "p_success": p_success, "z_time": z_time, "p_time": p_time,
    }  # fmt: skip
