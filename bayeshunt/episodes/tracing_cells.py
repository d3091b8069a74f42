"""One number of a table opened: its rule with its numbers, and the rows behind it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core import displays
from bayeshunt.core.bins import EFFECTS, ENERGY
from bayeshunt.core.errors import InputError
from bayeshunt.models.body.forward import ForwardModel

__all__ = ["CellTrace", "trace_cell"]


@dataclass(frozen=True, eq=False, repr=False)
class CellTrace(displays.Displayed):
    """A cell P(variable = state | Gait = gait) of a model's table opened.

    model: whose table. variable, state: the row. gait: the column; of P(Gait) the state itself.
    probability: as in ``model.cpt``. count: the rows behind it, total: those of the whole column; None where nobody
    knows.
    """

    model: ForwardModel
    variable: str
    state: str
    gait: str
    probability: float
    count: int | None
    total: int | None

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
    return CellTrace(model, variable, state, gait, probability, *known)
