"""Which cell, moved over its own interval, changes P(best gait) most: a tornado whose bars open the rows."""

from __future__ import annotations

from typing import Any

import pandas as pd

from bayeshunt.core.units import label, true_minus
from bayeshunt.models.body.posterior import Posterior
from bayeshunt.views import grounds
from bayeshunt.views.drawings import svg
from bayeshunt.views.notebook.html import Html, fold, row, table, tag

__all__ = ["tornado"]

_MOST_BARS, _MOST_ROWS = 8, 12
_LEAST = 5e-4  # smaller effects are not drawn
_WIDE = 260.0


def tornado(answer: Posterior) -> Html:
    """Return a bar per cell, the one that matters most first: from P(best) at its low end to that at its high end."""
    found = answer.sensitivity()
    shown: list[dict[Any, Any]] = found[found["effect"] >= _LEAST].head(_MOST_BARS).to_dict("records")
    point = float(answer.probabilities[answer.best])
    if not shown:
        words = f"No cell, moved over its own interval, changes P({answer.best}) by {_LEAST:g} or more."
        return tag("div", words, class_="bh-note")
    bars = [fold(_bar(cell, point), _rows(answer, cell)) for cell in shown]
    note = f"Bars: P({answer.best}) as each cell moves over its own 95 % interval; the line is the answer, {point:.3f}."
    return tag("div", *bars, tag("div", note, class_="bh-note"))


def _bar(cell: dict[Any, Any], point: float) -> Html:
    ends = sorted((float(cell["best_at_low"]), float(cell["best_at_high"])))
    name = f"{cell['variable']} {label(str(cell['state']))}, {cell['given']}"
    count = "count unknown" if pd.isna(cell["count"]) else f"{int(cell['count'])} rows"
    said = f"{ends[0]:.3f} to {ends[1]:.3f}, {count}"
    picture = svg.drawing(
        _WIDE, 14,
        svg.box(0, 1, _WIDE, 12, fill=svg.PANEL),
        svg.box(_WIDE * ends[0], 1, max(_WIDE * (ends[1] - ends[0]), 1.0), 12, fill=svg.BAR),
        svg.line([(_WIDE * point, 0), (_WIDE * point, 14)], stroke=svg.CHOSEN, stroke_width=2),
        label=f"{name}: {said}",
    )  # fmt: skip
    return tag("span", picture, f"{true_minus(name)}: {said}", class_="bh-tornado")


def _rows(answer: Posterior, cell: dict[Any, Any]) -> Html:
    """The babbled rows that the cell counts, where the model holds them."""
    model = answer.model
    if not (model.has_counts and len(model.data)):
        return tag("div", "The model holds no rows; model.with_data(frame) gives it its own again.", class_="bh-note")
    if pd.isna(cell["gait"]):
        return tag("div", "Rows are shown of one gait; this cell counts those of every gait.", class_="bh-note")
    found = model.rows(str(cell["variable"]), str(cell["state"]), str(cell["gait"]))
    if not len(found):
        return tag("div", "No row fell into this cell.", class_="bh-note")
    columns, lines = grounds.babbled(found, _MOST_ROWS)
    rest = len(found) - len(lines)
    more = tag("div", f"and {rest} more rows", class_="bh-note") if rest else None
    return tag("div", table(columns, (row(at, map(true_minus, said)) for at, *said in lines)), more)
