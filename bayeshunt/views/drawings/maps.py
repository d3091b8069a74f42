"""Maps as drawings: a hunt from above, a plan in the hunter's frame, what each learned coordinate answers."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from bayeshunt.config.loading import parse
from bayeshunt.config.schema import ArenaSettings, ObstacleSettings
from bayeshunt.core.units import degrees, length, true_minus
from bayeshunt.episodes.episode import Episode
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel
from bayeshunt.planners.api import Plan
from bayeshunt.views import grounds, theme
from bayeshunt.views.drawings import svg
from bayeshunt.views.notebook.html import Html, tag

__all__ = ["Window", "episode_map", "gait_key", "inverse_map", "plan_map", "sector"]

_MARGIN = 26
_MOST_DOUBTED = 400  # coordinates whose interval is worked out, at some 2 ms each
_MOST_SECTORS = 1500  # of an inverse map: some 300 kB


class Window(NamedTuple):
    """From metres (across to the right, up) to pixels of a drawing."""

    left: float
    top: float  # metres, the highest
    scale: float  # pixels per metre
    width: float
    height: float

    @classmethod
    def around(cls, across: Any, up: Any, *, size: float = 360.0, least: float = 0.1) -> Window:
        """The window around points [N], at most ``size`` pixels either way, ``least`` metres at least."""
        across, up = np.asarray(across, dtype=float), np.asarray(up, dtype=float)
        wide, tall = max(np.ptp(across), least), max(np.ptp(up), least)
        scale = (size - 2 * _MARGIN) / max(wide, tall)
        width = max(wide * scale + 2 * _MARGIN, 300.0)  # room for the ruler and the legend
        left = (across.min() + across.max()) / 2 - (width / 2 - _MARGIN) / scale
        top = (up.min() + up.max() + tall) / 2
        return cls(left, top, scale, width, tall * scale + 2 * _MARGIN + 14)

    def at(self, across: float, up: float) -> tuple[float, float]:
        """Pixels of a point."""
        return _MARGIN + (across - self.left) * self.scale, _MARGIN + (self.top - up) * self.scale

    def ruler(self) -> Html:
        """A scale bar of a round length, at the bottom."""
        reach = 0.3 * (self.width - 2 * _MARGIN) / self.scale
        power = 10.0 ** math.floor(math.log10(reach))
        step = max(step * power for step in (1, 2, 5) if step * power <= reach)
        y, end = self.height - 8, _MARGIN + step * self.scale
        bar = svg.line([(_MARGIN, y - 4), (_MARGIN, y), (end, y), (end, y - 4)], stroke=svg.INK)
        return tag("g", bar, svg.text(end + 6, y + 1, length(step), faint=True))

    def robot(self, across: float, up: float, direction: float, colour: str, title: str, size: float = 8.0) -> Html:
        """A robot as an arrowhead; ``direction`` in radians counter-clockwise from the right, NaN draws a disc."""
        x, y = self.at(across, up)
        if math.isnan(direction):
            return svg.disc(x, y, 0.6 * size, title, fill=colour)
        corners = [(size, 0.0), (size * 0.85, 2.55), (size * 0.35, math.pi), (size * 0.85, -2.55)]
        points = " ".join(
            f"{x + reach * math.cos(direction + turn):.1f},{y - reach * math.sin(direction + turn):.1f}"
            for reach, turn in corners
        )
        return tag("polygon", tag("title", title), points=points, fill=colour)


def episode_map(episode: Episode) -> Html:
    """Return a hunt from above: both trails, the poses at each decision, the walls and obstacles."""
    trail, frame = episode.trail, episode.frame
    across = [*trail["hunter_x"], *trail["prey_x"]]
    up = [*trail["hunter_y"], *trail["prey_y"]]
    if not across:
        across, up = [*frame["hunter_x"], *frame["prey_x"]], [*frame["hunter_y"], *frame["prey_y"]]
    arena = _arena(episode)
    if arena.walled:
        across, up = [*across, -arena.width / 2, arena.width / 2], [*up, -arena.height / 2, arena.height / 2]
    for obstacle in arena.obstacles:
        across, up = [*across, *(x for x, _ in obstacle.outline())], [*up, *(y for _, y in obstacle.outline())]
    window = Window.around(across, up)
    parts = [*map(partial(_solid, window), arena.obstacles)]
    if arena.walled:
        parts.append(_wall(window, arena.width / 2, arena.height / 2))
    for who, colour in (("prey", svg.PREY), ("hunter", svg.HUNTER)):
        points = [window.at(x, y) for x, y in zip(trail[f"{who}_x"], trail[f"{who}_y"], strict=True)]
        parts.append(svg.line(_thin(points), stroke=colour, stroke_width=1.8, stroke_linejoin="round"))
        for row in frame.to_dict("records"):
            place = (row[f"{who}_x"], row[f"{who}_y"], row[f"{who}_theta"])
            chosen = f", chose {row['gait']}" if who == "hunter" else ""
            parts.append(window.robot(*place, colour, f"{who}, {row['time']:.1f} s{chosen}", 6))
    if episode.caught and len(trail):
        end = window.at(trail["hunter_x"].iloc[-1], trail["hunter_y"].iloc[-1])
        parts.append(svg.disc(*end, 11, "caught here", fill="none", stroke=svg.CATCH, stroke_width=2))
    parts += [window.ruler(), _legend(window)]
    return svg.drawing(window.width, window.height, *parts, label="Paths of hunter and prey from above")


def plan_map(plan: Plan) -> Html | None:
    """Return what a plan expects, in the hunter's frame (its heading is up); None if it tells no place."""
    prey, branch = plan.predicted_prey, _branch(plan)
    if prey is None and branch is None and plan.target is None:
        return None
    ahead, right, turn = _path(prey if prey is not None else plan.target)
    places = [(0.0, 0.0), *zip(right, ahead, strict=True)]
    if branch is not None:
        places += list(zip(branch[1], branch[0], strict=True))
    window = Window.around(*zip(*places, strict=True), size=320)
    parts = [svg.line([window.at(x, y) for x, y in zip(right, ahead, strict=True)], stroke=svg.PREY, stroke_width=1.5)]
    shown = range(len(ahead)) if len(ahead) <= 25 else range(0, len(ahead), math.ceil(len(ahead) / 25))
    if prey is None and math.isnan(turn[0]):
        shown = range(0)  # a point aimed at, not the prey's pose: the ring below shows it
    for step in shown:
        when = "now" if step == 0 else f"{step} ahead"
        parts.append(window.robot(right[step], ahead[step], math.pi / 2 - turn[step], svg.PREY, f"prey, {when}", 6))
    if branch is not None:
        parts.append(svg.line([window.at(x, y) for y, x, _ in zip(*branch, strict=True)], stroke=svg.HUNTER))
        for step, (y, x, heading) in enumerate(zip(*branch, strict=True)):
            parts.append(window.robot(x, y, math.pi / 2 - heading, svg.HUNTER, f"hunter, {step} ahead", 6))
    parts.append(window.robot(0, 0, math.pi / 2, svg.HUNTER, "hunter, now", 9))
    if plan.target is not None:
        goal = (float(plan.target.right), float(plan.target.forward))
        parts.append(svg.disc(*window.at(*goal), 9, "target", fill="none", stroke=svg.CHOSEN, stroke_width=2))
    parts += [window.ruler(), _legend(window)]
    return svg.drawing(window.width, window.height, *parts, label="Predicted paths in the hunter's frame")


