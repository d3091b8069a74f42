"""Every number opens: an answer or a decision down to its formula, table cells, counts and babbled rows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core import displays
from bayeshunt.core.errors import InputError, shown
from bayeshunt.core.gaits import Gait
from bayeshunt.episodes.tracing_cells import CellTrace, cell_interval, trace_cell
from bayeshunt.episodes.tracing_plans import PlanTrace, trace_plan
from bayeshunt.models.body.explain import log_terms
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.posterior import Posterior
from bayeshunt.planners.api import Plan

__all__ = ["CellTrace", "PlanTrace", "Trace", "trace", "trace_answer"]


@dataclass(frozen=True, eq=False, repr=False)
class Trace(displays.Displayed):
    """A probability P(Gait | evidence) opened.

    answer: what is traced. gait: whose probability.
    factors: a row per gait: prior and what each observed variable gives, their product (the joint probability with
        the evidence), and the product's share of the sum: the posterior.
    cells: a row per factor of ``gait``: variable, state, given, probability, count, its rows (missing where
        nobody knows), and low, high, its 95 % interval (NaN where nobody knows, or where the table was set).
    """

    answer: Posterior
    gait: str
    factors: pd.DataFrame
    cells: pd.DataFrame

    @property
    def formula(self) -> str:
        """The rule with its numbers: "P(wide left | e) = 0.1 x 0.005 x 0.315 / 0.0001575 = 1"."""
        row = self.factors.loc[self.gait]
        parts = " x ".join(f"{row[name]:.6g}" for name in self.factors.columns[:-2])
        return (
            f"P({self.gait} | {', '.join(self.answer.evidence)}) = {parts} / "
            f"{self.answer.evidence_probability:.6g} = {row['posterior']:.6g}"
        )

    def rows(self, variable: str) -> pd.DataFrame:
        """Return the babbled rows behind one factor's cell, with their paths where they have one.

        In the paper's structure as many as its count; in others, of those rows the ones of this gait and bin whatever
        the further parents are. Raises as ``ForwardModel.rows``, and InputError for a variable that was not observed.
        """
        model = self.answer.model
        if variable == "Gait":
            return model.rows("Gait", self.gait)
        if variable not in self.answer.cell.evidence:
            raise InputError(f"{variable}: expected Gait or one of {', '.join(self.answer.cell.evidence)}")
        return model.rows(variable, self.answer.cell.evidence[variable], self.gait)

    def __repr__(self) -> str:
        return f"<Trace: {self.formula}>"


def trace(
    x: Any, gait: Gait | str | None = None, *, cell: Any = None, model: ForwardModel | None = None
) -> Trace | CellTrace | PlanTrace:
    """Return what a number is made of, down to the rows.

    x: an answer of an inverse model; a plan (a decision: ``episode.plans[i]``); or a forward model, of which ``cell``
        is opened.
    gait: whose probability, of an answer; None: the most probable.
    cell: (variable, state or SI number, gait), or ("Gait", gait).
    model: the tables behind a plan that weighed sequences, which carries none itself.

    Raises InputError for anything else, a plan that weighed nothing or came from another process, and a gait that
    is not in the repertoire.
    """
    if isinstance(x, ForwardModel):
        return trace_cell(x, cell)
    if isinstance(x, Plan) and x.answer is None and x.posterior is None and x.nodes > 1:
        return trace_plan(x, model)
    answer = x.answer if isinstance(x, Plan) else x
    if isinstance(x, Plan) and answer is None:
        why = (
            "came from another process" if x.posterior is not None else "weighed no posterior; plan.trace has its nodes"
        )
        raise InputError(f"this plan {why}")
    if not isinstance(answer, Posterior):
        raise InputError(f"expected an answer of an inverse model or a plan, got {shown(x)}")
    return trace_answer(answer, gait)


def trace_answer(answer: Posterior, gait: Gait | str | None = None) -> Trace:
    """Open an answer; gait: whose probability, None: the most probable."""
    names = answer.model.gaits.names
    name = answer.best if gait is None else names[answer.model.gaits.index(gait)]
    return Trace(answer, name, _factors(answer), _cells(answer, name))


def _factors(answer: Posterior) -> pd.DataFrame:
    """Prior, P(variable | gait and the variables before it), their product and its share, by gait."""
    cell = answer.cell
    terms = log_terms(answer.model, (cell.distance_bin, cell.angle_bin, cell.heading_bin), cell.energy_bin)
    kept = {name: np.exp(logs) for name, logs in terms.items() if name == "prior" or name in cell.evidence}
    product = np.prod(list(kept.values()), axis=0)
    index = pd.Index(answer.model.gaits.names, name="Gait")
    return pd.DataFrame({**kept, "product": product, "posterior": product / product.sum()}, index=index)


def _cells(answer: Posterior, gait: str) -> pd.DataFrame:
    """The cells of P(Gait) and of each observed variable, with their counts."""
    model, rows = answer.model, []
    for variable, state in {"Gait": gait, **answer.cell.evidence}.items():
        column = 0 if variable == "Gait" else model.gaits.index(gait)
        at = list(model.states[variable]).index(state)
        low, high = cell_interval(model, variable, at)[:, model.gaits.index(gait)].tolist()
        rows.append(
            {
                "variable": variable,
                "state": state,
                "given": "" if variable == "Gait" else f"Gait = {gait}",
                "probability": model.cpt(variable).iloc[at, column],
                "count": model.counts(variable).iloc[at, column] if model.has_counts else pd.NA,
                "low": low,
                "high": high,
            }
        )
    return pd.DataFrame(rows).astype({"count": "Int64"})
