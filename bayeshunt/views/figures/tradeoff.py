"""The figure of a trade-off: what a quicker catch costs in changes of gait and in metres."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bayeshunt.views.figures.style import FAINT, LINE, MARKERS, PLANNERS, shorten, styled

__all__ = ["tradeoff_figure"]

_PANELS = (("mean_transitions", "changes of gait per hunt"), ("mean_distance_m", "way travelled per hunt [m]"))
_ENERGY = ("mean_energy_j", "energy per hunt [J]")


@styled
def tradeoff_figure(frame: pd.DataFrame) -> Figure:
    """Return mean catch time against changes of gait and against distance, one point per planner and weight.

    Of a body that measures what it spends, against energy and against changes of gait.

    frame: as :func:`bayeshunt.experiments.studies.tradeoff.tradeoff` returns it. The points of one varied weight
    are joined; the value stands beside each. Whiskers: 95 % t intervals of the means.
    """
    panels = (_ENERGY, _PANELS[0]) if _ENERGY[0] in frame else _PANELS
    figure = Figure(figsize=(9.0, 4.0), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    for axes, (column, label) in zip((left, right), panels, strict=True):
        _draw(axes, frame, column)
        axes.set_xlabel(label)
        axes.set_xlim(left=0)
        axes.grid(color=LINE, linewidth=0.5)
        axes.set_axisbelow(True)
    left.set_ylabel("mean time to the catch [s], a miss counts as the limit\n(whiskers: 95 % intervals)")
    left.set_ylim(bottom=0)
    left.set_title(str(frame.attrs.get("arena", "")))
    handles, labels = left.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right upper")
    return figure


def _draw(axes: Axes, frame: pd.DataFrame, column: str) -> None:
    """Draw one panel."""
    taken: list[tuple[float, float]] = []  # where labels stand, as shares of the panel
    scale = frame[[column, "mean_time_s"]].max().to_numpy(dtype=float)
    for index, ((planner, weight), rows) in enumerate(frame.groupby(["planner", "weight"], sort=False)):
        look: dict[str, Any] = {"color": PLANNERS[index % len(PLANNERS)], "marker": MARKERS[index % len(MARKERS)]}
        name = shorten(str(planner).replace("_", " "))
        label = f"{name}, price of {weight}" if weight else name
        axes.plot(rows[column], rows["mean_time_s"], label=label, markersize=5, linewidth=1.0, zorder=3, **look)
        _whiskers(axes, rows, column, look["color"])
        points = list(zip(rows[column], rows["mean_time_s"], rows["value"], strict=True)) if weight else []
        ends = [points[0], points[-1]] if len(points) > 1 else points
        for x, y, value in [*ends, *points[1:-1]]:  # the ends first: they say which way the weight grows
            place = (x / scale[0], y / scale[1])
            near = sum(abs(place[0] - u) <= 0.07 and abs(place[1] - v) <= 0.05 for u, v in taken)
            if not near or (x, y, value) in ends:
                taken.append(place)  # labels of one place stand below each other
                below: dict[str, Any] = {"textcoords": "offset points", "xytext": (6, 5 - 9 * near)}
                axes.annotate(f"{value:g}", (x, y), fontsize=7, color=FAINT, **below)


def _whiskers(axes: Axes, rows: pd.DataFrame, column: str, colour: str) -> None:
    """The intervals of both means, where the frame has them: one of an earlier version has none."""
    if f"{column}_low" not in rows:
        return
    across, up = (
        np.clip([rows[name] - rows[f"{name}_low"], rows[f"{name}_high"] - rows[name]], 0, None)
        for name in (column, "mean_time_s")
    )
    axes.errorbar(
        rows[column], rows["mean_time_s"], xerr=across, yerr=up, fmt="none", color=colour, linewidth=0.9, zorder=2
    )
