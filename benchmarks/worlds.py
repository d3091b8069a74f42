"""Planners in worlds that they were not chosen in: one table, paired on the same hunts, each held against a bound.

``python -m benchmarks.worlds [WORLD ...] [--planner NAME ...] [--arena open|walled] [--runs 10] [--seed 0 ...]
[--cache FOLDER] [--keep NAME ...] [--figure FILE.svg] [--json FILE]``

WORLD: a name of the table below, or a preset with settings, such as ``paper,robot.gait_duration=1.664``; several
settings are several commas. By default all of the table. ``--runs`` is per bearing and seed. Every planner meets the
same prey and the same noise, so that differences are paired. A result is kept in the cache under what it depends
on, this package's code included: a second run only hunts what is missing, and more ``--runs`` only the further ones.
``--keep NAME`` takes results of that planner from earlier code, where you know that it has not changed.

Columns: caught, 95 % Wilson interval, mean time (a miss counts the time limit), difference of the mean time to the
bound's and to that of the best of the simpler planners, each with its standard error over paired hunts, and CPU time
of a decision.
"""

from __future__ import annotations

import argparse
import ast
import hashlib
import json
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import bayeshunt
from bayeshunt.config.loading import load_experiment, preset_names
from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.errors import did_you_mean
from bayeshunt.episodes.loop import run_hunt
from bayeshunt.experiments.protocol import hunt_seed
from bayeshunt.experiments.scores import wilson_interval
from benchmarks.hunters import BOTH, Row, prepared, table

PLANNERS = ("prediction", "planning", "intercept", "belief", "intercept_walls", "omniscient")
#: Those that a planner of ours has to be no worse than.
SIMPLER = ("reactive", "prediction", "planning", "constant_velocity")
BOUNDS = ("omniscient", "reference", "kinematic_limit")
#: What a hunt's course depends on.
_CODE = ("core", "config", "data", "models", "worlds", "perception", "planners", "episodes", "experiments")


@dataclass(frozen=True)
class World:
    """A preset and what is changed in it. arenas: where to hunt. bound: the planner that others are held against."""

    name: str
    preset: str = "paper"
    changes: dict[str, Any] = field(default_factory=dict)
    arenas: tuple[str, ...] = BOTH
    bound: str = "omniscient"

    @classmethod
    def read(cls, text: str) -> World:
        """Return the world of that name, or ``PRESET,KEY=VALUE,...``."""
        if text in WORLDS:
            return WORLDS[text]
        preset, *parts = text.split(",")
        if preset not in preset_names():
            raise SystemExit(f"unknown world {text!r}{did_you_mean(text, [*WORLDS, *preset_names()])}")
        changes = {}
        for key, _, value in (part.partition("=") for part in parts):
            try:
                changes[key] = tomllib.loads(f"v = {value}")["v"]
            except tomllib.TOMLDecodeError:  # a text without its quotes
                changes[key] = value
        return cls(text, preset, changes)

    @property
    def settings(self) -> ExperimentSettings:
        """The experiment, with one run per bearing."""
        return load_experiment(self.preset, {**self.changes, "protocol.runs": 1})


_ROOM = {"arenas.walled.width": 2.4, "arenas.walled.height": 2.4}
WORLDS = {
    world.name: world
    for world in (
        World("paper"),
        World("oses2010", "oses2010"),
        World("time-step 0.416 s", changes={"robot.gait_duration": 0.416}),
        World("evader", changes={"prey.behaviour": "evader"}, arenas=("walled",)),
        World("straight prey", changes={"prey.behaviour": "straight"}, arenas=("walled",)),
        World("random walk", changes={"prey.behaviour": "random_walk"}, arenas=("walled",)),
        World("prey far, large room", changes={"protocol.prey_distance": 10.0, **_ROOM}, arenas=("walled",)),
        World("slippery", "slippery", arenas=("open",), bound="reference"),
        World("prey as fast", changes={"prey.speed": 0.0576}),
    )
}


