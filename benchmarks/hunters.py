"""Success and catch time of planners, and of planners with one thing changed.

``python -m benchmarks.hunters [--runs 100] [--seed 0 --seed 1 --seed 2] [--rows final|ablation|gap|held-out]
[--planner NAME ...] [--set KEY=VALUE ...] [--jobs 1] [--json FILE]``

Every row runs the preset "paper" with all its seeds; each seed babbles its own forward model, and its own
rooms for planners that explore. The table of ``reference`` is made with seed 0, the memories in training
hunts. Prints one markdown row per arena: caught, 95 % Wilson interval, mean time (a miss counts 60 s), CPU
time of a decision; * marks planners that are given more than they learn within the run. ``--set`` changes a
setting of the experiment, e.g. prey.senses_hunter=true or robot="car". ``--json FILE`` keeps the numbers.
"""

from __future__ import annotations

import argparse
import json
import tomllib
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed

from bayeshunt.config.loading import load_experiment
from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.episodes.loop import run_hunt
from bayeshunt.experiments.preparation import learn_rooms, prepare_planner
from bayeshunt.experiments.protocol import hunt_seed, learn_model
from bayeshunt.experiments.scores import wilson_interval
from bayeshunt.experiments.studies.memories import remember
from bayeshunt.experiments.studies.references import reference
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.api import Planner
from bayeshunt.planners.asking import Timed
from bayeshunt.planners.registry import is_ab_initio
from benchmarks.interventions import FORESEEN, register

BOTH = ("open", "walled")


@dataclass(frozen=True)
class Row:
    """A planner with settings; arenas: where it runs; world: settings of the experiment that are changed."""

    planner: str
    settings: dict[str, Any] = field(default_factory=dict)
    arenas: tuple[str, ...] = BOTH
    world: dict[str, Any] = field(default_factory=dict)

    @property
    def label(self) -> str:
        """The planner and what was changed."""
        changed = {**self.settings, **self.world}
        return ", ".join([self.planner, *(f"{key} = {value}" for key, value in changed.items())])


_BASELINES = ("pure_pursuit", "proportional_navigation", "constant_velocity")
_OURS = ("intercept", "belief", "intercept_walls")
_MEMORIES = ("frugal", "memory", "memory_place", "memory_previous")
_BOUNDS = ("reference", "omniscient", "kinematic_limit")
FINAL = (
    Row("planning"),
    *map(Row, _BASELINES),
    Row("intercept", {"prior": False}),
    *map(Row, (*_OURS, *_MEMORIES, *_BOUNDS)),
)
_WALLED = ("walled",)
ABLATION = (
    Row("intercept"),
    Row("intercept", {"prior": False}),
    Row("intercept", {"prior_speed": 1.0}),
    Row("intercept", {"hazard": 0.0}),
    Row("intercept", {"hazard": 0.05}),
    Row("intercept", {"hazard": 0.2}),
    Row("intercept", {"heading_price": 0.0}),
    Row("intercept", {"heading_price": 0.7}),
    Row("intercept", {"turn_steps": 2}),
    Row("intercept", {"spread": 0.02}),
    Row("intercept", {"spread": 0.2}),
    Row("intercept", {"room_chance": 0.0}),
    Row("intercept", {"room_chance": 0.2}),
    Row("intercept", {"room_chance": 0.4}),
    Row("intercept", {"room_chance": 0.6}),
    Row("intercept_walls"),
    Row("intercept_walls", {"prior_speed": 1.0}),
    Row("intercept_walls", {"heading_price": 0.7}),
    Row("intercept_walls", {"rebound": 0.0}, _WALLED),
    Row("intercept_walls", {"rebound": 0.4}, _WALLED),
    Row("intercept_walls", {"clearance": 0.0}, _WALLED),
    Row("intercept_walls", {"clearance": 0.8}, _WALLED),
)
_QUIET_PREY = {"prey.noise.slip": 0.0, "prey.noise.drift_sd": 0.0}
_QUIET = {**_QUIET_PREY, "robot.noise.slip": 0.0, "robot.noise.drift_sd": 0.0}
#: From what a hunt can teach to what nobody can know, one step at a time.
GAP = (
    Row("intercept"),
    Row("intercept_walls"),
    Row("intercept_walls", {"prior_speed": 1 / 1.2}),
    Row(FORESEEN),
    Row("omniscient"),
    Row("reference", arenas=("open",)),
    Row("intercept_walls", world=_QUIET_PREY),
    Row("omniscient", world=_QUIET_PREY),
    Row("intercept_walls", world=_QUIET),
    Row("omniscient", world=_QUIET),
)
HELD_OUT = tuple(map(Row, ("planning", *_OURS)))
SETS = {"final": FINAL, "ablation": ABLATION, "gap": GAP, "held-out": HELD_OUT}


