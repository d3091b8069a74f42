"""One side panel for each bar of a posterior: its formula, its cells with their counts, and their rows.

Popovers of HTML: a card has no script, and needs none for a click, Enter, a breadcrumb and Esc.
"""

from __future__ import annotations

import hashlib
from typing import Any

from bayeshunt.core.units import true_minus
from bayeshunt.models.body.posterior import Posterior
from bayeshunt.views import grounds
from bayeshunt.views.notebook.html import Html, join, number, row, table, tag
from bayeshunt.views.opened import opened

__all__ = ["panels"]

_MOST_ROWS = 12  # of one cell


def panels(answer: Posterior) -> tuple[dict[str, str], Html]:
    """Return gait -> id of its panel, and the panels."""
    facts = opened(answer, rows=False)
    key = repr((answer.evidence, facts["factors"], facts["counts"]))
    group = f"bh-{hashlib.sha256(key.encode()).hexdigest()[:10]}"
    ids = {gait: f"{group}-{at}" for at, gait in enumerate(facts["gaits"])}
    return ids, join(_panel(answer, facts, at, ids[gait]) for at, gait in enumerate(facts["gaits"]))


def _panel(answer: Posterior, facts: dict[str, Any], at: int, name: str) -> Html:
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
        rows.append(row(f"{variable} {state}".strip(), [number(factors[place], 4), tag("td", said)]))
    ends = f" = {number(float(answer.values[at]), 4)}"
    return join(
        [_side(name, [f"P({gait})"], tag("p", formula + ends), table(["table of", "P", "counted"], rows)), *below]
    )


def _rows(answer: Posterior, variable: str, gait: str, names: tuple[str, str], said: str) -> Html:
    """The babbled rows behind one cell."""
    cell = (variable, gait) if variable == "Gait" else (variable, answer.cell.evidence[variable], gait)
    found = answer.model.rows(*cell)
    columns, lines = grounds.babbled(found, _MOST_ROWS)
    rest = len(found) - len(lines)
    more = tag("p", f"and {rest} more") if rest else None
    shown = table(columns, (row(at, map(true_minus, words)) for at, *words in lines))
    return _side(names[1], [f"P({gait})", said], shown, more)


def _side(name: str, path: list[str], *content: Any) -> Html:
    """A panel with its breadcrumb, whose first part closes what lies above it."""
    back = {"type": "button", "popovertarget": name, "popovertargetaction": "hide"}
    *before, here = path
    crumbs = [tag("li", tag("button", part, **back)) for part in before]
    crumbs.append(tag("li", here, aria_current="page"))
    close = tag("button", "×", aria_label="Close", **back)
    head = tag("div", tag("ol", *crumbs, class_="bh-crumbs"), close, class_="bh-head")
    said = f"What {here} is made of" if not before else f"Rows of {here}"
    return tag("div", head, *content, class_="bh-side", id=name, popover=True, role="dialog", aria_label=said)
