"""The network as a drawing: its causes and its effects, each with the distribution over its states."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from bayeshunt.core.bins import EFFECTS, ENERGY, Axis
from bayeshunt.core.units import label, length, true_minus
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.posterior import Posterior
from bayeshunt.models.tables.structures import PREVIOUS, depends_on_previous
from bayeshunt.views import grounds
from bayeshunt.views.drawings import svg
from bayeshunt.views.notebook.html import Html, tag

__all__ = ["marginals", "network", "posteriors"]

_WIDTH = 720
_NODE = (292, 96)  # width and height of an effect's node
_GAP = 18
_LEFT = 282  # width of the Gait node
_RIGHT = _WIDTH - _NODE[0] - 20  # where the effects' nodes start
_ROW = 16  # height of a gait's bar
_BEFORE = 52  # height of the PreviousGait node
_SPINE = 24  # room for the edges to the left of stacked nodes
_MOST_GAITS = 16
_MOST_BARS = 120


def marginals(model: ForwardModel) -> dict[str, np.ndarray]:
    """Return the distribution of every variable, "Gait" [G] and effects [K]: ``P(v) = sum_g P(g) P(v | g)``."""
    gait = model.probabilities("Gait")
    return {"Gait": gait, **{effect: model.probabilities(effect) @ gait for effect in model.structure.effects}}


def posteriors(answer: Posterior) -> dict[str, np.ndarray]:
    """Return P(Gait | evidence) [G] and P(v | evidence) [K] of Heading and Energy, where they were not observed."""
    cell, model = answer.cell, answer.model
    at, heading, energy = (cell.distance_bin, cell.angle_bin), cell.heading_bin, cell.energy_bin
    found = {"Gait": answer.values}
    if heading is None:
        joint = model.evidence(*at, np.arange(model.axes.heading.bins), energy).sum(axis=1)
        found["Heading"] = joint / joint.sum()
    if energy is None and (axis := model.axes.energy) is not None:
        joint = np.array([model.evidence(*at, heading, number).sum() for number in range(axis.bins)])
        found[ENERGY] = joint / joint.sum()
    return found


def network(model: ForwardModel, answer: Posterior | None = None) -> Html:
    """Return the network with the marginals of its variables, or with their posteriors given an answer's evidence."""
    shares, seen = marginals(model), {}
    if answer is not None:
        shares |= posteriors(answer)
        cell = answer.cell
        bins = (cell.distance_bin, cell.angle_bin, cell.heading_bin, cell.energy_bin)
        seen = {e: index for e, index in zip((*EFFECTS, ENERGY), bins, strict=True) if index is not None}
    beside, stacked = _beside(model, shares, seen, answer), _stacked(model, shares, seen, answer)
    return tag("div", tag("div", beside, class_="bh-desk"), tag("div", stacked, class_="bh-phone"))


def _beside(model: ForwardModel, shares: dict[str, np.ndarray], seen: dict[str, int], answer: Any) -> Html:
    """The effects to the right of their causes."""
    gait_height, before = _gait_height(model), _has_before(model)
    left_height = gait_height + (_GAP + _BEFORE if before else 0)
    effects = model.structure.effects
    right_height = len(effects) * (_NODE[1] + _GAP) - _GAP
    height = max(left_height, right_height) + 4
    top = (height - left_height) / 2
    parts = [_gait_node(model, shares["Gait"], top, gait_height, answer)]
    causes = {"Gait": top + gait_height / 2}  # middle of each node
    if before:
        causes[PREVIOUS] = top + left_height - _BEFORE / 2
        parts.append(_before_node(model, causes[PREVIOUS] - _BEFORE / 2))
    first = (height - right_height) / 2
    for place, effect in enumerate(effects):
        y = first + place * (_NODE[1] + _GAP)
        for cause, middle in causes.items():
            if _points(model, cause, effect):
                parts.append(svg.arrow(_LEFT + 4, middle, _RIGHT - 4, y + _NODE[1] / 2))
    parts.append(_effects(model, shares, seen, first))
    return svg.drawing(_WIDTH, height, *parts, label=_said(model))


