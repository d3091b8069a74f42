"""Figures of sweeps: success and catch time against a setting, the kinematic limit drawn in."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, PercentFormatter

from bayeshunt.core.errors import InputError
from bayeshunt.experiments.studies.sweep import AXES, COLUMNS
from bayeshunt.views.figures.style import FAINT, LINE, MARKERS, PLANNERS, shorten, styled

__all__ = ["MAX_PANELS", "sweep_figure"]

#: Drawn as a limit: grey, dashed, without an interval.
_LIMIT = "kinematic_limit"
#: More panels side by side than this cannot be read.
MAX_PANELS = 6
#: Columns of the intervals of each row of panels; a frame of an earlier version has none of the mean time.
_LIMITS = (("ci_low", "ci_high"), ("mean_time_s_low", "mean_time_s_high"))
_TICKS = 5  # labelled steps of an axis, at most: more of them touch


@styled
def sweep_figure(frame: pd.DataFrame) -> Figure:
    """Return success (with 95 % Wilson intervals) above mean catch time (95 % t intervals), against the first axis.

    frame: as :func:`bayeshunt.experiments.studies.sweep.sweep` returns it. One column of panels per arena and
    combination of the other axes' values, one line per planner; ``kinematic_limit`` is drawn as a limit.

    Raises InputError if there would be more than :data:`MAX_PANELS` columns.
    """
    axis, *others = [name for name in frame.columns if name not in COLUMNS]
    # By the values' text: a value of a setting may be a list, which cannot be grouped by.
    panels = list(frame.groupby([*(frame[name].map(str) for name in others), "arena"], sort=False))
    if len(panels) > MAX_PANELS:
        raise InputError(f"sweep: {len(panels)} panels are too many for a figure; sweep fewer axes or arenas")
    planners = list(dict.fromkeys(frame["planner"]))
    figure = Figure(figsize=(2.2 + 2.9 * len(panels), 4.6), layout="constrained")
    grid = figure.subplots(2, len(panels), sharex=True, sharey="row", squeeze=False)
    for column, (key, rows) in enumerate(panels):
        grid[0, column].set_title(_title(others, key if isinstance(key, tuple) else (key,)))
        for planner, some in rows.groupby("planner", sort=False):
            _lines(grid[:, column], some, axis, str(planner), planners)
        grid[1, column].set_xlabel(AXES[axis][0] if axis in AXES else axis)
    _finish(grid, frame[axis])
    handles, labels = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right upper")
    return figure


def _lines(axes: Any, rows: pd.DataFrame, axis: str, planner: str, planners: list[str]) -> None:
    """Draw one planner's success and time."""
    place, label = _places(rows[axis]), shorten(planner.replace("_", " "))
    if planner == _LIMIT:
        look: dict[str, Any] = {"color": FAINT, "linestyle": (0, (4, 3)), "linewidth": 1.4, "zorder": 2}
    else:
        index = [name for name in planners if name != _LIMIT].index(planner)
        colour, marker = PLANNERS[index % len(PLANNERS)], MARKERS[index % len(MARKERS)]
        look = {"color": colour, "marker": marker, "markersize": 4, "linewidth": 1.4, "zorder": 3}
        for panel, (low, high) in zip(axes, _LIMITS, strict=True):
            if low in rows:
                limits = rows[low].astype(float), rows[high].astype(float)
                panel.fill_between(place, *limits, color=colour, alpha=0.16, lw=0)
    axes[0].plot(place, rows["success"], label=label, **look)
    axes[1].plot(place, rows["mean_time_s"], **look)


def _finish(grid: np.ndarray, values: pd.Series) -> None:
    """Name and scale the axes."""
    axes: Axes
    for axes in grid.ravel():
        axes.grid(color=LINE, linewidth=0.5)
        axes.set_axisbelow(True)
        if not _numeric(values):
            names = list(dict.fromkeys(map(str, values)))
            axes.set_xticks(range(len(names)), [shorten(name, 12) for name in names])
        elif values.min() > 0 and values.max() / values.min() > 20:
            axes.set_xscale("log")
        else:
            axes.xaxis.set_major_locator(MaxNLocator(_TICKS))
    grid[0, 0].set_ylabel("prey caught\n(95 % Wilson interval)")
    grid[0, 0].yaxis.set_major_formatter(PercentFormatter(1.0))
    grid[0, 0].set_ylim(-0.03, 1.03)
    grid[1, 0].set_ylabel("mean time [s], a miss\nis the limit (95 % interval)")
    grid[1, 0].set_ylim(bottom=0)


def _places(values: pd.Series) -> Any:
    """Where values lie on the horizontal axis: themselves, or their order if they are no numbers."""
    return values if _numeric(values) else range(len(values))


def _numeric(values: pd.Series) -> bool:
    return pd.api.types.is_numeric_dtype(values) and not pd.api.types.is_bool_dtype(values)


def _title(others: list[str], key: tuple[Any, ...]) -> str:
    *values, arena = key
    return ", ".join([str(arena), *(f"{name} = {value}" for name, value in zip(others, values, strict=True))])
