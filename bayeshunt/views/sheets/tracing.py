"""The sheet of a number opened."""

from __future__ import annotations

import pandas as pd

from bayeshunt.core.units import label
from bayeshunt.episodes.tracing import Trace
from bayeshunt.views.sheets.sheet import Note, Sheet, Table

__all__ = ["trace"]


def trace(opened: Trace) -> Sheet:
    """Return the formula with its numbers, the factors of every gait, and the cells behind those of one."""
    factors = opened.factors
    rows = [[gait, *(f"{value:.4g}" for value in factors.loc[gait])] for gait in factors.index]
    lit = frozenset({list(factors.index).index(opened.gait)})
    cells = [
        [
            cell["variable"],
            cell["state"] if cell["variable"] == "Gait" else label(cell["state"]),
            f"{cell['probability']:.4g}",
            "unknown" if pd.isna(cell["count"]) else int(cell["count"]),
        ]
        for cell in opened.cells.to_dict("records")
    ]
    return Sheet(
        f"Trace of P({opened.gait})",
        "",
        [("formula", opened.formula)],
        [
            Table(["Gait", *factors.columns], rows, lit, most=len(rows)),
            Table(["table of", "state", "probability", "rows"], cells, words=frozenset({0, 1})),
            Note(
                "trace.rows(variable) gives the babbled rows behind a cell; model.without(rows) the model without them."
            ),
        ],
    )
