"""Would numba pay? ``python -m benchmarks.compiled [--json] [--seed 0] [--runs 5]`` (extra ``bench``).

The package has no compiled code of its own. This measures what it would gain, in processor seconds,
on the parts where a loop of plain arithmetic costs most, each rewritten for numba here:

* sensors: rays of the prey's eight proximity sensors, in the physics loop;
* values: the value of every gait sequence of the planner "planning";
* captures: chances of capture in the lookahead of the planner "intercept" (not in the paper's rows);
* counting: bins and cells of a million rows, in a fit.

What importing and compiling cost is measured in fresh processes, as every worker pays it; with numba's
cache on disk a process after the first only loads. Then whole evaluations of the paper's five rows are
run in turns, as they are and with sensors and values compiled. Results must be the same.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from functools import partial
from typing import Any
from unittest import mock

import numpy as np
import pandas as pd

from bayeshunt.config.loading import load_experiment
from bayeshunt.experiments.protocol import learn_model
from bayeshunt.experiments.run.runner import evaluate
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.counting.cells import count_numbers, number_cells
from bayeshunt.planners.interception import lookahead
from bayeshunt.planners.registry import make_planner
from bayeshunt.planners.search import rollouts
from bayeshunt.worlds.prey import behaviours
from bayeshunt.worlds.prey import proximity as sensors
from benchmarks.command import command, show
from benchmarks.evaluation import ROWS
from benchmarks.kernels import Kernels, compile_kernels
from benchmarks.planning import make_situations

FULL_RUNS, COUNTED_ROWS = 100, 1_000_000


def warm_up(kernels: Kernels, work: Workload) -> None:
    """Call every kernel once with the kinds of arguments that it will get: numba compiles then."""
    for plain, compiled in work.pairs(kernels).values():
        np.testing.assert_allclose(np.hstack(compiled()), np.hstack(plain()), rtol=1e-9, atol=1e-9)


class Workload:
    """Arguments for each part, taken from the preset's hunts."""

    def __init__(self, seed: int, rows: int) -> None:
        self.settings = load_experiment("paper")
        self.model = learn_model(self.settings, seed)
        rng = np.random.default_rng(seed)
        arena = self.settings.arenas["walled"]
        self.walls = (0.5 * arena.width, 0.5 * arena.height)
        # Near a wall, where the sensors have something to work out.
        self.poses = [(self.walls[0] - 0.05, y, t) for y, t in rng.uniform(-0.4, 3.0, (200, 2)).tolist()]
        self.reach = self.settings.prey.sensor_range
        self.hunter, self.path = planning_arguments(self.model, rng)
        self.capture = capture_arguments(self.model, rng)
        self.axes = self.model.axes
        self.codes = rng.integers(len(self.model.gaits), size=rows)
        spans = ((0.0, self.axes.distance.edges[-1] - 1e-9), (-3.14, 3.14), (-3.14, 3.14))
        self.values = [rng.uniform(low, high, rows) for low, high in spans]

    def pairs(self, kernels: Kernels) -> dict[str, tuple[Callable[[], Any], Callable[[], Any]]]:
        """Each part as it is and compiled, as calls without arguments."""
        return {
            "sensors": (lambda: self.sense(sensors.proximity), lambda: self.sense(kernels.sensors)),
            "values": (
                lambda: rollouts.mean_distance(self.hunter, self.path),
                lambda: kernels.values(self.hunter, self.path),
            ),
            "captures": (
                lambda: PLAIN_CHANCE(*self.capture).ravel(),
                lambda: kernels.captures(*self.capture).ravel(),
            ),
            "counting": (lambda: self.count(), lambda: self.counted(kernels)),
        }

    def sense(self, proximity: Callable[..., Any]) -> list[Any]:
        """200 poses."""
        return [proximity(*pose, self.reach, self.walls, None) for pose in self.poses]

    def count(self) -> np.ndarray:
        """The package's way, in one piece and one thread."""
        columns = [self.codes, *(axis.index(v) for axis, v in zip(self.axes, self.values, strict=True))]
        shape = (len(self.model.gaits), *self.axes.shape)
        return count_numbers(number_cells(columns, shape), shape)[1]

    def counted(self, kernels: Kernels) -> np.ndarray:
        """The same, compiled."""
        return kernels.counting(self.codes, self.values, self.axes, len(self.model.gaits))[1]


