"""Sheets of the forward model, the inverse model and its answers."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np

from bayeshunt.core.bins import ENERGY
from bayeshunt.core.errors import ZeroCountError
from bayeshunt.core.units import degrees, length
from bayeshunt.episodes.tracing import trace_answer
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel
from bayeshunt.models.body.posterior import Posterior
from bayeshunt.models.tables.structures import depends_on_previous
from bayeshunt.views import grounds
from bayeshunt.views.drawings import maps, network
from bayeshunt.views.drawings.tornado import tornado
from bayeshunt.views.notebook.html import Html, join, number, tag
from bayeshunt.views.sheets import tracing
from bayeshunt.views.sheets.energy import energy
from bayeshunt.views.sheets.panels import panels
from bayeshunt.views.sheets.sheet import Bars, Drawn, Note, Opening, Part, Printed, Sheet, Table
from bayeshunt.views.sheets.tables import heat_table

__all__ = ["bars", "forward_model", "inverse_model", "posterior", "spark"]

#: What the columns of an explanation are compared with.
_EXPLAINED = (
    "How each variable speaks for or against a gait: natural logarithm of its probability under this gait "
    "over that under the reference. The parts add up to the log-odds; −∞: of probability 0 there."
)
_BLOCKS = " ▁▂▃▄▅▆▇█"


def forward_model(model: ForwardModel) -> Sheet:
    """Return the network with its marginals and every table; in text a row per gait, its columns as sparklines."""
    title, pairs = f"Forward model: {grounds.description(model)}", _facts(model)
    try:
        tables = [model.table(variable) for variable in (*model.structure.effects, "Gait")]
    except ZeroCountError as error:
        return Sheet(title, _origin(model), pairs, [Note(f"Nothing to show yet: {error}.")])
    note = Note(grounds.SUMMED_OVER) if depends_on_previous(model.structure) else None
    drawn = [Drawn(partial(heat_table, t), title=t.title, opened=i == 0) for i, t in enumerate(tables)]
    parts = [Drawn(lambda: network.network(model.binned)), note, *drawn, Printed(lambda: _gaits(model).lines())]
    if model.knows_energy:
        cost = energy(model)
        parts += [Drawn(cost, title="Energy of each gait"), Printed(lambda: ["", *cost.lines()])]
    return Sheet(title, _origin(model), pairs, parts)


def _facts(model: ForwardModel) -> list[tuple[str, object]]:
    bins = ", ".join(f"{axis.name} {axis.bins}" for axis in model.axes.all)
    if not model.has_counts:
        return [("gaits", len(model.gaits)), ("bins", bins), ("counts and intervals", "unknown")]
    motion = model.source.residual_of
    beside = [] if motion is None else [("tables of", f"what the fitted {motion} misses; drawn: the poses it gives")]
    residuals = model.source.residuals
    if residuals is not None and residuals.motion.lags:
        speed, turning = residuals.motion.lag
        beside += [("lags behind its commands", f"{speed:.2g} of a gait in speed, {turning:.2g} in turning")]
    return [
        *beside,
        ("gaits", len(model.gaits)),
        ("babbling rows", model.joint.total or "none counted here"),
        ("bins", bins),
        ("prior", f"{number(model.prior)} per cell" if model.prior else "none"),
        ("P(Gait)", model.gait_prior),
        ("one gait lasts", "unknown" if model.gaits.duration is None else f"{model.gaits.duration:g} s"),
    ]


def _origin(model: ForwardModel) -> str:
    """Where the tables come from."""
    if not model.has_counts:
        return "imported network"
    sources = len(model.provenance.get("sources", []))
    if sources:
        return f"learned from {sources} babbling table{'s' if sources != 1 else ''}"
    return "naive Bayes network" if model.structure.is_naive else f"structure {model.structure.name}"


def _gaits(model: ForwardModel) -> Table:
    """A row per gait: rows, mean outcome, and its three columns as sparklines."""
    columns = {effect: model.probabilities(effect) for effect in model.structure.effects}
    # Of an imported network nobody knows the rows: no column rather than one of zeros.
    counts = model.joint.marginal("Gait").tolist() if model.has_counts else None
    rows = []
    for i, name in enumerate(model.gaits.names):
        sparks = (spark(columns[effect][:, i]) for effect in columns)
        rows.append([name, *([] if counts is None else [counts[i]]), _outcome(model, i), *sparks])
    heads = ["gait", *([] if counts is None else ["rows"]), "mean outcome", *columns]
    words = frozenset(i for i, name in enumerate(heads) if name != "rows")
    return Table(heads, rows, words=words, most=len(rows))


def _outcome(model: ForwardModel, index: int) -> str:
    try:
        pose = model.predict(model.gaits.names[index])
    except ZeroCountError:
        return "never babbled"
    return f"{length(pose.distance)} at {degrees(pose.angle)}, heading {degrees(pose.heading)}"


def spark(values: np.ndarray, width: int = 12) -> str:
    """Return values as a line of blocks; neighbours are added up to fit ``width`` characters."""
    edges = np.linspace(0, len(values), min(width, len(values)) + 1).astype(int)[:-1]
    sums = np.add.reduceat(np.asarray(values, dtype=float), edges)
    if not sums.max() > 0:
        return _BLOCKS[0] * len(sums)
    # Whatever is not 0 shows.
    return "".join(_BLOCKS[math.ceil(8 * share / sums.max())] for share in sums)


def inverse_model(inverse: InverseModel) -> Sheet:
    """Return how many learned coordinates each gait is the best answer of, and their map."""
    table, names = inverse.table(), inverse.model.gaits.names
    best = np.bincount(table[list(names)].to_numpy().argmax(axis=1), minlength=len(names))
    places = f"{len(table)} {grounds.coordinates(inverse.model)}"
    given = "".join(f", {variable} = {state}" for variable, state in inverse.model.known.items())
    counted = Table(["gait", "best in"], list(zip(names, best.tolist(), strict=True)), most=len(names))
    drawn = Drawn(lambda: maps.inverse_map(inverse), lambda: maps.gait_key(inverse.model), beside=True)
    title = f"Inverse model: P(Gait | Distance, Angle{given})"
    return Sheet(title, f"{places}; colour: the most probable gait there", (), [drawn, Printed(counted.lines)])


def posterior(answer: Posterior) -> Sheet:
    """Return an answer as bars, with P(evidence), support, the learned coordinate and the explanation."""
    nearest = f" ({grounds.snapped(answer)})" if answer.snapped else ""
    pairs = [
        ("asked", answer.asked),
        (grounds.coordinate_used(answer.model), grounds.cell(answer) + grounds.known(answer.model) + nearest),
        ("P(evidence)", f"{answer.evidence_probability:.6g}"),
        ("support", grounds.support(answer)),
    ]
    found = grounds.interval(answer)
    pairs += [("energy", grounds.energy(answer))] if answer.model.knows_energy else []
    pairs += [("how sure", grounds.how_sure(answer, found))] if found is not None else []
    shares = dict(zip(answer.source.gaits, answer.values.tolist(), strict=True))
    parts = [
        Note(grounds.beyond(answer)) if answer.beyond else None,
        bars(answer, shares, answer.best, None if found is None else grounds.within(found)),
        Drawn(lambda: _explanation(answer), Note(_EXPLAINED), title="What each variable said")
        if len(shares) > 1
        else None,
        Drawn(lambda: network.network(answer.model, answer), title="The network given this evidence"),
        Drawn(lambda: tornado(answer), title="Which cell matters most") if found is not None else None,
        Drawn(lambda: _opened(answer), title=f"Where P({answer.best}) comes from") if found is not None else None,
    ]
    return Sheet(f"P(Gait | {', '.join(answer.evidence)})", f"most probable: {answer.best}", pairs, parts)


def bars(answer: Posterior | None, shares: dict[str, float], lit: str, within: Any) -> Part:
    """Return a posterior as bars, each of which opens a panel with what it is made of where rows were counted."""
    if answer is None or not answer.model.has_counts:
        return Bars(shares, lit, within)
    return Opening(partial(panels, answer), Bars(shares, lit, within))


def _opened(answer: Posterior) -> Html:
    """The formula with its numbers, and the cells with their counts."""
    opened = tracing.trace(trace_answer(answer))
    formula = tag("div", str(dict(opened.pairs)["formula"]))
    return join([formula, *(part.html() for part in opened.parts if part is not None)])


def _explanation(answer: Posterior) -> Table:
    """``answer.explain()`` as a table."""
    frame = answer.explain()
    asked = {"Heading": answer.heading, ENERGY: answer.energy}
    columns = [c for c in ("prior", *answer.model.structure.effects) if asked.get(c, 0.0) is not None]
    rows = [
        [gait, facts["reference"], *(number(facts[c]) for c in columns), number(facts["log_odds"])]
        for gait, facts in zip(frame.index, frame.to_dict("records"), strict=True)
    ]
    lit = frozenset(i for i, gait in enumerate(frame.index) if gait == answer.best)
    return Table(["Gait", "compared with", *columns, "log-odds"], rows, lit)