def _stacked(model: ForwardModel, shares: dict[str, np.ndarray], seen: dict[str, int], answer: Any) -> Html:
    """All nodes below each other, for a phone; edges run down the left side."""
    gait_height, before = _gait_height(model), _has_before(model)
    parts = [_gait_node(model, shares["Gait"], 0, gait_height, answer)]
    causes = {"Gait": (7.0, gait_height / 2)}  # where its edges run, middle of the node
    first = gait_height + _GAP
    if before:
        causes[PREVIOUS] = (15.0, first + _BEFORE / 2)
        parts.append(_before_node(model, first))
        first += _BEFORE + _GAP
    parts = [tag("g", *parts, transform=f"translate({_SPINE} 0)")]
    for cause, (x, middle) in causes.items():
        ends = [
            first + place * (_NODE[1] + _GAP) + _NODE[1] / 2
            for place, effect in enumerate(model.structure.effects)
            if _points(model, cause, effect)
        ]
        if ends:
            parts.append(svg.line([(_SPINE, middle), (x, middle), (x, ends[-1])], stroke=svg.FAINT, stroke_width="1.4"))
        parts += [svg.arrow(x, end, _SPINE, end) for end in ends]
    parts.append(tag("g", _effects(model, shares, seen, first), transform=f"translate({_SPINE + 2 - _RIGHT} 0)"))
    height = first + len(model.structure.effects) * (_NODE[1] + _GAP) - _GAP + 4
    return svg.drawing(_SPINE + _NODE[0] + 20, height, *parts, label=_said(model))


def _said(model: ForwardModel) -> str:
    return f"{grounds.description(model)}; bars are probabilities"


def _gait_height(model: ForwardModel) -> int:
    shown = min(len(model.gaits), _MOST_GAITS)
    return 34 + _ROW * shown + (18 if shown < len(model.gaits) else 0)


def _has_before(model: ForwardModel) -> bool:
    return PREVIOUS in model.known or depends_on_previous(model.structure)


def _points(model: ForwardModel, cause: str, effect: str) -> bool:
    """Whether there is an edge from a cause to an effect."""
    return cause in (*model.structure.parents(effect), *model.known)


def _effects(model: ForwardModel, shares: dict[str, np.ndarray], seen: dict[str, int], first: float) -> Html:
    """The nodes of the effects from ``first`` down, and the edges between them."""
    parts: list[Html] = []
    effects = model.structure.effects
    for place, effect in enumerate(effects):
        parts += [_link(effects.index(p), place, first) for p in model.structure.parents(effect) if p in effects]
        parts.append(
            _effect_node(model.axes[effect], shares[effect], seen.get(effect), first + place * (_NODE[1] + _GAP))
        )
    return tag("g", *parts)


def _link(parent: int, child: int, first: float) -> Html:
    """An edge between two effects, along their right side where they are not neighbours."""
    step, (width, height) = _NODE[1] + _GAP, _NODE
    down = child > parent
    if abs(parent - child) == 1:
        start, end = first + parent * step + (height if down else 0), first + child * step + (0 if down else height)
        return svg.arrow(_RIGHT + width / 2, start, _RIGHT + width / 2, end)
    x, (start, end) = _RIGHT + width, (first + place * step + height / 2 for place in (parent, child))
    bend = svg.line(
        [(x, start), (x + 14, start + (8 if down else -8)), (x + 14, end - (8 if down else -8))],
        stroke=svg.FAINT,
        stroke_width="1.4",
    )
    return tag("g", bend, svg.arrow(x + 14, end - (8 if down else -8), x + 1, end))


def _frame(x: float, y: float, width: float, height: float, name: str, note: str, marked: bool) -> list[Html]:
    edge = svg.CHOSEN if marked else svg.LINE
    return [
        svg.box(x, y, width, height, rx=8, fill=svg.PANEL, stroke=edge, stroke_width=2 if marked else 1),
        svg.text(x + 12, y + 20, name, font_weight=600, style="font-weight:600"),
        svg.text(x + width - 12, y + 20, note, anchor="end", faint=True),
    ]


