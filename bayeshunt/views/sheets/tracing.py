"""The sheet of a number opened."""

from __future__ import annotations

import pandas as pd

from bayeshunt.core.units import bounds, label, objective
from bayeshunt.episodes.tracing import CellTrace, PlanTrace, Trace
from bayeshunt.views import grounds
from bayeshunt.views.sheets.sheet import Note, Part, Sheet, Table

__all__ = ["cell", "plan", "trace"]


_MOST_ROWS = 20  # of a cell, in its sheet


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
            "" if pd.isna(cell["low"]) else grounds.cell_within(cell["low"], cell["high"]),
        ]
        for cell in opened.cells.to_dict("records")
    ]
    return Sheet(
        f"Trace of P({opened.gait})",
        "",
        [("formula", opened.formula), *_sure(opened)],
        [
            Table(["Gait", *factors.columns], rows, lit, most=len(rows)),
            Table(["table of", "state", "probability", "rows", "95 % interval"], cells, words=frozenset({0, 1})),
            Note(
                "trace.rows(variable) gives the babbled rows behind a cell; model.without(rows) the model without them."
            ),
        ],
    )


def _sure(opened: Trace) -> list[tuple[str, str]]:
    """The interval of the probability, and whether the answer is sure; nothing where nobody knows."""
    found = grounds.interval(opened.answer)
    if found is None:
        return []
    within = bounds(*grounds.within(found)[opened.gait])
    return [("95 % interval", within), ("how sure", grounds.how_sure(opened.answer, found))]


def cell(opened: CellTrace) -> Sheet:
    """Return the rule of a cell with its numbers, and the rows behind it where the model holds them."""
    note = Note("trace.rows() gives the babbled rows behind the cell.")
    shown = None
    if opened.model.has_counts and len(opened.model.data):
        rows = opened.rows()
        columns, lines = grounds.babbled(rows, _MOST_ROWS)
        left = len(rows) - len(lines)
        shown = Table(columns, lines, left_out=f"and {left} more" if left > 0 else "")
    formula = opened.formula.replace(f"= {opened.state}", f"= {label(opened.state)}", 1)
    pairs = [("formula", formula)]
    pairs += [] if opened.within is None else [("95 % interval", grounds.cell_within(*opened.within))]
    return Sheet(f"Trace of a cell of P({opened.variable})", "", pairs, [shown, note])


def plan(opened: PlanTrace) -> Sheet:
    """Return what a plan's value is made of, its branch, and the best and worst under each first gait."""
    value = next(name for name in ("value_m", "value_s", "value") if name in opened.branch)
    factor, unit = (1000.0, "mm") if value == "value_m" else (1.0, "s" if value == "value_s" else "")
    branch = [[str(row.get("gait") or "now"), f"{factor * row[value]:.4g}"] for row in opened.branch.to_dict("records")]
    rest = [
        [str(gait), int(row["nodes"]), f"{factor * row['least']:.4g}", f"{factor * row['greatest']:.4g}"]
        for gait, row in opened.alternatives.iterrows()
    ]
    lit = frozenset(
        {list(opened.alternatives.index).index(opened.gait)} if opened.gait in opened.alternatives.index else ()
    )
    parts: list[Part | None] = [
        Table(["branch", f"value [{unit}]" if unit else "value"], branch),
        Table(["first gait", "nodes", "least", "greatest"], rest, lit),
    ]
    if opened.model is not None:
        cells = [
            [c["gait"], c["variable"], label(c["state"]), f"{c['probability']:.4g}",
             "unknown" if pd.isna(c["count"]) else f"{c['count']} of {c['rows']}"]
            for c in opened.cells.to_dict("records")
        ]  # fmt: skip
        parts.append(Table(["gait", "table of", "likeliest", "probability", "rows"], cells, words=frozenset({0, 1, 2})))
    parts.append(Note("trace.rows(gait) gives the babbled rows that a gait's outcomes are drawn from."))
    return Sheet(f"Trace of the decision for {opened.gait}", "", [("formula", _said(opened))], parts)


def _said(opened: PlanTrace) -> str:
    """The formula in the units of people."""
    value, what = objective(opened.plan.value, opened.plan.objective)
    said = f"{what}: {value:.6g}, the least of {opened.plan.nodes} alternatives"
    if opened.means is None:
        return said
    hunter, prey, gap = opened.means
    places = [f"({', '.join(f'{1000 * part:.1f}' for part in place)}) mm" for place in (hunter, prey)]
    return (
        f"{said}; after {opened.steps} gaits the mean hunter is at {places[0]} and the prey expected at {places[1]}, "
        f"{1000 * gap:.1f} mm apart"
    )
