"""What recordings are foreseen to: ``python -m benchmarks.recordings [--only husky ...] [--people FOLDER]``.

A line a target: what was measured with its 95 % interval and its number of windows, and the target beside it. Seed 0;
everything is held out. Intervals resample commands or individuals (of two animals, blocks of time): rows that follow
each other depend on each other.

``--people`` names a folder of recordings of people, 2.5 frames a second, metres: each file is a scene, but of the
public files of ETH and UCY the five usual scenes are taken (eth, hotel, students001 and 003, zara01, zara02).
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import bayeshunt as bh
from bayeshunt.core.errors import InputError
from bayeshunt.data import tracks as tracks_file
from benchmarks.command import command, quiet_pgmpy, show

__all__ = ["PARTS", "line", "measure", "report"]

_DATA = Path(__file__).parents[1] / "data"
#: Scene -> what the names of its files end with.
_SCENES = {"eth": ["biwi_eth"], "hotel": ["biwi_hotel"], "univ": ["students001", "students003"],
           "zara1": ["crowds_zara01"], "zara2": ["crowds_zara02"]}  # fmt: skip
_PREY = ["stands", "constant_velocity", "autoregression", "conditioned"]
_BATCHES = 20  # of one table of transitions, in a row of the memory's figures
#: Windows scored of each fold; tests take fewer.
MOST = 1500

Figures = list[dict[str, Any]]


def line(
    what: str, value: float, target: float | None, low: float = np.nan, high: float = np.nan, n: int = 0, unit: str = ""
) -> dict[str, Any]:
    """Return one figure; a target is met at or below it, None is none."""
    met = None if target is None else bool(value <= target)
    return {"what": what, "value": float(value), "low": float(low), "high": float(high), "n": int(n), "unit": unit,
            "target": target, "met": met}  # fmt: skip


def windows() -> pd.DataFrame:
    """The Husky's windows as a babbling table; the number of its gaits is chosen by the rows."""
    columns = ("cmd_left_rad_s", "cmd_right_rad_s"), ("x_forward_m", "y_left_m", "yaw_ccw_rad")
    return bh.gaits_from_windows(pd.read_csv(_DATA / "husky_windows.csv"), *columns, time_step=2.0, gaits="auto")


def husky() -> Figures:
    """The pose after 2 s: five folds, every command whole in one of them; gaits chosen inside each training fold."""
    targets = {"residual": (0.31, 22.0), "previous_gait": (0.38, 22.0)}
    models = ("stays", "unicycle", "unicycle_lag", "table", "previous_gait", "residual")
    rows: Figures = []
    for row in bh.score_forward(windows(), "auto", models, folds_by="calib_step").to_dict("records"):
        place, turn = targets.get(row["model"], (None, None))
        what = f"Husky, {row['model']}"
        rows += [
            line(what, row["position_m"], place, row["position_low"], row["position_high"], row["n"], "m"),
            line(what, row["heading_deg"], turn, row["heading_low"], row["heading_high"], row["n"], "deg"),
        ]
    return rows


def bins() -> Figures:
    """Densities of the paper's structure: default bins, and those that the rows choose."""
    frame = pd.read_csv(_DATA / "husky_windows.csv")
    columns = ("cmd_left_rad_s", "cmd_right_rad_s"), ("x_forward_m", "y_left_m", "yaw_ccw_rad")
    rows: Figures = []
    for gaits, length, target in ((25, None, -1.0), (9, 0.99, None)):
        table = bh.gaits_from_windows(frame, *columns, time_step=2.0, gaits=gaits, body_length=length)
        names, body = sorted(set(table["gait"])), length or 0.5  # what it says of a robot whose length is not given
        default, auto = (
            bh.assess(table, names, structures=[], permutations=1, axes=axes)
            for axes in (bh.EffectAxes.standard(body), "auto")
        )
        nats = [float(found.structures.loc["naive", "density"]) for found in (default, auto)]
        what = f"Husky, {gaits} gaits, body {'not given' if length is None else f'{length:g} m'}"
        rows.append(line(f"{what}: default bins, density loss", nats[0], None, n=len(table), unit="nats a row"))
        rows.append(line(f"{what}: auto less default", nats[1] - nats[0], target, n=len(table), unit="nats a row"))
        warned = any("bins" in note for note in default.notes)
        rows.append(line(f"{what}: default bins pass without a warning", float(not warned), 0.0, n=len(table)))
    return rows