PLAIN_CHANCE = lookahead.chance_within


def planning_arguments(model: ForwardModel, rng: np.random.Generator) -> tuple[Any, Any]:
    """What "planning" values in one decision: the samples of all its sequences, and the predicted prey."""
    seen: list[Any] = []

    def note(hunter: Any, path: Any) -> np.ndarray:
        seen.append((hunter, path))
        return rollouts.mean_distance(hunter, path)

    make_planner("planning", model, objective=note).plan(make_situations(model, 1, rng=rng)[0], rng=rng)
    return max(seen, key=lambda pair: len(pair[0].steps))


def capture_arguments(model: ForwardModel, rng: np.random.Generator) -> tuple[Any, ...]:
    """What "intercept" works out in one decision: all pairs of gaits against all futures."""
    seen: list[Any] = []

    def note(*arguments: Any) -> np.ndarray:
        seen.append(arguments)
        return PLAIN_CHANCE(*arguments)

    with mock.patch.object(lookahead, "chance_within", note):
        make_planner("intercept", model).plan(make_situations(model, 1, rng=rng)[0], rng=rng)
    return max(seen, key=lambda arguments: arguments[0].size)


def least(work: Callable[[], Any], repeats: int = 7) -> float:
    """Least processor seconds of ``repeats`` calls: other programs on the machine disturb it least."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)


def time_parts(work: Workload, kernels: Kernels) -> list[dict[str, Any]]:
    """One row per part: microseconds of one call as it is and compiled."""
    rows = []
    for name, (plain, compiled) in work.pairs(kernels).items():
        calls = 1 if name == "counting" else 50
        one, two = (1e6 * least(partial(repeat, f, calls)) / calls for f in (plain, compiled))
        each = len(work.poses) if name == "sensors" else 1
        rows.append({"part": name, "plain_us": one / each, "compiled_us": two / each, "times_faster": one / two})
    return rows


def repeat(work: Callable[[], Any], times: int) -> None:
    """Call ``times`` times."""
    for _ in range(times):
        work()


def costs() -> dict[str, float]:
    """Processor seconds of importing numba and of compiling or loading the kernels, in this process."""
    work = Workload(0, 1000)
    start = time.process_time()
    import numba  # noqa: F401

    imported = time.process_time()
    warm_up(compile_kernels(cache="NUMBA_CACHE_DIR" in os.environ), work)
    return {"import_s": imported - start, "compile_s": time.process_time() - imported}


def fresh_costs() -> dict[str, float]:
    """What a worker pays: a fresh process without a cache, and one that finds the kernels in it."""
    command = [sys.executable, "-m", "benchmarks.compiled", "--costs"]

    def run(**environment: str) -> dict[str, float]:
        done = subprocess.run(command, capture_output=True, text=True, check=True, env={**os.environ, **environment})
        return json.loads(done.stdout)

    with tempfile.TemporaryDirectory() as folder:
        plain, _, cached = run(), run(NUMBA_CACHE_DIR=folder), run(NUMBA_CACHE_DIR=folder)
    return {"import_s": min(plain["import_s"], cached["import_s"]), "compile_s": plain["compile_s"],
            "load_s": cached["compile_s"]}  # fmt: skip


@contextmanager
def compiled_hunts(kernels: Kernels) -> Iterator[None]:
    """Hunts use the compiled sensors and values."""
    space = rollouts.CompiledRollouts.space

    def with_values(self: Any, block: int, path: Any, objective: Any, spent: Any = None) -> Any:
        return space(self, block, path, kernels.values, spent)

    with (
        mock.patch.object(behaviours, "proximity", kernels.sensors),
        mock.patch.object(rollouts.CompiledRollouts, "space", with_values),
    ):
        yield


def evaluate_rows(work: Workload, runs: int, seed: int) -> pd.DataFrame:
    """The paper's five rows in this process."""
    found = []
    for arena in ("walled", "open"):
        planners = [planner for planner, where in ROWS if where == arena]
        found.append(evaluate(work.settings, runs=runs, seed=seed, planners=planners, arenas=[arena], model=work.model))
    return pd.concat(found, ignore_index=True)[["planner", "arena", "theta", "caught", "time"]]


