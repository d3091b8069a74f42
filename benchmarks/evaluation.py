"""What a whole evaluation costs: ``python -m benchmarks.evaluation [--json] [--seed 0] [--runs 100]``.

The five rows that the paper reports (reactive and prediction in walls, prediction and planning in the
open, and planning in walls), babbling and fitting included, with one worker and with two, in turns.
"""

from __future__ import annotations

import os
import time
from typing import Any

from bayeshunt.config.loading import load_experiment
from bayeshunt.experiments.protocol import learn_model
from bayeshunt.experiments.run.runner import evaluate
from benchmarks.command import command, show

#: Planner and arena of every row.
ROWS = (
    ("reactive", "walled"),
    ("prediction", "walled"),
    ("planning", "walled"),
    ("prediction", "open"),
    ("planning", "open"),
)


def time_rows(runs: int, seed: int, jobs: int) -> float:
    """Seconds for all rows."""
    start = time.perf_counter()
    settings = load_experiment("paper")
    model = learn_model(settings, seed)
    for arena in ("walled", "open"):
        planners = [planner for planner, where in ROWS if where == arena]
        evaluate(settings, runs=runs, seed=seed, jobs=jobs, planners=planners, arenas=[arena], model=model)
    return time.perf_counter() - start


def measure(runs: int, seed: int, rounds: int) -> dict[str, Any]:
    """Least seconds over the rounds with one and two workers, started and warm."""
    time_rows(1, seed, 2)  # starts the workers
    times: dict[int, list[float]] = {1: [], 2: []}
    for _ in range(rounds):
        for jobs, taken in times.items():
            taken.append(time_rows(runs, seed, jobs))
    one, two = min(times[1]), min(times[2])
    hunts = len(ROWS) * len(load_experiment("paper").protocol.thetas) * runs
    return {
        "hunts": hunts, "one_worker_s": one, "two_workers_s": two, "speed_up": one / two, "rounds": rounds,
        "seed": seed, "cores": os.cpu_count(),
    }  # fmt: skip


def report(facts: dict[str, Any]) -> str:
    """The figures as text."""
    return (
        f"Whole evaluation, {facts['hunts']} hunts of five rows, babbling and fitting included [s]\n"
        f"  one worker {facts['one_worker_s']:.1f}   two workers {facts['two_workers_s']:.1f}   "
        f"speed-up {facts['speed_up']:.2f} on {facts['cores']} cores"
    )


def main() -> None:
    """Run and print."""
    parser = command(__doc__)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--runs", type=int, default=100, help="per bearing")
    parser.add_argument("--rounds", type=int, default=2)
    options = parser.parse_args()
    facts = measure(options.runs, options.seed, options.rounds)
    show(facts, report, options)


if __name__ == "__main__":
    main()
