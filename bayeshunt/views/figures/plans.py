"""Figures of planning: the search tree, and what one decision expects."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from bayeshunt.core.errors import InputError
from bayeshunt.planners.api import Plan
from bayeshunt.views.figures.style import CHOSEN, FAINT, HUNTER, LINE, PREY, body, frame_axes, shorten, styled

__all__ = ["planning_step", "search_tree"]


@styled
def search_tree(plan: Plan) -> Figure:
    """Return the search tree (the paper's figure 5): every node at its depth and value, the chosen branch lit.

    Raises InputError for a plan that was not made by a search.
    """
    trace = _searched(plan)
    figure = Figure(figsize=(7.2, 4.0), layout="constrained")
    axes = figure.subplots()
    depth, value = trace["T"].to_numpy(dtype=float), trace["value_bodies"].to_numpy(dtype=float)
    parents = trace["parent"].to_numpy()
    edges = [[(depth[p], value[p]), (depth[n], value[n])] for n, p in enumerate(parents) if p >= 0]
    axes.add_collection(LineCollection(edges, colors=LINE, linewidths=0.6, zorder=1))
    opened = trace["expanded"].to_numpy(dtype=bool)
    axes.scatter(depth[~opened], value[~opened], s=9, facecolor="white", edgecolor=FAINT, linewidth=0.7, zorder=2,
                 label=f"generated only ({int((~opened).sum())})")  # fmt: skip
    axes.scatter(depth[opened], value[opened], s=13, color=HUNTER, zorder=3, label=f"expanded ({int(opened.sum())})")
    _chosen_branch(axes, trace)
    axes.set_xlabel("T, gaits executed")
    axes.set_ylabel("Value: predicted distance [bodies]")
    axes.set_xticks(range(int(depth.max()) + 1))
    axes.set_ylim(bottom=0)
    axes.margins(x=0.04)
    axes.set_title(f"Search tree of {len(trace)} nodes; chosen: {_sequence(plan)}")
    axes.legend(loc="upper right", frameon=True, framealpha=0.9, edgecolor="none")
    return figure


def _chosen_branch(axes: Axes, trace: pd.DataFrame) -> None:
    branch = trace[trace["chosen"]].sort_values("T")
    x, y = branch["T"].to_numpy(dtype=float), branch["value_bodies"].to_numpy(dtype=float)
    axes.plot(x, y, color=CHOSEN, linewidth=2.2, marker="o", markersize=5, zorder=5, label="chosen branch")


@styled
def planning_step(plan: Plan) -> Figure:
    """Return one planning iteration (the paper's figure 6a), in the hunter's frame, its heading up.

    The predicted prey, the mean ends of the gait sequences considered, coloured by Value, and the chosen one.

    Raises InputError for a plan that was not made by a search.
    """
    trace = _searched(plan)
    figure = Figure(figsize=(6.4, 4.6), layout="constrained")
    axes = figure.subplots()
    diameter = 1000 * _body_length(trace)
    ends = trace[trace["T"] > 0].sort_values("value_bodies", ascending=False)
    dots = axes.scatter(
        ends["hunter_right"] * 1000, ends["hunter_forward"] * 1000, c=ends["value_bodies"], s=14, cmap="viridis_r",
        zorder=2, linewidths=0,
    )  # fmt: skip
    figure.colorbar(dots, ax=axes, label="Value: predicted distance [bodies]", shrink=0.75)
    branch = trace[trace["chosen"]].sort_values("T")
    right, ahead = branch["hunter_right"].to_numpy() * 1000, branch["hunter_forward"].to_numpy() * 1000
    axes.plot(right, ahead, color=HUNTER, linewidth=1.8, zorder=5)
    _prey_path(axes, plan, diameter, right)
    for x, y, heading in zip(right, ahead, branch["hunter_heading"], strict=True):
        body(axes, x, y, heading, diameter, HUNTER, zorder=5)
    axes.annotate("hunter now", (0, -diameter / 2), (0, -4), textcoords="offset points", ha="center", va="top",
                  color=HUNTER)  # fmt: skip
    frame_axes(axes)
    axes.margins(0.08)
    axes.set_title(f"One decision: {_sequence(plan)}")
    return figure


def _prey_path(axes: Axes, plan: Plan, diameter: float, hunter_right: np.ndarray) -> None:
    """The prey predicted 0..T steps ahead; what the chosen sequence aims at stands out."""
    path, steps = plan.predicted_prey, len(hunter_right) - 1
    if path is None:
        return
    right, ahead = np.asarray(path.right) * 1000, np.asarray(path.forward) * 1000
    shown = min(len(right), steps + 3)
    axes.plot(right[:shown], ahead[:shown], color=PREY, linewidth=1.0, linestyle=(0, (4, 2)), zorder=3)
    for t in range(shown):
        faint = {} if t in (0, steps) else {"alpha": 0.45}
        body(axes, right[t], ahead[t], float(path.heading[t]), diameter, PREY, **faint)
    words = [(0, "prey now"), *([(steps, f"prey predicted {steps} ahead")] if 0 < steps < shown else [])]
    for t, text in words:
        # Labels go to the side away from the hunter's path.
        side = 1 if right[t] >= (hunter_right.mean() if t == 0 else hunter_right[t]) else -1
        axes.annotate(
            text, (right[t] + side * diameter / 2, ahead[t]), (side * 5, 0), textcoords="offset points",
            ha="left" if side > 0 else "right", va="center", color=PREY, zorder=7,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.8},
        )  # fmt: skip


def _sequence(plan: Plan) -> str:
    starts = [0, *(i + 1 for i, (a, b) in enumerate(pairwise(plan.gaits)) if a != b), len(plan.gaits)]
    return ", ".join(f"{shorten(plan.gaits[a])} x{b - a}" for a, b in pairwise(starts))


def _body_length(trace: pd.DataFrame) -> float:
    farthest = trace.nlargest(1, "value_m")
    return float(farthest["value_m"].iloc[0] / farthest["value_bodies"].iloc[0])


def _searched(plan: Plan) -> pd.DataFrame:
    needed = {"node", "parent", "T", "value_m", "value_bodies", "expanded", "chosen", "hunter_forward", "hunter_right"}
    if not needed <= set(plan.trace.columns):
        raise InputError("this plan was not made by a search over gait sequences; use the planner 'planning'")
    return plan.trace
