"""Sheets of probability tables, as heat maps: count, interval and rows of every cell at hand, long tables readable."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sized
from typing import Any

import numpy as np

from bayeshunt.core.units import label, true_minus
from bayeshunt.episodes.tracing import CellTrace
from bayeshunt.models.tables.probability_table import ProbabilityTable
from bayeshunt.views.drawings import svg
from bayeshunt.views.notebook.html import Html, number, probability, row, table, tag
from bayeshunt.views.sheets.panels import cell_panel
from bayeshunt.views.sheets.sheet import Drawn, Part, Printed, Sheet, Table
from bayeshunt.views.terminal.text_tables import clean

__all__ = ["MOST_ROWS", "heat_table", "probability_table"]

#: Of a longer table only the likeliest bins are shown; fewer where they are none the less a small part of it.
MOST_ROWS = 200
_LONG, _MOST_OF_LONG = 2000, 50
#: A table of no more bins is seen at once, without strips above it.
_FEW_BINS = 12
_MOST_PRINTED = 60  # rows of a table in text
_MOST_STRIPS = 40
#: Boxes of all strips of a table.
_MOST_BOXES = 1000
#: Cells of a table that open, and rows that all their panels list together.
_MOST_OPEN, _MOST_BABBLED = 300, 400
#: Nor more cells than a browser shows at once, some 2 MB of page.
_MOST_CELLS = 12_000


def probability_table(shown: ProbabilityTable) -> Sheet:
    """Return a table with all that is behind its numbers; in text the bins that rows fell into, or could."""
    bins, columns = shown.probability.shape
    parts: list[Part] = [Drawn(lambda: heat_table(shown)), Printed(lambda: _seen(shown).lines())]
    return Sheet(shown.title, f"{bins} x {columns}, {_origin(shown)}", (), parts)


def _seen(shown: ProbabilityTable) -> Table:
    """The bins that rows fell into, or could; zeros are dots."""
    values = shown.probability.to_numpy()
    counts = None if shown.count is None else shown.count.to_numpy().sum(axis=1)
    kept = np.flatnonzero(values.any(axis=1) if counts is None or not counts.any() else counts)[:_MOST_PRINTED]
    labels, head = _states(shown), [shown.variable, *map(clean, shown.probability.columns)]
    rows = [[labels[i], *("·" if p == 0 else f"{p:.3f}" for p in values[i])] for i in kept]
    left = len(labels) - len(kept)
    more = f"{left} more bins"
    if counts is not None:
        head.append("rows")
        rows = [[*row, counts[i]] for row, i in zip(rows, kept, strict=True)]
        more += f", {counts.sum() - counts[kept].sum()} rows in them"
    return Table(head, rows, left_out=more if left else "")


def _origin(shown: ProbabilityTable) -> str:
    if shown.count is None:
        return "imported: no counts, no intervals"
    prior = f"prior {number(shown.prior)}" if shown.prior else "maximum likelihood (no prior)"
    return f"{int(shown.count.to_numpy().sum())} rows, {prior}"


def heat_table(shown: ProbabilityTable) -> Html:
    """Return the heat table of one CPT, with switches that show counts and intervals where these are known."""
    values = shown.probability.to_numpy()
    behind = _behind(shown)
    kept = _rows_to_show(values)
    opened = _opened(shown, behind, kept)
    labels, columns = _states(shown), list(shown.probability.columns)
    top = max(float(values.max()), 1e-300)
    group = _group(shown)
    rows = []
    empty = _empty(values, behind) if len(values) > _FEW_BINS else np.zeros(len(values), dtype=bool)
    for i in kept:
        cells = [
            _cell(
                shown, (true_minus(labels[i]), columns[j]), values[i, j], [a[i, j] for a in behind], top, group,
                f"{group}-{i}-{j}" if (i, j) in opened else None,
            )
            for j in range(len(columns))
        ]  # fmt: skip
        rows.append(row(true_minus(labels[i]), cells, class_="bh-none" if empty[i] else None))
    shown_too = [("show counts", "bh-switch"), ("show intervals", "bh-limits")][: len(behind) // 2]
    switches = [tag("label", tag("input", type="checkbox"), text, class_=name) for text, name in shown_too]
    left_out = len(labels) - len(kept)
    note = tag("div", f"{left_out} bins are not shown.", class_="bh-note") if left_out else None
    behind_it = ("probability", "count", "count and interval")[len(behind) // 2]
    more = ", another opens its rows" if opened else ""
    hint = f"Point at a cell for its {behind_it}; a click keeps it{more}. Tab and the arrow keys go from cell to cell."
    heat = table([shown.variable, *columns], rows, class_="bh-heat")
    strips = _strips(values, columns) if len(values) > _FEW_BINS else None
    body = tag("div", heat, class_="bh-readout", data_hint=hint)
    below = [cell_panel(cell, shown.title, f"{group}-{i}-{j}", _most(opened)) for (i, j), cell in opened.items()]
    return tag("div", strips, *switches, body, note, *below, class_="bh-table")


def _opened(shown: ProbabilityTable, behind: list[np.ndarray], kept: list[int]) -> dict[tuple[int, int], CellTrace]:
    """The cells that open, by row and column: those shown that rows fell into, of very many the fullest."""
    if shown.model is None or not behind:
        return {}
    count, total = behind[:2]
    seen = sorted((-int(count[i, j]), i, j) for i in kept for j in np.flatnonzero(count[i]).tolist())[:_MOST_OPEN]
    variable, names = shown.variable.removesuffix(" residual"), shown.model.gaits.names
    values, states, found = shown.probability.to_numpy(), list(shown.probability.index), {}
    for _, i, j in seen:
        at = i if variable == "Gait" else j
        within = (float(behind[2][i, j]), float(behind[3][i, j])) if behind[2:] else None
        found[i, j] = CellTrace(
            shown.model, variable, str(states[i]), names[at],
            float(values[i, j]), int(count[i, j]), int(total[i, j]), within,
        )  # fmt: skip
    return found


def _most(opened: Sized) -> int:
    """Rows that each panel lists: few where there are many panels."""
    return max(3, min(12, _MOST_BABBLED // max(len(opened), 1)))


def _empty(values: np.ndarray, behind: list[np.ndarray]) -> np.ndarray:
    """Whether no row fell into each bin; where nobody counted, whether none ever could."""
    empty: np.ndarray = (behind[0] if behind else values).sum(axis=1) == 0
    return empty


def _strips(values: np.ndarray, columns: list[str]) -> Html:
    """Every column as a strip over all bins: where it has its weight, seen at once."""
    strips = min(len(columns), _MOST_STRIPS)
    values = _merged(values, max(50, _MOST_BOXES // strips))
    bins, parts = len(values), []
    for j in range(strips):
        top = max(float(values[:, j].max()), 1e-300)
        parts.append(tag("span", svg.shorten(str(columns[j]), 17)))
        boxes = [
            svg.box(i, 0, 1, 1, fill=svg.BAR, fill_opacity=f"{0.2 + 0.8 * float(values[i, j]) / top:.2f}")
            for i in np.flatnonzero(values[:, j] > 0.02 * top).tolist()
        ]
        parts.append(tag("svg", *boxes, viewBox=f"0 0 {bins} 1", preserveAspectRatio="none"))
    said = "Where each column has its weight, over all bins"
    return tag("div", *parts, class_="bh-strips", role="img", aria_label=said)


def _merged(values: np.ndarray, most: int) -> np.ndarray:
    """Values [K, G] of at most so many rows: where there are more, the greatest of each few that stand together."""
    few = -(-len(values) // most)
    return np.maximum.reduceat(values, np.arange(0, len(values), few)) if few > 1 else values


def _states(shown: ProbabilityTable) -> list[str]:
    """The bins as people read them, gaits as they are called."""
    names = list(shown.probability.index)
    return names if shown.variable == "Gait" else [label(name) for name in names]


def _behind(shown: ProbabilityTable) -> list[np.ndarray]:
    """Count, the total of the column, low and high of every cell [K, G]; without those that nobody knows."""
    if shown.count is None:
        return []
    count = shown.count.to_numpy()
    counted = [count, np.broadcast_to(count.sum(axis=0), count.shape)]
    return (
        counted if shown.low is None or shown.high is None else [*counted, shown.low.to_numpy(), shown.high.to_numpy()]
    )


def _group(shown: ProbabilityTable) -> str:
    """A name for the cells of one table, the same for the same table: one of them can be picked."""
    content = shown.title.encode() + shown.probability.to_numpy().tobytes()
    return f"bh-{hashlib.sha256(content).hexdigest()[:10]}"


def _cell(
    shown: ProbabilityTable, place: tuple[str, str], p: float, behind: list[Any], top: float, group: str,
    opens: str | None,
) -> Html:  # fmt: skip
    """A cell with what stands behind it. One that holds something is a choice among its table's.

    So the keyboard reaches the table at one stop, its arrow keys go from cell to cell, and a click keeps the words:
    all without a script. One that opens has a button over it, at its edge until the cell is picked.
    """
    given = f"{shown.variable} = {place[0]}" if shown.variable != "Gait" else str(place[0])
    known = "".join(f", {variable} = {state}" for variable, state in shown.known.items())
    column = f" | {place[1]}{known}" if shown.variable != "Gait" else ""
    hint = f"P({given}{column}) = {p:.4f}"
    content = [tag("span", probability(p), class_="bh-p")]
    if behind:
        n, total, *limits = behind
        if limits:
            hint += ", {:g} % interval {:.4f} to {:.4f}".format(100 * shown.level, *limits)
        hint += f", {int(n)} of {int(total)} rows"
        content.append(tag("span", int(n) or "·", class_="bh-n"))
        content += [tag("span", "{:.3f} to {:.3f}".format(*limits), class_="bh-i")] if limits else []
    shade = math.sqrt(p / top)
    zero = "bh-zero" if p == 0 else None
    if p > 0 or (behind and behind[0] > 0):
        content = [tag("label", tag("input", type="radio", name=group, aria_label=hint), *content)]
    if opens is not None:
        button = tag("button", "›", type="button", popovertarget=opens, aria_label=f"Rows of P({given}{column})")
        content = [tag("div", *content, button, class_="bh-cell")]
    return tag("td", *content, title=hint, class_=zero, style=f"--p:{shade:.2f}" if shade >= 0.005 else None)


def _rows_to_show(values: np.ndarray) -> list[int]:
    """All rows of a readable table; of a larger one the likeliest, in order."""
    most = min(MOST_ROWS if len(values) <= _LONG else _MOST_OF_LONG, max(20, _MOST_CELLS // values.shape[1]))
    if len(values) <= most:
        return list(range(len(values)))
    return sorted(np.argsort(-values.max(axis=1), kind="stable")[:most].tolist())