@cache
def code() -> str:
    """Return a digest of the package's code; comments and docstrings do not count."""
    digest = hashlib.sha256()
    root = Path(bayeshunt.__file__).parent
    for path in sorted(path for part in _CODE for path in (root / part).rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        for node in ast.walk(tree):
            body = getattr(node, "body", None)
            if isinstance(body, list):
                node.body = [line for line in body if not _is_text(line)]  # type: ignore[attr-defined]
        digest.update(f"{path.relative_to(root)}{ast.dump(tree)}".encode())
    return digest.hexdigest()[:16]


def _is_text(line: ast.stmt) -> bool:
    return isinstance(line, ast.Expr) and isinstance(line.value, ast.Constant) and isinstance(line.value.value, str)


@dataclass
class Cell:
    """A planner in an arena of a world, with one seed: the ends (time, caught) of its hunts by run, at all bearings."""

    ends: dict[int, list[tuple[float, bool]]]
    decision_ms: float = 0.0


def cell(world: World, row: Row, arena: str, seed: int, runs: int, folder: Path, keep: Sequence[str]) -> Cell:
    """Return a cell with at least ``runs`` runs per bearing: from the cache, and what is missing hunted now."""
    settings = world.settings
    what = json.dumps([settings.model_dump(mode="json"), row.planner, row.settings, arena, seed], sort_keys=True)
    stem = hashlib.sha256(what.encode()).hexdigest()[:24]
    path = folder / f"{stem}-{code()}.json"
    older = sorted(folder.glob(f"{stem}-*.json"), key=lambda one: one.stat().st_mtime)
    source = path if path.exists() else older[-1] if older and row.planner in keep else None
    found = Cell({})
    if source is not None:
        stored = json.loads(source.read_text())
        found = Cell({int(run): [tuple(end) for end in ends] for run, ends in stored["ends"].items()}, stored["ms"])
    missing = [run for run in range(runs) if run not in found.ends]
    if missing:
        given = table(row.planner, settings.model_dump_json())
        planner, timed = prepared(settings, row, given, arena, seed)
        for run in missing:
            found.ends[run] = [
                (end.time, bool(end.caught))
                for end in (
                    run_hunt(settings, planner, arena, theta, hunt_seed(seed, index, run))
                    for index, theta in enumerate(settings.protocol.thetas)
                )
            ]
        found.decision_ms = 1e3 * float(np.median(timed or [0.0]))
        folder.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps({"ends": found.ends, "ms": found.decision_ms}) + "\n")
    return found


@dataclass(frozen=True)
class Score:
    """What a planner did in an arena of a world, all seeds together; times [s] in the order of the hunts."""

    world: str
    arena: str
    row: Row
    times: np.ndarray
    caught: int
    decision_ms: float

    @property
    def mean(self) -> float:
        """Mean time [s]."""
        return float(self.times.mean())

    def against(self, other: Score) -> tuple[float, float]:
        """Return the difference of the mean times [s], and its standard error over paired hunts."""
        gap = self.times - other.times
        return float(gap.mean()), float(gap.std() / len(gap) ** 0.5)


def measure(world: World, rows: Sequence[Row], given: argparse.Namespace) -> Iterator[list[Score]]:
    """Yield the scores of all rows, arena by arena."""
    for arena in world.arenas:
        if given.arena in (None, arena):
            scores = []
            for row in rows:
                cells = [cell(world, row, arena, seed, given.runs, given.cache, given.keep) for seed in given.seed]
                ends = [end for one in cells for run in range(given.runs) for end in one.ends[run]]
                times, caught = np.array([time for time, _ in ends]), sum(catch for _, catch in ends)
                ms = float(np.mean([one.decision_ms for one in cells]))
                scores.append(Score(world.name, arena, row, times, caught, ms))
            yield scores


HEAD = (
    "| world | arena | planner | caught | success | 95 % interval | mean time [s] | to the bound [s] | "
    "to the best simpler [s] | decision CPU [ms] |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
)


