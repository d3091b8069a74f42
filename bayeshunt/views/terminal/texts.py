"""Plain-text forms: what ``print`` shows of a model, an answer, a table, a plan and a hunt."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from bayeshunt.core.bins import EFFECTS
from bayeshunt.core.errors import ZeroCountError
from bayeshunt.core.units import degrees, label, length, objective
from bayeshunt.episodes.episode import Episode
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel
from bayeshunt.models.body.posterior import Posterior
from bayeshunt.models.tables.probability_table import ProbabilityTable
from bayeshunt.models.tables.structures import depends_on_previous
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.planners.api import Plan
from bayeshunt.views import grounds
from bayeshunt.views.notebook.plans import value_column

_BLOCKS = " ▁▂▃▄▅▆▇█"
_BAR = 24  # characters of a full bar
_MOST_ROWS = 60
_MOST_NAME = 24


def forward_model(model: ForwardModel) -> str:
    """Return a row per gait: rows, mean outcome, and its three columns as sparklines."""
    head = [f"Forward model: {grounds.description(model)}", f"{len(model.gaits)} gaits, {_origin(model)}", ""]
    if depends_on_previous(model.structure):
        head[2:2] = [grounds.SUMMED_OVER]
    try:
        columns = {effect: model.probabilities(effect) for effect in EFFECTS}
    except ZeroCountError as error:
        return "\n".join([*head, f"nothing to show yet: {error}"])
    # Of an imported network nobody knows the rows: no column rather than one of zeros.
    counts = model.joint.marginal("Gait").tolist() if model.has_counts else None
    rows: list[list[str]] = []
    for index, name in enumerate(model.gaits.names):
        sparks = [spark(columns[effect][:, index]) for effect in EFFECTS]
        counted = [] if counts is None else [str(counts[index])]
        rows.append([clean(name), *counted, _outcome(model, index), *sparks])
    names = ["gait", *([] if counts is None else ["rows"]), "mean outcome", *EFFECTS]
    return "\n".join([*head, *align(names, rows, left={i for i, name in enumerate(names) if name != "rows"})])


def _origin(model: ForwardModel) -> str:
    """What the tables rest on."""
    if not model.has_counts:
        return "imported: no counts, no intervals"
    prior = f"prior {model.prior:g}" if model.prior else "maximum likelihood"
    return f"{model.joint.total} rows, {prior}, P(Gait) {model.gait_prior}"


def _outcome(model: ForwardModel, index: int) -> str:
    try:
        pose = model.predict(model.gaits.names[index])
    except ZeroCountError:
        return "never babbled"
    return f"{length(pose.distance)} at {degrees(pose.angle)}, heading {degrees(pose.heading)}"


def inverse_model(inverse: InverseModel) -> str:
    """Return how many learned coordinates each gait is the best answer of."""
    table, names = inverse.table(), inverse.model.gaits.names
    best = table[list(names)].to_numpy().argmax(axis=1)
    rows = [[clean(name), str(int((best == i).sum()))] for i, name in enumerate(names)]
    lines = align(["gait", "best in"], rows)
    places = f"{len(table)} {grounds.coordinates(inverse.model)}"
    given = "".join(f", {variable} = {state}" for variable, state in inverse.model.known.items())
    return "\n".join([f"Inverse model{given}: {places}", "", *lines])


def posterior(answer: Posterior) -> str:
    """Return the posterior as bars, with what it rests on."""
    lines = [f"P(Gait | {', '.join(answer.evidence)})", ""]
    lines += bars(zip(answer.source.gaits, answer.values.tolist(), strict=True))
    nearest = [f"{'':<20}({grounds.snapped(answer)})"] if answer.snapped else []
    note = grounds.beyond(answer).replace(". ", ".\n").splitlines()
    return "\n".join(
        [
            *lines,
            "",
            f"asked               {answer.asked}",
            f"{grounds.coordinate_used(answer.model):<18}  {grounds.cell(answer)}{grounds.known(answer.model)}",
            *nearest,
            f"P(evidence)         {answer.evidence_probability:.6g}",
            f"support             {grounds.support(answer)}",
            *note,
        ]
    )


def probability_table(shown: ProbabilityTable) -> str:
    """Return the probabilities of the bins that rows fell into, or could; zeros are dots."""
    values = shown.probability.to_numpy()
    counts = None if shown.count is None else shown.count.to_numpy().sum(axis=1)
    kept = np.flatnonzero(values.any(axis=1) if counts is None or not counts.any() else counts)[:_MOST_ROWS]
    labels, head = list(shown.probability.index), [shown.variable, *map(clean, shown.probability.columns)]
    rows = [[clean(_state(shown, labels[i])), *("·" if p == 0 else f"{p:.3f}" for p in values[i])] for i in kept]
    left = len(labels) - len(kept)
    more = f"{left} more bins"
    if counts is not None:
        head.append("rows")
        rows = [[*row, str(counts[i])] for row, i in zip(rows, kept, strict=True)]
        more += f", {counts.sum() - counts[kept].sum()} rows in them"
    return "\n".join([shown.title, "", *align(head, rows), *([f"({more})"] if left else [])])


def _state(shown: ProbabilityTable, name: str) -> str:
    """A bin as people read it, a gait as it is called."""
    return name if shown.variable == "Gait" else label(name)


def prey_model(prey: PreyModel) -> str:
    """Return the transitions seen, the most frequent first, with their intervals."""
    head = f"Prey model: {prey.observations} transitions, in the prey's own earlier frame"
    if prey.is_empty:
        return f"{head}\nnothing observed yet, so nothing can be predicted"
    frame = prey.cpt().sort_values("count", ascending=False, kind="stable")
    rows = [
        [*map(label, labels), f"{p:.3f}", str(n), f"{low:.3f} to {high:.3f}"]
        for labels, p, n, low, high in zip(
            frame.index, frame["probability"], frame["count"], frame["low"], frame["high"], strict=True
        )
    ]
    lines = align([*EFFECTS, "P", "count", "95 % interval"], rows[:_MOST_ROWS])
    more = [f"(and {len(rows) - _MOST_ROWS} rarer cells)"] if len(rows) > _MOST_ROWS else []
    return "\n".join([head, "", *lines, *more])


def plan(shown: Plan) -> str:
    """Return a decision and the chosen branch with its values, or the posterior that decided."""
    value, what = objective(shown.value, shown.objective)
    lines = [
        f"Plan: {clean(shown.gait)}",
        f"sequence  {' > '.join(map(clean, shown.gaits))}",
        f"value     {value:.4g}, {what}",
        f"nodes     {shown.nodes} considered" + (f", {shown.expansions} expanded" if shown.expansions else ""),
    ]
    if shown.evidence_probability is not None:
        lines.append(f"evidence  P = {shown.evidence_probability:.4g}, support {grounds.rows(shown.support)}")
    trace = shown.trace
    name, unit, factor = value_column(trace.columns)
    if {"node", "parent", "chosen", "T"} <= set(trace.columns) and name is not None:
        lines += ["", *_tree(trace, name, unit, factor)]
    elif shown.posterior is not None and "gait" in trace.columns:
        lines += ["", *bars(zip(trace["gait"], np.asarray(shown.posterior).tolist(), strict=True))]
    return "\n".join(lines)


def _tree(trace: Any, value: str, unit: str, factor: float, most: int = 3) -> list[str]:
    """The chosen branch, and beside each of its nodes the next best alternatives."""
    lines = []
    for record in trace[trace["chosen"]].sort_values("T").to_dict("records"):
        indent = "  " * int(record["T"])
        name = clean(record["gait"]) or "now"
        lines.append(f"{indent}* {name}  {factor * record[value]:.2f} {unit}".rstrip())
        rivals = trace[(trace["parent"] == record["parent"]) & ~trace["chosen"]]
        for rival in rivals.nsmallest(most, value).to_dict("records"):
            lines.append(f"{indent}  {clean(rival['gait'])}  {factor * rival[value]:.2f}")
    return lines


def episode(shown: Episode) -> str:
    """Return the outcome and a row per decision."""
    origin = shown.provenance
    ending = f"caught after {shown.time:.2f} s" if shown.caught else f"not caught in {shown.time:g} s"
    what = ", ".join(f"{name} {origin[name]}" for name in ("planner", "arena", "theta", "seed") if name in origin)
    rows = [
        [
            str(r["step"]),
            f"{r['time']:.1f}",
            f"{r['seen_distance'] * 1000:.0f}",
            degrees(r["seen_angle"]),
            clean(r["gait"]),
            f"{objective(r['value'], r['objective'])[0]:.3g}",
            str(r["prey_observations"]),
        ]
        for r in shown.frame.to_dict("records")
    ]
    lines = align(["step", "time s", "prey mm", "bearing", "gait", "value", "moves seen"], rows, left={4})
    value = [f"value: {objective(0.0, shown.frame['objective'].iloc[0])[1]}"] if rows else []
    return "\n".join([f"Hunt: {ending} ({what})", "", *lines, *value])


def bars(shares: Iterable[tuple[str, float]]) -> list[str]:
    """Return a line per name: name, bar, probability."""
    pairs = [(clean(name), share) for name, share in shares]
    width = max(len(name) for name, _ in pairs)
    return [f"{name:<{width}}  {'█' * round(share * _BAR):<{_BAR}}  {share:.4f}" for name, share in pairs]


def spark(values: np.ndarray, width: int = 12) -> str:
    """Return values as a line of blocks; neighbours are added up to fit ``width`` characters."""
    edges = np.linspace(0, len(values), min(width, len(values)) + 1).astype(int)[:-1]
    sums = np.add.reduceat(np.asarray(values, dtype=float), edges)
    if not sums.max() > 0:
        return _BLOCKS[0] * len(sums)
    # Whatever is not 0 shows.
    return "".join(_BLOCKS[math.ceil(8 * share / sums.max())] for share in sums)


def align(head: Sequence[str], rows: Sequence[Sequence[str]], *, left: set[int] | None = None) -> list[str]:
    """Return lines of a table with two spaces between columns; columns ``left`` are left-aligned."""
    from bayeshunt.views.terminal.text_tables import TextTable, number, word

    lefts = {0} if left is None else left
    table = TextTable(*(word(name) if i in lefts else number(name) for i, name in enumerate(head)), ruled=False)
    for row in rows:
        table.row(*row)
    return table.lines()


def clean(name: Any, length: int = _MOST_NAME) -> str:
    """Return a name on one line, without control characters that a terminal would obey, cut to ``length``."""
    printable = "".join(c if c.isprintable() else "�" for c in str(name))
    return printable if len(printable) <= length else printable[: length - 1] + "…"