def _gait_node(model: ForwardModel, shares: np.ndarray, top: float, height: float, answer: Posterior | None) -> Html:
    """The gaits with their probabilities, those of an answer with the whiskers of their intervals."""
    learned, found = answer is not None, None if answer is None else grounds.interval(answer)
    ends = None if found is None else found[["low", "high"]].to_numpy()
    parts = _frame(2, top + 2, _LEFT, height - 4, "Gait", "given the evidence" if learned else "P(Gait)", False)
    order = range(len(shares)) if len(shares) <= _MOST_GAITS else np.argsort(-shares, kind="stable")[:_MOST_GAITS]
    scale = 96 / max(float(shares.max() if ends is None else ends.max()), 1e-300)
    for place, index in enumerate(order):
        y = top + 34 + place * _ROW
        share, name = float(shares[index]), model.gaits.names[index]
        best = learned and index == int(np.argmax(shares))
        parts.append(svg.text(122, y + 9, svg.shorten(name, 17), anchor="end"))
        fill = svg.CHOSEN if best else svg.BAR
        parts.append(svg.box(130, y, max(share * scale, 0.5), 10, f"{name}: {share:.4g}", fill=fill, rx=1.5))
        if ends is not None:
            low, high = (130 + scale * ends[index]).tolist()
            parts.append(svg.line([(low, y + 5), (max(high, low + 1.5), y + 5)], stroke=svg.INK, stroke_width=1.6))
        parts.append(svg.text(_LEFT - 10, y + 9, f"{share:.3f}", anchor="end", faint=True))
    if len(shares) > _MOST_GAITS:
        left = len(shares) - _MOST_GAITS
        parts.append(svg.text(122, top + 34 + _MOST_GAITS * _ROW + 10, f"and {left} more", anchor="end", faint=True))
    return tag("g", *parts)


def _before_node(model: ForwardModel, top: float) -> Html:
    """The gait before: observed, or summed over."""
    observed = model.known.get(PREVIOUS)
    parts = _frame(2, top, _LEFT, _BEFORE, PREVIOUS, "observed" if observed else "summed over", observed is not None)
    chances = f", P(PreviousGait) {model.gait_prior}" if model.has_counts else ""
    said = svg.shorten(observed, 40) if observed else f"{len(model.gaits)} gaits{chances}"
    return tag("g", *parts, svg.text(14, top + 40, said, faint=observed is None))


def _effect_node(axis: Axis, shares: np.ndarray, observed: int | None, y: float) -> Html:
    x, (width, height) = _RIGHT, _NODE
    names = [true_minus(label(name)) for name in axis.labels]
    note = f"highest {shares.max():.3f}" if observed is None else f"observed: {names[observed]}"
    parts = _frame(x, y, width, height, axis.name, note, observed is not None)
    parts += _bars(axis.name, names, shares, observed, x + 12, y + 28, width - 24, height - 48)
    for place, anchor, words in _ticks(axis):
        parts.append(svg.text(x + 12 + place * (width - 24), y + height - 6, words, anchor=anchor, faint=True))
    return tag("g", *parts)


def _bars(
    name: str,
    labels: list[str],
    shares: np.ndarray,
    observed: int | None,
    x: float,
    y: float,
    width: float,
    height: float,
) -> list[Html]:
    """A bar per bin; where bins outnumber the pixels, neighbours are added up."""
    group = math.ceil(len(shares) / _MOST_BARS)
    step = width * group / len(shares)
    starts = np.arange(0, len(shares), group)
    sums = np.add.reduceat(shares, starts)
    scale = height / max(float(sums.max()), 1e-300)
    bars = [svg.line([(x, y + height), (x + width, y + height)], stroke=svg.LINE)]
    for place, (start, share) in enumerate(zip(starts.tolist(), sums.tolist(), strict=True)):
        last = min(start + group, len(shares)) - 1
        bins = labels[start] if group == 1 else f"{labels[start]} to {labels[last]}"
        marked = observed is not None and start <= observed <= last
        tall = height if marked else share * scale
        if tall <= 0:
            continue
        fill = svg.CHOSEN if marked else svg.BAR
        faded = 0.35 if observed is not None and not marked else None
        bars.append(
            svg.box(
                x + place * step + 0.5,
                y + height - tall,
                max(step - 1, 0.8),
                tall,
                f"{name} {bins}: {share:.4g}",
                fill=fill,
                opacity=faded,
            )
        )
    return bars


def _ticks(axis: Axis) -> list[tuple[float, str, str]]:
    """Place in [0, 1], anchor and label of the ends and the middle of an axis."""
    if axis.circular:
        middle = (axis.bins // 2 + 0.5) / axis.bins
        return [(0, "start", "−180°"), (middle, "middle", "0°"), (1, "end", "180°")]
    far = float(axis.edges[-1])
    if axis.name == ENERGY:
        return [(0, "start", "0"), (0.5, "middle", f"{far / 2:.3g} J"), (1, "end", f"{far:.3g} J")]
    return [(0, "start", "0"), (0.5, "middle", length(far / 2)), (1, "end", length(far))]
