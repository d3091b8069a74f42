"""Geometry of the report's charts: what goes where, in pixels; the template turns it into SVG.

Every chart has one series per planner, in one order and with one colour and marker throughout.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.units import degrees, theta
from bayeshunt.experiments.scores import wilson_interval
from bayeshunt.views.theme import PLANNERS

__all__ = ["MARKERS", "Scale", "Ticks", "styles", "success_charts", "time_charts"]

#: Values of an axis and what is written there.
Ticks = list[tuple[float, str]]
#: Size of a chart [px]; the page scales it.
WIDTH, HEIGHT = 440, 290
#: Planners that one chart holds; more get a chart each.
_TOGETHER = 3
_LEFT, _RIGHT, _TOP, _BOTTOM = 46, 14, 14, 44
#: Marker outlines around (0, 0), as SVG paths: they tell the planners apart where colours do not.
MARKERS = (
    "M-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0z",
    "M-3.7-3.7h7.4v7.4h-7.4z",
    "M0-4.8L4.6 3.4H-4.6z",
    "M0-5.2L5.2 0L0 5.2L-5.2 0z",
    "M0 4.8L4.6-3.4H-4.6z",
)


@dataclass(frozen=True)
class Scale:
    """Maps values from ``low`` to ``high`` to pixels from ``start`` to ``end``."""

    low: float
    high: float
    start: float
    end: float

    def __call__(self, value: float) -> float:
        """Return the pixel of ``value``, in tenths."""
        share = (value - self.low) / ((self.high - self.low) or 1.0)
        return round(self.start + share * (self.end - self.start), 1)


def styles(planners: list[str]) -> dict[str, dict[str, Any]]:
    """Return the colour class and marker of every planner."""
    return {
        name: {"planner": name, "colour": i % len(PLANNERS) + 1, "marker": MARKERS[i % len(MARKERS)]}
        for i, name in enumerate(planners)
    }


def success_charts(rows: list[dict[str, Any]], looks: dict[str, dict[str, Any]]) -> list[dict[str, Any]]:
    """Return per arena the chart of success by bearing, with 95 % intervals; ``rows`` as ``summarise`` gives them."""
    charts = []
    thetas = sorted({row["theta"] for row in rows if row["theta"] is not None})
    for arena in _arenas(rows):
        here = [row for row in rows if row["arena"] == arena]
        names = list(dict.fromkeys(row["planner"] for row in here))
        x, y = _across(thetas), Scale(0.0, 1.0, HEIGHT - _BOTTOM, _TOP)
        ticks = [(value, degrees(value)) for value in thetas]
        chart = _frame(f"Success by first bearing of the prey, {arena} arena", x, y, ticks, _percent_ticks())
        chart |= {"arena": arena, "x_label": "first bearing of the prey, clockwise", "y_label": "caught"}
        chart["series"] = [
            {
                **looks[name],
                "band": "",
                "points": _whiskers([r for r in here if r["planner"] == name], x, y, _dodge(i, len(names))),
            }
            for i, name in enumerate(names)
        ]
        for place, (name, series) in enumerate(zip(names, chart["series"], strict=True)):
            mine = _of(here, name)
            series["published"] = _published(mine, x, y, _dodge(place, len(names)))
            series["line"] = " ".join(f"{p['x']},{p['y']}" for p in series["points"])
        charts += _apart(chart)
    return charts


def _of(rows: list[dict[str, Any]], planner: str) -> list[dict[str, Any]]:
    return [row for row in rows if row["planner"] == planner]


def _apart(chart: dict[str, Any]) -> list[dict[str, Any]]:
    """The chart; where it has more planners than can be told apart, one for each of them, the others faint behind."""
    if len(chart["series"]) <= _TOGETHER:
        return [chart]
    return [
        {
            **chart,
            "title": f"{chart['title']}: {own['planner']}",
            "caption": f"{own['planner']}, {chart['arena']} arena",
            "series": [own],
            "ghosts": [other["line"] for other in chart["series"] if other is not own],
        }
        for own in chart["series"]
    ]


def time_charts(
    results: pd.DataFrame, settings: ExperimentSettings, looks: dict[str, dict[str, Any]]
) -> list[dict[str, Any]]:
    """Return per arena the chart of the share of hunts that ended in a catch by each time."""
    charts, limit = [], settings.protocol.time_limit
    for arena, hunts in results.groupby("arena", sort=False):
        x, y = Scale(0.0, limit, _LEFT, WIDTH - _RIGHT), Scale(0.0, 1.0, HEIGHT - _BOTTOM, _TOP)
        parts = next((n for n in (6, 5, 4) if float(limit / n).is_integer()), 6)  # whole seconds where they can be
        ticks = [(at, f"{at:.3g}") for at in (limit * i / parts for i in range(parts + 1))]
        chart = _frame(f"Share caught by time, {arena} arena", x, y, ticks, _percent_ticks())
        chart |= {"arena": str(arena), "x_label": "time since the start [s]", "y_label": "caught by then"}
        chart["series"] = [
            {
                **looks[str(name)],
                "points": [],
                "published": [],
                "line": _staircase(some, limit, x, y),
                "band": _band(some, limit, x, y),
            }
            for name, some in hunts.groupby("planner", sort=False)
        ]
        charts += _apart(chart)
    return charts


def _frame(title: str, x: Scale, y: Scale, x_ticks: Ticks, y_ticks: Ticks) -> dict[str, Any]:
    return {
        "title": title, "caption": "", "ghosts": [], "width": WIDTH, "height": HEIGHT,
        "left": _LEFT, "right": WIDTH - _RIGHT, "top": _TOP, "bottom": HEIGHT - _BOTTOM,
        "x_ticks": [(x(value), label) for value, label in x_ticks],
        "y_ticks": [(y(value), label) for value, label in y_ticks],
    }  # fmt: skip


def _percent_ticks() -> Ticks:
    return [(i / 4, f"{25 * i} %") for i in range(5)]


def _across(thetas: list[float]) -> Scale:
    """Room for half a step beside the first and the last bearing."""
    half = 0.5 * min(np.diff(thetas)) if len(thetas) > 1 else 0.5
    return Scale(thetas[0] - half, thetas[-1] + half, _LEFT, WIDTH - _RIGHT)


def _dodge(place: int, count: int) -> float:
    """Pixels by which a planner's marks move sideways, so that intervals stay apart."""
    return round((place - (count - 1) / 2) * min(7.0, 40.0 / count), 1)


