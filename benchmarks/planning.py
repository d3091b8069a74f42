"""What planning costs: ``python -m benchmarks.planning [--json] [--seed 0] [--situations 50]``.

1. Best-first against breadth-first as the depth grows, each searching until a sequence ends within
   half a body of the predicted prey or the tree is exhausted, and again with the default budget of
   60 expansions: nodes, the expansion after which the best sequence was found, its value and length,
   the share of situations in which half a body was reached, and time. "lazy" composes and values a
   node's children on expansion, so its time is what each expansion costs; "compiled", the default,
   reads sequences composed when the planner was made and values all of them in one pass.
2. The time of one decision of each planner with its default settings, by the clock and in processor
   time of its thread, which other programs on the machine disturb less, and what share of the
   robot's time-step the slowest in a hundred takes.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from bayeshunt.config.loading import load_robot
from bayeshunt.core.geometry import Polar
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.planners.api import Plan, Planner, Situation
from bayeshunt.planners.registry import make_planner, planner_names
from bayeshunt.planners.search.search import ORDERS
from bayeshunt.worlds.babbling import babble
from benchmarks.command import command, show

DEPTHS = (2, 4, 6, 8, 10)
BUDGETS = (None, 60)  # expansions


def make_model(seed: int, steps: int = 2000) -> ForwardModel:
    """The forward model of a babbled Khepera."""
    robot = load_robot("khepera")
    return ForwardModel.fit(babble(robot, steps=steps, seed=seed), robot.gaits)


def make_situations(model: ForwardModel, count: int, *, rng: np.random.Generator) -> list[Situation]:
    """Prey within 10 bodies, anywhere around, going about 16 cm a step with some turning."""
    body = model.gaits.body_length
    prey = PreyModel()
    for _ in range(8):
        prey.observe(Polar(rng.normal(0.16, 0.01), rng.normal(0.0, 0.1), rng.normal(0.1, 0.2)))
    turns = rng.uniform(-math.pi, math.pi, size=(count, 2)).tolist()
    distances = rng.uniform(1.02 * body, 10.0 * body, size=count).tolist()
    return [
        Situation(Polar(d, a, h), prey, body_length=body, time_step=model.gaits.duration)
        for d, (a, h) in zip(distances, turns, strict=True)
    ]


def decide(
    planner: Planner, situations: list[Situation], seed: int, look: Callable[[Plan], Any] = id
) -> tuple[list[Any], np.ndarray]:
    """Return what ``look`` keeps of each plan, and each decision's time [s] by the clock and of the processor [2, N].

    Every planner gets the same generators.
    """
    kept, times = [], np.empty((2, len(situations)))
    for number, situation in enumerate(situations):
        rng = np.random.default_rng([seed, number])
        start, worked = time.perf_counter(), time.thread_time()
        plan = planner.plan(situation, rng=rng)
        times[:, number] = time.perf_counter() - start, time.thread_time() - worked
        kept.append(look(plan))
    return kept, times


def figures(plan: Plan) -> tuple[float, ...]:
    """Expansions, nodes, expansions until the best sequence was generated, value [m], sequence length."""
    trace = plan.trace
    best = trace.index[trace["chosen"]][-1]
    found_after = trace["expansion"][trace["parent"][best]] + 1
    return plan.expansions, plan.nodes, found_after, plan.value, len(plan.gaits)


def compare_orders(model: ForwardModel, situations: list[Situation], seed: int) -> list[dict[str, Any]]:
    """One row per depth, budget and order: means over the situations."""
    rows = []
    for depth, budget, order in itertools.product(DEPTHS, BUDGETS, ORDERS):
        settings: dict[str, Any] = {"depth": depth, "order": order, "expansions": budget}
        seen, compiled = decide(make_planner("planning", model, **settings), situations, seed, figures)
        _, lazy = decide(make_planner("planning", model, rollouts="lazy", **settings), situations, seed)
        expanded, generated, found_after, values, lengths = np.array(seen, dtype=float).T
        bodies = values / model.gaits.body_length
        rows.append(
            {
                "depth": depth,
                "budget": "none" if budget is None else budget,
                "order": order,
                "expanded": float(expanded.mean()),
                "generated": float(generated.mean()),
                "best_found_after": float(found_after.mean()),
                "value_bodies": float(bodies.mean()),
                "reached": float(np.mean(bodies <= 0.5)),
                "length": float(lengths.mean()),
                "lazy_ms": float(lazy[0].mean() * 1e3),
                "compiled_ms": float(compiled[0].mean() * 1e3),
            }
        )
    return rows


def time_decisions(model: ForwardModel, situations: list[Situation], seed: int) -> list[dict[str, Any]]:
    """One row per planner: the distribution of one decision's time [us] and the cost of making the planner [ms]."""
    rows = []
    for name in planner_names(standalone=True):
        start = time.perf_counter()
        planner = make_planner(name, model)
        made = time.perf_counter() - start
        decide(planner, situations[:50], seed)
        _, (clock, processor) = decide(planner, situations, seed)
        rows.append(
            {
                "planner": name,
                "decisions": len(clock),
                "median_us": float(np.median(clock) * 1e6),
                "p99_us": float(np.percentile(clock, 99) * 1e6),
                "cpu_median_us": float(np.median(processor) * 1e6),
                "cpu_p99_us": float(np.percentile(processor, 99) * 1e6),
                "cpu_p99_percent_of_step": float(np.percentile(processor, 99) / model.gaits.duration * 100.0),
                "make_ms": made * 1e3,
            }
        )
    return rows


def table(title: str, rows: list[dict[str, Any]]) -> str:
    """Rows as an aligned table."""
    cells = [[f"{v:.2f}" if isinstance(v, float) else str(v) for v in row.values()] for row in rows]
    lines = [list(rows[0]), *cells]
    widths = [max(len(line[i]) for line in lines) for i in range(len(lines[0]))]
    texts = ["  " + "  ".join(text.rjust(width) for text, width in zip(line, widths, strict=True)) for line in lines]
    return "\n".join([title, *texts])


def report(facts: dict[str, Any]) -> str:
    """The figures as text."""
    return "\n".join(
        [
            table(f"Search orders, means over {facts['situations']} situations", facts["orders"]),
            table(f"One decision with default settings; the time-step is {facts['step_s']:g} s", facts["decisions"]),
        ]
    )


def main() -> None:
    """Run both comparisons and print them."""
    parser = command(__doc__)
    parser.add_argument("--seed", type=int, default=0, help="of babbling, situations and decisions")
    parser.add_argument("--situations", type=int, default=50, help="situations of the order comparison")
    parser.add_argument("--decisions", type=int, default=2000, help="decisions timed per planner")
    options = parser.parse_args()
    model = make_model(options.seed)
    rng = np.random.default_rng(options.seed)
    facts = {
        "orders": compare_orders(model, make_situations(model, options.situations, rng=rng), options.seed),
        "decisions": time_decisions(model, make_situations(model, options.decisions, rng=rng), options.seed),
        "situations": options.situations,
        "step_s": model.gaits.duration,
        "seed": options.seed,
    }
    show(facts, report, options)


if __name__ == "__main__":
    main()