def guppies() -> Figures:
    """The later half of each recording, learned from the earlier one."""
    tracks = tracks_file.load(_DATA / "guppies.parquet")
    rows: Figures = []
    for step, target in ((0.2, 64.0), (0.48, 168.0)):
        found = bh.score_prey(tracks, _PREY, time_step=step, split="time", most=MOST)
        rows += _errors(f"guppies, {step:g} s", found, {"ade": target}, "px", scores=("ade",))
    return rows


def locusts() -> Figures:
    """The last of five locusts, learned from the four others, and from itself too: how much it differs from them."""
    tracks = tracks_file.load(_DATA / "locusts.parquet")
    last = tracks["id"] == tracks["id"].unique()[-1]
    kinds = {"conditioned": tracks[~last], "conditioned, itself counted too": tracks}
    models: dict[str, Any] = {"stands": "stands", "constant_velocity": "constant_velocity"}
    for name, learned in kinds.items():
        rows = bh.transitions(learned, 0.6)
        models[name] = bh.PreyModel.fit(rows, given="speed", residual_of="constant_velocity")
    found = bh.score_prey(tracks[last], models, time_step=0.6, split="time", most=max(MOST, len(tracks)))
    for name in ("ade", "fde", "ade_low", "ade_high", "fde_low", "fde_high"):
        found[name] *= 100
    return _errors("locust, 0.6 s", found, {"ade": 2.75}, "cm", scores=("ade",))


def people(folder: Path) -> Figures:
    """Each scene left out in turn; means over scenes."""
    found = bh.score_prey(scenes(folder), _PREY, split="scene", most=MOST)
    rows = _errors("people", found, {"ade": 0.525, "fde": 1.10}, "m")
    best = found.set_index("model").loc["conditioned"]
    n = int(best["n"])
    for score, target in (("best20_ade", 0.29), ("best20_fde", 0.49), ("energy", 0.395), ("nll", 0.10)):
        rows.append(line(f"people, conditioned, {score}", best[score], target, n=n))
    for share, within in ((50, 8.0), (90, 4.0)):
        apart = abs(100 * best[f"cover{share}"] - share)
        rows.append(line(f"people, conditioned, {share} % regions are off by", apart, within, n=n, unit="%"))
    return rows


def scenes(folder: Path) -> pd.DataFrame:
    """The tracks in a folder with their scenes; InputError without any."""
    files = sorted(folder.glob("*.txt"))
    named = {scene: [f for f in files for end in ends if f.stem.endswith(end)] for scene, ends in _SCENES.items()}
    if not all(named.values()):
        named = {file.stem: [file] for file in files}
    if len(named) < 2:
        raise InputError(f"{folder}: expected two or more .txt files of tracks, a scene each")
    parts = []
    for scene, paths in named.items():
        for path in paths:
            part = bh.read_tracks(path, 2.5, "m")
            parts.append(part.assign(scene=scene, id=[f"{path.stem}_{name}" for name in part["id"]]))
    return pd.concat(parts, ignore_index=True)


def _errors(
    what: str, found: pd.DataFrame, targets: dict[str, float], unit: str, scores: tuple[str, ...] = ("ade", "fde")
) -> Figures:
    """Mean and final errors of each model; the targets are those of ``conditioned``."""
    return [
        line(f"{what}, {row['model']}, {score}", row[score], targets.get(score) if row["model"] == "conditioned" else
             None, row[f"{score}_low"], row[f"{score}_high"], row["n"], unit)
        for row in found.to_dict("records") for score in scores
    ]  # fmt: skip


