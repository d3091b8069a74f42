"""Displays of the forward model, the inverse model and its answers."""

from __future__ import annotations

from bayeshunt.core.bins import EFFECTS
from bayeshunt.core.errors import ZeroCountError
from bayeshunt.core.units import true_minus
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel
from bayeshunt.models.body.posterior import Posterior
from bayeshunt.models.tables.structures import depends_on_previous
from bayeshunt.views import grounds
from bayeshunt.views.drawings import maps, network
from bayeshunt.views.notebook.html import Html, card, facts, fold, join, number, row, table, tag
from bayeshunt.views.notebook.tables import folded_tables

#: What the columns of an explanation are compared with.
_EXPLAINED = (
    "How each variable speaks for or against a gait: natural logarithm of its probability under this gait "
    "over that under the reference. The parts add up to the log-odds; −∞: of probability 0 there."
)


def forward_model(model: ForwardModel) -> Html:
    """Return the network with its marginals, and every table."""
    title = f"Forward model: {grounds.description(model)}"
    pairs = [("gaits", len(model.gaits)), ("bins", ", ".join(f"{axis.name} {axis.bins}" for axis in model.axes))]
    if model.has_counts:
        pairs[1:1] = [("babbling rows", model.joint.total or "none counted here")]
        pairs += [
            ("prior", f"{number(model.prior)} per cell" if model.prior else "none"),
            ("P(Gait)", model.gait_prior),
            ("one gait lasts", "unknown" if model.gaits.duration is None else f"{model.gaits.duration:g} s"),
        ]
    else:
        pairs.append(("counts and intervals", "unknown"))
    try:
        drawn = network.network(model)
        tables = folded_tables([model.table(variable) for variable in (*EFFECTS, "Gait")])
    except ZeroCountError as error:
        return card(title, _origin(model), facts(pairs), tag("div", f"Nothing to show yet: {error}."))
    note = tag("div", grounds.SUMMED_OVER, class_="bh-note") if depends_on_previous(model.structure) else None
    return card(title, _origin(model), facts(pairs), drawn, note, tables)


def _origin(model: ForwardModel) -> str:
    """Where the tables come from."""
    if not model.has_counts:
        return "imported network"
    sources = len(model.provenance.get("sources", []))
    if sources:
        return f"learned from {sources} babbling table{'s' if sources != 1 else ''}"
    return "naive Bayes network" if model.structure.is_naive else f"structure {model.structure.name}"


def inverse_model(inverse: InverseModel) -> Html:
    """Return the map of learned coordinates, each in the colour of its most probable gait."""
    places = f"{len(inverse.table())} {grounds.coordinates(inverse.model)}"
    subtitle = f"{places}; colour: the most probable gait there"
    drawn = tag("div", maps.inverse_map(inverse), maps.gait_key(inverse.model), class_="bh-two")
    given = "".join(f", {variable} = {state}" for variable, state in inverse.model.known.items())
    return card(f"Inverse model: P(Gait | Distance, Angle{given})", subtitle, drawn)


def posterior(answer: Posterior) -> Html:
    """Return an answer as bars, with P(evidence), support, the learned coordinate and the explanation."""
    title = f"P(Gait | {', '.join(answer.evidence)})"
    parts = [posterior_facts(answer), bars(dict(zip(answer.source.gaits, answer.values, strict=True)), answer.best)]
    if len(answer.source.gaits) > 1:
        parts.append(fold("What each variable said", explanation(answer), tag("div", _EXPLAINED, class_="bh-note")))
    parts.append(fold("The network given this evidence", network.network(answer.model, answer)))
    return card(title, f"most probable: {answer.best}", *parts)


def posterior_facts(answer: Posterior) -> Html:
    """Return what an answer rests on."""
    used = true_minus(grounds.cell(answer)) + grounds.known(answer.model)
    nearest = f" ({grounds.snapped(answer)})" if answer.snapped else ""
    name = "learned coordinate used" if answer.model.has_counts else "coordinate used"
    rests_on = facts(
        [
            ("asked", true_minus(answer.asked)),
            (name, used + nearest),
            ("P(evidence)", number(answer.evidence_probability, 4)),
            ("support", grounds.support(answer)),
        ]
    )
    note = tag("div", grounds.beyond(answer), class_="bh-note") if answer.beyond else None
    return join([rests_on, note])


def bars(shares: dict[str, float], lit: str | None = None) -> Html:
    """Return probabilities by name as a bar chart; ``lit`` stands out."""
    top = max([*shares.values(), 1e-300])
    rows = []
    for name, share in shares.items():
        said = f"{share:.4f}"
        # the shortest bar is still a stub, which would contradict a printed zero
        bar = tag("span", class_="bh-bar", style=f"width:{100 * share / top:.1f}%") if float(said) else ""
        rows.append(row(name, [tag("td", bar, class_="bh-track"), said], lit=name == lit))
    return table(["Gait", "", "probability"], rows)


def explanation(answer: Posterior) -> Html:
    """Return ``answer.explain()`` as a table."""
    frame = answer.explain()
    parts = [c for c in ("prior", *EFFECTS) if c != "Heading" or answer.heading is not None]
    rows = [
        row(
            gait,
            [facts_["reference"], *(number(facts_[c]) for c in parts), number(facts_["log_odds"])],
            lit=gait == answer.best,
        )
        for gait, facts_ in zip(frame.index, frame.to_dict("records"), strict=True)
    ]
    return join([table(["Gait", "compared with", *parts, "log-odds"], rows)])
