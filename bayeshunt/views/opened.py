"""An answer opened as plain values, for pages and widgets: factors of every gait, their cells' counts, some rows."""

from __future__ import annotations

from typing import Any

import pandas as pd

from bayeshunt.core.units import label, true_minus
from bayeshunt.episodes.tracing import trace_answer
from bayeshunt.models.body.posterior import Posterior
from bayeshunt.views import grounds
from bayeshunt.views.pages.page import number

__all__ = ["opened"]

_MOST_ROWS = 30  # of one cell


def opened(answer: Posterior, *, rows: bool = True) -> dict[str, Any]:
    """Return what trace.js shows of an answer.

    gaits; variables: "Gait" and those observed; states: their bins as people read them; factors [V, G]: P(Gait) and
    P(variable | gait and the variables before it); counts [V, G] of the cells, None where nobody knows.
    rows: of the most probable gait's cells, [index, distance, angle, heading] in words, where the model holds rows.
    """
    model, found = answer.model, trace_answer(answer)
    names = list(model.gaits.names)
    factors = found.factors.drop(columns=["product", "posterior"])
    variables = ["Gait", *answer.cell.evidence]
    held = rows and model.has_counts and len(model.data) > 0
    counts = [_counts(answer, variable) for variable in variables] if model.has_counts else None
    return {
        "gaits": names,
        "variables": variables,
        "states": ["", *(true_minus(label(state)) for state in answer.cell.evidence.values())],
        "factors": [[number(v) for v in factors[column].tolist()] for column in factors],
        "counts": counts,
        "best": answer.best,
        "rows": [_rows(found.rows(variable)) for variable in variables] if held else None,
    }


def _counts(answer: Posterior, variable: str) -> list[int]:
    counts = answer.model.counts(variable)
    table = counts.to_numpy()
    if variable != "Gait":
        return [int(n) for n in table[list(counts.index).index(answer.cell.evidence[variable])]]
    return [int(n) for n in table[:, 0]]


def _rows(frame: pd.DataFrame) -> dict[str, Any]:
    """The first rows in words, and how many there are."""
    columns, lines = grounds.babbled(frame, _MOST_ROWS)
    return {"columns": columns, "lines": [[at, *map(true_minus, said)] for at, *said in lines], "count": len(frame)}