def inverse_map(inverse: InverseModel) -> Html:
    """Return the most probable gait of every learned coordinate, in the robot's frame (heading up).

    The wider the interval of its probability, the paler it is.

    Where there are more coordinates than can be seen, neighbours share a sector in the colour of most of them.
    """
    axes, names = inverse.model.axes, inverse.model.gaits.names
    table = inverse.table()
    best = table[list(names)].to_numpy().argmax(axis=1)
    outer = table["distance"] + axes.distance.width
    right, ahead = outer * np.sin(table["angle"]), outer * np.cos(table["angle"])
    window = Window.around([0.0, *right], [0.0, *ahead], size=420)
    colours, stripes = theme.gait_variables(inverse.model), theme.stripes(inverse.model)
    bins = np.stack([axes.distance.index(table["distance"].to_numpy()), axes.angle.index(table["angle"].to_numpy())])
    within = _within(inverse, table, best) if len(table) <= _MOST_DOUBTED else None
    parts = []
    for corner, span, members in _sectors(bins, _MOST_SECTORS):
        gait = int(np.bincount(best[members]).argmax())
        reach, angle = (
            axis.edges[[a, min(a + n, axis.bins)]] for axis, a, n in zip(list(axes)[:2], corner, span, strict=True)
        )
        first = table.iloc[members[0]]
        if len(members) == 1:
            hint = f"{names[gait]}, support {grounds.rows(first['support'])}"
            if within is not None:
                low, high = within[members[0]]
                hint += f", 95 % interval {low:.2f} to {high:.2f}"
        else:
            hint = f"{names[gait]} in {int((best[members] == gait).sum())} of {len(members)} coordinates"
        place = f"{length(first['distance'])}, {true_minus(degrees(first['angle']))}"
        sure = 1.0 if within is None else 1.0 - float(np.mean([within[m][1] - within[m][0] for m in members]))
        look = {"fill_opacity": f"{0.15 + 0.85 * sure:.2f}", "stroke": svg.FAINT, "stroke_width": 0.6}
        parts.append(sector(window, reach, angle, colours[gait], f"{place}: {hint}", stripes[gait], **look))
    parts += [window.robot(0, 0, math.pi / 2, svg.INK, "robot", 8), window.ruler()]
    return svg.drawing(window.width, window.height, *parts, label="Most probable gait of every learned coordinate")