def lines(scores: Sequence[Score], bound: str) -> Iterator[str]:
    """Yield a markdown row for each planner."""
    best = min((s for s in scores if s.row.planner in SIMPLER), key=lambda s: s.mean, default=None)
    limit = next((s for s in scores if s.row.planner == bound), None)
    for score in scores:
        low, high = wilson_interval(score.caught, len(score.times))
        gaps = [
            "" if other is None or other is score else "{:+.2f} ± {:.2f}".format(*score.against(other))
            for other in (limit, best if score.row.planner not in (*SIMPLER, *BOUNDS) else None)
        ]
        yield (
            f"| {score.world} | {score.arena} | {score.row.label} | {score.caught}/{len(score.times)} | "
            f"{score.caught / len(score.times):.1%} | {low:.1%} to {high:.1%} | {score.mean:.2f} | "
            f"{gaps[0]} | {gaps[1]} | {score.decision_ms:.2f} |"
        )


def draw(found: Sequence[Sequence[Score]], bounds: dict[str, str], path: Path) -> None:
    """Draw each planner's mean time above the bound's, world by world."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    names = [s.row.label for s in found[0] if s.row.planner not in BOUNDS]
    figure, axes = plt.subplots(figsize=(7.5, 0.6 * len(found) + 1.4), layout="constrained")
    colours = plt.get_cmap("viridis")(np.linspace(0.0, 0.85, len(names)))
    for place, scores in enumerate(found):
        limit = next((s for s in scores if s.row.planner == bounds[s.world]), None)
        if limit is None:
            continue
        axes.axhline(place, color="0.85", zorder=0)
        offsets = np.linspace(-0.28, 0.28, len(names)) if len(names) > 1 else [0.0]
        for name, colour, marker, off in zip(names, colours, "vsoDP^Xd*<>h" * len(names), offsets, strict=False):
            score = next((s for s in scores if s.row.label == name), None)
            if score is not None:
                gap, error = score.against(limit)
                axes.errorbar(
                    gap, place + off, xerr=1.96 * error, fmt=marker, color=colour, ms=5, capsize=2,
                    label=name if place == 0 else None,
                )  # fmt: skip
    axes.axvline(0.0, color="0.3", lw=1)
    axes.set_yticks(range(len(found)), [f"{s[0].world}, {s[0].arena}" for s in found])
    axes.invert_yaxis()
    axes.set_xscale("symlog", linthresh=2.0)
    axes.set_xticks(
        [-5, -2, -1, 0, 1, 2, 5, 10, 20, 40], labels=["-5", "-2", "-1", "0", "1", "2", "5", "10", "20", "40"]
    )
    axes.set_xlabel("mean time above the bound's, a miss counts the time limit [s]")
    figure.legend(loc="outside upper center", ncols=min(4, len(names)), frameon=False)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=150)
    plt.close(figure)


def main() -> None:
    """Hunt what is missing, print, draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("world", nargs="*", help="by default the table: " + "; ".join(WORLDS))
    parser.add_argument("--planner", action="append", help=f"by default {', '.join(PLANNERS)}")
    parser.add_argument("--arena", choices=BOTH)
    parser.add_argument("--runs", type=int, default=10, help="per bearing and seed (10)")
    parser.add_argument("--seed", type=int, action="append", help="by default 0")
    parser.add_argument("--cache", type=Path, default=Path("results/worlds"), help="folder of results (results/worlds)")
    parser.add_argument("--keep", action="append", default=[], metavar="PLANNER")
    parser.add_argument("--figure", type=Path)
    parser.add_argument("--json", type=Path)
    given = parser.parse_args()
    given.seed = given.seed or [0]
    worlds = [World.read(text) for text in given.world or WORLDS]
    found: list[list[Score]] = []
    print(HEAD)
    for world in worlds:
        names = dict.fromkeys(
            [*(given.planner or PLANNERS), *([world.bound] if given.figure or not given.planner else ())]
        )
        for scores in measure(world, [Row(name) for name in names], given):
            found.append(scores)
            print("\n".join(lines(scores, world.bound)), flush=True)
    if given.figure:
        draw(found, {world.name: world.bound for world in worlds}, given.figure)
    if given.json:
        facts = [
            {"world": s.world, "arena": s.arena, "planner": s.row.label, "runs": len(s.times), "caught": s.caught,
             "mean_time_s": s.mean, "decision_ms": s.decision_ms} for scores in found for s in scores
        ]  # fmt: skip
        given.json.write_text(json.dumps({"seeds": given.seed, "rows": facts}, indent=1) + "\n")


if __name__ == "__main__":
    main()
