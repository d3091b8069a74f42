"""How sure an answer is: the Dirichlet uncertainty of every table that it is made of, carried to P(Gait | evidence).

A table column with counts N and pseudo-counts a is itself uncertain: Dirichlet(N + a) (Gelman et al., Bayesian Data
Analysis, 3rd ed., section 3.4). Each draw of the tables gives one P(Gait | evidence) by Bayes' rule; the interval holds
the middle ``level`` of them. The draws are the same every time (``models.certainty.draws``); between two gaits whose
tables are independent nothing is drawn, their log-odds are integrated (``models.certainty.two_gaits``).
"""

from __future__ import annotations

import numpy as np
import pandas as pd

from bayeshunt.core.checks import check_number
from bayeshunt.core.errors import InputError
from bayeshunt.models.certainty.draws import log_beta, log_dirichlet
from bayeshunt.models.certainty.factors import (
    AXES,
    Factor,
    add_up,
    check_counted,
    factors,
    log_sum,
    pseudo_words,
    spread,
)
from bayeshunt.models.certainty.two_gaits import can_integrate, integrate
from bayeshunt.models.tables.sources import TableSource

__all__ = ["interval"]

_LEVEL = "a probability between 0 and 1"


def interval(
    source: TableSource, bins: dict[str, int], point: np.ndarray, level: float = 0.95, pseudo: float | None = None
) -> pd.DataFrame:
    """Return low, median and high of P(Gait | evidence), a row per gait in table order.

    source: the model's tables. bins: effect -> bin number, the evidence. point: P(Gait | evidence) [G] as printed,
        which lies inside. level, pseudo: as in ``Posterior.interval``.
    ``attrs`` say level and pseudo (in words).

    Raises InputError for an imported network, a level outside (0, 1) or a bad pseudo-count.
    """
    check_counted(source)
    if not 0.0 < check_number(level, "level", _LEVEL) < 1.0:
        raise InputError(f"level: expected {_LEVEL}, got {level}")
    tail = (1.0 - level) / 2.0
    parts = factors(source, bins, pseudo)
    if can_integrate(parts):
        low, median, high = integrate(parts, (tail, 0.5, 1.0 - tail))
    else:
        low, median, high = np.quantile(_posterior_draws(parts), [tail, 0.5, 1.0 - tail], axis=1)
    columns = {"low": np.minimum(low, point), "median": median, "high": np.maximum(high, point)}
    frame = pd.DataFrame(columns, index=pd.Index(source.gaits.names, name="Gait"))
    frame.attrs = {"level": float(level), "pseudo": pseudo_words(source, pseudo)}
    return frame


def _posterior_draws(parts: list[Factor]) -> np.ndarray:
    """P(Gait | evidence) [G, n] under each of n draws of the tables."""
    dimensions = sum(part.cells for part in parts)
    joint, first = np.zeros([1] * len(AXES) + [1]), 0
    for part in parts:
        joint = joint + spread(part, _draw(part, first, dimensions), extra=1)
        first += part.cells
    logs = add_up(joint)
    shares: np.ndarray = np.exp(logs - log_sum(logs, 0))
    return shares


def _draw(part: Factor, first: int, dimensions: int) -> np.ndarray:
    """Log probabilities over the factor's axes and n draws (1 where nothing is uncertain)."""
    if not part.estimated:
        with np.errstate(divide="ignore"):
            logs: np.ndarray = np.log(part.probability)[..., None]
        return logs
    weights = part.counts + part.pseudo
    if part.observed is None:
        return log_dirichlet(weights, first, dimensions)
    own = weights[part.observed]
    rest = np.delete(weights, part.observed, axis=0).sum(axis=0)
    return log_beta(own, rest, first, dimensions)
