"""Figures of scores on recordings: how far models foresee places, with intervals, the baselines set apart."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from bayeshunt.core.units import in_unit
from bayeshunt.views.figures.style import CHOSEN, FAINT, LINE, shorten, styled

__all__ = ["forward_scores", "prey_scores"]

#: Models that learn no table.
_BASELINES = (
    "stays",
    "unicycle",
    "unicycle_lag",
    "stands",
    "constant_velocity",
    "constant_velocity_noise",
    "autoregression",
)

#: Models of a body that does not move; how far behind all others their row is cut, and not drawn to scale.
_STILL, _FAR_BEHIND = ("stays", "stands"), 1.5
_ARROW = "; arrow: beyond the axis"


@styled
def forward_scores(table: pd.DataFrame) -> Figure:
    """Return mean errors of position and heading with 95 % intervals, a row a model.

    table: as ``score_forward`` returns it; models that could not be scored are left out.
    """
    known = table[table["n"] > 0].reset_index(drop=True)
    figure = Figure(figsize=(7.4, 0.9 + 0.34 * len(known)), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    times, unit = in_unit(float(known["position_high"].max()))
    cut = _dots(left, known, "position_m", "position_low", "position_high", times)
    cut |= _dots(right, known, "heading_deg", "heading_low", "heading_high")
    left.set_xlabel(f"mean error of the position [{unit}]")
    right.set_xlabel("mean error of the heading [°]")
    left.set_title(f"{int(known['n'].max())} windows, held out; bars: 95 %{_ARROW if cut else ''}")
    return figure


@styled
def prey_scores(table: pd.DataFrame, unit: str) -> Figure:
    """Return mean and final errors of forecasts with 95 % intervals over individuals, a row a model.

    table: as ``score_prey`` returns it. unit: of its lengths.
    """
    figure = Figure(figsize=(7.4, 0.9 + 0.34 * len(table)), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    times, unit = in_unit(float(np.nanmax(table[["ade_high", "fde_high"]].to_numpy(dtype=float))), unit)
    cut = _dots(left, table, "ade", "ade_low", "ade_high", times)
    cut |= _dots(right, table, "fde", "fde_low", "fde_high", times)
    left.set_xlabel(f"mean error over the steps, ADE [{unit}]")
    right.set_xlabel(f"error of the last step, FDE [{unit}]")
    windows, individuals = (int(table[name].max()) for name in ("n", "individuals"))
    left.set_title(f"{windows} windows of {individuals} individuals; bars: 95 %{_ARROW if cut else ''}")
    return figure


def _dots(axes: Axes, table: pd.DataFrame, mean: str, low: str, high: str, times: float = 1.0) -> bool:
    """Draw a column of dots; return whether a body that stays is so far behind that it got an arrow instead."""
    places = np.arange(len(table))[::-1]
    values, least, most = (times * table[name].to_numpy(dtype=float) for name in (mean, low, high))
    still = table["model"].isin(_STILL).to_numpy()
    reach = float(np.nanmax(most if still.all() else most[~still]))
    cut = still & (least > _FAR_BEHIND * reach)
    shown = np.where(cut, 1.12 * reach, values)
    bars = np.where(cut, 0.0, np.clip(np.array([values - least, most - values]), 0.0, None))
    colours = [FAINT if name in _BASELINES else CHOSEN for name in table["model"]]
    axes.hlines(places, 0, shown, color=LINE, linewidth=1, zorder=1)
    for colour in (FAINT, CHOSEN):
        mine = np.array([c == colour for c in colours])
        look: dict[str, Any] = {"fmt": "none", "ecolor": colour, "elinewidth": 1.4, "capsize": 3, "zorder": 2}
        axes.errorbar(shown[mine & ~cut], places[mine & ~cut], xerr=bars[:, mine & ~cut], **look)
    axes.scatter(shown[~cut], places[~cut], color=np.array(colours)[~cut], s=22, zorder=3)
    axes.scatter(shown[cut], places[cut], color=FAINT, s=26, zorder=3, marker=">")
    for value, end, y in zip(values, np.where(cut, shown, most), places, strict=True):
        axes.annotate(f"{value:.3g}", (end, y), xytext=(5, 0), textcoords="offset points", va="center", fontsize=7.5)
    axes.set_yticks(places, [shorten(str(name), 26).replace("_", " ") for name in table["model"]])
    axes.set_xlim(0, 1.16 * (1.12 * reach if cut.any() else float(np.nanmax(most))))
    axes.xaxis.set_major_locator(MaxNLocator(nbins=4))  # so that no two numbers touch
    axes.set_ylim(-0.6, len(table) - 0.4)
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0)
    return bool(cut.any())
