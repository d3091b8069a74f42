"""What learning and asking cost: ``python -m benchmarks.inference [--json] [--seed 0]``.

One run on one machine, so that the ratios can be compared:

1. one posterior P(Gait | Distance, Angle), with other evidence each time: this project's answer,
   pgmpy's VariableElimination query and pyAgrum's LazyPropagation. Targets are spread over 7 bodies
   (most are replaced by the nearest learned cell); "own cell" takes targets at learned cells only;
2. many answers at once;
3. whether the three engines agree, on a model with a prior so that agreeing is not trivial;
4. fitting a million rows: counted once and fitted by pgmpy from the counts, against pgmpy's own fit
   of every row. Both start from the same table, in metres and radians (which pgmpy needs labelled) or
   already labelled, and end in a pgmpy network with the same tables; tables that differ are an error.
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.config.loading import load_robot
from bayeshunt.core.bins import EFFECTS, EffectAxes
from bayeshunt.data import babbling_table
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel
from bayeshunt.models.body.posterior import Posterior
from bayeshunt.models.counting.cells import CountedCells
from bayeshunt.models.tables import network
from bayeshunt.models.tables.structures import NAIVE
from bayeshunt.worlds.babbling import babble
from benchmarks.command import command, quiet_pgmpy

ANSWERS, QUERIES, MANY, REPEATS = 20_000, 300, 200_000, 5
FIT_ROWS, FIT_REPEATS = 1_000_000, 9


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
    inverse.posterior_many(distances, angles)  # what can answer where is worked out when first asked
    single = ask_ours(inverse, distances[:ANSWERS], angles[:ANSWERS])
    table = inverse.table().iloc[rng.integers(0, len(inverse.table()), ANSWERS)]
    own = ask_ours(inverse, table["distance"].to_numpy(), table["angle"].to_numpy())
    many = best_time(lambda: inverse.posterior_many(distances, angles)) / MANY
    answers = [inverse.posterior(d, a) for d, a in zip(distances[:QUERIES], angles[:QUERIES], strict=True)]
    pgmpy, _ = ask_pgmpy(model, answers)
    pyagrum, _ = ask_pyagrum(model, answers)
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
        }
        for name, seconds in ways
    ]


def agreement(frame: pd.DataFrame, model: ForwardModel, seed: int) -> dict[str, Any]:
    """Largest difference between the engines where agreeing is not trivial.

    A maximum-likelihood model may leave one possible gait in every cell, and then engines agree
    whatever they compute. With a prior every gait keeps some mass everywhere.
    """
    smoothed = ForwardModel.fit(frame, model.gaits, prior=0.5)
    inverse = InverseModel(smoothed)
    targets = make_targets(smoothed, QUERIES, rng=np.random.default_rng(seed))
    answers = [inverse.posterior(d, a) for d, a in zip(*targets, strict=True)]
    ours = np.array([answer.values for answer in answers])
    gaps = [np.abs(ask(smoothed, answers)[1] - ours).max() for ask in (ask_pgmpy, ask_pyagrum)]
    fitted = InverseModel(model).table()[list(model.gaits.names)].to_numpy()
    return {
        "prior": smoothed.prior,
        "answers": len(answers),
        "max_difference": float(max(gaps)),
        "certain": float(np.mean(ours.max(axis=1) == 1.0)),
        "certain_in_fitted_model": float(np.mean(fitted.max(axis=1) == 1.0)),
    }


def million_rows(frame: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """A million rows in metres and radians, drawn from the babbled ones, their distances spread a little."""
    rows = frame[list(babbling_table.COLUMNS)].iloc[rng.integers(0, len(frame), FIT_ROWS)].reset_index(drop=True)
    rows["distance"] *= rng.uniform(0.95, 1.05, FIT_ROWS)
    return rows


def fit_labels(labels: pd.DataFrame, states: dict[str, list[str]]) -> Any:
    """The network that this project fits to rows already labelled: counted once, fitted by pgmpy from the counts."""
    columns = [babbling_table.positions(labels[v], states[v]) for v in network.VARIABLES]
    counted = CountedCells.of_columns(network.VARIABLES, [len(states[v]) for v in network.VARIABLES], columns)
    return network.fit_cells(counted, states, 0.0, NAIVE)


def cut(rows: pd.DataFrame, states: dict[str, list[str]], axes: EffectAxes) -> pd.DataFrame:
    """The rows labelled as a user of pandas and pgmpy would: ``pandas.cut``, the seam of a turn in its first bin."""
    labelled = {"Gait": rows["gait"].astype("category")}
    for axis in axes:
        edges, labels = axis.edges, states[axis.name]
        if axis.circular:
            edges, labels = np.append(edges, edges[-1] + axis.width), [*labels, labels[0]]
        labelled[axis.name] = pd.cut(rows[axis.name.lower()], edges, right=False, labels=labels, ordered=False)
    return pd.DataFrame(labelled)


def fit_table(frame: pd.DataFrame, model: ForwardModel, seed: int) -> list[dict[str, Any]]:
    """Seconds from a million rows to pgmpy's network with its tables, in turns; one row for each peer.

    Both sides start from the same table and end in the same CPDs. Metres and radians have to be labelled
    for pgmpy: as text, by ``pandas.cut`` or, most generously, as the Categorical that this project's own
    binning gives. Gaits are text, as babbling gives them, or a Categorical. Rows already labelled are a
    Categorical, which pgmpy reads fastest, or text.
    """
    from pgmpy.models import DiscreteBayesianNetwork
    from pgmpy.parameter_estimator import DiscreteMLE

    rows = million_rows(frame, np.random.default_rng(seed))
    fitted = ForwardModel.fit(rows, model.gaits)
    states = network.state_names(fitted.gaits, fitted.axes)

    kept = rows.astype({"gait": "category"})

    def bin_rows() -> pd.DataFrame:
        columns = babbling_table.discretise(rows, fitted.gaits, fitted.axes).T
        named = zip(network.VARIABLES, columns, strict=True)
        return pd.DataFrame({v: pd.Categorical.from_codes(column, states[v]) for v, column in named})

    def learn(labels: pd.DataFrame) -> Any:
        net = DiscreteBayesianNetwork([("Gait", effect) for effect in EFFECTS])
        return net.fit(labels, estimator=DiscreteMLE(state_names=states))

    def ours(table: pd.DataFrame = rows) -> Any:
        return ForwardModel.fit(table, model.gaits).network

    def label_rows() -> pd.DataFrame:
        columns = babbling_table.discretise(rows, fitted.gaits, fitted.axes).T
        named = zip(network.VARIABLES, columns, strict=True)
        return pd.DataFrame({v: np.array(states[v], dtype=object)[column] for v, column in named}, dtype="str")

    categories = bin_rows()
    text = categories.astype("str")
    ways = {
        "metres; text labels, pgmpy": (ours, lambda: learn(label_rows())),
        "metres; pandas.cut, pgmpy": (ours, lambda: learn(cut(rows, states, fitted.axes))),
        "... gaits a Categorical": (lambda: ours(kept), lambda: learn(cut(kept, states, fitted.axes))),
        "metres; our bins, pgmpy": (ours, lambda: learn(bin_rows())),
        "labels (Categorical)": (lambda: fit_labels(categories, states), lambda: learn(categories)),
        "labels (text)": (lambda: fit_labels(text, states), lambda: learn(text)),
    }
    return [{"rows": FIT_ROWS, "from": start, **compare_fits(*pair)} for start, pair in ways.items()]


def compare_fits(ours: Callable[[], Any], theirs: Callable[[], Any]) -> dict[str, Any]:
    """Least seconds of each, by the clock and of the processor, in turns, and the largest difference of the CPDs.

    Raises RuntimeError if the CPDs differ.
    """
    sides: tuple[list[tuple[float, float]], ...] = ([], [])
    for _ in range(FIT_REPEATS):
        for work, times in zip((ours, theirs), sides, strict=True):
            start, worked = time.perf_counter(), time.process_time()
            work()
            times.append((time.perf_counter() - start, time.process_time() - worked))
    one, two = ({e: net.get_cpds(e).get_values() for e in EFFECTS} for net in (ours(), theirs()))
    # P(Gait) is uniform in the paper's model and the frequency in pgmpy's: it is no part of what is learned.
    gap = max(float(np.abs(one[v] - two[v]).max()) for v in EFFECTS)
    if gap > network.TOLERANCE:
        raise RuntimeError(f"the tables differ by {gap:.1e}: the times cannot be compared")
    (clock, worked), (pgmpy_clock, pgmpy_worked) = (np.min(times, axis=0).tolist() for times in sides)
    return {
        "fit_s": clock, "pgmpy_s": pgmpy_clock, "times_faster": pgmpy_clock / clock,
        "fit_cpu_s": worked, "pgmpy_cpu_s": pgmpy_worked, "times_less_cpu": pgmpy_worked / worked,
        "max_difference": gap,
    }  # fmt: skip


def report(facts: dict[str, Any]) -> str:
    """The figures as text."""
    answers, same, fit = facts["answers"], facts["agreement"], facts["fit"]
    lines = [f"{'one answer':<28}{'us':>10}{'x pgmpy':>10}{'x pyAgrum':>11}"]
    lines += [
        f"{row['asked']:<28}{row['us_per_answer']:>10.3f}"
        f"{row['times_faster_than_pgmpy']:>10.1f}{row['times_faster_than_pyagrum']:>11.1f}"
        for row in answers
    ]
    lines += [
        f"largest difference between the three engines, prior {same['prior']}, {same['answers']} answers: "
        f"{same['max_difference']:.1e}",
        f"(cells with one possible gait, where agreeing is trivial: {same['certain']:.0%} there, "
        f"{same['certain_in_fitted_model']:.0%} in the model timed above)",
        "",
        f"{f'fit {FIT_ROWS:,} rows from':<28}{'s':>8}{'pgmpy s':>9}{'times':>7}{'cpu s':>8}{'pgmpy':>8}{'times':>7}"
        "  tables differ by",
        *(
            f"{row['from']:<28}{row['fit_s']:>8.3f}{row['pgmpy_s']:>9.3f}{row['times_faster']:>7.1f}"
            f"{row['fit_cpu_s']:>8.3f}{row['pgmpy_cpu_s']:>8.3f}{row['times_less_cpu']:>7.1f}  "
            f"{row['max_difference']:.0e}"
            for row in fit
        ),
    ]
    return "\n".join(lines)


def main() -> None:
    """Run and print."""
    parser = command(__doc__)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    quiet_pgmpy()
    robot = load_robot("khepera")
    frame = babble(robot, steps=2000, seed=options.seed)
    model = ForwardModel.fit(frame, robot.gaits)
    answers, same = answers_table(model, options.seed), agreement(frame, model, options.seed)
    fit = fit_table(frame, model, options.seed)
    record = {"answers": answers, "agreement": same, "fit": fit}
    print(json.dumps(record) if options.json else report(record))


if __name__ == "__main__":
    main()
