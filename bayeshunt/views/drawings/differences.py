"""Two models side by side as drawings: signed heat tables, and the inverse map with what changed."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from bayeshunt.core.units import degrees, label, length, true_minus
from bayeshunt.models.comparison.compare import Comparison
from bayeshunt.views import theme
from bayeshunt.views.drawings import svg
from bayeshunt.views.drawings.maps import Window, sector
from bayeshunt.views.notebook.html import Html, row, table, tag

__all__ = ["answers_map", "signed_table"]

_MOST_ROWS = 60
_LEAST = 0.005  # smaller differences are not written


def signed_table(found: Comparison, variable: str) -> Html:
    """Return the differences of one table: orange where the second model says more, blue where less.

    Cells whose interval excludes 0 are framed; bins that differ nowhere are left out.
    """
    difference, marked = found.difference[variable], found.marked[variable].to_numpy()
    low, high, values = found.low[variable].to_numpy(), found.high[variable].to_numpy(), difference.to_numpy()
    kept = np.flatnonzero(marked.any(axis=1) | (np.abs(np.nan_to_num(values)) >= _LEAST).any(axis=1))
    shown = sorted(
        kept[np.argsort(-np.abs(np.nan_to_num(values[kept])).max(axis=1), kind="stable")][:_MOST_ROWS].tolist()
    )
    top = max(float(np.nanmax(np.abs(values))), 1e-300)
    rows = []
    for i in shown:
        name = true_minus(label(str(difference.index[i])))
        cells = [_cell(values[i, j], top, bool(marked[i, j]), (low[i, j], high[i, j])) for j in range(values.shape[1])]
        rows.append(row(name, cells))
    left = len(difference) - len(shown)
    note = f"{left} bins differ nowhere or less." if left else ""
    heads = [variable, *map(str, difference.columns)]
    return tag("div", table(heads, rows, class_="bh-signed"), tag("div", note, class_="bh-note") if note else None)


def _cell(value: float, top: float, marked: bool, ends: tuple[float, float]) -> Html:
    if math.isnan(value):
        return tag("td", "?")
    text = "·" if abs(value) < _LEAST else true_minus(f"{value:+.2f}".replace("0.", "."))
    colour = "var(--bh-prey)" if value > 0 else "var(--bh-hunter)"
    share = round(40 * math.sqrt(abs(value) / top))
    look = f"background:color-mix(in srgb, {colour} {share}%, transparent)" if share else None
    known = not any(map(math.isnan, ends))
    hint = f"{value:+.4f}" + (f", interval {ends[0]:+.4f} to {ends[1]:+.4f}" if known else "")
    return tag("td", tag("b", text) if marked else text, style=look, title=hint, class_="bh-marked" if marked else None)


def answers_map(found: Comparison, *, after: bool) -> Html:
    """Return the most probable gait of every coordinate of one of the models; those that changed are outlined."""
    model, answers, axes = found.models[after], found.answers, found.models[after].axes
    outer = answers["distance"] + axes.distance.width
    window = Window.around(
        [0.0, *(outer * np.sin(answers["angle"]))], [0.0, *(outer * np.cos(answers["angle"]))], size=380
    )
    drawn = zip(theme.gait_variables(found.models[0]), theme.stripes(found.models[0]), strict=True)  # one key for both
    looks = dict(zip(model.gaits.names, drawn, strict=True))
    order = answers.sort_values("changed", kind="stable")  # outlines on top
    parts = [
        _sector(window, one, axes.distance.width, 2 * math.pi / axes.angle.bins, looks, after)
        for one in order.to_dict("records")
    ]
    which = "second" if after else "first"
    parts += [window.robot(0, 0, math.pi / 2, svg.INK, "robot", 8), window.ruler()]
    return svg.drawing(window.width, window.height, *parts, label=f"Most probable gait of the {which} model")


def _sector(
    window: Window, one: dict[Any, Any], wide: float, turn: float, looks: dict[str, tuple[str, int]], after: bool
) -> Html:
    distance, angle = float(one["distance"]), float(one["angle"])
    gait = str(one["after" if after else "before"])
    reach, edges = np.array([distance - wide / 2, distance + wide / 2]), np.array([angle - turn / 2, angle + turn / 2])
    place = f"{length(distance)}, {true_minus(degrees(angle))}"
    hint = f"{place}: {one['before']}" + (f", then {one['after']}" if one["changed"] else "")
    outline = {"stroke": svg.INK, "stroke_width": 2.2} if one["changed"] else {}
    colour, stripes = looks[gait]
    return sector(window, reach, edges, colour, hint, stripes, **outline)
