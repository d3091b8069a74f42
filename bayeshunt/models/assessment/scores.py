"""Held-out predictions of one structure, and the scores that judge them.

Letters: N rows, S states of a variable, G gaits. Every prediction of a row comes from tables that were
fitted without the fold that the row is in. Logarithms are natural: log-losses are in nats per row.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pandas as pd

from bayeshunt.core.bins import EFFECTS
from bayeshunt.models.assessment.rows import CodedRows
from bayeshunt.models.counting.backoff import leaning_table
from bayeshunt.models.counting.cells import CountedCells, conditional
from bayeshunt.models.tables.effects import local_tables, multiply
from bayeshunt.models.tables.structures import PREVIOUS, Structure, find_structure

__all__ = [
    "RELIABILITY_BINS",
    "HeldOut",
    "accuracy",
    "brier",
    "confusion",
    "gains_of_gait",
    "gait_blind",
    "held_out",
    "log_loss",
    "reliability",
    "variable_scores",
]

#: Equal-width bins of the forecast probability in a reliability diagram.
RELIABILITY_BINS = 10


@dataclass(frozen=True, eq=False)
class HeldOut:
    """What a structure predicted for every row.

    log_probability: log P(Distance, Angle, Heading | causes) of what happened, [N].
    gaits: P(Gait | Distance, Angle [, PreviousGait]), [N, G], uniform P(Gait): the inverse model.
    structures: the structure of each fold (searched ones may differ).
    forecasts: effect -> P(effect | causes), [N, S], the other effects summed over; empty unless asked for.
    gaits_with_heading: as ``gaits``, given Heading as well; None unless asked for.
    """

    log_probability: np.ndarray
    gaits: np.ndarray
    structures: tuple[Structure, ...]
    forecasts: dict[str, np.ndarray]
    gaits_with_heading: np.ndarray | None


def held_out(
    rows: CodedRows,
    structure: str | Structure,
    fold: np.ndarray,
    prior: float,
    *,
    backoff: float | None = None,
    every_score: bool = False,
) -> HeldOut:
    """Predict each fold from the others.

    structure: a Structure, or a name; a name that needs a search is searched anew without each fold.
    fold: int [N]. prior: Dirichlet pseudo-count per cell, >= 0. backoff: rows that the tables without the gait before
    are worth in those with it; None: none.
    every_score: also keep what only the scores of single variables need (N x S numbers each).
    Raises InputError if a table would be too large.
    """
    sizes, number = rows.sizes, len(rows.codes)
    log_probability, gaits = np.empty(number), np.empty((number, sizes["Gait"]))
    forecasts = {effect: np.empty((number, sizes[effect])) for effect in EFFECTS if every_score}
    with_heading = np.empty_like(gaits) if every_score else None
    structures = []
    for test in (fold == k for k in np.unique(fold)):
        table = rows.count(~test)
        found = find_structure(structure, table) if isinstance(structure, str) else structure
        structures.append(found)
        predictor = _Predictor(found, _tables(found, table, prior, backoff), sizes)
        columns = {name: rows.column(name)[test] for name in rows.names}
        with np.errstate(divide="ignore"):
            log_probability[test] = np.log(predictor.probability(columns))
        gaits[test] = predictor.gait_posterior(columns, heading=False)
        for effect, forecast in forecasts.items():
            forecast[test] = predictor.forecast(effect, columns)
        if with_heading is not None:
            with_heading[test] = predictor.gait_posterior(columns, heading=True)
    return HeldOut(log_probability, gaits, tuple(structures), forecasts, with_heading)


def _tables(structure: Structure, table: CountedCells, prior: float, backoff: float | None) -> dict[str, np.ndarray]:
    """P(effect | parents) of every effect; where the gait before is a parent, leaning on those without it."""
    tables = local_tables(structure, table, prior)
    if backoff is None:
        return tables
    for effect in EFFECTS:
        parents = structure.parents(effect)
        if PREVIOUS in parents:
            base = conditional(table.tabulate((effect, *(p for p in parents if p != PREVIOUS))), prior)
            counts = table.tabulate((effect, *parents))
            tables[effect] = leaning_table(counts, np.expand_dims(base, 1 + parents.index(PREVIOUS)), backoff)
    return tables


class _Predictor:
    """Predictions from the tables of one structure, for rows given as state numbers by variable."""

    def __init__(self, structure: Structure, tables: dict[str, np.ndarray], sizes: dict[str, int]) -> None:
        self.structure, self.tables, self.sizes = structure, tables, sizes

    def probability(self, columns: dict[str, np.ndarray], effects: tuple[str, ...] = EFFECTS) -> np.ndarray:
        """Product over ``effects`` of P(effect | parents) [N]."""
        product = np.ones(len(columns["Gait"]))
        for effect in effects:
            product *= self.tables[effect][tuple(columns[v] for v in (effect, *self.structure.parents(effect)))]
        return product

    def forecast(self, effect: str, columns: dict[str, np.ndarray]) -> np.ndarray:
        """P(effect | causes) [N, S]."""
        causes = self.structure.causes
        table = multiply(self.structure, self.tables, (*causes, effect), self.sizes)
        found: np.ndarray = table[tuple(columns[cause] for cause in causes)]
        return found

    def gait_posterior(self, columns: dict[str, np.ndarray], *, heading: bool) -> np.ndarray:
        """P(Gait | effects [, PreviousGait]) [N, G]; zeros where no gait could have done it."""
        joint = np.empty((len(columns["Gait"]), self.sizes["Gait"]))
        for gait in range(self.sizes["Gait"]):
            supposed = {**columns, "Gait": np.full(len(joint), gait)}
            joint[:, gait] = self.probability(supposed) if heading else self._without_heading(supposed)
        totals = joint.sum(axis=1, keepdims=True)
        found: np.ndarray = np.divide(joint, totals, out=np.zeros_like(joint), where=totals > 0)
        return found

    def _without_heading(self, columns: dict[str, np.ndarray]) -> np.ndarray:
        """P(Distance, Angle | causes) [N]: the heading summed over, one of its states at a time."""
        if not any("Heading" in self.structure.parents(effect) for effect in EFFECTS):
            return self.probability(columns, ("Distance", "Angle"))
        states = range(self.sizes["Heading"])
        number = len(columns["Gait"])
        found: np.ndarray = np.sum(
            [self.probability({**columns, "Heading": np.full(number, h)}) for h in states], axis=0
        )
        return found


def log_loss(forecast: np.ndarray, happened: np.ndarray) -> float:
    """Return the mean of -log P(what happened) [nat]; infinite if something impossible happened.

    forecast: [N, S], rows sum to 1. happened: state numbers [N].
    """
    with np.errstate(divide="ignore"):
        return float(-np.log(forecast[np.arange(len(happened)), happened]).mean())


def brier(forecast: np.ndarray, happened: np.ndarray) -> float:
    """Return the mean over rows of sum_s (P(s) - [s happened])^2: 0 is perfect, 2 the worst.

    Source: Brier, "Verification of forecasts expressed in terms of probability" (1950).
    """
    sure = forecast[np.arange(len(happened)), happened]
    return float((np.square(forecast).sum(axis=1) - 2.0 * sure + 1.0).mean())


def gait_blind(rows: CodedRows, fold: np.ndarray, prior: float) -> dict[str, np.ndarray]:
    """Return effect -> held-out P(effect) [N, S], the same for every gait."""
    forecasts = {effect: np.empty((len(fold), rows.sizes[effect])) for effect in EFFECTS}
    for test in (fold == k for k in np.unique(fold)):
        counts = rows.count(~test)
        for effect, forecast in forecasts.items():
            forecast[test] = conditional(counts.tabulate((effect,)), prior)
    return forecasts


def variable_scores(rows: CodedRows, predicted: HeldOut, blind: dict[str, np.ndarray]) -> pd.DataFrame:
    """Return one row per effect: log_loss, brier, and both for a forecast that ignores the gait.

    blind: as :func:`gait_blind` returns it.
    density, density_without_gait: the log-losses per metre or radian, log_loss + log(width of a bin): they compare
    over bins, as log-losses do not. impossible: rows whose outcome had probability 0.
    """
    records = []
    for effect in EFFECTS:
        forecast, happened = predicted.forecasts[effect], rows.column(effect)
        without, width = log_loss(blind[effect], happened), rows.axes[effect].width
        loss = log_loss(forecast, happened)
        records.append(
            {
                "log_loss": loss,
                "brier": brier(forecast, happened),
                "density": loss + math.log(width),
                "density_without_gait": without + math.log(width),
                "log_loss_without_gait": without,
                "brier_without_gait": brier(blind[effect], happened),
                "impossible": int((forecast[np.arange(len(happened)), happened] == 0).sum()),
            }
        )
    return pd.DataFrame(records, index=pd.Index(EFFECTS, name="variable"))


def gains_of_gait(rows: CodedRows, predicted: HeldOut, blind: dict[str, np.ndarray]) -> np.ndarray:
    """Return the nats [N, 3] that the gait gained over ``blind`` in each row and effect, below 0 where it cost."""
    gains, each = [], np.arange(len(rows.codes))
    for effect in EFFECTS:
        happened = rows.column(effect)
        with np.errstate(divide="ignore", invalid="ignore"):
            own = np.log(predicted.forecasts[effect][each, happened])
            gains.append(own - np.log(blind[effect][each, happened]))
    return np.column_stack(gains)


def reliability(rows: CodedRows, predicted: HeldOut) -> pd.DataFrame:
    """Return how often events of a forecast probability happened, in ten bins of the forecast.

    Events are all states of a variable in all rows. Columns: variable, low, high (the bin), count
    (events), forecast (their mean), observed (share that happened); bins without events are left out.
    """
    sources = {**predicted.forecasts, "Gait": predicted.gaits}
    tables = [_reliability(name, forecast, rows.column(name)) for name, forecast in sources.items()]
    return pd.concat(tables, ignore_index=True)


def _reliability(name: str, forecast: np.ndarray, happened: np.ndarray) -> pd.DataFrame:
    hits = np.zeros(forecast.shape, dtype=bool)
    hits[np.arange(len(happened)), happened] = True
    bins = np.minimum((forecast * RELIABILITY_BINS).astype(np.int64), RELIABILITY_BINS - 1).ravel()
    count, mean, share = (
        np.bincount(bins, weights=weights, minlength=RELIABILITY_BINS)
        for weights in (np.ones(bins.size), forecast.ravel(), hits.ravel().astype(float))
    )
    full = np.flatnonzero(count)
    return pd.DataFrame(
        {
            "variable": name,
            "low": full / RELIABILITY_BINS,
            "high": (full + 1) / RELIABILITY_BINS,
            "count": count[full].astype(np.int64),
            "forecast": mean[full] / count[full],
            "observed": share[full] / count[full],
        }
    )


def confusion(rows: CodedRows, posterior: np.ndarray) -> pd.DataFrame:
    """Return how often each gait (rows) was taken for each gait (columns), by highest posterior.

    Ties go to the first gait in table order; rows that no gait could have done are left out.
    """
    names = list(rows.gaits.names)
    table = np.zeros((len(names), len(names)), dtype=np.int64)
    known = posterior.any(axis=1)
    np.add.at(table, (rows.column("Gait")[known], posterior[known].argmax(axis=1)), 1)
    return pd.DataFrame(table, index=pd.Index(names, name="executed"), columns=pd.Index(names, name="inferred"))


def accuracy(rows: CodedRows, posterior: np.ndarray) -> float:
    """Return the share of rows whose gait has the highest posterior; a row that no gait could have done is a miss."""
    return float(((posterior.argmax(axis=1) == rows.column("Gait")) & posterior.any(axis=1)).mean())