def time_evaluations(work: Workload, kernels: Kernels, runs: int, seed: int, rounds: int) -> dict[str, Any]:
    """Least processor seconds of the rows as they are and compiled, in turns; RuntimeError if results differ."""
    times: dict[str, list[float]] = {"plain": [], "compiled": []}
    tables = {}
    for _ in range(rounds):
        for name, taken in times.items():
            start = time.process_time()
            with compiled_hunts(kernels) if name == "compiled" else nullcontext():
                tables[name] = evaluate_rows(work, runs, seed)
            taken.append(time.process_time() - start)
    if not tables["plain"].equals(tables["compiled"]):
        raise RuntimeError("compiled and plain hunts differ: their times cannot be compared")
    hunts = len(tables["plain"])
    one, two = (1e3 * min(taken) / hunts for taken in times.values())
    return {"hunts": hunts, "plain_ms_per_hunt": one, "compiled_ms_per_hunt": two, "saved_share": 1.0 - two / one}


def measure(runs: int, seed: int, rounds: int) -> dict[str, Any]:
    """Everything, and what it comes to for a whole evaluation."""
    cost = fresh_costs()
    work, kernels = Workload(seed, COUNTED_ROWS), compile_kernels()
    warm_up(kernels, work)
    parts, hunts = time_parts(work, kernels), time_evaluations(work, kernels, runs, seed, rounds)
    saved = 1e-3 * (hunts["plain_ms_per_hunt"] - hunts["compiled_ms_per_hunt"])
    whole = len(ROWS) * len(work.settings.protocol.thetas) * FULL_RUNS
    first, later = cost["import_s"] + cost["compile_s"], cost["import_s"] + cost["load_s"]
    return {
        "cost": cost, "parts": parts, "evaluation": hunts, "whole_hunts": whole,
        "whole_s": 1e-3 * hunts["plain_ms_per_hunt"] * whole, "saved_s": saved * whole,
        "hunts_to_pay_compiling": first / saved if saved > 0 else None,
        "hunts_to_pay_loading": later / saved if saved > 0 else None, "seed": seed,
    }  # fmt: skip


def report(facts: dict[str, Any]) -> str:
    """The figures as text."""
    cost, hunts = facts["cost"], facts["evaluation"]
    lines = [
        "numba, processor time",
        f"  each process: import {cost['import_s']:.2f} s, compile {cost['compile_s']:.2f} s "
        f"(from its cache on disk {cost['load_s']:.2f} s)",
        f"  {'part, one call':<16}{'as it is us':>12}{'compiled us':>12}{'times':>7}",
    ]
    lines += [
        f"  {row['part']:<16}{row['plain_us']:>12.2f}{row['compiled_us']:>12.2f}{row['times_faster']:>7.1f}"
        for row in facts["parts"]
    ]
    lines += [
        f"  hunts of the paper's rows ({hunts['hunts']}): {hunts['plain_ms_per_hunt']:.2f} ms each, compiled "
        f"{hunts['compiled_ms_per_hunt']:.2f} ms: {hunts['saved_share']:.1%} saved",
        f"  whole evaluation ({facts['whole_hunts']:,} hunts): {facts['whole_s']:.1f} s, of which compiling would save "
        f"{facts['saved_s']:.1f} s in all and cost {cost['import_s'] + cost['compile_s']:.1f} s in each worker",
    ]
    return "\n".join(lines)


def main() -> None:
    """Run and print."""
    parser = command(__doc__)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--runs", type=int, default=5, help="per bearing, of the hunts timed")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--costs", action="store_true", help="only import and compile, once, in this process")
    options = parser.parse_args()
    if options.costs:
        print(json.dumps(costs()))
        return
    facts = measure(options.runs, options.seed, options.rounds)
    show(facts, report, options)


if __name__ == "__main__":
    main()
