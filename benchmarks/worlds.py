"""Planners in worlds that they were not chosen in: one table, paired on the same hunts, each held against a bound.

``python -m benchmarks.worlds [WORLD ...] [--planner NAME ...] [--arena open|walled] [--runs 10] [--seed 0 ...]
[--cache FOLDER] [--show] [--figure FILE.svg] [--json FILE]``

WORLD: a name of the table below, or a preset with settings, such as ``paper,robot.gait_duration=1.664``; several
settings are several commas. By default all of the table. Beside the behaviours that ship a prey may zigzag, be circling
or stop_and_go (:mod:`benchmarks.strange_prey`). ``--runs`` is per bearing and seed. Every planner meets the
same prey and the same noise, so that differences are paired.

Hunts are kept in the cache, run by run: the command can be stopped and goes on where it was, and more ``--runs`` only
hunt the further ones. Each result says the code that made it. One of earlier code comes first: its run 0 is hunted
again, and if a single hunt ends in another way all of its hunts are thrown away. ``--show`` hunts nothing and prints
what there is, with a + at planners whose hunts are of earlier code.

Columns: caught, 95 % Wilson interval, mean time (a miss counts the time limit), difference of the mean time to the
bound's and to that of the best of the simpler planners, each with its standard error over paired hunts, and CPU time
of a decision.
"""

from __future__ import annotations

import argparse
import ast
import hashlib
import json
import sys
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
from benchmarks import strange_prey
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
    """A planner in an arena of a world, with one seed: the ends (time, caught) of its hunts by run, at all bearings.

    made_by: digest of the code that hunted them.
    """

    world: World
    row: Row
    arena: str
    seed: int
    path: Path
    ends: dict[int, list[tuple[float, bool]]] = field(default_factory=dict)
    decision_ms: float = 0.0
    made_by: str = ""

    @classmethod
    def of(cls, world: World, row: Row, arena: str, seed: int, folder: Path) -> Cell:
        """Return what has been hunted of it."""
        facts = [world.settings.model_dump(mode="json"), row.planner, row.settings, arena, seed]
        stem = hashlib.sha256(json.dumps(facts, sort_keys=True).encode()).hexdigest()[:24]
        found = cls(world, row, arena, seed, folder / f"{stem}.json")
        if found.path.exists():
            stored = json.loads(found.path.read_text())
            found.ends = {int(run): [tuple(end) for end in ends] for run, ends in stored["ends"].items()}
            found.decision_ms, found.made_by = stored["ms"], stored["code"]
        return found

    @property
    def is_old(self) -> bool:
        """Whether other code than the present one hunted it."""
        return bool(self.ends) and self.made_by != code()

    def hunt(self, runs: int) -> None:
        """Hunt what is missing of ``runs`` runs, and again what earlier code did that the present one does not."""
        missing = [run for run in range(runs) if run not in self.ends]
        if not (missing or self.is_old):
            return
        settings = self.world.settings
        planner, timed = prepared(
            settings, self.row, table(self.row.planner, settings.model_dump_json()), self.arena, self.seed
        )

        def ends(run: int) -> list[tuple[float, bool]]:
            thetas = enumerate(settings.protocol.thetas)
            hunts = (run_hunt(settings, planner, self.arena, at, hunt_seed(self.seed, i, run)) for i, at in thetas)
            return [(hunt.time, bool(hunt.caught)) for hunt in hunts]

        if self.is_old and (again := ends(0)) != self.ends[0]:
            self.ends = {0: again}
            missing = list(range(1, runs))
        self.made_by = code()
        for run in missing:
            self.ends[run] = ends(run)
            self.decision_ms = 1e3 * float(np.median(timed or [0.0]))
            self.keep()
        self.keep()

    def keep(self) -> None:
        """Write it."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        facts = {"world": self.world.name, "arena": self.arena, "planner": self.row.label, "seed": self.seed,
                 "code": self.made_by, "ms": self.decision_ms, "ends": self.ends}  # fmt: skip
        self.path.write_text(json.dumps(facts) + "\n")


@dataclass(frozen=True)
class Score:
    """What a planner did in an arena of a world, all seeds together; times [s] in the order of the hunts.

    is_old: whether some of them were hunted by earlier code.
    """

    world: str
    arena: str
    row: Row
    times: np.ndarray
    caught: int
    decision_ms: float
    is_old: bool = False

    @property
    def mean(self) -> float:
        """Mean time [s]."""
        return float(self.times.mean())

    def against(self, other: Score) -> tuple[float, float]:
        """Return the difference of the mean times [s], and its standard error over paired hunts."""
        gap = self.times - other.times
        return float(gap.mean()), float(gap.std() / len(gap) ** 0.5)


def scores(cells: Sequence[Cell], runs: int) -> Iterator[list[Score]]:
    """Yield the scores of all planners, place by place, over the runs that all of them have there."""
    places: dict[tuple[str, str], dict[str, list[Cell]]] = {}
    for one in cells:
        places.setdefault((one.world.name, one.arena), {}).setdefault(one.row.label, []).append(one)
    for (world, arena), rows in places.items():
        common = range(min(runs, *(len(one.ends) for row in rows.values() for one in row)))
        found = []
        for row in rows.values() if common else ():
            ends = [end for one in row for run in common for end in one.ends[run]]
            times, caught = np.array([time for time, _ in ends]), sum(catch for _, catch in ends)
            ms = float(np.mean([one.decision_ms for one in row]))
            old = any(one.is_old for one in row)
            found.append(Score(world, arena, row[0].row, times, caught, ms, old))
        yield found


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
        name = score.row.label + "+" * score.is_old
        yield (
            f"| {score.world} | {score.arena} | {name} | {score.caught}/{len(score.times)} | "
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
    parser.add_argument("--show", action="store_true", help="hunt nothing, print what there is")
    parser.add_argument("--figure", type=Path)
    parser.add_argument("--json", type=Path)
    given = parser.parse_args()
    given.seed = given.seed or [0]
    strange_prey.register()
    worlds = [World.read(text) for text in given.world or WORLDS]
    names = {
        world.name: dict.fromkeys([*(given.planner or PLANNERS), *(() if given.planner else (world.bound,))])
        for world in worlds
    }
    cells = [
        Cell.of(world, Row(name), arena, seed, given.cache)
        for world in worlds for arena in world.arenas if given.arena in (None, arena)
        for name in names[world.name] for seed in given.seed
    ]  # fmt: skip
    if not given.show:
        for number, one in enumerate(sorted(cells, key=lambda one: not one.is_old), 1):
            print(
                f"\r{number}/{len(cells)} {one.world.name}, {one.arena}: {one.row.label}\033[K", end="", file=sys.stderr
            )
            one.hunt(given.runs)
        print(file=sys.stderr)
    found = [row for row in scores(cells, given.runs) if row]
    bounds = {world.name: world.bound for world in worlds}
    print("\n".join([HEAD, *(line for row in found for line in lines(row, bounds[row[0].world]))]))
    if given.figure:
        draw(found, bounds, given.figure)
    if given.json:
        facts = [
            {"world": s.world, "arena": s.arena, "planner": s.row.label, "runs": len(s.times), "caught": s.caught,
             "mean_time_s": s.mean, "decision_ms": s.decision_ms, "earlier_code": s.is_old}
            for row in found for s in row
        ]  # fmt: skip
        given.json.write_text(json.dumps({"seeds": given.seed, "rows": facts}, indent=1) + "\n")


if __name__ == "__main__":
    main()
