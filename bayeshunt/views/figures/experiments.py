"""Figures of the experiments: where hunts start, and how often they succeed from each bearing."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.errors import InputError, did_you_mean
from bayeshunt.core.geometry import Polar, Pose
from bayeshunt.core.units import degrees
from bayeshunt.experiments.reported import compare
from bayeshunt.experiments.scores import summarise
from bayeshunt.views.figures.style import BAR, FAINT, HUNTER, INK, LINE, PREY, body, frame_axes, solid, styled
from bayeshunt.views.reported import p_text

__all__ = ["draw_setup", "draw_success", "experiment", "setup", "success"]


@styled
def setup(settings: ExperimentSettings, arena: str) -> Figure:
    """Return where hunter and prey start in ``arena``, seen from above (the paper's figures 3, 4 and 6b, left)."""
    figure = Figure(figsize=(3.6, 3.6), layout="constrained")
    draw_setup(figure.subplots(), settings, arena)
    return figure


@styled
def success(results: pd.DataFrame, settings: ExperimentSettings, planner: str, arena: str) -> Figure:
    """Return the success from each bearing with 95 % Wilson intervals (the same figures, right)."""
    figure = Figure(figsize=(4.2, 3.4), layout="constrained")
    draw_success(figure.subplots(), results, settings, planner, arena)
    return figure


@styled
def experiment(results: pd.DataFrame, settings: ExperimentSettings, planner: str, arena: str) -> Figure:
    """Return set-up and success side by side: one of the paper's figures 3, 4 and 6b.

    results: one row per hunt, as ``bayeshunt.evaluate`` returns it.
    Raises InputError if it holds no hunt of this planner in this arena.
    """
    figure = Figure(figsize=(7.4, 3.5), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=[1, 1.25])
    draw_setup(left, settings, arena)
    draw_success(right, results, settings, planner, arena)
    return figure


def draw_setup(axes: Axes, settings: ExperimentSettings, arena: str) -> None:
    """Draw the start of every hunt, the hunter's heading up; each prey faces the same way."""
    if arena not in settings.arenas:
        raise InputError(f"unknown arena {arena!r}{did_you_mean(arena, settings.arenas)}")
    place, protocol = settings.arenas[arena], settings.protocol
    hunter, prey = settings.robot.body.body_length * 1000, settings.prey.body.diameter * 1000
    distance = protocol.prey_distance * hunter
    room = 500 * min(place.width, place.height) - distance if place.walled else np.inf
    side = 1 if room > 2.5 * prey else -1  # labels go between prey and hunter where the wall is near
    for theta in protocol.thetas:
        seen = Polar(distance, theta, 0.0)
        body(axes, seen.right, seen.forward, 0, prey, PREY)
        outward = (side * np.sin(theta), side * np.cos(theta))
        beyond = tuple(part + step * prey / 2 for part, step in zip((seen.right, seen.forward), outward, strict=True))
        apart = 12 * np.sign(seen.right) if side < 0 and abs(seen.right) < 2 * prey else 0  # two labels ahead
        axes.annotate(degrees(theta), beyond, (13 * outward[0] + apart, 10 * outward[1]), textcoords="offset points",
                      ha="center", va="center", color=PREY)  # fmt: skip
    body(axes, 0, 0, 0, hunter, HUNTER)
    axes.annotate("hunter", (0, -hunter / 2), (0, -3), textcoords="offset points", ha="center", va="top", color=HUNTER)
    outline: list[tuple[float, float]] = []
    if place.walled:
        x, y = 0.5 * place.width, 0.5 * place.height
        corners = [protocol.hunter_pose.relative(Pose(*at, 0.0)) for at in ((x, y), (x, -y), (-x, -y), (-x, y))]
        outline = [(1000 * corner.right, 1000 * corner.forward) for corner in corners]
        axes.add_patch(Polygon(outline, fill=False, edgecolor=INK, linewidth=2))
    for obstacle in place.obstacles:
        corners = [protocol.hunter_pose.relative(Pose(*at, 0.0)) for at in obstacle.outline()]
        axes.add_patch(solid(np.array([(1000 * corner.right, 1000 * corner.forward) for corner in corners])))
    frame_axes(axes)
    reach = max([1.35 * distance, *(1.04 * abs(part) for corner in outline for part in corner)])
    axes.set_xlim(-reach, reach)
    axes.set_ylim(-reach, reach)
    axes.set_aspect("equal", adjustable="box")
    axes.set_title(f"{arena}: prey at θ")


def draw_success(axes: Axes, results: pd.DataFrame, settings: ExperimentSettings, planner: str, arena: str) -> None:
    """Draw a bar per bearing with its interval; the total, and the published total, as lines."""
    chosen = results[(results["planner"] == planner) & (results["arena"] == arena)]
    if chosen.empty:
        raise InputError(f"the results hold no hunt of planner {planner!r} in arena {arena!r}")
    rows = summarise(chosen, settings)
    bearings = [row for row in rows if row["theta"] is not None]
    total = next(row for row in rows if row["theta"] is None)
    x = np.arange(len(bearings))
    shares = np.array([row["success"] for row in bearings]) * 100
    spread = np.array([[row["success"] - row["ci_low"], row["ci_high"] - row["success"]] for row in bearings]).T * 100
    axes.bar(x, shares, color=BAR, width=0.68)
    axes.errorbar(x, shares, yerr=np.clip(spread, 0, None), fmt="none", ecolor=INK, elinewidth=0.9, capsize=2.5)
    axes.axhline(total["success"] * 100, color=INK, linewidth=1, label=_all(total))
    if total["paper_success"] is not None:
        line: dict[str, Any] = {"color": PREY, "linewidth": 1.2, "linestyle": (0, (4, 2))}
        said = next(row for row in compare(chosen, settings) if row["theta"] is None)
        axes.axhline(total["paper_success"] * 100, label=_paper(said), **line)
    _draw_published(axes, bearings)
    axes.set_xticks(x, [degrees(row["theta"]) for row in bearings])
    axes.set_ylim(0, 105)
    axes.set_yticks(range(0, 101, 20))
    axes.grid(axis="y", color=LINE, linewidth=0.5)
    axes.set_axisbelow(True)
    axes.set_xlabel(f"first bearing of the prey, clockwise: {_named(bearings)}")
    axes.set_ylabel("caught [%], 95 % Wilson interval")
    axes.set_title(f"{planner}, {_runs(bearings)} per bearing")
    axes.legend(loc="upper left", bbox_to_anchor=(0, -0.18), fontsize=8, labelcolor=FAINT)


def _named(bearings: list[dict[str, float]]) -> str:
    """The bearings as the paper and ``--theta`` name them."""
    names = [f"{row['theta']:g}" for row in bearings]
    return f"θ = {', '.join(names) if len(names) <= 8 else f'{names[0]} to {names[-1]}'}"


def _draw_published(axes: Axes, bearings: list[dict[str, Any]]) -> None:
    """Mark what was published of each bearing, where it was."""
    known = [(x, 100 * row["paper_success"]) for x, row in enumerate(bearings) if row["paper_success"] is not None]
    if known:
        axes.plot(*zip(*known, strict=True), "D", color=PREY, markersize=5, markeredgecolor="white", clip_on=False,
                  zorder=5, label="published, by bearing")  # fmt: skip


def _paper(said: dict[str, Any]) -> str:
    """The published total in words, its counts and the test of the difference where they are known."""
    share = f"{100 * said['paper_success']:.1f} %"
    if said["paper_caught"] is None:
        return f"published: {share}"
    time = "" if said["paper_mean_time_s"] is None else f", mean {said['paper_mean_time_s']:.1f} s"
    test = f", p {p_text(said['p_success'])}"
    return f"published: {said['paper_caught']}/{said['paper_runs']} = {share}{test}{time}"


def _all(total: dict[str, float]) -> str:
    share, low, high = (100 * total[name] for name in ("success", "ci_low", "ci_high"))
    caught = f"all: {total['caught']}/{total['runs']} = {share:.1f} % ({low:.1f} to {high:.1f})"
    return f"{caught}, mean {total['mean_time_s']:.1f} s"


def _runs(bearings: list[dict[str, float]]) -> str:
    runs = sorted({int(row["runs"]) for row in bearings})
    return f"{runs[0]} hunts" if len(runs) == 1 else f"{runs[0]} to {runs[-1]} hunts"
