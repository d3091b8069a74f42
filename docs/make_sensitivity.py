"""Make docs/sensitivity.md and docs/images/sensitivity.png: what changes of preset oses2010 do to what it reproduces.

python docs/make_sensitivity.py FOLDER [--runs 100] [--seed 0] [--jobs 1]

Every row is a point of a sweep, as ``bayeshunt sweep --preset oses2010 --axis arenas.walled.width=-2%,+2%`` runs it.
The hunts are kept in FOLDER; the same line goes on where it was stopped.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import bayeshunt as bh
from bayeshunt.experiments.reported import compare

DOCS = Path(__file__).parent
#: What is varied, and how a row calls it.
AXES: dict[str, tuple[str, tuple[object, ...]]] = {
    "protocol.catch_distance": ("catch distance, bodies", (1.02, 1.1, 1.2, 1.5)),  # 1.02 is the preset's own
    "arenas.walled.width": ("width", ("-5%", "-2%", "+2%", "+5%")),
    "arenas.walled.height": ("height", ("-5%", "-2%", "+2%", "+5%")),
    "gait_duration": ("time-step", ("-2%", "+2%")),
    "speed_ratio": ("prey's speed / hunter's", ("-5%", "-2%", "-1%", "+1%", "+2%", "+5%")),
    "slip": ("slip", (0.0, 0.05, 0.10, 0.15)),
    "prey.senses_hunter": ("prey senses the hunter", (False,)),
    "protocol.hunter_theta": ("start turned, rad", (-0.0349, 0.0349)),
    "protocol.hunter_x": ("start ahead, m", (-0.005, 0.005)),
    "protocol.hunter_y": ("start to the left, m", (-0.004, 0.004)),
}
#: What is evaluated where: all of which something was published.
ROWS = {"walled": ("reactive", "prediction"), "open": ("prediction", "planning")}
PANELS = (("reactive", "walled"), ("prediction", "walled"), ("prediction", "open"), ("planning", "open"))


def main() -> None:
    """Sweep, and write the table and the figure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    rows = [row for axis in AXES for row in swept(axis, options)]
    frame = pd.DataFrame(rows)
    (DOCS / "sensitivity.md").write_text(markdown(frame, options), encoding="utf-8")
    with mpl.rc_context({"font.family": "DejaVu Sans", "font.size": 9}):
        draw(frame).savefig(DOCS / "images" / "sensitivity.png", dpi=110)


def swept(axis: str, options: argparse.Namespace) -> list[dict[str, object]]:
    """Sweep one axis; a row per point: its name, and by planner and arena its success, p, mean time and profile."""
    name, values = AXES[axis]
    published = bh.load_experiment("oses2010").published
    for arena, planners in ROWS.items():
        bh.sweep("oses2010", {axis: values}, runs=options.runs, seed=options.seed, jobs=options.jobs,
                 planners=planners, arenas=[arena], out=options.folder / axis / arena)  # fmt: skip
    rows = []
    for number, value in enumerate(values):
        own = axis == "protocol.catch_distance" and number == 0
        row: dict[str, object] = {"change": "none" if own else f"{name} {value}".replace("hunter False", "hunter: no")}
        for arena in ROWS:
            hunts = bh.load_results(options.folder / axis / arena / f"point-{number:03d}")
            settings = bh.load_experiment("oses2010").model_copy(update={"published": published})
            for said in compare(hunts, settings):
                key = f"{said['planner']} {arena}"
                if said["theta"] is None:
                    row |= {key: said["success"], f"{key} p": said["p_success"], f"{key} s": said["mean_time_s"]}
            for planner, some in hunts.groupby("planner"):
                row[f"{planner} {arena} by theta"] = list(some.groupby("theta")["caught"].mean())
        rows.append(row)
        print(row["change"], flush=True)
    return rows


def markdown(frame: pd.DataFrame, options: argparse.Namespace) -> str:
    """The table, a row per change."""
    lines = [
        "# What changes of `oses2010` do",
        "",
        f"Made by `docs/make_sensitivity.py`: `bayeshunt sweep`, {options.runs} runs per bearing, seed {options.seed}. "
        "One thing is changed at a time; in brackets the p-value of Fisher's test against the published count "
        "(< 0.001: excluded). A percentage changes the preset's own value.",
        "",
        "| change | reactive walled, by bearing, % | prediction walled, % | mean time, s | prediction open, % | "
        "planning open, % |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for row in frame.to_dict("records"):
        profile = " ".join(f"{100 * share:.0f}" for share in row["reactive walled by theta"])
        cells = [row["change"], profile, share(row, "prediction walled"), f"{row['prediction walled s']:.1f}"]
        lines.append(f"| {' | '.join([*cells, share(row, 'prediction open'), share(row, 'planning open')])} |")
    own = frame.iloc[0]
    lines += ["", "The unchanged row by bearing (theta 0 to 6), %:", ""]
    for planner, arena in PANELS:
        profile = " ".join(f"{100 * part:.0f}" for part in own[f"{planner} {arena} by theta"])
        lines.append(f"- `{planner}`, {arena}: {profile}")
    return "\n".join(lines) + "\n"


def share(row: dict[str, object], key: str) -> str:
    """A success and its p-value."""
    p = float(row[f"{key} p"])
    return f"{100 * float(row[key]):.1f} ({'< 0.001' if p < 0.001 else f'{p:.2g}'})"


def draw(frame: pd.DataFrame) -> mpl.figure.Figure:
    """A panel per published total: a dot per change, filled where it is not excluded; the published value as a line."""
    settings = bh.load_experiment("oses2010")
    size = 11, 0.27 * len(frame) + 1.1
    figure, panels = plt.subplots(1, len(PANELS), figsize=size, sharey=True, layout="constrained")
    place = np.arange(len(frame))[::-1]
    for panel, (planner, arena) in zip(panels, PANELS, strict=True):
        key = f"{planner} {arena}"
        fits = frame[f"{key} p"].to_numpy(dtype=float) >= 0.05
        values = 100 * frame[key].to_numpy(dtype=float)
        panel.axvline(100 * settings.reported(planner, arena).share, color="#d55e00", lw=1.3, ls=(0, (4, 2)))
        panel.plot(values[fits], place[fits], "o", color="#0072b2", ms=5)
        panel.plot(values[~fits], place[~fits], "o", mfc="none", color="#0072b2", ms=5)
        panel.set_title(f"{planner}, {arena}", fontsize=9)
        panel.set_xlabel("caught [%]")
        panel.set_xlim(-3, 103)
        panel.grid(color="#dddddd", lw=0.5)
    panels[0].set_yticks(place, frame["change"])
    figure.supxlabel("dashed: published; filled: p at least 0.05 (Fisher)", fontsize=8)
    return figure


if __name__ == "__main__":
    main()
