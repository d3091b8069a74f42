"""What planning costs: ``python -m benchmarks.planning [--json] [--seed 0] [--situations 50]``.

1. Best-first against breadth-first as the depth grows, each searching until a sequence ends within
   half a body of the predicted prey or the tree is exhausted, and again with the default budget of
   60 expansions: nodes, the expansion after which the best sequence was found, its value and length,
   the share of situations in which half a body was reached, and time. "lazy" composes and values a
   node's children on expansion, so its time is what each expansion costs; "compiled", the default,
   reads sequences composed when the planner was made and values all of them in one pass.
2. The time of one decision of each planner with its default settings.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from bayeshunt.geometry import Polar
from bayeshunt.models.forward import ForwardModel
from bayeshunt.models.prey import PreyModel
from bayeshunt.planners.base import Plan, Planner, Situation
from bayeshunt.planners.registry import make_planner, planner_names
from bayeshunt.planners.search import ORDERS
from bayeshunt.settings import load_robot
from bayeshunt.world.babbling import babble

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
    """Return what ``look`` keeps of each plan and each decision's time [s]; every planner gets the same generators."""
    kept, times = [], np.empty(len(situations))
    for number, situation in enumerate(situations):
        rng = np.random.default_rng([seed, number])
        start = time.perf_counter()
        plan = planner.plan(situation, rng=rng)
        times[number] = time.perf_counter() - start
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
                "lazy_ms": float(lazy.mean() * 1e3),
                "compiled_ms": float(compiled.mean() * 1e3),
            }
        )
    return rows


def time_decisions(model: ForwardModel, situations: list[Situation], seed: int) -> list[dict[str, Any]]:
    """One row per planner: the distribution of one decision's time [us] and the cost of making it."""
    rows = []
    for name in planner_names(standalone=True):
        start = time.perf_counter()
        planner = make_planner(name, model)
        made = time.perf_counter() - start
        decide(planner, situations[:50], seed)
        _, times = decide(planner, situations, seed)
        rows.append(
            {
                "planner": name,
                "decisions": len(times),
                "median_us": float(np.median(times) * 1e6),
                "p99_us": float(np.percentile(times, 99) * 1e6),
                "max_us": float(times.max() * 1e6),
                "make_ms": made * 1e3,
            }
        )
    return rows


def show(title: str, rows: list[dict[str, Any]]) -> None:
    """Print rows as an aligned table."""
    cells = [[f"{v:.2f}" if isinstance(v, float) else str(v) for v in row.values()] for row in rows]
    lines = [list(rows[0]), *cells]
    widths = [max(len(line[i]) for line in lines) for i in range(len(lines[0]))]
    print(title)
    for line in lines:
        print("  " + "  ".join(text.rjust(width) for text, width in zip(line, widths, strict=True)))


def main() -> None:
    """Run both comparisons and print them."""
    parser = argparse.ArgumentParser(description="What planning costs.")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--seed", type=int, default=0, help="of babbling, situations and decisions")
    parser.add_argument("--situations", type=int, default=50, help="situations of the order comparison")
    parser.add_argument("--decisions", type=int, default=2000, help="decisions timed per planner")
    options = parser.parse_args()
    model = make_model(options.seed)
    rng = np.random.default_rng(options.seed)
    orders = compare_orders(model, make_situations(model, options.situations, rng=rng), options.seed)
    decisions = time_decisions(model, make_situations(model, options.decisions, rng=rng), options.seed)
    if options.json:
        print(json.dumps({"orders": orders, "decisions": decisions, "seed": options.seed}))
        return
    show(f"Search orders, means over {options.situations} situations", orders)
    show("One decision with default settings", decisions)


if __name__ == "__main__":
    main()
