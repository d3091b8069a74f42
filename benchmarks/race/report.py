"""The race as a table, as CSV and as a figure."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np

from bayeshunt.experiments.scores import wilson_interval
from benchmarks.race.jobs import ELSEWHERE, WORLDS, Row

__all__ = ["Ended", "write"]

#: A row, and the time of each of its hunts, in an order that is the same for every hunter.
Ended = tuple[Row, list[float]]
#: Seconds of a gait in preset "paper".
_GAIT = 3.328
_HEAD = """# Learning by trial against babbling

`python -m benchmarks.race` (extras `rl` and `bench`) makes this page, `race.csv` beside it and the figure of
[the race](../../docs/race.md), which says what it means. Preset "paper"; every row hunts with the same seeds and
bearings (evaluation seed 0), in `bayeshunt` itself. Intervals are 95 % Wilson, a miss counts 60 s, ± is the standard
error. A gait lasts 3.328 s of a robot's time. CPU is that of learning: babbling, exploring and fitting; or training, in
a compiled copy of the hunt. The settings called tuned come from a small search on the very hunts that are reported,
which flatters them a little; constants of our planners were chosen on this preset, on other seeds.
"""


def write(found: Sequence[Ended], root: Path) -> None:
    """Write all three."""
    results = root / "benchmarks" / "results"
    with (results / "race.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, [field.name for field in fields(Row)], lineterminator="\n")
        table.writeheader()
        table.writerows(asdict(row) for row, _ in found)
    (results / "race.md").write_text(markdown(found), encoding="utf-8")
    for name, dark in (("race", False), ("race_dark", True)):
        draw([row for row, _ in found if row.world == "paper"], root / "docs" / "images" / f"{name}.png", dark=dark)


# --- the table --------------------------------------------------------------------------------


def markdown(found: Sequence[Ended]) -> str:
    """All tables."""
    parts = [_HEAD]
    here = [one for one in found if one[0].world == "paper"]
    for arena in ("open", "walled"):
        some = [one for one in here if one[0].arena == arena]
        parts.append(f"## {arena.capitalize()}\n\n{_lines(some)}")
    parts.append(_paired(here))
    parts.append(_elsewhere("Settings that nobody was trained for", found, list(WORLDS)[1:]))
    parts.append(_elsewhere("On legs, and with a camera", found, list(ELSEWHERE)))
    return "\n".join(part for part in parts if part)


def _elsewhere(title: str, found: Sequence[Ended], worlds: Sequence[str]) -> str:
    some = [one for one in found if one[0].world in worlds]
    if not some:
        return ""
    some.sort(key=lambda one: (worlds.index(one[0].world), one[0].arena))
    return f"## {title}\n\n{_lines(some, world=True)}"


def label(row: Row) -> str:
    """Who it is: a planner, or a learner and its settings."""
    if not row.reward:
        return f"`{row.hunter}`"
    return (
        f"{row.hunter}, {'tuned' if row.tuned else 'defaults'}, {'shaped' if row.reward == 'shaped' else 'not shaped'}"
    )


def _lines(found: Iterable[Ended], *, world: bool = False) -> str:
    first = "| setting | arena | hunter " if world else "| hunter "
    lines = [
        f"{first}| seed | gaits | robot time | caught | success | 95 % interval | mean time [s] | CPU [s] |",
        ("| --- | --- | --- " if world else "| --- ") + "| --- " * 8 + "|",
    ]
    for row, _ in found:
        start = f"| {row.world} | {row.arena} | {label(row)} " if world else f"| {label(row)} "
        lines.append(
            f"{start}| {row.seed} | {row.gaits:,} | {_duration(row.hours)} | {row.caught}/{row.hunts} | "
            f"{row.caught / row.hunts:.1%} | {row.low:.1%} to {row.high:.1%} | {row.mean_s:.2f} ± {row.se_s:.2f} | "
            f"{row.cpu_s:.1f} |"
        )
    return "\n".join(lines) + "\n"


def _duration(hours: float) -> str:
    if hours < 1.0:
        return f"{60 * hours:.0f} min" if hours > 0.03 else f"{3600 * hours:.0f} s"
    return f"{hours:.1f} h" if hours < 48 else f"{hours / 24:.1f} days"


def _paired(found: Sequence[Ended]) -> str:
    """Learners minus planners over the same 700 hunts."""
    many = [one for one in found if one[0].hunts >= 700]
    lines = []
    for row, times in many:
        for other, theirs in many:
            if row.reward and not other.reward and row.arena == other.arena:
                gap = np.array(times) - np.array(theirs)
                error = float(np.std(gap) / math.sqrt(len(gap)))
                who = f"{row.hunter}, {row.gaits:,} gaits"
                lines.append(f"| {who} | {row.arena} | {label(other)} | {gap.mean():+.2f} ± {error:.2f} |")
    if not lines:
        return ""
    head = "| learner | arena | minus | difference of the mean time [s] |\n| --- | --- | --- | --- |"
    return "\n".join(["## Paired, over the same 700 hunts", "", head, *lines, ""])


# --- the figure -------------------------------------------------------------------------------

_INK = {False: ("#222222", "#ffffff", "#dddddd"), True: ("#e6e6e6", "#1e2129", "#3a3f4b")}
#: Who is drawn how: line, marker, colour by day and by night.
_LOOKS: dict[str, tuple[str, str, str, str]] = {
    "planning": ("--", "s", "#56799b", "#8fb4d9"),
    "intercept": ("-", "o", "#0072b2", "#56b4e9"),
    "intercept_walls": ("-", "^", "#00734f", "#2fbf91"),
    "DQN": ("-", "D", "#b35a00", "#e69f00"),
    "PPO": ("-", "v", "#b0307f", "#e78ac3"),
}
_TOP = ((60 / 3600, "1 min"), (1.0, "1 h"), (24.0, "1 day"), (30 * 24.0, "1 month"))


def draw(rows: Sequence[Row], path: Path, *, dark: bool) -> None:
    """Success and mean time against gaits executed, an arena a column."""
    import matplotlib as mpl
    import matplotlib.pyplot as plt

    ink, ground, grid = _INK[dark]
    style = {
        "font.family": "DejaVu Sans", "font.size": 9, "text.color": ink, "axes.labelcolor": ink, "xtick.color": ink,
        "ytick.color": ink, "axes.edgecolor": ink, "figure.facecolor": ground, "axes.facecolor": ground,
    }  # fmt: skip
    with mpl.rc_context(style):
        figure, panels = plt.subplots(2, 2, figsize=(9.5, 6.6), sharex=True, sharey="row", layout="constrained")
        for column, arena in enumerate(("open", "walled")):
            here = [row for row in rows if row.arena == arena]
            for panel, success in ((panels[0][column], True), (panels[1][column], False)):
                _panel(panel, here, success=success, dark=dark)
                panel.grid(color=grid, lw=0.5)
            _hours(panels[0][column], arena)
            panels[1][column].set_xlabel("gaits executed")
        panels[0][0].set_ylabel("caught [%]")
        panels[1][0].set_ylabel("mean time, a miss counts 60 s [s]")
        handles, labels = panels[0][1].get_legend_handles_labels()
        seen = dict(zip(labels, handles, strict=True))
        figure.legend(seen.values(), seen.keys(), loc="outside lower center", ncols=5, frameon=False, fontsize=8)
        figure.savefig(path, dpi=110)
        plt.close(figure)


def _panel(panel: Any, rows: Sequence[Row], *, success: bool, dark: bool) -> None:
    panel.set_xscale("log")
    panel.set_xlim(14, 1.5e6)
    panel.set_ylim((-3, 103) if success else (0, 62))
    for name, (line, marker, day, night) in _LOOKS.items():
        colour = night if dark else day
        mine = [row for row in rows if row.hunter == name]
        said = f"{name}, tuned, shaped" if mine and mine[0].reward else name
        main = [row for row in mine if not row.reward or (row.tuned and row.reward == "shaped")]
        if main:
            _curve(panel, main, success, {"ls": line, "marker": marker, "color": colour, "label": said})
        for reward, fill in (("shaped", colour), ("time", "none")):
            some = [row for row in mine if not row.tuned and row.reward == reward]
            if some:
                shown = f"{name}, defaults, {'shaped' if reward == 'shaped' else 'not shaped'}"
                look = {"ls": "", "marker": "*" if name == "PPO" else "P", "color": colour, "mfc": fill, "ms": 10}
                _curve(panel, some, success, {**look, "label": shown})


def _curve(panel: Any, rows: Sequence[Row], success: bool, look: dict[str, Any]) -> None:
    """All seeds of a number of gaits as one point: hunts together; each seed's own as a small dot.

    A seed that hunted 210 times and 700 times counts with its 700, which hold the 210.
    """
    rows = list({(row.gaits, row.seed): row for row in sorted(rows, key=lambda row: row.hunts)}.values())
    points = []
    for gaits in sorted({_near(row.gaits) for row in rows}):
        some = [row for row in rows if _near(row.gaits) == gaits]
        hunts, caught = sum(row.hunts for row in some), sum(row.caught for row in some)
        at = float(np.mean([row.gaits for row in some]))
        mean = sum(row.mean_s * row.hunts for row in some) / hunts
        spread = math.sqrt(sum((row.se_s * row.hunts) ** 2 for row in some)) / hunts
        low, high = wilson_interval(caught, hunts)
        points.append(
            (at, 100 * caught / hunts, 100 * low, 100 * high) if success else (at, mean, mean - spread, mean + spread)
        )
        if len(some) > 1:
            own = [100 * row.caught / row.hunts if success else row.mean_s for row in some]
            panel.plot([at] * len(own), own, ".", color=look["color"], ms=3, alpha=0.6)
    x, y, low, high = np.array(points).T
    panel.errorbar(x, y, (y - low, high - y), lw=1.4, ms=look.get("ms", 5), capsize=2, elinewidth=0.8,
                   **{key: value for key, value in look.items() if key != "ms"})  # fmt: skip


def _near(gaits: int) -> float:
    """The same for numbers of gaits that differ by less than a tenth: learners stop at the end of a batch."""
    return round(8 * math.log10(gaits))


def _hours(panel: Any, arena: str) -> None:
    top = panel.secondary_xaxis("top", functions=(lambda n: n * _GAIT / 3600, lambda h: h * 3600 / _GAIT))
    top.set_xticks([hours for hours, _ in _TOP], [said for _, said in _TOP])
    top.minorticks_off()
    top.set_xlabel(f"{arena}: a robot's time")
