"""Figures of what was learned: gait outcomes, the network, a prey transition and the prey table."""

from __future__ import annotations

import math
import textwrap
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, ConnectionPatch

from bayeshunt.core.bins import ENERGY, Axis
from bayeshunt.core.geometry import Polar, wrap
from bayeshunt.core.units import degrees, label, length, true_minus
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.tables.structures import CAUSES, PREVIOUS, depends_on_previous
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.views import grounds, theme
from bayeshunt.views.figures.style import BAR, CHOSEN, FAINT, INK, LINE, PREY, body, frame_axes, shorten, styled

__all__ = ["draw_prey_table", "draw_transition", "gait_outcomes", "network", "prey", "prey_table", "prey_transition"]

_MOST_CELLS = 24
_MOST_DOTS = 300  # per gait
_MOST_VECTORS = 50  # per gait: dots drawn one by one in a vector file
_LEAST, _SPREAD = 1e-3, 31.0  # dots of probabilities: the least shown; points^2 of a certain bin
_TALLEST = 14.0  # inch
_DASHES = ("-", (0, (4, 2)), (0, (1, 1.5)))  # of a gait's path, by how many gaits of its colour go before it


@styled
def gait_outcomes(model: ForwardModel) -> Figure:
    """Return where each gait takes the robot (the paper's figure 1c): positions, and headings.

    Dots are the babbling rows if the model holds them, else the centres of the counted cells, larger
    where more rows fell, or in an imported network of the probable bins, larger where more probable;
    lines are mean paths (straight to the mean end where part-way poses were not recorded), discs mean ends.
    Of gaits that share a colour, all but the first have rings for dots and broken lines.
    """
    figure = Figure(figsize=(7.2, _height(model, 3.9)), layout="constrained")
    place, turn = figure.subplots(1, 2, width_ratios=[1.25, 1])
    diameter = (model.gaits.body_length or 0.0) * 1000  # unknown: no disc
    body(place, 0, 0, 0, diameter, INK)
    counted = model.joint.marginal("Gait") if model.has_counts else np.ones(len(model.gaits))
    colours, stripes = theme.gait_colours(model), theme.stripes(model)
    for index in np.flatnonzero(counted).tolist():
        colour, look = colours[index], min(stripes[index], len(_DASHES) - 1)
        ends, size, turns, turn_size = _ends(model, index)
        place.scatter(
            ends.right * 1000,
            ends.forward * 1000,
            s=size,
            facecolors="none" if look else colour,
            edgecolors=colour,
            alpha=0.45,
            linewidths=0.6 if look else 0,
            rasterized=_many(ends),
        )
        path = _mean_path(model, index)
        place.plot(path[:, 1] * 1000, path[:, 0] * 1000, color=colour, linewidth=1.3, linestyle=_DASHES[look])
        body(place, path[-1, 1] * 1000, path[-1, 0] * 1000, path[-1, 2], diameter, colour, linewidth=0.9)
        turn.scatter(
            np.degrees(turns), np.full(len(turns), index), s=turn_size, color=colour, alpha=0.45, linewidths=0,
            rasterized=_many(ends),
        )  # fmt: skip
        turn.plot(math.degrees(path[-1, 2]), index, "|", color=colour, markersize=12, markeredgewidth=1.6)
    frame_axes(place)
    place.set_title("Where one step of each gait leads")
    turn.set_title("Which way it then faces")
    _name_gaits(turn, model, 18)
    _degrees(turn, "heading [° clockwise]")
    return figure


def _many(ends: Polar) -> bool:
    """Whether dots are so many that they go into a vector file as a picture: 3,000 of them make 2.7 MB."""
    return np.size(ends.distance) > _MOST_VECTORS