@cache
def table(planner: str, experiment: str) -> dict[str, Any]:
    """The settings of a planner that needs a table made beforehand; made once per process and experiment."""
    settings = ExperimentSettings.model_validate_json(experiment)
    if planner == "reference":
        return {"table": reference(settings, seed=0)}
    return {"tables": remember(settings, seed=1000)} if planner.startswith("memory") else {}


@cache
def own_model(experiment: str, seed: int) -> ForwardModel:
    """The forward model of an experiment and a seed; babbled once per process."""
    return learn_model(ExperimentSettings.model_validate_json(experiment), seed)


def prepared(
    settings: ExperimentSettings, row: Row, given: dict[str, Any], arena: str, seed: int
) -> tuple[Planner, list[float]]:
    """Return a row's planner, ready to hunt in an arena, and the list that the CPU seconds of its decisions go into."""
    register()
    model = own_model(settings.model_dump_json(), seed)
    mine = {**settings.planner.get(row.planner, {}), **given, **row.settings}
    settings = settings.model_copy(update={"planner": {row.planner: mine}})
    rooms = learn_rooms(settings, [row.planner], [arena], seed, model)
    planner = prepare_planner(row.planner, model, settings, rooms, arena)
    if row.planner == "kinematic_limit":
        return planner, []
    timed = Timed(planner)
    return timed, timed.seconds


def hunts(settings: ExperimentSettings, row: Row, given: dict[str, Any], arena: str, seed: int) -> tuple[list, list]:
    """Hunt with one row in one arena, with one seed: (time, caught) of every hunt, CPU seconds of every decision."""
    planner, seconds = prepared(settings, row, given, arena, seed)
    ends = []
    for index, theta in enumerate(settings.protocol.thetas):
        for run in range(settings.protocol.runs):
            result = run_hunt(settings, planner, arena, theta, hunt_seed(seed, index, run))
            ends.append((result.time, result.caught))
    return ends, seconds


def measure(experiment: dict[str, Any], row: Row, arena: str, seeds: list[int], pool: Parallel) -> dict[str, Any]:
    """Hunt with one row in one arena, with every seed."""
    settings = load_experiment("paper", {**experiment, **row.world})
    given = table(row.planner, settings.model_dump_json())
    parts = pool(delayed(hunts)(settings, row, given, arena, seed) for seed in seeds)
    ends = [end for part, _ in parts for end in part]
    decisions = [seconds for _, part in parts for seconds in part] or [0.0]
    times, caught = [time for time, _ in ends], sum(caught for _, caught in ends)
    low, high = wilson_interval(caught, len(times))
    return {
        "row": row.label,
        "ab_initio": is_ab_initio(row.planner),
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
    name = facts["row"] + ("" if facts["ab_initio"] else " *")
    return (
        f"| {name} | {facts['arena']} | {facts['caught']}/{facts['runs']} | {facts['success']:.2%} | "
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
    parser.add_argument("--jobs", type=int, default=1, help="worker processes")
    parser.add_argument("--json", type=Path)
    given = parser.parse_args()
    seeds = given.seed or [0, 1, 2]
    changes = (text.partition("=") for text in given.set or ())
    experiment = {"protocol.runs": given.runs, **{k: tomllib.loads(f"v = {value}")["v"] for k, _, value in changes}}
    register()
    print("| planner | arena | caught | success | 95 % interval | mean time [s] | decision CPU ms, median / p99 |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    found = []
    with Parallel(n_jobs=given.jobs) as pool:
        for row in SETS[given.rows]:
            if given.planner and row.planner not in given.planner:
                continue
            for arena in row.arenas:
                found.append(measure(experiment, row, arena, seeds, pool))
                print(line(found[-1]), flush=True)
    if given.json:
        given.json.write_text(json.dumps({"seeds": seeds, "rows": found}, indent=1) + "\n")


if __name__ == "__main__":
    main()
