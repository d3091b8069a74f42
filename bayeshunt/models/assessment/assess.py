"""Is the model any good? Held-out scores, calibration, tests of its assumption, and other structures.

Every score is k-fold: a row is predicted by tables that have not counted it. Maximum-likelihood tables
would give a new row probability 0 as soon as it lands in a fresh bin, an infinite loss; the tables of an
assessment are therefore smoothed by a Dirichlet prior, the same for every structure.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.config.loading import recorded_gaits
from bayeshunt.core import displays
from bayeshunt.core.arguments import check_fields, checked_but
from bayeshunt.core.bins import Axis, EffectAxes
from bayeshunt.core.checks import check_kind, check_pseudo_count, check_whole
from bayeshunt.core.errors import InputError, did_you_mean, shown
from bayeshunt.core.gaits import Gait, GaitRepertoire
from bayeshunt.data import babbling_table
from bayeshunt.files.parquet import PROVENANCE_KEY
from bayeshunt.models.assessment import scores
from bayeshunt.models.assessment.independence import independence
from bayeshunt.models.assessment.rows import CodedRows, set_aside
from bayeshunt.models.assessment.structures import compare
from bayeshunt.models.assessment.warnings import warnings
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.counting.auto_axes import chosen_axes
from bayeshunt.models.counting.backoff import BackOff, check_strength
from bayeshunt.models.counting.measures import check_rows, measured
from bayeshunt.models.tables.effects import check_size
from bayeshunt.models.tables.structures import (
    NAIVE,
    PREVIOUS,
    PREVIOUS_GAIT,
    STRUCTURES,
    Structure,
    depends_on_previous,
    find_structure,
    strength_of,
)

__all__ = ["PRIOR", "Assessment", "assess"]

#: Bins that know no body.
_ANY_AXES = EffectAxes(Axis.linear("Distance", 1.0), Axis.full_turn("Angle", 1), Axis.full_turn("Heading", 1))
#: Dirichlet pseudo-count per cell of an assessment: about one row's worth in a column of 36 bins.
PRIOR = 0.03


@dataclass(frozen=True, eq=False, repr=False)
class Assessment(displays.Displayed):
    """How good a forward model is on a babbling table. Log-losses are natural, in nats per row.

    settings: rows scored, folds, seed, prior, permutations, bins of each variable, the structure assessed, and the rows
        of back-off (None: none).
    variables: per effect, held-out log_loss and brier, both also for a forecast that ignores the gait; density, the
        log-loss per metre or radian: that of all three together, in nats per m rad2, is in ``structures``.
    reliability: per variable and bin of the forecast: count, mean forecast, share observed.
    gaits: held-out accuracy, log_loss and brier of P(Gait | Distance, Angle), the inverse model, and
        accuracy_with_heading.
    confusion: rows executed, columns inferred from Distance and Angle, counts.
    independence: tests that effects are independent given the gait; see ``assess_independence``.
    structures: held-out log_loss, bic and parameters of each structure; see ``assess_structures``.
    found: structure name -> Structure fitted to all rows.
    given: scores of the model given, its own tables on these rows; None if none was given.
    notes: what a reader has to know besides.
    """

    settings: dict[str, Any]
    variables: pd.DataFrame
    reliability: pd.DataFrame
    gaits: dict[str, float]
    confusion: pd.DataFrame
    independence: pd.DataFrame
    structures: pd.DataFrame
    found: dict[str, Structure]
    given: dict[str, Any] | None
    notes: tuple[str, ...]

    def __post_init__(self) -> None:
        check_fields(self)

    def __repr__(self) -> str:
        facts, best = self.settings, self.structures["log_loss"].idxmin()
        return f"<Assessment: {facts['rows']} rows, {facts['folds']} folds, best structure {best}>"

    def to_dict(self) -> dict[str, Any]:
        """Return everything as plain values for JSON; a number that is not finite is None."""
        tables = {
            "variables": self.variables.reset_index().to_dict("records"),
            "reliability": self.reliability.to_dict("records"),
            "gaits": self.gaits,
            "confusion": {str(k): row for k, row in self.confusion.to_dict("index").items()},
            "independence": self.independence.to_dict("records"),
            "structures": self.structures.reset_index().to_dict("records"),
            "edges": {name: [list(edge) for edge in s.edges] for name, s in self.found.items()},
        }
        found: dict[str, Any] = _plain(
            {"settings": self.settings, **tables, "given": self.given, "notes": list(self.notes)}
        )
        return found


@checked_but("frame", "structures", "model")
def assess(
    frame: pd.DataFrame,
    gaits: Iterable[Gait | str] | GaitRepertoire | None = None,
    *,
    model: ForwardModel | None = None,
    folds: int = 5,
    seed: int = 0,
    prior: float = PRIOR,
    axes: EffectAxes | str | None = None,
    structures: Sequence[str] | None = None,
    permutations: int = 999,
    backoff: BackOff = "auto",
) -> Assessment:
    """Assess the forward model that ``frame`` gives, and compare the paper's structure with others.

    frame: a babbling table. gaits: the repertoire; by default the model's or the recorded robot's.
    model: its gaits, bins and structure are assessed, and its own tables are scored on ``frame`` too.
    folds: 2 to the number of rows. seed: of the folds and the shuffles; same seed, same numbers.
    prior: Dirichlet pseudo-count per cell of every table that is fitted here, >= 0.
    axes: bins; by default the model's or ``EffectAxes.standard``; "auto": those of the highest held-out density.
        Coarser bins make sparse structures comparable; log-losses of different bins are not, densities are.
    structures: names, compared with "naive"; by default all that the table allows.
    permutations: shuffles of each independence test, >= 1.
    backoff: rows > 0 that a gait's own table is worth in each after another gait; by default the model's, if it depends
        on the gait before, else 5; None: the prior alone.

    ``notes`` begin with a warning where the tables foresee rows worse than ignoring the gait does, and where other bins
    would foresee them much better. A single row absurdly far out is left out and named in ``notes``, as is a structure
    whose tables would be too large. Raises DataError for a table that is not one, InputError for settings out of range.
    """
    _check(model, axes, seed, prior, permutations, structures)
    strength = _strength(backoff, model)
    babbling_table.validate(frame)
    repertoire = _repertoire(frame, gaits, model)
    frame, of_residuals = _as_counted(frame, model)
    grid = chosen_axes(axes, frame, repertoire)
    grid = grid or (model.axes if model is not None else EffectAxes.standard(repertoire.body_length))
    scored, aside = set_aside(frame, grid)
    rows = CodedRows.of(scored, repertoire, grid)
    if model is not None and depends_on_previous(model.structure) and not rows.has_previous:
        raise InputError("the model depends on the gait before, and the table has no column previous_gait")
    others, notes = _others(rows, structures)
    for_folds, for_shuffles = np.random.SeedSequence(seed).spawn(2)
    fold = rows.folds(folds, np.random.default_rng(for_folds))
    naive = scores.held_out(rows, NAIVE, fold, prior, every_score=True)
    comparison, found = compare(rows, others, fold, prior, naive, strength)
    structure = NAIVE if model is None else model.structure
    predicted = naive
    if not structure.is_naive:
        predicted = scores.held_out(rows, structure, fold, prior, backoff=strength, every_score=True)
    blind = scores.gait_blind(rows, fold, prior)
    variables = scores.variable_scores(rows, predicted, blind)
    gains = scores.gains_of_gait(rows, predicted, blind)
    return Assessment(
        settings={
            "rows": len(scored), "folds": int(folds), "seed": int(seed), "prior": float(prior),
            "permutations": int(permutations), "bins": {axis.name: axis.bins for axis in rows.axes},
            "structure": structure.name, "backoff": strength,
        },
        variables=variables,
        reliability=scores.reliability(rows, predicted),
        gaits=_gait_scores(rows, predicted),
        confusion=scores.confusion(rows, predicted.gaits),
        independence=independence(rows, permutations, for_shuffles),
        structures=comparison,
        found=found,
        given=None if model is None else _given(model, frame, rows),
        notes=(*aside, *warnings(scored, rows, variables, gains), *of_residuals, *notes),
    )  # fmt: skip


def _strength(backoff: BackOff, model: ForwardModel | None) -> float | None:
    """Rows of back-off of the tables after another gait: those of a model that has such tables, else the usual."""
    if backoff == "auto" and model is not None and model.has_counts and depends_on_previous(model.structure):
        return model.backoff
    strength = strength_of(backoff, PREVIOUS_GAIT)
    return None if strength is None else check_strength(strength)


def _as_counted(frame: pd.DataFrame, model: ForwardModel | None) -> tuple[pd.DataFrame, list[str]]:
    """The rows as the model counts them, and what to say of that."""
    motion = None if model is None else model.source.residual_of
    if model is None or motion is None:
        return frame, []
    return model.source.recast(frame), [
        f"Scored is what the fitted {motion} misses: the losses do not compare with those of poses (see score)."
    ]


def _gait_scores(rows: CodedRows, predicted: scores.HeldOut) -> dict[str, float]:
    executed = rows.column("Gait")
    facts = {
        "accuracy": scores.accuracy(rows, predicted.gaits),
        "log_loss": scores.log_loss(predicted.gaits, executed),
        "brier": scores.brier(predicted.gaits, executed),
    }
    if predicted.gaits_with_heading is not None:
        facts["accuracy_with_heading"] = scores.accuracy(rows, predicted.gaits_with_heading)
    return facts


def _given(model: ForwardModel, frame: pd.DataFrame, rows: CodedRows) -> dict[str, Any]:
    """Scores of a model's own tables: held out only if it has not counted these rows; None where nobody knows."""
    counted = type(model.source.counted).of(frame, model.gaits, model.axes) if model.has_counts else None
    probability = _own_probability(model, rows)
    possible = probability > 0
    with np.errstate(divide="ignore"):
        log_loss = float(-np.log(probability).mean())
    return {
        "structure": model.structure.name,
        "prior": model.prior if model.has_counts else None,
        "log_loss": log_loss,
        "impossible": int((~possible).sum()),
        "log_loss_of_possible": float(-np.log(probability[possible]).mean()) if possible.any() else math.nan,
        "same_rows": model.source.counted == counted if model.has_counts else None,
    }


