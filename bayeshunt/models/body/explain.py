"""What each variable said: the log-odds of a gait as a sum of prior, Distance, Angle and Heading.

Naive Bayes multiplies, so its log-odds add (I. J. Good, Probability and the Weighing of Evidence, 1950):
``log P(g|e)/P(r|e) = log P(g)/P(r) + sum_v log P(v|g)/P(v|r)``, for a gait g, its reference r and the
bins v of the evidence e. In other structures each part is what the variable says given those before
it: ``log P(Distance | g)``, ``log P(Angle | Distance, g)``, ``log P(Heading | Distance, Angle, g)``.
"""

from __future__ import annotations

import numpy as np
import pandas as pd

from bayeshunt.core.bins import EFFECTS, ENERGY
from bayeshunt.core.errors import InputError
from bayeshunt.models.body.forward import ForwardModel

__all__ = ["PARTS", "RIVAL", "explain", "log_terms"]

#: Bin numbers of Distance, Angle and Heading; None for what was not asked.
Bins = tuple[int, int, int | None]
#: The reference that compares each gait with the best of the others.
RIVAL = "rival"
#: The parts of the sum, in the order of the columns.
PARTS = ("prior", *EFFECTS)


def explain(
    model: ForwardModel, bins: Bins, values: np.ndarray, reference: str = RIVAL, energy: int | None = None
) -> pd.DataFrame:
    """Return the parts of each gait's log-odds, one row per gait; see ``Posterior.explain``.

    bins: the evidence; energy: its bin of Energy, None where that was not asked. values: P(Gait | evidence) [G] under
    the model.
    """
    gaits = model.gaits.names
    if len(gaits) < 2:
        raise InputError("there is only one gait, so there is nothing to compare it with")
    terms = log_terms(model, bins, energy)
    rivals = _rivals(values, terms) if reference == RIVAL else np.full(len(gaits), model.gaits.index(reference))
    if reference != RIVAL and not values[rivals[0]] > 0:
        raise InputError(
            f"gait {reference!r} has probability 0 here; compare with "
            f"{gaits[int(np.argmax(values))]!r}, or with the rival"
        )
    parts = {name: _difference(logs, rivals) for name, logs in terms.items()}
    # Computed from the posterior itself, so that the sum of the parts can be checked against it.
    log_odds = _difference(_log(values), rivals)
    index = pd.Index(gaits, name="Gait")
    columns = {"probability": values, "reference": [gaits[r] for r in rivals], **parts, "log_odds": log_odds}
    return pd.DataFrame(columns, index=index)


def log_terms(model: ForwardModel, bins: Bins, energy: int | None = None) -> dict[str, np.ndarray]:
    """Return log P(g) and log P(v | g) [G] of each part, natural logarithm; 0 for what was not asked."""
    terms = _pose_terms(model, bins)
    if model.structure.has_energy:
        before = model.evidence(*bins)
        after = before if energy is None else model.evidence(*bins, energy)
        terms[ENERGY] = np.where(before > 0, _log(after) - _log(np.where(before > 0, before, 1.0)), 0.0)
    return terms


def _pose_terms(model: ForwardModel, bins: Bins) -> dict[str, np.ndarray]:
    """The terms of place and heading."""
    if not model.structure.is_naive:
        return _chain_terms(model, bins)
    p = model.probabilities
    terms = {"prior": _log(p("Gait"))}
    for effect, row in zip(EFFECTS, bins, strict=True):
        terms[effect] = np.zeros(len(model.gaits)) if row is None else _log(p(effect)[row])
    return terms


def _chain_terms(model: ForwardModel, bins: Bins) -> dict[str, np.ndarray]:
    """The terms of the chain rule: each is the growth of log P(g, evidence) by one more variable."""
    prior, (distance, angle, heading) = model.probabilities("Gait"), bins
    known = [prior, prior * model.probabilities("Distance")[distance], model.evidence(distance, angle)]
    if heading is not None:
        known.append(model.evidence(distance, angle, heading))
    terms = {"prior": _log(prior), **{effect: np.zeros(len(prior)) for effect in EFFECTS}}
    for effect, before, after in zip(EFFECTS, known, known[1:], strict=False):
        # Once a gait is ruled out, no further variable has anything to add.
        terms[effect] = np.where(before > 0, _log(after) - _log(np.where(before > 0, before, 1.0)), 0.0)
    return terms


def _rivals(values: np.ndarray, terms: dict[str, np.ndarray]) -> np.ndarray:
    """Index [G] of the most probable gait other than each gait (ties: first in table order).

    Where the others all have probability 0, the rival of the best is the one ruled out by fewest parts.
    """
    best = int(np.argmax(values))
    logs = np.stack(list(terms.values()))  # [parts, G]
    ruled_out = np.isneginf(logs)
    rest = np.where(ruled_out, 0.0, logs).sum(axis=0)
    others = (g for g in range(len(values)) if g != best)
    rivals = np.full(len(values), best)
    rivals[best] = max(others, key=lambda g: (values[g], -ruled_out[:, g].sum(), rest[g]))
    return rivals


def _difference(terms: np.ndarray, rivals: np.ndarray) -> np.ndarray:
    """``terms[g] - terms[r(g)]`` [G]; 0 for a gait compared with itself.

    Of the two gaits compared one has P > 0, hence finite terms: inf - inf cannot occur.
    """
    own = np.arange(len(terms)) == rivals
    with np.errstate(invalid="ignore"):
        return np.where(own, 0.0, terms - terms[rivals])


def _log(probabilities: np.ndarray) -> np.ndarray:
    with np.errstate(divide="ignore"):
        found: np.ndarray = np.log(probabilities)
        return found
