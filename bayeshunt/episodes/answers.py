"""What a decision's answer rests on, in numbers that an episode keeps: its interval, and the table cells behind it.

So a file of an episode alone says how sure every posterior was, and opens it down to the counts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from bayeshunt.episodes.tracing import trace_answer
from bayeshunt.episodes.tracing_cells import cell_interval
from bayeshunt.models.body.posterior import Posterior
from bayeshunt.planners.api import Plan

__all__ = ["AnswerCells", "answer_cells", "stored", "with_answers"]


class AnswerCells(NamedTuple):
    """The cells behind P(Gait | evidence), V variables ("Gait" first, then those observed) and G gaits.

    within: ends of the posterior's 95 % interval [2, G]. states: the bins, "" of Gait. factors: what multiplies [V, G].
    counts: rows in the cells [V, G]; low, high: their 95 % intervals [V, G], NaN where a table is set, not estimated.
    None of an imported network: within, counts, low, high.
    """

    variables: list[str]
    states: list[str]
    factors: np.ndarray
    within: np.ndarray | None = None
    counts: np.ndarray | None = None
    low: np.ndarray | None = None
    high: np.ndarray | None = None


def answer_cells(answer: Posterior, *, within: bool = True) -> AnswerCells:
    """Return the cells behind an answer; ``within``: and its interval, which costs most."""
    model, evidence = answer.model, answer.cell.evidence
    factors = trace_answer(answer).factors.drop(columns=["product", "posterior"]).to_numpy().T
    variables, states = ["Gait", *evidence], ["", *evidence.values()]
    if not model.has_counts:
        return AnswerCells(variables, states, factors)
    counts, ends = [model.counts("Gait").to_numpy()[:, 0]], [cell_interval(model, "Gait")]
    for variable, state in evidence.items():
        at = list(model.states[variable]).index(state)
        counts.append(model.counts(variable).to_numpy()[at])
        ends.append(cell_interval(model, variable, at))
    low, high = np.stack(ends, axis=1)
    found = answer.interval()[["low", "high"]].to_numpy().T if within else None
    return AnswerCells(variables, states, factors, found, np.stack(counts).astype(int), low, high)


def with_answers(frame: pd.DataFrame, plans: Sequence[Plan]) -> pd.DataFrame:
    """Return an episode's table with ``answer_*``: what :class:`AnswerCells` has, as lists, row after row.

    The table as it is where no plan carries an answer.
    """
    if not any(plan.answer is not None for plan in plans):
        return frame
    found = [None if plan.answer is None else answer_cells(plan.answer) for plan in plans]
    columns: dict[str, Any] = {
        f"answer_{name}": [_column(rests, name) for rests in found] for name in AnswerCells._fields
    }
    return frame.assign(**columns)


def _column(rests: AnswerCells | None, name: str) -> list[Any] | None:
    value = None if rests is None else getattr(rests, name)
    return None if value is None else np.ravel(value).tolist()


def stored(row: Mapping[Any, Any]) -> AnswerCells | None:
    """Return what a row of the table keeps of its answer; None if it keeps nothing."""
    if row.get("answer_variables") is None:
        return None
    variables, states = ([str(name) for name in row[f"answer_{part}"]] for part in ("variables", "states"))
    gaits = len(row["answer_factors"]) // len(variables)

    def kept(part: str) -> np.ndarray | None:
        values = row[f"answer_{part}"]
        return None if values is None else np.asarray(values).reshape(-1, gaits)

    return AnswerCells(
        variables, states, np.asarray(row["answer_factors"]).reshape(-1, gaits),
        *(kept(part) for part in ("within", "counts", "low", "high")),
    )  # fmt: skip
