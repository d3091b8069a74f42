"""What learning and asking cost: ``python -m benchmarks.inference [--json] [--seed 0]``.

One run on one machine, so that the ratios can be compared:

1. one posterior P(Gait | Distance, Angle), with other evidence each time: this project's answer,
   pgmpy's VariableElimination query and pyAgrum's LazyPropagation. Targets are spread over 7 bodies
   (most are replaced by the nearest learned cell); "own cell" takes targets at learned cells only;
2. many answers at once;
3. fitting a million rows: counted once and fitted by pgmpy from the counts, against pgmpy's own fit
   of the raw rows; the tables are checked to be equal at 1e-12.
"""

from __future__ import annotations

import argparse
import json
import logging
import math
import time
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt import dataset
from bayeshunt.axes import EFFECTS
from bayeshunt.models import network
from bayeshunt.models.forward import ForwardModel
from bayeshunt.models.inverse import InverseModel
from bayeshunt.models.posterior import Posterior
from bayeshunt.settings import load_robot
from bayeshunt.world.babbling import babble

ANSWERS, QUERIES, MANY, REPEATS = 20_000, 300, 200_000, 5
FIT_ROWS = 1_000_000


def best_time(work: Callable[[], Any], repeats: int = REPEATS) -> float:
    """Shortest of ``repeats`` times [s]: the least disturbed by whatever else the machine does."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


def make_targets(model: ForwardModel, count: int, *, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Distances [m] up to 7 bodies and angles [rad], all around."""
    return rng.uniform(0.0, 7.0 * model.gaits.body_length, count), rng.uniform(-math.pi, math.pi, count)


def ask_ours(inverse: InverseModel, distances: np.ndarray, angles: np.ndarray) -> float:
    """Seconds per answer."""
    targets = list(zip(distances.tolist(), angles.tolist(), strict=True))
    posterior = inverse.posterior

    def work() -> None:
        for distance, angle in targets:
            posterior(distance, angle)

    return best_time(work) / len(targets)


def ask_pgmpy(model: ForwardModel, answers: list[Posterior]) -> tuple[float, np.ndarray]:
    """Seconds per query, and the posteriors [N, G]."""
    from pgmpy.inference import VariableElimination

    engine = VariableElimination(model.network)
    asked = [answer.evidence for answer in answers]

    def work() -> list[Any]:
        return [engine.query(["Gait"], evidence=evidence, show_progress=False) for evidence in asked]

    values = [[found.get_value(Gait=name) for name in model.gaits.names] for found in work()]
    return best_time(work) / len(asked), np.array(values)


def ask_pyagrum(model: ForwardModel, answers: list[Posterior]) -> tuple[float, np.ndarray]:
    """Seconds per query (evidence changed, propagated, read), and the posteriors [N, G]."""
    import pyagrum as gum

    net = gum.BayesNet()
    for name in network.VARIABLES:
        states = [f"s{i}" for i in range(len(model.probabilities(name)))]
        net.add(gum.LabelizedVariable(name, name, states))
    for name in network.VARIABLES[1:]:
        net.addArc("Gait", name)
        for gait, column in enumerate(model.probabilities(name).T):
            net.cpt(name)[{"Gait": gait}] = column.tolist()
    net.cpt("Gait").fillWith(model.probabilities("Gait").tolist())
    engine = gum.LazyPropagation(net)
    engine.addTarget("Gait")
    asked = [{"Distance": a.cell.distance_bin, "Angle": a.cell.angle_bin} for a in answers]

    def work() -> list[Any]:
        found = []
        for evidence in asked:
            engine.setEvidence(evidence)
            engine.makeInference()
            found.append(engine.posterior("Gait").toarray().ravel())
        return found

    values = np.array(work())
    return best_time(work) / len(asked), values