def _within(inverse: InverseModel, table: Any, best: np.ndarray) -> list[tuple[float, float]] | None:
    """The 95 % interval of each coordinate's best gait; None where nobody knows the counts."""
    if not inverse.model.has_counts:
        return None
    found = []
    for place, gait in zip(table[["distance", "angle"]].to_numpy(dtype=float), best.tolist(), strict=True):
        ends = inverse.posterior(float(place[0]), float(place[1])).interval()[["low", "high"]].to_numpy()[gait]
        found.append((float(ends[0]), float(ends[1])))
    return found


def _sectors(bins: np.ndarray, most: int) -> Iterator[tuple[Sequence[int], Sequence[int], np.ndarray]]:
    """First bin, number of bins and members of at most ``most`` sectors that hold all coordinates ``bins`` [2, N]."""
    span, width = [1, 1], int(bins[1].max()) + 1
    while True:
        owner = bins[0] // span[0] * width + bins[1] // span[1]
        if len(corners := np.unique(owner)) <= most:
            break
        span[0 if span[0] <= span[1] else 1] *= 2
    order = np.argsort(owner, kind="stable")
    starts = np.searchsorted(owner[order], corners)
    for corner, members in zip(corners.tolist(), np.split(order, starts[1:]), strict=True):
        yield (corner // width * span[0], corner % width * span[1]), span, members


def gait_key(model: ForwardModel) -> Html:
    """Return the colours of the gaits in a list beside a map."""
    rows = []
    looks = zip(model.gaits.names, theme.gait_variables(model), theme.stripes(model), strict=True)
    for name, colour, stripes in list(looks)[:40]:
        lines = [svg.line([(0, y), (12, y)], **_STRIPE) for y in _between(0.0, 12.0, stripes)]
        label = "striped colour" if stripes else "colour"
        swatch = svg.drawing(12, 12, svg.box(0, 0, 12, 12, fill=colour, rx=2), *lines, label=label)
        look = "display:flex;gap:8px;align-items:center"
        rows.append(tag("div", swatch, tag("span", name), style=look))
    return tag("div", *rows)


def sector(
    window: Window, reach: np.ndarray, angle: np.ndarray, colour: str, hint: str, stripes: int = 0, **outline: Any
) -> Html:
    """Return an annular sector between two distances [m] and two angles [rad], clockwise from up; striped across."""
    (near, far), edges = reach, angle
    corners = [window.at(r * math.sin(a), r * math.cos(a)) for r, a in
               ((near, edges[0]), (far, edges[0]), (far, edges[1]), (near, edges[1]))]  # fmt: skip
    path = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in corners) + "Z"
    outline = outline or {"stroke": svg.FAINT, "stroke_width": 0.6}
    drawn = tag("path", tag("title", hint), d=path, fill=colour, **outline)
    ends = [[window.at(r * math.sin(a), r * math.cos(a)) for a in edges] for r in _between(near, far, stripes)]
    return tag("g", drawn, *(svg.line(points, **_STRIPE) for points in ends)) if stripes else drawn


