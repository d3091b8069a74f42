"""What a set of hunts adds up to: success with its interval, mean catch time, per bearing and in all."""

from __future__ import annotations

import math
from itertools import combinations
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.config.schema.published import Published
from bayeshunt.core.arguments import checked
from bayeshunt.core.checks import check_whole
from bayeshunt.core.errors import InputError

__all__ = ["as_evaluated", "mean_interval", "paired_differences", "summarise", "wilson_interval"]

#: 97.5 % quantile of the standard normal distribution.
_Z95 = 1.959963984540054


def wilson_interval(successes: int, runs: int) -> tuple[float, float]:
    """Return the 95 % Wilson score interval of a success rate; (0, 1) for no runs.

    Raises InputError unless both are whole numbers and 0 <= successes <= runs.
    Reference: E. B. Wilson, J. Am. Stat. Assoc. 22 (1927), 209-212.
    """
    check_whole(successes, "successes", 0)
    check_whole(runs, "runs", 0)
    if successes > runs:
        raise InputError(f"successes: {successes} are more than the {runs} runs")
    if runs == 0:
        return 0.0, 1.0
    p, z2 = successes / runs, _Z95 * _Z95
    centre = p + z2 / (2 * runs)
    spread = _Z95 * math.sqrt(p * (1 - p) / runs + z2 / (4 * runs * runs))
    scale = 1 + z2 / runs
    low = 0.0 if successes == 0 else (centre - spread) / scale
    high = 1.0 if successes == runs else (centre + spread) / scale
    return low, high


def mean_interval(values: ArrayLike) -> tuple[float, float]:
    """Return the 95 % interval of a mean: Student's t; the mean itself twice for fewer than two values.

    Of catch times this is the interval of the mean over hunts, a miss counting as the time limit.
    """
    array = np.asarray(values, dtype=float)
    mean = float(array.mean())
    if len(array) < 2:
        return mean, mean
    from scipy.stats import t

    half = float(t.ppf(0.975, len(array) - 1) * array.std(ddof=1) / math.sqrt(len(array)))
    return mean - half, mean + half


@checked
def summarise(results: pd.DataFrame, settings: ExperimentSettings) -> list[dict[str, Any]]:
    """Return one row per planner, arena and bearing, and one with ``theta`` None for their total.

    results: one row per hunt, as :func:`bayeshunt.evaluate` returns it. Times of missed hunts
    count as the time limit. ``paper_success`` is the published share, or None where none was published. Of a body
    that measures what it spends also ``mean_energy_j`` [J], its 95 % interval ``energy_low``, ``energy_high``,
    ``mean_changes`` of gait and ``mean_falls`` of a hunt.
    """
    settings = as_evaluated(results, settings)
    rows = []
    for (planner, arena), hunts in results.groupby(["planner", "arena"], sort=False):
        published = settings.reported(str(planner), str(arena))
        bearings = [float(theta) for theta in settings.protocol.thetas]
        theta: Any
        for theta, some in hunts.groupby("theta", sort=True):
            at = published.at(bearings.index(float(theta))) if published and float(theta) in bearings else None
            rows.append(_row(planner, arena, float(theta), some, at))
        rows.append(_row(planner, arena, None, hunts, published))
    return rows


def as_evaluated(results: pd.DataFrame, settings: ExperimentSettings) -> ExperimentSettings:
    """Return the settings without their published figures, and with a note that says so, where these say nothing.

    That is where a given model of another structure hunted, as ``results.attrs["structure"]`` tells, and not
    one of the structure that the settings learn.
    """
    own = settings.model.structure
    structure = results.attrs.get("structure") or own  # earlier files do not say theirs
    if structure == own:
        return settings
    note = f"Hunted with a given model of structure {structure}; {settings.name!r} itself learns {own}."
    if settings.published:
        note += " Its settings were fitted to published totals with that; these figures have no published counterpart."
    elif settings.note:
        note = f"{settings.note} {note}"
    return settings.model_copy(update={"note": note, "published": {}})


def _row(
    planner: Any, arena: Any, theta: float | None, hunts: pd.DataFrame, published: Published | None
) -> dict[str, Any]:
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
        "paper_success": None if published is None else published.share,
        **(_spent(hunts) if "energy" in hunts else {}),
    }


def _spent(hunts: pd.DataFrame) -> dict[str, float]:
    low, high = mean_interval(hunts["energy"])
    means = {name: math.fsum(hunts[name]) / len(hunts) for name in ("energy", "transitions", "falls")}
    return {
        "mean_energy_j": means["energy"], "energy_low": low, "energy_high": high,
        "mean_changes": means["transitions"], "mean_falls": means["falls"],
    }  # fmt: skip


def paired_differences(results: pd.DataFrame) -> list[dict[str, Any]]:
    """Return how planners differ in success on the same hunts (arena, bearing, seed), a row per arena and pair.

    Keys: arena, first, second, hunts (that both hunted), only_first, only_second (caught by one alone), difference
    (success of the first less the second), low, high (95 % interval), p (exact McNemar test, two-sided).
    Source of the interval: A. Agresti and Y. Min, Simple improved confidence intervals for comparing matched
    proportions, Statistics in Medicine 24 (2005).
    """
    rows = []
    for arena, here in results.groupby("arena", sort=False):
        caught = here.pivot_table(index=["theta", "seed"], columns="planner", values="caught", aggfunc="first")
        for first, second in combinations(dict.fromkeys(here["planner"]), 2):
            both = caught[[first, second]].dropna().astype(bool)
            if len(both):
                rows.append({"arena": str(arena), "first": first, "second": second, **_paired(*both.to_numpy().T)})
    return rows


def _paired(first: np.ndarray, second: np.ndarray) -> dict[str, Any]:
    from scipy.stats import binomtest

    only_first, only_second = int((first & ~second).sum()), int((second & ~first).sum())
    b, c, n = only_first + 0.5, only_second + 0.5, len(first) + 2
    middle, spread = (b - c) / n, _Z95 * math.sqrt(max((b + c) - (b - c) ** 2 / n, 0.0)) / n
    either = only_first + only_second
    return {
        "hunts": len(first),
        "only_first": only_first,
        "only_second": only_second,
        "difference": (only_first - only_second) / len(first),
        "low": max(middle - spread, -1.0),
        "high": min(middle + spread, 1.0),
        "p": float(binomtest(only_first, either).pvalue) if either else 1.0,
    }
