"""Sheets of probability tables, as heat maps: count and interval of every cell at hand, long tables readable."""

from __future__ import annotations

import hashlib
import math
from typing import Any

import numpy as np

from bayeshunt.core.errors import NothingObservedError
from bayeshunt.core.units import degrees, label, length, true_minus
from bayeshunt.models.tables.probability_table import ProbabilityTable
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.views.drawings import maps, svg
from bayeshunt.views.notebook.html import Html, number, probability, row, table, tag
from bayeshunt.views.sheets.sheet import Drawn, Note, Part, Printed, Sheet, Table
from bayeshunt.views.terminal.text_tables import clean

#: Of a longer table only the likeliest bins are shown.
MOST_ROWS = 200
#: A table of no more bins is seen at once, without strips above it.
_FEW_BINS = 12
_MOST_PRINTED = 60  # rows of a table in text
_MOST_STRIPS = 40
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
    labels, columns = _states(shown), list(shown.probability.columns)
    top = max(float(values.max()), 1e-300)
    group = _group(shown)
    rows = []
    empty = _empty(values, behind) if len(values) > _FEW_BINS else np.zeros(len(values), dtype=bool)
    for i in kept:
        cells = [
            _cell(shown, (true_minus(labels[i]), columns[j]), values[i, j], [a[i, j] for a in behind], top, group)
            for j in range(len(columns))
        ]
        rows.append(row(true_minus(labels[i]), cells, class_="bh-none" if empty[i] else None))
    shown_too = [("show counts", "bh-switch"), ("show intervals", "bh-limits")][: len(behind) // 2]
    switches = [tag("label", tag("input", type="checkbox"), text, class_=name) for text, name in shown_too]
    left_out = len(labels) - len(kept)
    note = tag("div", f"{left_out} bins are not shown.", class_="bh-note") if left_out else None
    behind_it = ("probability", "count", "count and interval")[len(behind) // 2]
    hint = f"Point at a cell for its {behind_it}; a click keeps it, Tab and the arrow keys go from cell to cell."
    heat = table([shown.variable, *columns], rows, class_="bh-heat")
    strips = _strips(values, columns) if len(values) > _FEW_BINS else None
    body = tag("div", heat, class_="bh-readout", data_hint=hint)
    return tag("div", strips, *switches, body, note, class_="bh-table")


def _empty(values: np.ndarray, behind: list[np.ndarray]) -> np.ndarray:
    """Whether no row fell into each bin; where nobody counted, whether none ever could."""
    empty: np.ndarray = (behind[0] if behind else values).sum(axis=1) == 0
    return empty


def _strips(values: np.ndarray, columns: list[str]) -> Html:
    """Every column as a strip over all bins: where it has its weight, seen at once."""
    bins, parts = len(values), []
    for j in range(min(len(columns), _MOST_STRIPS)):
        top = max(float(values[:, j].max()), 1e-300)
        parts.append(tag("span", svg.shorten(str(columns[j]), 17)))
        boxes = [
            svg.box(i, 0, 1, 1, fill=svg.BAR, fill_opacity=f"{0.2 + 0.8 * float(values[i, j]) / top:.2f}")
            for i in np.flatnonzero(values[:, j] > 0.02 * top).tolist()
        ]
        parts.append(tag("svg", *boxes, viewBox=f"0 0 {bins} 1", preserveAspectRatio="none"))
    said = "Where each column has its weight, over all bins"
    return tag("div", *parts, class_="bh-strips", role="img", aria_label=said)


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


def _cell(shown: ProbabilityTable, place: tuple[str, str], p: float, behind: list[Any], top: float, group: str) -> Html:
    """A cell with what stands behind it. One that holds something is a choice among its table's.

    So the keyboard reaches the table at one stop, its arrow keys go from cell to cell, and a click keeps the words:
    all without a script.
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
    return tag("td", *content, title=hint, class_=zero, style=f"--p:{shade:.2f}" if shade >= 0.005 else None)


def _rows_to_show(values: np.ndarray) -> list[int]:
    """All rows of a readable table; of a larger one the likeliest, in order."""
    most = min(MOST_ROWS, max(20, _MOST_CELLS // values.shape[1]))
    if len(values) <= most:
        return list(range(len(values)))
    return sorted(np.argsort(-values.max(axis=1), kind="stable")[:most].tolist())


def prey_model(prey: PreyModel) -> Sheet:
    """Return the prey table: each transition seen, how often, and where it leads."""
    title = "Prey model: P(Distance, Angle, Heading)"
    subtitle = f"{prey.observations} transitions, in the prey's own frame one time-step earlier"
    if prey.is_empty:
        return Sheet(title, subtitle, (), [Note("Nothing observed yet, so nothing can be predicted.")])
    cells = prey_table(prey)
    return Sheet(
        title, subtitle, expected(prey), [Drawn(lambda: prey_map(prey), cells, beside=True), Printed(cells.lines)]
    )


def expected(prey: PreyModel) -> list[tuple[str, str]]:
    """Return the mean transition in words; nothing if the headings seen leave no mean."""
    try:
        mean = prey.predict(1)
    except NothingObservedError:
        return []
    return [
        ("expected next distance", length(mean.distance)),
        ("expected angle", f"{degrees(mean.angle, 1)} clockwise"),
        ("expected heading", f"{degrees(mean.heading, 1)} clockwise"),
    ]


def prey_table(prey: PreyModel) -> Table:
    """Return the cells seen, the most frequent first."""
    frame = prey.cpt().sort_values("count", ascending=False, kind="stable")
    columns = (frame[name].tolist() for name in ("probability", "count", "low", "high"))
    rows = [
        [*map(label, bins), f"{p:.3f}", _count(n), f"{low:.3f} to {high:.3f}"]
        for bins, p, n, low, high in list(zip(frame.index, *columns, strict=True))[:MOST_ROWS]
    ]
    rest = len(frame) - len(rows)
    more = f"and {rest} rarer cells" if rest else ""
    return Table(["Distance", "Angle", "Heading", "P", "count", "95 % interval"], rows, left_out=more)


def _count(number: float) -> str:
    """A count in words; an expected one to three digits."""
    return f"{number:.0f}" if number == int(number) else f"{number:.3g}"


def prey_map(prey: PreyModel) -> Html:
    """Return where the prey's steps led, as arrows in its own earlier frame (heading up)."""
    cells = np.array(prey.to_dict()["counts"])[:, :3].astype(int)
    weights = np.array(prey.to_dict()["counts"])[:, 3]
    axes = prey.axes
    reach = (cells[:, 0] + 0.5) * axes.distance.width
    angles, headings = axes.angle.centres[cells[:, 1]], axes.heading.centres[cells[:, 2]]
    right, ahead = reach * np.sin(angles), reach * np.cos(angles)
    window = maps.Window.around([0.0, *right], [0.0, *ahead], size=240, least=float(reach.max()))
    parts = [window.robot(0, 0, math.pi / 2, svg.FAINT, "the prey one time-step earlier", 9)]
    for i in np.argsort(weights, kind="stable")[-400:]:
        size = 4 + 8 * math.sqrt(weights[i] / weights.max())
        hint = f"{_count(weights[i])} of {prey.observations} transitions"
        parts.append(window.robot(right[i], ahead[i], math.pi / 2 - headings[i], svg.PREY, hint, size))
    return svg.drawing(window.width, window.height, *parts, window.ruler(), label="Where the prey's steps led")
