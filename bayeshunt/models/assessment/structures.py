"""The same rows under other assumptions: what each structure predicts, and what it costs in parameters."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence

import numpy as np
import pandas as pd

from bayeshunt.core.bins import EFFECTS
from bayeshunt.models.assessment.rows import CodedRows
from bayeshunt.models.assessment.scores import HeldOut, accuracy, held_out
from bayeshunt.models.counting.cells import log_likelihood, parameters
from bayeshunt.models.tables import network
from bayeshunt.models.tables.effects import check_size, local_tables
from bayeshunt.models.tables.structures import NAIVE, Structure, bic, find_structure

__all__ = ["compare"]

#: Two-sided 95 % of a normal distribution.
_Z = 1.959963984540054


def compare(
    rows: CodedRows, names: Sequence[str], fold: np.ndarray, prior: float, naive: HeldOut, backoff: float | None = None
) -> tuple[pd.DataFrame, dict[str, Structure]]:
    """Return one row per structure, the paper's first, and the structures found in all rows.

    names: structures besides "naive". naive: what the paper's structure predicted, the yardstick.
    backoff: of held-out tables with the gait before, see :func:`held_out`.

    Columns: factors; parameters (free probabilities of the effects' tables); log_likelihood and bic
    (maximum likelihood on all rows, nat; more is better); log_loss (held out, nat per row; less is
    better); density, the same per m rad2, which compares over bins; gain, its mean difference to the
    paper's structure, with a 95 % interval from the pairs of rows, gain_low to gain_high; impossible,
    rows of probability 0; gait_accuracy, held out, from Distance and Angle; agreement, folds that found
    the same edges.
    """
    records, found = {}, {}
    for name in ("naive", *names):
        structure = NAIVE if name == "naive" else find_structure(name, rows.count())
        predicted = naive if name == "naive" else held_out(rows, name, fold, prior, backoff=backoff)
        records[name] = {**_fit(rows, structure, prior), **_scores(rows, structure, predicted, naive)}
        found[name] = structure
    frame = pd.DataFrame.from_dict(records, orient="index")
    return frame.rename_axis("structure"), found


def _fit(rows: CodedRows, structure: Structure, prior: float) -> dict[str, object]:
    """Fit all rows with pgmpy, check its tables against the counts, and count what the fit costs."""
    table = rows.count()
    check_size(structure, table)
    fitted = network.fit_cells(table, rows.states, prior, structure)
    network.check_equal(fitted, local_tables(structure, table, prior))
    counts = {effect: table.tabulate((effect, *structure.parents(effect))) for effect in EFFECTS}
    return {
        "factors": structure.describe(),
        "parameters": sum(map(parameters, counts.values())),
        "log_likelihood": sum(map(log_likelihood, counts.values())),
        "bic": sum(bic(table, effect, structure.parents(effect)) for effect in EFFECTS),
    }


def _scores(rows: CodedRows, structure: Structure, predicted: HeldOut, naive: HeldOut) -> dict[str, object]:
    possible = np.isfinite(predicted.log_probability)
    gain, low, high = _paired_gain(predicted.log_probability, naive.log_probability)
    edges = Counter(found.edges for found in predicted.structures)
    return {
        "log_loss": float(-predicted.log_probability.mean()),
        "density": float(-predicted.log_probability.mean()) + sum(math.log(axis.width) for axis in rows.axes),
        "gain": gain,
        "gain_low": low,
        "gain_high": high,
        "impossible": int((~possible).sum()),
        "gait_accuracy": accuracy(rows, predicted.gaits),
        "agreement": edges[structure.edges],
    }


def _paired_gain(log_probability: np.ndarray, reference: np.ndarray) -> tuple[float, float, float]:
    """Mean of the rows' differences and its 95 % interval; NaN where a row is impossible to one of the two."""
    with np.errstate(invalid="ignore"):
        difference = log_probability - reference
    if not np.isfinite(difference).all():
        return math.nan, math.nan, math.nan
    mean = float(difference.mean())
    half = _Z * float(difference.std(ddof=1)) / math.sqrt(len(difference))
    return mean, mean - half, mean + half
