"""One side panel for each number of a card: its formula, its count and interval, and the rows behind it.

Popovers of HTML: a card has no script, and needs none for a click, Enter, a breadcrumb and Esc.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from typing import Any

import pandas as pd

from bayeshunt.core.units import bounds, label, true_minus
from bayeshunt.episodes.tracing import CellTrace
from bayeshunt.models.body.posterior import Posterior
from bayeshunt.views import grounds
from bayeshunt.views.notebook.html import Html, join, number, row, table, tag
from bayeshunt.views.opened import opened

__all__ = ["babbled_list", "cell_panel", "panels", "side"]

_MOST_ROWS = 12  # of one cell
_NO_ROWS = "the model holds none, model.with_data(frame) gives it its own again"


def panels(answer: Posterior) -> tuple[dict[str, str], Html]:
    """Return gait -> id of its panel, and the panels."""
    facts = opened(answer, rows=False)
    key = repr((answer.evidence, facts["factors"], facts["counts"]))
    group = f"bh-{hashlib.sha256(key.encode()).hexdigest()[:10]}"
    ids = {gait: f"{group}-{at}" for at, gait in enumerate(facts["gaits"])}
    found = grounds.interval(answer)
    sure = {} if found is None else grounds.within(found)
    return ids, join(_panel(answer, facts, at, ids[gait], sure.get(gait)) for at, gait in enumerate(facts["gaits"]))


def _panel(answer: Posterior, facts: dict[str, Any], at: int, name: str, sure: tuple[float, float] | None) -> Html:
    """The formula of one gait's probability, a row per factor, and the panels of its cells."""
    gait, holds = facts["gaits"][at], bool(len(answer.model.data))
    factors = [values[at] for values in facts["factors"]]
    product = " × ".join(number(value, 4) for value in factors)
    formula = f"P({gait} | {', '.join(answer.evidence)}) = {product} / {number(answer.evidence_probability, 4)}"
    rows, below = [], []
    for place, (variable, state) in enumerate(zip(facts["variables"], facts["states"], strict=True)):
        count = facts["counts"][place][at]
        said = f"{count} {'row' if count == 1 else 'rows'}"
        if count and holds:
            cell = f"{name}-{place}"
            below.append(_rows(answer, variable, gait, (name, cell), f"{variable} {state}".strip()))
            said = tag("button", said, type="button", popovertarget=cell)
        within = facts["within"][place][at] or "set"
        rows.append(row(f"{variable} {state}".strip(), [number(factors[place], 4), within, tag("td", said)]))
    ends = f" = {number(float(answer.values[at]), 4)}"
    heads = ["table of", "P", "95 % interval", "counted"]
    how_sure = None if sure is None else tag("p", f"95 % interval {bounds(*sure)}")
    return join([side(name, [f"P({gait})"], tag("p", formula + ends), how_sure, table(heads, rows)), *below])


def _rows(answer: Posterior, variable: str, gait: str, names: tuple[str, str], said: str) -> Html:
    """The babbled rows behind one cell."""
    cell = (variable, gait) if variable == "Gait" else (variable, answer.cell.evidence[variable], gait)
    found = answer.model.rows(*cell)
    columns, lines = grounds.babbled(found, _MOST_ROWS)
    rest = len(found) - len(lines)
    more = tag("p", f"and {rest} more") if rest else None
    shown = table(columns, (row(at, map(true_minus, words)) for at, *words in lines))
    return side(names[1], [f"P({gait})", said], shown, more)


def cell_panel(opened: CellTrace, title: str, name: str, most: int) -> Html:
    """Return the panel of a cell of a table: its rule with its numbers, its interval, and at most ``most`` rows.

    title: of the table. name: id of the panel.
    """
    state = opened.state if opened.variable == "Gait" else label(opened.state)
    said = [true_minus(opened.formula.replace(f"= {opened.state}", f"= {state}", 1))]
    said += [] if opened.within is None else [f"95 % interval {grounds.cell_within(*opened.within)}"]
    here = state if opened.variable == "Gait" else f"{state}, {opened.gait}"
    counted = f"{opened.count} of {opened.total} rows"
    rows = babbled_list(opened.rows(), most, counted) if len(opened.model.data) else tag("p", f"{counted}; {_NO_ROWS}")
    return side(name, [title, true_minus(here)], *(tag("p", line) for line in said), rows)


def babbled_list(found: pd.DataFrame, most: int, said: str) -> Html:
    """Return the first babbled rows as a list under what is ``said`` of them, and how many more there are."""
    columns, lines = grounds.babbled(found, most)
    listed = tag("ol", *(_listed(*line) for line in lines), class_="bh-rows")
    rest = len(found) - len(lines)
    head = tag("p", f"{said}: {', '.join(columns[1:])}")
    return join([head, listed, tag("p", f"and {rest} more") if rest else None])


def _listed(at: str, *said: str) -> Html:
    return tag("li", tag("span", at), true_minus(", ".join(said)))


def side(name: str, path: Sequence[str], *content: Any) -> Html:
    """Return a panel with its breadcrumb, whose first part closes what lies above it."""
    back = {"type": "button", "popovertarget": name, "popovertargetaction": "hide"}
    *before, here = path
    crumbs = [tag("li", tag("button", part, **back)) for part in before]
    crumbs.append(tag("li", here, aria_current="page"))
    close = tag("button", "×", aria_label="Close", **back)
    head = tag("div", tag("ol", *crumbs, class_="bh-crumbs"), close, class_="bh-head")
    said = f"What {here} is made of" if not before else f"Rows of {here}"
    return tag("div", head, *content, class_="bh-side", id=name, popover=True, role="dialog", aria_label=said)