def first() -> Figures:
    """Seconds of a processor from a messy CSV to a model, in one command: those that it takes on a quiet machine."""
    import resource

    with tempfile.TemporaryDirectory() as folder:
        rng = np.random.default_rng(0)
        told = np.repeat(rng.choice([[0.1, 0.1], [0.2, 0.1], [0.1, 0.2], [-0.1, 0.1]], size=120), 40, axis=0)
        turn, ahead = (told[:, 1] - told[:, 0]) * 5, told.mean(axis=1)
        yaw = np.concatenate([[0.0], np.cumsum(turn[:-1] * 0.05)])
        place = np.cumsum(ahead * 0.05 * np.exp(1j * yaw)) * 1000
        log = pd.DataFrame({"t_ms": np.arange(len(told)) * 50, "x_mm": place.real, "y_mm": place.imag})
        log = log.assign(heading_deg=np.degrees(yaw) % 360, cmd_left=told[:, 0], cmd_right=told[:, 1])
        log.loc[77, "x_mm"] = np.nan
        pd.concat([log[:300], log[290:295], log[300:900], log[950:]]).to_csv(Path(folder) / "log.csv", index=False)
        words = ["fit", "log.csv", "--time-step", "1", "--gaits", "auto", "--prior", "0.03", "--out", "model.json"]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, "-m", "bayeshunt", *words], cwd=folder, check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        spent = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
        return [line("first fit from a messy CSV", spent, 5.0, n=len(log), unit="s of a processor")]


def memory(transitions: int) -> Figures:
    """How much the process grows while transitions are counted: tables hold what differs, not what was counted."""
    import resource

    rows = bh.transitions(tracks_file.load(_DATA / "guppies.parquet"), 0.2)
    rows = pd.concat([rows] * _BATCHES, ignore_index=True)
    model = bh.PreyModel.fit(rows, given="speed", residual_of="constant_velocity")
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    while model.observations < transitions:
        model.update(rows)
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
    return [line("memory grown while counting", grown, 100.0, n=model.observations, unit="MB")]


#: Name -> part that needs no recordings of one's own.
PARTS: dict[str, Callable[[], Figures]] = {
    "husky": husky, "bins": bins, "guppies": guppies, "locusts": locusts, "first": first
}  # fmt: skip


def measure(only: list[str], folder: Path | None = None, transitions: int = 0) -> dict[str, Any]:
    """The figures of the parts asked for; of people where a folder is named, of the memory where transitions are."""
    facts = {name: part() for name, part in PARTS.items() if name in only}
    if folder is not None:
        facts["people"] = people(folder)
    if transitions:
        facts["memory"] = memory(transitions)
    return facts


def report(facts: dict[str, Any]) -> str:
    """The figures as a Markdown table."""
    return "\n".join(_lines(facts))


def _lines(facts: dict[str, Any]) -> Iterator[str]:
    yield from ("| what | measured | 95 % interval | n | target | met |", "| --- | --- | --- | --- | --- | --- |")
    for row in (row for part in facts.values() for row in part):
        interval = "" if np.isnan(row["low"]) else f"{row['low']:.3g} to {row['high']:.3g}"
        target = "" if row["target"] is None else f"<= {row['target']:g}"
        met = "" if row["met"] is None else "yes" if row["met"] else "no"
        yield f"| {row['what']} | {row['value']:.4g} {row['unit']} | {interval} | {row['n']} | {target} | {met} |"


def main() -> None:
    """Run and print."""
    parser = command(__doc__)
    parser.add_argument("--only", nargs="*", choices=list(PARTS), default=list(PARTS))
    parser.add_argument("--people", type=Path, metavar="FOLDER", help="also score people recorded in its files")
    parser.add_argument("--transitions", type=int, default=0, help="also count so many: 10000000 take ten minutes")
    options = parser.parse_args()
    quiet_pgmpy()
    show(measure(options.only, options.people, options.transitions), report, options)


if __name__ == "__main__":
    main()
