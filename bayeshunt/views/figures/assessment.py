"""The figure of an assessment: is a forecast of 70 % right in 70 % of the cases?"""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bayeshunt.experiments.scores import wilson_interval
from bayeshunt.models.assessment.assess import Assessment
from bayeshunt.views.figures.style import BAR, CHOSEN, FAINT, INK, LINE, styled

__all__ = ["reliability"]

_PANELS = ("Distance", "Angle", "Heading", "Gait")
_GIVEN = {"Gait": "Distance,\nAngle"}  # in one line it runs out of the figure


@styled
def reliability(assessment: Assessment) -> Figure:
    """Return reliability diagrams of the three effects and of the gait, and the gain of other structures.

    A point below the diagonal is a forecast that was too sure. Bars: 95 % Wilson intervals of the
    share observed, as if a row's events were independent.
    """
    figure = Figure(figsize=(7.4, 4.6), layout="constrained")
    parts: Any = figure.subfigures(2, 1, height_ratios=[1.05, 1])
    top, bottom = parts
    for axes, variable in zip(top.subplots(1, 4, sharey=True), _PANELS, strict=True):
        _draw_reliability(axes, assessment.reliability.query("variable == @variable"), variable)
    top.supxlabel("forecast probability", fontsize=8.5)
    _draw_gains(bottom.subplots(), assessment.structures)
    return figure


def _draw_reliability(axes: Axes, table: pd.DataFrame, variable: str) -> None:
    hits = (table["observed"] * table["count"]).round().astype(int)
    limits = np.array([wilson_interval(h, n) for h, n in zip(hits, table["count"], strict=True)]).reshape(-1, 2)
    observed = table["observed"].to_numpy()
    axes.plot([0, 1], [0, 1], color=LINE, linewidth=1, zorder=1)
    # A Wilson interval holds its own share; rounding may leave -1e-17.
    bars = np.clip([observed - limits[:, 0], limits[:, 1] - observed], 0.0, None)
    sizes = 12 + 8 * np.log10(table["count"])
    axes.errorbar(table["forecast"], observed, yerr=bars, fmt="none", color=FAINT, linewidth=1, zorder=2)
    axes.scatter(table["forecast"], observed, s=sizes, color=BAR, edgecolor=INK, linewidth=0.5, zorder=3, clip_on=False)
    axes.set_title(f"{variable} | {_GIVEN.get(variable, 'Gait')}")
    if variable == _PANELS[0]:
        axes.set_ylabel("share observed (95 % Wilson)")
    axes.set(xlim=(0, 1), ylim=(0, 1), xticks=[0, 0.5, 1], yticks=[0, 0.5, 1])
    axes.set_aspect("equal")


def _draw_gains(axes: Axes, structures: pd.DataFrame) -> None:
    others = structures.drop(index="naive").iloc[::-1]
    places = np.arange(len(others))
    gain = others["gain"].to_numpy(dtype=float)
    bars = [gain - others["gain_low"], others["gain_high"] - gain]
    axes.axvline(0, color=LINE, linewidth=1, zorder=1)
    axes.errorbar(gain, places, xerr=bars, fmt="o", color=CHOSEN, markersize=5, capsize=3, linewidth=1.2, zorder=3)
    labels = [f"{name}\n{count:,} parameters" for name, count in others["parameters"].items()]
    axes.set_yticks(places, labels)
    axes.set_ylim(-0.6, len(others) - 0.4)
    axes.set_title("Other structures against the paper's naive Bayes")
    axes.set_xlabel("held-out log-likelihood per row, less that of naive Bayes [nat], 95 % interval; right is better")
