"""An answer opened as plain values, for pages and widgets: factors of every gait, their cells' counts, some rows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.units import label, true_minus
from bayeshunt.episodes.answers import AnswerCells, answer_cells
from bayeshunt.episodes.tracing import trace_answer
from bayeshunt.models.body.posterior import Posterior
from bayeshunt.views import grounds
from bayeshunt.views.pages.page import number

__all__ = ["opened", "opened_cells"]

_MOST_ROWS = 30  # of one cell


def opened(answer: Posterior, *, rows: bool = True) -> dict[str, Any]:
    """Return what trace.js shows of an answer; :func:`opened_cells` says what.

    rows: of the most probable gait's cells, [index, distance, angle, heading] in words, where the model holds rows.
    """
    model, found = answer.model, trace_answer(answer)
    rests = answer_cells(answer, within=False)
    held = rows and model.has_counts and len(model.data) > 0
    plain = opened_cells(rests, model.gaits.names, answer.best)
    return {**plain, "rows": [_rows(found.rows(variable)) for variable in rests.variables] if held else None}


def opened_cells(rests: AnswerCells, gaits: Sequence[str], best: str) -> dict[str, Any]:
    """Return the cells behind an answer as plain values.

    gaits; variables: "Gait" and those observed; states: their bins as people read them; factors [V, G]: P(Gait) and
    P(variable | gait and the variables before it); counts [V, G] of the cells, and within [V, G], their intervals in
    words, "" where a table was set: None where nobody knows. best: the gait whose rows are shown. rows: None.
    """
    return {
        "gaits": list(gaits),
        "variables": rests.variables,
        "states": [true_minus(label(state)) for state in rests.states],
        "factors": [[number(v) for v in values] for values in rests.factors.tolist()],
        "counts": None if rests.counts is None else rests.counts.tolist(),
        "within": None if rests.low is None or rests.high is None else _within(rests.low, rests.high),
        "best": best,
        "rows": None,
    }


def _within(low: np.ndarray, high: np.ndarray) -> list[list[str]]:
    ends = zip(low.tolist(), high.tolist(), strict=True)
    return [["" if a != a else grounds.cell_within(a, b) for a, b in zip(*line, strict=True)] for line in ends]


def _rows(frame: pd.DataFrame) -> dict[str, Any]:
    """The first rows in words, and how many there are."""
    columns, lines = grounds.babbled(frame, _MOST_ROWS)
    return {"columns": columns, "lines": [[at, *map(true_minus, said)] for at, *said in lines], "count": len(frame)}
