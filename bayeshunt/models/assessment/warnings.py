"""What an assessment warns of: tables that foresee rows worse than no table would, and bins that cost."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from bayeshunt.core.bins import EFFECTS, Axis, EffectAxes
from bayeshunt.core.units import degrees, length
from bayeshunt.models.assessment.rows import CodedRows
from bayeshunt.models.counting.auto_axes import auto_axes, density_losses

__all__ = ["is_grave", "warnings"]

#: Stands in a warning that the gait makes predictions worse, and in no other note.
_GRAVE = "WORSE"
#: Bins that foresee a row by this many nats better are worth saying.
_WORTH = 0.5
#: Nats a row: a loss beyond the first is said whatever the interval, one below the last is none.
_OVERLOOKED, _Z, _NOTHING = 0.05, 1.96, 0.01
#: More rows than this tell no more of bins.
_MOST_ROWS = 20_000


def warnings(frame: pd.DataFrame, rows: CodedRows, variables: pd.DataFrame, gains: np.ndarray) -> list[str]:
    """Return what to warn of, a line each: variables that the gait makes worse, and bins that do better.

    frame: the rows, as coded in ``rows``. variables: their scores, see ``scores.variable_scores``. gains: nats [N, 3]
    that the gait gained in each row.
    """
    loss, blind = variables["log_loss"], variables["log_loss_without_gait"]
    said = [
        f"{name} is foreseen {_GRAVE} than ignoring the gait: {loss[name]:.2f} nats a row against {blind[name]:.2f}; "
        "more rows, fewer gaits or wider bins would help."
        for name, gain in zip(EFFECTS, gains.T, strict=True)
        if _costs(gain)
    ]
    if _costs(gains.sum(axis=1)):
        said.insert(0, f"The model is {_GRAVE} than ignoring the gait: {loss.sum():.2f} nats a row against "
                       f"{blind.sum():.2f}; do not use it with these bins.")  # fmt: skip
    better = _better_bins(frame, rows)
    return [*said, better] if better and (said or not better.startswith("Finer")) else said


def is_grave(note: str) -> bool:
    """Return whether a note of an assessment warns that the gait makes predictions worse: it comes first, in red."""
    return _GRAVE in note


def _costs(gain: np.ndarray) -> bool:
    """Whether the gait costs: by more than chance (95 %), or by more than can be overlooked."""
    with np.errstate(invalid="ignore"):  # a row of probability 0 costs without end
        mean, error = float(gain.mean()), float(gain.std()) / math.sqrt(len(gain))
    return mean < -_OVERLOOKED or mean < min(-_Z * error, -_NOTHING)


def _better_bins(frame: pd.DataFrame, rows: CodedRows) -> str:
    """What bins chosen by the data would gain, if it is much."""
    if len(frame) > _MOST_ROWS:
        frame = frame.iloc[:_MOST_ROWS]
    codes = rows.column("Gait")[: len(frame)]
    chosen = auto_axes(frame, rows.gaits)
    gain = _density(frame, codes, rows.axes) - _density(frame, codes, chosen)
    if not gain >= _WORTH:
        return ""
    finer = all(new.width <= old.width for new, old in zip(chosen, rows.axes, strict=True))
    kind = "Finer" if finer else "Other"
    return f"{kind} bins foresee a row by {gain:.2f} nats better: {_words(chosen)} (axes='auto', --auto-bins)."


def _density(frame: pd.DataFrame, codes: np.ndarray, axes: EffectAxes) -> float:
    """Held-out density log-loss of a row [nats per m rad2]."""
    return sum(density_losses(frame[axis.name.lower()].to_numpy(dtype=float), codes, axis) for axis in axes)


def _words(axes: EffectAxes) -> str:
    return ", ".join(f"{axis.name} {_width(axis)}" for axis in axes)


def _width(axis: Axis) -> str:
    return degrees(axis.width) if axis.circular else length(axis.width)