#: A stripe lets the ground through; what is below it keeps its hint.
_STRIPE = {"stroke": "var(--bh-paper)", "stroke_width": 2, "pointer_events": "none"}


def _between(start: float, end: float, count: int) -> list[float]:
    """Places that part an interval evenly."""
    return [start + (end - start) * (k + 1) / (count + 1) for k in range(count)]


def _branch(plan: Plan) -> tuple[list[float], list[float], list[float]] | None:
    """Forward, right [m] and heading of the hunter along the chosen branch, if the trace tells poses."""
    trace = plan.trace
    if not {"chosen", "T", "hunter_forward", "hunter_right", "hunter_heading"} <= set(trace.columns):
        return None
    rows = trace[trace["chosen"]].sort_values("T")
    return tuple(rows[name].tolist() for name in ("hunter_forward", "hunter_right", "hunter_heading"))  # type: ignore[return-value]


def _path(polar: Any) -> tuple[list[float], list[float], list[float]]:
    parts = (polar.forward, polar.right, polar.heading)
    return tuple(np.atleast_1d(np.asarray(part, dtype=float)).tolist() for part in parts)


def _arena(episode: Episode) -> ArenaSettings:
    """The arena that the hunt took place in; open where the record does not say."""
    settings, name = episode.provenance.get("settings", {}), episode.provenance.get("arena")
    return parse(ArenaSettings, settings.get("arenas", {}).get(name, {}), "the episode's arena")


def _solid(window: Window, obstacle: ObstacleSettings) -> Html:
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in (window.at(*corner) for corner in obstacle.outline()))
    return tag("polygon", tag("title", "obstacle"), points=points, fill=svg.FAINT, fill_opacity=0.55)


def _wall(window: Window, half_width: float, half_height: float) -> Html:
    x, y = window.at(-half_width, half_height)
    return svg.box(
        x, y, 2 * half_width * window.scale, 2 * half_height * window.scale,
        fill="none", stroke=svg.FAINT, stroke_width=2,
    )  # fmt: skip


def _legend(window: Window) -> Html:
    y, x = window.height - 7, window.width - 118
    return tag(
        "g", svg.disc(x, y - 4, 4, fill=svg.HUNTER), svg.text(x + 8, y, "hunter"),
        svg.disc(x + 66, y - 4, 4, fill=svg.PREY), svg.text(x + 74, y, "prey"),
    )  # fmt: skip


def _thin(points: list[tuple[float, float]], most: int = 400) -> list[tuple[float, float]]:
    """At most ``most`` of the points, the last one always."""
    step = max(1, math.ceil(len(points) / most))
    return points[::step] + (points[-1:] if points and (len(points) - 1) % step else [])