def _ends(model: ForwardModel, gait: int) -> tuple[Polar[Any], np.ndarray, np.ndarray, np.ndarray]:
    """Where one gait ends, a Polar of arrays [N] with the sizes [N] of its dots, and its headings [M] with theirs."""
    if not model.has_counts:
        return _probable_ends(model, gait)
    if model.data:
        rows = model.rows("Gait", model.gaits.names[gait])
        rows = rows.iloc[:: max(1, len(rows) // _MOST_DOTS)]
        ends, size = Polar(*(rows[name].to_numpy() for name in Polar._fields)), np.full(len(rows), 3.5)
        return ends, size, ends.heading, size
    mine = model.joint.cells[:, 0] == gait
    cells, counts = model.joint.cells[mine], model.joint.counts[mine]
    places = (axis.centres[cells[:, column]] for column, axis in enumerate(model.axes, start=1))
    ends, size = Polar(*places), 1 + 2.2 * np.sqrt(counts)
    return ends, size, ends.heading, size


def _probable_ends(model: ForwardModel, gait: int) -> tuple[Polar[Any], np.ndarray, np.ndarray, np.ndarray]:
    """The same from probabilities alone: bins of less than one in a thousand are left out."""
    distance, angle, heading = model.axes
    joint = model.evidence(*np.ogrid[: distance.bins, : angle.bins])[..., gait]
    share = joint / max(joint.sum(), 1e-300)  # 0 throughout for a gait that is never chosen
    d, a = np.nonzero(share > _LEAST)
    turns = model.probabilities("Heading")[:, gait]
    h = np.flatnonzero(turns > _LEAST)
    ends: Polar[Any] = Polar(distance.centres[d], angle.centres[a], None)
    return ends, 1 + _SPREAD * np.sqrt(share[d, a]), heading.centres[h], 1 + _SPREAD * np.sqrt(turns[h])


def _height(model: ForwardModel, least: float) -> float:
    """Height of a figure [inch] with a line per gait."""
    return min(max(least, 1.2 + 0.24 * len(model.gaits)), _TALLEST)


def _name_gaits(axes: Axes, model: ForwardModel, length: int) -> None:
    """Name the rows after the gaits, the first on top; smaller where they are very many."""
    room = 72 * 0.6 * _height(model, 0.0) / len(model.gaits)  # points per name
    names = [shorten(name, length) for name in model.gaits.names]
    axes.set_yticks(range(len(names)), names, fontsize=min(8.5, 0.8 * room))
    axes.set_ylim(len(names) - 0.4, -0.6)


def _mean_path(model: ForwardModel, gait: int) -> np.ndarray:
    """Mean poses [P + 2, 3] of a gait from the start: forward, right [m], heading [rad clockwise]."""
    if model.mean_paths is not None:
        return np.vstack([np.zeros(3), model.mean_paths[gait]])
    end = model.predict(model.gaits[gait])
    return np.array([[0.0, 0.0, 0.0], [end.forward, end.right, end.heading]])


@styled
def network(model: ForwardModel) -> Figure:
    """Return the network (the paper's figure 1b): its edges, and the distribution over each variable."""
    effects = model.structure.effects
    figure = Figure(figsize=(7.2, _height(model, 1.4 * len(effects))))
    before = PREVIOUS in model.known or depends_on_previous(model.structure)
    gait_axes = figure.add_axes((0.15, 0.34, 0.19, 0.52) if before else (0.15, 0.18, 0.19, 0.68))
    shares = model.probabilities("Gait")
    _gait_bars(gait_axes, model, shares)
    _name_gaits(gait_axes, model, 16)
    gait_axes.set_title("P(Gait)")
    boxes = {"Gait": gait_axes}
    if before:
        boxes[PREVIOUS] = _gait_before(figure, model)
    share, tall = 0.915 / len(effects), 0.51 / len(effects)  # of the height: an effect with its labels, its bars
    for place, effect in enumerate(effects):
        axes = boxes[effect] = figure.add_axes((0.6, 0.935 - tall - share * place, 0.37, tall))
        _effect_bars(axes, model.axes[effect], model.probabilities(effect) @ shares)
    known = [(cause, effect) for cause in model.known for effect in effects]
    for parent, child in (*model.structure.edges, *known):
        _edge(figure, boxes[parent], boxes[child], parent in CAUSES)
    causes = " ".join(f"P({cause})" for cause in model.structure.causes)
    said = textwrap.fill(f"{causes} {grounds.description(model)}", 130 if before else 110)
    figure.text(0.02, 0.03 if "\n" not in said else 0.01, said, fontsize=6.5 if before else 8.5, color=FAINT)
    return figure


def _gait_bars(axes: Axes, model: ForwardModel, shares: np.ndarray) -> None:
    """A bar for each gait, striped where it shares its colour with another."""
    for row, (share, colour, many) in enumerate(
        zip(shares, theme.gait_colours(model), theme.stripes(model), strict=True)
    ):
        axes.barh(row, share, color=colour, height=0.7)
        for k in range(1, many + 1):
            y = row - 0.35 + 0.7 * k / (many + 1)
            axes.plot([0, share], [y, y], color="white", linewidth=1.2, solid_capstyle="butt")


def _gait_before(figure: Figure, model: ForwardModel) -> Axes:
    """A box for the gait before: the one that is known, or that it is summed over."""
    axes = figure.add_axes((0.15, 0.13, 0.19, 0.09))
    axes.set(title=PREVIOUS, xticks=[], yticks=[])
    axes.spines[["top", "right"]].set_visible(True)
    chances = f", {model.gait_prior}" if model.has_counts else ""
    said = model.known.get(PREVIOUS, f"summed over{chances}")
    axes.text(0.5, 0.45, said, ha="center", va="center", fontsize=8, transform=axes.transAxes)
    return axes


def _effect_bars(axes: Axes, axis: Axis, shares: np.ndarray) -> None:
    if axis.circular:
        axes.bar(np.degrees(_unwrapped(axis)), shares, width=math.degrees(axis.width) * 0.9, color=BAR)
        _degrees(axes, "", grid=False)
        unit = "° clockwise"
    else:
        scale, unit = (1.0, "J") if axis.name == ENERGY else (1000.0, "mm")
        axes.bar(axis.centres * scale, shares, width=0.9 * axis.width * scale, color=BAR)
        axes.set_xlim(0, float(axis.edges[-1]) * scale)
    axes.set_title(f"P({axis.name}), {unit}")
    axes.locator_params(axis="y", nbins=3)


def _edge(figure: Figure, parent: Axes, child: Axes, from_gait: bool) -> None:
    """An arrow between two variables; among effects along the right edge."""
    start, end = ((1.08, 0.5), (-0.17, 0.5)) if from_gait else ((1.0, 0.4), (1.0, 0.6))
    bend = "arc3" if from_gait else "arc3,rad=-0.6"
    figure.add_artist(
        ConnectionPatch(
            start, end, "axes fraction", "axes fraction", axesA=parent, axesB=child, arrowstyle="-|>",
            connectionstyle=bend, mutation_scale=12, color=FAINT, linewidth=1.1,
        )
    )  # fmt: skip


def _unwrapped(axis: Axis) -> np.ndarray:
    """Bin centres of a circular axis, increasing."""
    found: np.ndarray = (axis.edges[:-1] + axis.edges[1:]) / 2
    return found


@styled
def prey_transition(transition: Polar, body_length: float) -> Figure:
    """Return one pose transition of the prey, in its own frame one time-step earlier (figure 2, left).

    transition: distance [m], angle and heading [rad clockwise]. body_length: metres.
    """
    figure = Figure(figsize=(3.6, 3.6), layout="constrained")
    draw_transition(figure.subplots(), transition, body_length)
    return figure


def draw_transition(axes: Axes, transition: Polar, body_length: float) -> None:
    """Draw a transition on ``axes``: both poses, its distance, angle and heading."""
    diameter = body_length * 1000
    right, ahead = float(transition.right) * 1000, float(transition.forward) * 1000
    angle, heading = float(transition.angle), float(transition.heading)
    reach = max(float(transition.distance) * 1000, 1.5 * diameter)
    axes.plot([0, 0], [0, reach * 0.72], color=FAINT, linewidth=0.8, linestyle=(0, (4, 3)))
    axes.plot([right, right], [ahead, ahead + diameter * 1.5], color=FAINT, linewidth=0.8, linestyle=(0, (4, 3)))
    axes.annotate("", (right, ahead), (0, 0), arrowprops={"arrowstyle": "-|>", "color": PREY, "linewidth": 1.2})
    body(axes, 0, 0, 0, diameter, FAINT, linestyle="--")
    body(axes, right, ahead, heading, diameter, PREY)
    facing = (right + diameter * 1.3 * math.sin(heading), ahead + diameter * 1.3 * math.cos(heading))
    axes.annotate("", facing, (right, ahead), arrowprops={"arrowstyle": "-|>", "color": PREY, "linewidth": 1.2})
    _arc(axes, 0, 0, reach * 1.1, angle)
    _arc(axes, right, ahead, diameter * 2.4, heading)
    side = 1 if right <= 0 else -1  # labels on the side away from the arrow
    away = (-side * math.cos(angle), side * math.sin(angle))  # across the arrow, on the side without the arc
    axes.annotate(
        f"distance {length(float(transition.distance))}", (right / 2, ahead / 2), (7 * away[0], 7 * away[1]),
        textcoords="offset points", ha="right" if away[0] < 0 else "left", va="top" if away[1] < -0.3 else "center",
        color=PREY,
    )  # fmt: skip
    axes.annotate(f"angle {true_minus(degrees(angle))}", (0, reach * 0.6), (side * 8, 0), textcoords="offset points",
                  ha="left" if side > 0 else "right", va="bottom")  # fmt: skip
    axes.annotate(f"heading {true_minus(degrees(heading))}", (right, ahead + diameter * 1.5), (side * 6, 2),
                  textcoords="offset points", ha="left" if side > 0 else "right", va="bottom")  # fmt: skip
    axes.annotate("one time-step earlier", (0, -diameter / 2), (0, -5), textcoords="offset points", ha="center",
                  va="top", color=FAINT)  # fmt: skip
    frame_axes(axes)
    low, high = min(0.0, ahead) - diameter * 1.6, max(reach * 0.72, ahead + diameter * 1.5) + diameter * 0.9
    middle, half = right / 2, max((high - low) / 2, abs(right) / 2 + diameter * 2.2)
    axes.set_xlim(middle - half, middle + half)
    axes.set_ylim(low, high)
    axes.set_aspect("equal", adjustable="box")
    axes.set_title("A transition of the prey")


def _arc(axes: Axes, right: float, ahead: float, diameter: float, clockwise: float) -> None:
    """The angle from straight ahead, clockwise [rad]."""
    ends = sorted([90.0, 90.0 - math.degrees(float(wrap(clockwise)))])
    axes.add_patch(Arc((right, ahead), diameter, diameter, theta1=ends[0], theta2=ends[1], color=CHOSEN, linewidth=1.3))


@styled
def prey_table(prey: PreyModel) -> Figure:
    """Return the learned prey table: each transition seen with its probability, count and 95 % interval (figure 2)."""
    rows = min(len(prey.counts), _MOST_CELLS)
    figure = Figure(figsize=(5.0, 1.2 + 0.24 * rows), layout="constrained")
    draw_prey_table(figure.subplots(), prey)
    return figure


def draw_prey_table(axes: Axes, prey: PreyModel) -> None:
    """Draw the most frequent transitions as bars with their 95 % credible intervals."""
    frame = prey.cpt().sort_values("count", ascending=False, kind="stable").head(_MOST_CELLS)
    y = np.arange(len(frame))
    p = frame["probability"].to_numpy()
    low, high = (np.clip(s * (frame[name].to_numpy() - p), 0, None) for name, s in (("low", -1), ("high", 1)))
    axes.barh(y, p, color=BAR, height=0.66)
    axes.errorbar(p, y, xerr=[low, high], fmt="none", ecolor=INK, elinewidth=0.9, capsize=2.5)
    labels = [true_minus(", ".join(map(label, cell))) for cell in frame.index]
    axes.set_yticks(y, labels)
    for place, count, end in zip(y, frame["count"], p + high, strict=True):
        axes.annotate(f"{count}", (end, place), (5, 0), textcoords="offset points", va="center", color=FAINT)
    axes.invert_yaxis()
    axes.set_xlim(0, min(1.12, float((p + high).max()) * 1.15))
    axes.set_xlabel("probability, 95 % interval, count")
    known = "all" if len(frame) == len(prey.counts) else f"{len(frame)} of"
    axes.set_title(f"{prey.observations} transitions, {known} {len(prey.counts)} cells")
    axes.set_ylabel("distance, angle, heading")


@styled
def prey(transition: Polar, learned: PreyModel, body_length: float) -> Figure:
    """Return the paper's figure 2: a prey transition beside the learned prey table."""
    rows = min(len(learned.counts), _MOST_CELLS)
    figure = Figure(figsize=(7.4, max(3.4, 1.2 + 0.26 * rows)), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=[1.15, 1])
    draw_transition(left, transition, body_length)
    draw_prey_table(right, learned)
    return figure


def _degrees(axes: Axes, label: str, *, grid: bool = True) -> None:
    axes.set_xlim(-185, 185)
    axes.set_xticks(range(-180, 181, 90))
    axes.set_xlabel(label)
    if grid:
        axes.grid(axis="x", color=LINE, linewidth=0.5)
        axes.set_axisbelow(True)