def _own_probability(model: ForwardModel, rows: CodedRows) -> np.ndarray:
    """P(Distance, Angle, Heading | Gait) [N] of each row, given the gait before as well if the model depends on it."""
    seen, names = rows.codes[:, -4:], model.gaits.names
    inside = seen[:, 1] < model.axes.distance.bins
    before = rows.column(PREVIOUS) if depends_on_previous(model.structure) else np.full(len(seen), len(names))
    chosen = model.probabilities("Gait")
    probability = np.zeros(len(seen))
    for state in np.unique(before[inside]).tolist():
        mine = inside & (before == state)
        gait, *bins = seen[mine].T
        joint = model.after(names[state] if state < len(names) else None).evidence(*bins)
        # a gait of probability 0 does nothing
        joint = np.divide(joint, chosen, out=np.zeros_like(joint), where=chosen > 0)
        probability[mine] = joint[np.arange(len(joint)), gait]
    return probability


def _repertoire(frame: pd.DataFrame, gaits: Any, model: ForwardModel | None) -> GaitRepertoire:
    record = frame.attrs.get(PROVENANCE_KEY, {})
    if model is not None:
        check_rows(model.gaits, model.provenance, record)
    if gaits is not None:
        return measured(gaits, _ANY_AXES, record)[0]
    if model is not None:
        return model.gaits
    if not {"robot", "repertoire"} & set(record):
        raise InputError("the table does not say which robot made it; give its gaits: assess(frame, robot.gaits)")
    return recorded_gaits(frame)