def _whiskers(rows: list[dict[str, Any]], x: Scale, y: Scale, aside: float) -> list[dict[str, Any]]:
    return [
        {
            "x": round(x(row["theta"]) + aside, 1),
            "y": y(row["success"]), "low": y(row["ci_low"]), "high": y(row["ci_high"]),
            "text": f"{row['planner']}, {theta(row['theta'])}: {row['caught']} of {row['runs']} caught, "
            f"{row['success']:.1%} ({row['ci_low']:.1%} to {row['ci_high']:.1%})",
        }
        for row in rows
        if row["theta"] is not None
    ]  # fmt: skip


def _published(rows: list[dict[str, Any]], x: Scale, y: Scale, aside: float) -> list[dict[str, Any]]:
    """Where the published share of each bearing lies, for those that there are."""
    return [
        {
            "x": round(x(row["theta"]) + aside, 1),
            "y": y(row["paper_success"]),
            "text": f"{row['planner']}, theta {row['theta']:g}, published: {row['paper_success']:.1%}",
        }
        for row in rows
        if row["theta"] is not None and row["paper_success"] is not None
    ]


def _staircase(hunts: pd.DataFrame, limit: float, x: Scale, y: Scale) -> str:
    """Points of the empirical distribution of catch times; misses never arrive."""
    times = np.sort(hunts.loc[hunts["caught"], "time"].to_numpy())
    points, before = [(x(0.0), y(0.0))], 0.0
    for time in np.unique(times):
        share = float(np.searchsorted(times, time, side="right")) / len(hunts)
        points += [(x(time), y(before)), (x(time), y(share))]
        before = share
    return " ".join(f"{a},{b}" for a, b in [*points, (x(limit), y(before))])


def _band(hunts: pd.DataFrame, limit: float, x: Scale, y: Scale) -> str:
    """Outline of the 95 % Wilson interval of the share caught by each time: along the low end, back along the high."""
    times, runs = np.sort(hunts.loc[hunts["caught"], "time"].to_numpy()), len(hunts)
    at = [0.0, *np.unique(times).tolist(), limit]
    ends = [wilson_interval(int(np.searchsorted(times, time, side="right")), runs) for time in at]
    lines = []
    for which in (0, 1):
        points = [(x(at[0]), y(ends[0][which]))]
        for time, before, now in zip(at[1:], ends, ends[1:], strict=False):
            points += [(x(time), y(before[which])), (x(time), y(now[which]))]
        lines.append(points)
    return " ".join(f"{a},{b}" for a, b in [*lines[0], *reversed(lines[1])])


def _arenas(rows: list[dict[str, Any]]) -> list[str]:
    return list(dict.fromkeys(row["arena"] for row in rows))
