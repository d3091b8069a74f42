"""The tables that an answer is made of, cut down to its evidence: their cells, counts and pseudo-counts.

``P(g, e) = sum over what is not known of P(g) prod_v P(v | parents)``: of an observed variable one bin is left of its
table, of others (the gait before; an effect between two observed ones) all of it, of the rest nothing.
Letters: K states of a variable.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bayeshunt.core.bins import EFFECTS, ENERGY
from bayeshunt.core.checks import check_pseudo_count
from bayeshunt.core.errors import InputError
from bayeshunt.models.counting.previous import PreviousCounts
from bayeshunt.models.tables.counted import CountedTables
from bayeshunt.models.tables.sources import TableSource
from bayeshunt.models.tables.structures import PREVIOUS

__all__ = ["AXES", "Factor", "add_up", "check_counted", "factors", "log_sum", "pseudo_words", "spread", "weights"]

#: What may be left of a table's variables once Distance and Angle are known, in the order of the axes.
AXES = (PREVIOUS, "Gait", *EFFECTS)


@dataclass(frozen=True, eq=False)
class Factor:
    """One table cut down to the evidence.

    variable: whose table. axes: the variables left, one axis each; the variable's own first, unless observed.
    observed: bin number of the variable; None: not known. fixed: parents -> bin numbers that the evidence fixes.
    table, counts, pseudo: the probabilities [K, ...], rows and Dirichlet pseudo-counts before the own axis is cut.
    estimated: False for a table that was set (a uniform P(Gait)).
    """

    variable: str
    axes: tuple[str, ...]
    observed: int | None
    fixed: dict[str, int]
    table: np.ndarray
    counts: np.ndarray
    pseudo: np.ndarray
    estimated: bool

    @property
    def probability(self) -> np.ndarray:
        """The probabilities over :attr:`axes`."""
        return self.table if self.observed is None else self.table[self.observed]

    @property
    def cells(self) -> int:
        """How many independent cells a draw of it needs."""
        return int(self.probability.size) if self.estimated else 0


def check_counted(source: TableSource) -> None:
    """Raise InputError for an imported network."""
    if source.support is None:
        raise InputError(
            "an imported network has probabilities but no counts, so nobody knows how sure its answers are"
        )


def factors(source: TableSource, bins: dict[str, int], pseudo: float | None = None) -> list[Factor]:
    """Return the tables behind P(Gait, evidence), the causes first.

    bins: the evidence. pseudo: pseudo-count per cell; None: the model's, at prior 0 it is 1/K a cell.
    """
    needed = set(bins)
    for _ in EFFECTS:  # the parents of what is needed are needed
        needed |= {p for v in needed for p in source.structure.parents(v) if p in EFFECTS}
    made = [_cause(source, cause, pseudo) for cause in source.causes]
    return made + [_effect(source, effect, bins, pseudo) for effect in (*EFFECTS, ENERGY) if effect in needed]


def weights(source: TableSource) -> dict[str, np.ndarray]:
    """Return the Dirichlet parameters [K, ...parents], rows and pseudo-counts, of every table that was estimated.

    A table that was set has none; nor has any of an imported network.
    """
    if source.support is None:
        return {}
    parts = [_cause(source, cause, None) for cause in source.causes]
    parts += [_effect(source, effect, {}, None) for effect in source.local if effect not in source.causes]
    return {part.variable: part.counts + part.pseudo for part in parts if part.estimated}


def _cause(source: TableSource, cause: str, pseudo: float | None) -> Factor:
    table = source.causes[cause]
    if cause == PREVIOUS and isinstance(source.counted, PreviousCounts):
        counts = source.counted.pairs.sum(axis=1)
    else:
        pooled = source.pooled if isinstance(source, CountedTables) and source.pooled is not None else source
        counts = pooled.joint.marginal("Gait")
    weights = np.full(counts.shape, _number(source.prior, len(counts), pseudo))
    return Factor(cause, (cause,), None, {}, table, counts, weights, source.gait_prior == "empirical")


def _effect(source: TableSource, effect: str, bins: dict[str, int], pseudo: float | None) -> Factor:
    parents = source.structure.parents(effect)
    counts = source.counts_of(effect)
    fixed = {p: bins[p] for p in parents if p in bins}
    cut = (slice(None), *(fixed.get(p, slice(None)) for p in parents))
    weights = np.broadcast_to(_pseudo(source, effect, pseudo), counts.shape)
    left = tuple(p for p in parents if p not in fixed)
    observed = bins.get(effect)
    axes = left if observed is not None else (effect, *left)
    table = source.local[effect]
    return Factor(effect, axes, observed, fixed, table[cut], counts[cut], weights[cut], True)


def _pseudo(source: TableSource, effect: str, pseudo: float | None) -> np.ndarray | float:
    """Pseudo-counts that broadcast over a table [K, ...parents]."""
    if pseudo is None and (leant := source.local_pseudo(effect)) is not None:
        return leant
    return _number(source.prior, len(source.states[effect]), pseudo)


def _number(prior: float, states: int, pseudo: float | None) -> float:
    """Pseudo-count per cell of a table of so many states."""
    if pseudo is None:
        return prior if prior > 0 else 1.0 / states
    if not check_pseudo_count(pseudo, "pseudo") > 0:
        raise InputError("pseudo is 0: an interval needs a pseudo-count per cell > 0; None takes the model's")
    return float(pseudo)


def pseudo_words(source: TableSource, pseudo: float | None) -> str:
    """Return which pseudo-counts an interval rests on: "pseudo-count 0.5 a cell"."""
    return source.pseudo_words if pseudo is None else f"pseudo-count {pseudo:g} a cell"


def spread(factor: Factor, values: np.ndarray, extra: int = 0) -> np.ndarray:
    """Return ``values`` over the factor's axes with an axis for each of :data:`AXES`, of size 1 where it has none.

    extra: further axes at the end, kept as they are.
    """
    names = sorted(factor.axes, key=AXES.index)
    order = [factor.axes.index(name) for name in names]
    moved = values.transpose(*order, *range(len(order), len(order) + extra))
    sizes = dict(zip(names, moved.shape, strict=False))
    return moved.reshape(*(sizes.get(name, 1) for name in AXES), *moved.shape[len(order) :])


def add_up(joint: np.ndarray) -> np.ndarray:
    """Return log P(Gait, evidence) [G, ...] of logs over :data:`AXES` and further axes: the rest is summed over."""
    hidden = tuple(i for i, name in enumerate(AXES) if name != "Gait" and joint.shape[i] > 1)
    summed = log_sum(joint, hidden) if hidden else joint
    return summed.reshape(joint.shape[AXES.index("Gait")], *joint.shape[len(AXES) :])


def log_sum(logs: np.ndarray, axes: int | tuple[int, ...]) -> np.ndarray:
    """Return log of the sum of exp(logs) along axes, which stay with size 1; -inf where all are."""
    top = logs.max(axis=axes, keepdims=True)
    shift = np.where(np.isfinite(top), top, 0.0)
    shares = logs - shift
    np.exp(shares, out=shares)
    with np.errstate(divide="ignore"):
        total: np.ndarray = np.log(shares.sum(axis=axes, keepdims=True)) + shift
    return total