def _others(rows: CodedRows, structures: Sequence[str] | None) -> tuple[list[str], list[str]]:
    """The structures to compare with the paper's, and what to say about those left out."""
    for name in structures or ():
        if name not in STRUCTURES:
            raise InputError(f"unknown structure {name!r}{did_you_mean(name, STRUCTURES)}")
    if structures is not None and "previous_gait" in structures and not rows.has_previous:
        raise InputError("structure 'previous_gait': the table has no column previous_gait")
    kept, notes = [name for name in STRUCTURES if name != "naive" and (structures is None or name in structures)], []
    if not rows.has_previous:
        kept = [name for name in kept if name != "previous_gait"]
        notes.append("The table does not say which gait went before, so previous_gait is left out.")
    if structures is not None:
        return kept, notes
    counted = rows.count()
    for name in [name for name in kept if name != "learned"]:  # whose search looks at tables of all sizes
        try:
            check_size(find_structure(name, counted), counted)
        except InputError as error:
            kept.remove(name)
            notes.append(f"{name} is left out: {error}.")
    return kept, notes


def _check(
    model: ForwardModel | None, axes: EffectAxes | str | None, seed: Any, prior: Any, permutations: Any, structures: Any
) -> None:
    if model is not None:
        check_kind(model, "model", ForwardModel, "a ForwardModel")
    if axes is not None and axes != "auto":
        check_kind(axes, "axes", EffectAxes, "an EffectAxes, such as EffectAxes.standard(0.057)")
    if structures is not None and (isinstance(structures, str) or not isinstance(structures, Sequence)):
        raise InputError(f"structures: expected a list of names, such as ['tan'], got {shown(structures)}")
    if model is not None and axes is not None:
        raise InputError("give a model or axes, not both: the model brings its own bins")
    for name, value, least in (("seed", seed, 0), ("permutations", permutations, 1)):
        check_whole(value, name, least)
    check_pseudo_count(prior, "prior")


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(key): _plain(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(inner) for inner in value]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value
