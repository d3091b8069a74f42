"""Hunts side by side, seen from above: who went where, and how it ended."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Rectangle

from bayeshunt.config.loading import parse
from bayeshunt.config.schema import ExperimentSettings, ObstacleSettings
from bayeshunt.config.schema.legs import legs_at_rest
from bayeshunt.core import units
from bayeshunt.core.errors import InputError
from bayeshunt.episodes.episode import Episode
from bayeshunt.views.figures.style import CATCH, FAINT, HUNTER, PREY, shorten, solid, styled

__all__ = ["draw_place", "hunts", "path_of", "reach_of"]

_PANEL = 2.25  # inches
_ROOM = 0.16  # inches above the first titles, which the layout does not see whole
_MARGIN = 90.0  # mm around the paths


@styled
def hunts(episodes: Sequence[Episode]) -> Figure:
    """Draw the paths of hunts in the world [mm]: one row per arena, one column per planner.

    Dots are decisions; a ring marks a catch. Of several hunts of one planner in one arena the last
    is drawn. Raises InputError without any.
    """
    if not episodes:
        raise InputError("hunts: expected at least one episode to draw")
    by_place = {(e.provenance["arena"], e.provenance["planner"]): e for e in episodes}
    rows, columns = (list(dict.fromkeys(part)) for part in zip(*by_place, strict=True))
    reaches = [reach_of([e for (place, _), e in by_place.items() if place == arena]) for arena in rows]
    shares = [height / width for _, _, width, height in reaches]
    size = (_PANEL * len(columns), sum(_PANEL * share + 0.45 for share in shares) + 0.3)
    figure = Figure(figsize=size, layout=ConstrainedLayoutEngine(rect=(0, 0, 1, 1 - _ROOM / size[1])))
    panels = figure.subplots(len(rows), len(columns), squeeze=False, height_ratios=shares)
    for i, arena in enumerate(rows):
        for j, planner in enumerate(columns):
            panel, episode = panels[i, j], by_place.get((arena, planner))
            panel.set(xticks=[], yticks=[])
            panel.spines[:].set_visible(False)
            if episode is not None:
                _draw(panel, episode, reaches[i])
                end = f"caught, {episode.time:.1f} s" if episode.caught else "missed"
                panel.set_title(f"{shorten(planner)}, {shorten(arena)}\n{end}", fontsize=8.5)
    _legend(figure)
    return figure


def _draw(panel: Axes, episode: Episode, reach: tuple[float, float, float, float]) -> None:
    x, y, width, height = reach
    settings = draw_place(panel, episode, reach)
    diameters = {"prey": settings.prey.body.diameter, "hunter": settings.robot.body.body_length}
    for who, colour in (("prey", PREY), ("hunter", HUNTER)):
        path = path_of(episode, who)
        panel.plot(*path.T, color=colour, linewidth=1.3, solid_capstyle="round")
        decisions = 1000 * episode.frame[[f"{who}_x", f"{who}_y"]].to_numpy()
        panel.plot(*decisions.T, ".", color=colour, markersize=3.2)
        panel.add_patch(
            Circle(path[-1], 500 * diameters[who], facecolor=colour, edgecolor="white", linewidth=0.6, zorder=4)
        )
    _legs(panel, episode, settings)
    if episode.caught:
        middle = (path_of(episode, "hunter")[-1] + path_of(episode, "prey")[-1]) / 2
        panel.plot(*middle, "o", color=CATCH, markersize=15, fillstyle="none", markeredgewidth=1.6, zorder=5)
    _scale_bar(panel, x - width / 2, y - height / 2, width)


def draw_place(panel: Axes, episode: Episode, reach: tuple[float, float, float, float]) -> ExperimentSettings:
    """Draw walls and obstacles of the hunt's arena [mm] within ``reach``; return the hunt's settings."""
    x, y, width, height = reach
    settings = parse(ExperimentSettings, episode.provenance["settings"], "the episode's settings")
    place = settings.arenas[episode.provenance["arena"]]
    panel.set_aspect("equal")
    panel.set_xlim(x - width / 2, x + width / 2)
    panel.set_ylim(y - height / 2, y + height / 2)
    if place.walled:
        corner, size = (-500 * place.width, -500 * place.height), (1000 * place.width, 1000 * place.height)
        panel.add_patch(Rectangle(corner, *size, fill=False, edgecolor=FAINT, linewidth=1.6))
    for obstacle in place.obstacles:
        panel.add_patch(solid(1000 * np.array(obstacle.outline())))
    return settings


def _legs(panel: Axes, episode: Episode, settings: ExperimentSettings) -> None:
    """Draw the hunter's legs, if it has any, where its path ends."""
    end = episode.trail.iloc[-1] if len(episode.trail) else episode.frame.iloc[0]
    x, y, theta = (float(end[f"hunter_{name}"]) for name in ("x", "y", "theta"))
    turn = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])
    for leg in legs_at_rest(settings.robot.body):
        ends = 1000 * (np.reshape(leg, (2, 2)) @ turn.T + [x, y])
        panel.plot(*ends.T, color=HUNTER, linewidth=1.6, solid_capstyle="round", zorder=3.5)


def _scale_bar(panel: Axes, left: float, bottom: float, width: float) -> None:
    length = next((size for size in (50, 100, 200, 500, 1000, 2000) if size >= 0.2 * width), 5000)
    start, height = left + 0.03 * width, bottom + 0.02 * width
    panel.plot([start, start + length], [height, height], color=FAINT, linewidth=1.4, solid_capstyle="butt")
    label = f" {units.length(length / 1000)}"
    panel.text(start + length, height, label, fontsize=7, color=FAINT, verticalalignment="center")


def _legend(figure: Figure) -> None:
    marks = [
        Line2D([], [], color=HUNTER, marker="o", markersize=5, label="hunter"),
        Line2D([], [], color=PREY, marker="o", markersize=5, label="prey"),
        Line2D([], [], color=CATCH, marker="o", markersize=9, fillstyle="none", linestyle="", label="catch"),
        Line2D([], [], color=FAINT, marker=".", markersize=4, linestyle="", label="decision"),
    ]
    figure.legend(handles=marks, loc="outside lower center", ncols=len(marks))


def path_of(episode: Episode, who: str) -> np.ndarray:
    """World positions [n, 2] of a robot from the start, in millimetres."""
    names = [f"{who}_x", f"{who}_y"]
    return 1000 * np.concatenate([episode.frame[names].to_numpy()[:1], episode.trail[names].to_numpy()])


def reach_of(episodes: Sequence[Episode]) -> tuple[float, float, float, float]:
    """Centre, width and height [mm] of the box that holds all these paths and, if any, walls and obstacles."""
    points = [path_of(episode, who) for episode in episodes for who in ("hunter", "prey")]
    for episode in episodes:
        place = episode.provenance["settings"]["arenas"][episode.provenance["arena"]]
        if place["walled"]:
            corner = 500 * np.array([place["width"], place["height"]])
            points.append(np.stack([-corner, corner]))
        points += [1000 * np.array(ObstacleSettings(**values).outline()) for values in place.get("obstacles", ())]
    low, high = np.concatenate(points).min(axis=0), np.concatenate(points).max(axis=0)
    (x, y), size = (low + high) / 2, high - low + 2 * _MARGIN
    width = float(size.max())
    return float(x), float(y), width, max(float(size[1]), 0.3 * width)