def answers_table(model: ForwardModel, seed: int) -> list[dict[str, Any]]:
    """One row per way of asking: microseconds per answer and how many times pgmpy's and pyAgrum's that is."""
    rng = np.random.default_rng(seed)
    inverse = InverseModel(model)
    distances, angles = make_targets(model, MANY, rng=rng)
    inverse.posterior_many(distances, angles)  # rings are worked out when first asked
    single = ask_ours(inverse, distances[:ANSWERS], angles[:ANSWERS])
    table = inverse.table().iloc[rng.integers(0, len(inverse.table()), ANSWERS)]
    own = ask_ours(inverse, table["distance"].to_numpy(), table["angle"].to_numpy())
    many = best_time(lambda: inverse.posterior_many(distances, angles)) / MANY
    answers = [inverse.posterior(d, a) for d, a in zip(distances[:QUERIES], angles[:QUERIES], strict=True)]
    pgmpy, theirs = ask_pgmpy(model, answers)
    pyagrum, agrums = ask_pyagrum(model, answers)
    ours = np.array([answer.values for answer in answers])
    difference = float(max(np.abs(theirs - ours).max(), np.abs(agrums - ours).max()))
    ways = [
        ("pgmpy VariableElimination", pgmpy),
        ("pyAgrum LazyPropagation", pyagrum),
        ("posterior, snapping", single),
        ("posterior, own cell", own),
        ("posterior_many", many),
    ]
    return [
        {
            "asked": name,
            "us_per_answer": 1e6 * seconds,
            "times_faster_than_pgmpy": pgmpy / seconds,
            "times_faster_than_pyagrum": pyagrum / seconds,
            "max_difference": difference,
        }
        for name, seconds in ways
    ]


def fit_table(frame: pd.DataFrame, model: ForwardModel, seed: int) -> dict[str, Any]:
    """Seconds of fitting a million rows our way and pgmpy's way, and the largest difference of the tables."""
    from pgmpy.models import DiscreteBayesianNetwork
    from pgmpy.parameter_estimator import DiscreteMLE

    rng = np.random.default_rng(seed)
    rows = frame.iloc[rng.integers(0, len(frame), FIT_ROWS)].reset_index(drop=True)
    rows = rows[list(dataset.COLUMNS)]
    rows["distance"] *= rng.uniform(0.95, 1.05, FIT_ROWS)
    fitted = ForwardModel.fit(rows, model.gaits)
    ours = best_time(lambda: ForwardModel.fit(rows, model.gaits), repeats=3)
    indices = dataset.discretise(rows, fitted.gaits, fitted.axes)
    states = network.state_names(fitted.gaits, fitted.axes)
    labels = {v: np.array(states[v], dtype=object)[indices[:, i]] for i, v in enumerate(network.VARIABLES)}
    raw = pd.DataFrame(labels)
    net = DiscreteBayesianNetwork([("Gait", effect) for effect in EFFECTS])
    start = time.perf_counter()
    theirs = net.fit(raw, estimator=DiscreteMLE(state_names=states))
    seconds = time.perf_counter() - start
    tables = network.tables_of(theirs)
    gaps = [np.abs(tables[v] - fitted.probabilities(v)).max() for v in EFFECTS]
    return {
        "rows": FIT_ROWS,
        "fit_s": ours,
        "pgmpy_fit_s": seconds,
        "times_faster": seconds / ours,
        "max_difference": float(max(gaps)),
    }


def report(answers: list[dict[str, Any]], fit: dict[str, Any]) -> str:
    """The figures as text."""
    lines = [f"{'one answer':<28}{'us':>10}{'x pgmpy':>10}{'x pyAgrum':>11}"]
    lines += [
        f"{row['asked']:<28}{row['us_per_answer']:>10.3f}"
        f"{row['times_faster_than_pgmpy']:>10.0f}{row['times_faster_than_pyagrum']:>11.0f}"
        for row in answers
    ]
    lines.append(f"largest difference between the engines: {answers[0]['max_difference']:.1e}")
    lines.append("")
    lines.append(
        f"fit {fit['rows']:,} rows: {fit['fit_s']:.3f} s; pgmpy on the raw rows, bins given: "
        f"{fit['pgmpy_fit_s']:.3f} s ({fit['times_faster']:.1f} times); tables differ by {fit['max_difference']:.1e}"
    )
    return "\n".join(lines)


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", action="store_true", help="print the figures as JSON")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    warnings.simplefilter("ignore")  # pgmpy warns of its own deprecations when imported
    logging.getLogger("pgmpy").setLevel(logging.ERROR)
    robot = load_robot("khepera")
    frame = babble(robot, steps=2000, seed=options.seed)
    model = ForwardModel.fit(frame, robot.gaits)
    answers, fit = answers_table(model, options.seed), fit_table(frame, model, options.seed)
    print(json.dumps({"answers": answers, "fit": fit}) if options.json else report(answers, fit))


if __name__ == "__main__":
    main()
