"""One number of a table opened: its rule with its numbers, and the rows behind it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core import displays, statistics
from bayeshunt.core.bins import EFFECTS, ENERGY
from bayeshunt.core.errors import InputError
from bayeshunt.models.body.forward import ForwardModel

__all__ = ["CellTrace", "cell_interval", "trace_cell"]


@dataclass(frozen=True, eq=False, repr=False)
class CellTrace(displays.Displayed):
    """A cell P(variable = state | Gait = gait) of a model's table opened.

    model: whose table. variable, state: the row. gait: the column; of P(Gait) the state itself.
    probability: as in ``model.cpt``. count: the rows behind it, total: those of the whole column; None where nobody
    knows. within: its 95 % credible interval; None where nobody knows, or where the table was set, not estimated.
    """

    model: ForwardModel
    variable: str
    state: str
    gait: str
    probability: float
    count: int | None
    total: int | None
    within: tuple[float, float] | None = None

    @property
    def formula(self) -> str:
        """The rule with its numbers: "P(Angle = 0 deg | straight) = (191 + 0) / (200 + 0 x 36) = 0.955"."""
        given = "" if self.variable == "Gait" else f" | {self.gait}"
        head, value = f"P({self.variable} = {self.state}{given})", f"{self.probability:.6g}"
        if self.count is None or self.total is None:
            return f"{head} = {value}: given, nobody counted"
        if self.variable == "Gait" and self.model.gait_prior == "uniform":
            return f"{head} = 1 / {len(self.model.gaits)} = {value}: set, as in the paper; {self.count} rows"
        prior, bins = self.model.prior, len(self.model.cpt(self.variable))
        rule = (self.count + prior) / (self.total + prior * bins)
        if not np.isclose(rule, self.probability, rtol=1e-9):
            return f"{head} = {value}: {self.count} of {self.total} rows, other parents summed over"
        return f"{head} = ({self.count} + {prior:g}) / ({self.total} + {prior:g} x {bins}) = {value}"

    def rows(self) -> pd.DataFrame:
        """Return the babbled rows behind the cell, as many as its count. Raises as ``ForwardModel.rows``."""
        if self.variable == "Gait":
            return self.model.rows("Gait", self.gait)
        return self.model.rows(self.variable, self.state, self.gait)

    def __repr__(self) -> str:
        return f"<Trace: {self.formula}>"


def trace_cell(model: ForwardModel, cell: Any) -> CellTrace:
    """Open a cell (variable, state or SI number, gait) of a model, or ("Gait", gait). Raises InputError."""
    if not isinstance(cell, tuple) or len(cell) not in (2, 3) or cell[0] not in (*EFFECTS, ENERGY, "Gait"):
        raise InputError(f"cell: expected (variable, state, gait) or ('Gait', gait), got {cell!r}")
    variable, state = cell[:2]
    gait = model.gaits.names[model.gaits.index(cell[-1])]
    if variable == "Gait":
        state, column = gait, 0
    else:
        labels = list(model.axes[variable].labels)
        if not isinstance(state, str) and not 0 <= (at := int(model.axes[variable].index(float(state)))) < len(labels):
            raise InputError(f"{variable} = {state:g} lies outside its bins, {labels[0]!r} to {labels[-1]!r}")
        state, column = state if isinstance(state, str) else labels[at], model.gaits.index(gait)
        if state not in labels:
            raise InputError(f"{variable} has no bin {state!r}; its bins are {labels[0]!r} to {labels[-1]!r}")
    row = list(model.cpt(variable).index).index(state)
    counts = model.counts(variable).to_numpy() if model.has_counts else None
    known = (None, None) if counts is None else (int(counts[row, column]), int(counts[:, column].sum()))
    probability = float(model.cpt(variable).to_numpy()[row, column])
    at = row if variable == "Gait" else column
    low, high = (float(end[at]) for end in cell_interval(model, variable, row))
    within = None if np.isnan(low) else (low, high)
    return CellTrace(model, variable, state, gait, probability, known[0], known[1], within)


def cell_interval(model: ForwardModel, variable: str, row: int = 0) -> np.ndarray:
    """Return the ends of the 95 % credible interval [2, G] of every gait's cell in one row of a table.

    The very numbers of ``model.table(variable)``, without those of its other rows; of P(Gait) all, whatever the row.
    NaN where nobody knows, or where the table was set.
    """
    names = model.gaits.names
    if not model.has_counts or (variable == "Gait" and model.gait_prior == "uniform"):
        return np.full((2, len(names)), np.nan)
    if variable == "Gait":
        return np.stack([end.to_numpy()[:, 0] for end in model.credible_interval(variable)])
    counts = model.joint.marginal(variable)
    pseudo = model.source.pseudo_counts(variable)
    if np.ndim(pseudo) or pseudo > 0:
        pseudo = _two(np.broadcast_to(pseudo, counts.shape), row).astype(float)
    low, high = statistics.credible_interval(_two(counts, row), pseudo)
    return np.stack([low[0], high[0]])


def _two(table: np.ndarray, row: int) -> np.ndarray:
    """One row, and all the others added up."""
    return np.stack([table[row], table.sum(axis=0) - table[row]])
