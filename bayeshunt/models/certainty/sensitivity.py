"""Which table cell an answer hangs on: each cell moved over its own credible interval, the others held."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core import statistics
from bayeshunt.core.checks import check_number
from bayeshunt.core.errors import InputError
from bayeshunt.models.certainty.factors import AXES, Factor, add_up, check_counted, factors, log_sum, spread
from bayeshunt.models.tables.sources import TableSource

__all__ = ["sensitivity"]

_LEVEL = "a probability between 0 and 1"


def sensitivity(source: TableSource, bins: dict[str, int], best: int, level: float = 0.95) -> pd.DataFrame:
    """Return a row per table cell, the one that moves P(best gait) most first; see ``Posterior.sensitivity``.

    bins: effect -> bin number, the evidence. best: index of the most probable gait.
    Raises InputError for an imported network or a level outside (0, 1).
    """
    check_counted(source)
    if not 0.0 < check_number(level, "level", _LEVEL) < 1.0:
        raise InputError(f"level: expected {_LEVEL}, got {level}")
    parts = factors(source, bins)
    rows = [
        row
        for number, part in enumerate(parts)
        if part.estimated
        for row in _moved(source, [p for i, p in enumerate(parts) if i != number], part, best, level)
    ]
    frame = pd.DataFrame(rows, columns=[*_COLUMNS])
    frame["effect"] = (frame["best_at_high"] - frame["best_at_low"]).abs()
    return frame.sort_values("effect", ascending=False, kind="stable", ignore_index=True)


_COLUMNS = (
    "variable", "state", "gait", "given", "count", "probability", "low", "high", "best_at_low", "best_at_high",
)  # fmt: skip


def _moved(source: TableSource, others: list[Factor], part: Factor, best: int, level: float) -> list[dict[str, Any]]:
    """The rows of one table's cells."""
    rest = sum((spread(other, _log(other.probability)) for other in others), np.zeros([1] * len(AXES)))
    flat = part.counts.reshape(len(part.counts), -1)
    # the very interval that the table itself shows: at prior 0 that of Jeffreys
    shown = 0.0 if source.prior == 0 and source.backoff is None else part.pseudo.reshape(flat.shape)
    bounds = statistics.credible_interval(flat, shown, level=level)
    rows = []
    for place in np.ndindex(part.probability.shape):
        own = place if part.observed is None else (part.observed, *place)
        at = [float(bound.reshape(part.counts.shape)[own]) for bound in bounds]
        moved = [_best(rest, part, place, value, best) for value in at]
        rows.append(
            {
                **_names(source, part, own),
                "count": int(part.counts[own]),
                "probability": float(part.table[own]),
                **dict(zip(("low", "high"), at, strict=True)),
                **dict(zip(("best_at_low", "best_at_high"), moved, strict=True)),
            }
        )
    return rows


def _best(rest: np.ndarray, part: Factor, place: tuple[int, ...], value: float, best: int) -> float:
    """P(best gait | evidence) with one cell at ``value``; the rest of a column that is not observed is scaled."""
    table = part.probability.copy()
    if part.observed is None:
        column: tuple[Any, ...] = (slice(None), *place[1:])
        left = 1.0 - table[place]
        table[column] *= (1.0 - value) / left if left > 0 else 0.0
    table[place] = value
    logs = add_up(rest + spread(part, _log(table)))
    return float(np.exp(logs - log_sum(logs, 0))[best])


def _names(source: TableSource, part: Factor, own: tuple[int, ...]) -> dict[str, Any]:
    """A cell in words: its variable, its state, its gait (None of a table without one), the states of the parents."""
    states, parents = source.states, source.structure.parents(part.variable)
    left = iter(own[1:])
    bins = [part.fixed[p] if p in part.fixed else next(left) for p in parents]
    at = {part.variable: states[part.variable][own[0]], **{p: states[p][i] for p, i in zip(parents, bins, strict=True)}}
    given = ", ".join(f"{p} = {at[p]}" for p in parents)
    return {"variable": part.variable, "state": at[part.variable], "gait": at.get("Gait"), "given": given}


def _log(table: np.ndarray) -> np.ndarray:
    with np.errstate(divide="ignore"):
        logs: np.ndarray = np.log(table)
    return logs
