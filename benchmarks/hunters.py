"""Success and catch time of planners, and of planners with one thing changed.

``python -m benchmarks.hunters [--runs 100] [--seed 0 --seed 1 --seed 2] [--rows final|ablation|held-out]
[--planner NAME ...] [--set KEY=VALUE ...] [--json FILE]``

Every row runs the preset "paper" in both arenas with all its seeds; each seed babbles its own forward
model (and room). Prints one markdown row per arena: runs, caught, 95 % Wilson interval, mean time (a
miss counts 60 s), CPU time of a decision. ``--set`` changes
a setting of the experiment, e.g. prey.senses_hunter=true or robot="car". ``--json FILE`` keeps the numbers.
"""

from __future__ import annotations

import argparse
import json
import time
import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from bayeshunt.config import ExperimentSettings
from bayeshunt.experiments.explorations import learn_room
from bayeshunt.experiments.protocol import hunt_seed, learn_model
from bayeshunt.experiments.scores import wilson_interval
from bayeshunt.hunting import run_hunt
from bayeshunt.planners.registry import make_planner
from bayeshunt.settings import load_experiment


@dataclass(frozen=True)
class Row:
    """A planner with settings; arenas: where it runs."""

    planner: str
    settings: dict[str, Any] = field(default_factory=dict)
    arenas: tuple[str, ...] = ("open", "walled")

    @property
    def label(self) -> str:
        """The planner and what was changed."""
        return ", ".join([self.planner, *(f"{key} = {value}" for key, value in self.settings.items())])


FINAL = (
    Row("planning"),
    Row("intercept"),
    Row("intercept", {"prior": False}),
    Row("intercept_room"),
    Row("intercept_walls", arenas=("walled",)),
    Row("belief"),
)
ABLATION = (
    Row("intercept"),
    Row("intercept", {"prior": False}),
    Row("intercept", {"hazard": 0.0}),
    Row("intercept", {"hazard": 0.05}),
    Row("intercept", {"hazard": 0.2}),
    Row("intercept", {"heading_price": 0.0}),
    Row("intercept", {"heading_price": 0.7}),
    Row("intercept", {"turn_steps": 2}),
    Row("intercept", {"spread": 0.02}),
    Row("intercept_room", {"room_chance": 0.0}),
    Row("intercept_room", {"room_chance": 0.2}),
    Row("intercept_room"),
    Row("intercept_room", {"room_chance": 0.6}),
    Row("intercept_walls", arenas=("walled",)),
    Row("intercept_walls", {"rebound": 0.0}, arenas=("walled",)),
    Row("intercept_walls", {"clearance": 0.0}, arenas=("walled",)),
)
HELD_OUT = tuple(row for row in FINAL if not row.settings)
SETS = {"final": FINAL, "ablation": ABLATION, "held-out": HELD_OUT}


class Timed:
    """A planner whose decisions are timed, in CPU seconds of its thread: other programs do not count."""

    def __init__(self, planner: Any) -> None:
        self.planner, self.name, self.seconds = planner, planner.name, []

    def plan(self, situation: Any, *, rng: np.random.Generator) -> Any:
        """Decide and note how long it took."""
        start = time.thread_time()
        found = self.planner.plan(situation, rng=rng)
        self.seconds.append(time.thread_time() - start)
        return found


def measure(
    settings: ExperimentSettings, row: Row, arena: str, seeds: list[int], runs: int, minds: dict[int, Any]
) -> dict[str, Any]:
    """Hunt with one row in one arena."""
    times, caught, decisions = [], 0, []
    for seed in seeds:
        model, room = minds[seed]
        given = {"room": room, **row.settings} if row.planner == "intercept_walls" else row.settings
        preset = settings.planner.get(row.planner, {})
        planner = Timed(make_planner(row.planner, model, **{**preset, **given}))
        for index, theta in enumerate(settings.protocol.thetas):
            for run in range(runs):
                result = run_hunt(settings, planner, arena, theta, hunt_seed(seed, index, run))
                times.append(result.time)
                caught += result.caught
        decisions += planner.seconds
    low, high = wilson_interval(caught, len(times))
    return {
        "row": row.label,
        "arena": arena,
        "runs": len(times),
        "caught": caught,
        "success": caught / len(times),
        "ci_low": low,
        "ci_high": high,
        "mean_time_s": float(np.mean(times)),
        "standard_error_s": float(np.std(times) / len(times) ** 0.5),
        "decision_ms": [float(1e3 * np.quantile(decisions, q)) for q in (0.5, 0.99)],
    }


def line(facts: dict[str, Any]) -> str:
    """Return one markdown row."""
    median, slow = facts["decision_ms"]
    return (
        f"| {facts['row']} | {facts['arena']} | {facts['caught']}/{facts['runs']} | {facts['success']:.2%} | "
        f"{facts['ci_low']:.2%} to {facts['ci_high']:.2%} | "
        f"{facts['mean_time_s']:.2f} ± {facts['standard_error_s']:.2f} | {median:.2f} / {slow:.2f} |"
    )


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--seed", type=int, action="append")
    parser.add_argument("--rows", choices=sorted(SETS), default="final")
    parser.add_argument("--planner", action="append", help="only rows of this planner")
    parser.add_argument("--set", action="append", help="KEY=VALUE, a setting of the experiment")
    parser.add_argument("--json", type=Path)
    given = parser.parse_args()
    seeds = given.seed or [0, 1, 2]
    changes = (text.partition("=") for text in given.set or ())
    settings = load_experiment("paper", {key: tomllib.loads(f"v = {value}")["v"] for key, _, value in changes})
    minds = {}
    for seed in seeds:
        model = learn_model(settings, seed)
        minds[seed] = (model, learn_room(settings, arena="walled", seed=seed, model=model))
    print("| planner | arena | caught | success | 95 % interval | mean time [s] | decision CPU ms, median / p99 |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    found = []
    for row in SETS[given.rows]:
        if given.planner and row.planner not in given.planner:
            continue
        for arena in row.arenas:
            found.append(measure(settings, row, arena, seeds, given.runs, minds))
            print(line(found[-1]), flush=True)
    if given.json:
        given.json.write_text(json.dumps({"seeds": seeds, "rows": found}, indent=1) + "\n")


if __name__ == "__main__":
    main()
