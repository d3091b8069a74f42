"""Exercises that check themselves: ``check(1, conditional)`` says whether an answer is right, or what is wrong with it.

Answers are compared with what bayeshunt says of the same babbled table, on data that the exercise has not shown.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import pandas as pd

import bayeshunt as bh

__all__ = ["Verdict", "check", "sliders"]


@dataclass(frozen=True)
class Verdict:
    """What the check says; it shows itself at the end of a cell."""

    number: int
    right: bool
    said: str

    def __repr__(self) -> str:
        return f"Exercise {self.number!r}: {'right. ' if self.right else 'not yet. '}{self.said}"


def check(number: int, answer: Callable[..., Any]) -> Verdict:
    """Try an answer to an exercise; never raises, so that a notebook with open exercises runs to its end."""
    if number not in list(_EXERCISES):  # compared, not looked up: it may be anything
        return Verdict(number, False, f"there is no such exercise; they are the numbers 1 to {max(_EXERCISES)}.")
    arguments, expected, hint, praise = _EXERCISES[number]()
    try:
        got = answer(*arguments)
    except Exception as error:  # a student's code may do anything
        return Verdict(number, False, f"it raised {type(error).__name__}: {error}")
    if got is None or got is ...:
        return Verdict(number, False, "it returned nothing.")
    try:
        a, b = np.asarray(got, float), np.asarray(expected, float)
    except (TypeError, ValueError):
        return Verdict(number, False, f"expected numbers, got a {type(got).__name__}.")
    if a.shape != b.shape:
        return Verdict(
            number, False, f"expected the shape {b.shape or 'of one number'}, got {a.shape or 'one number'}."
        )
    if np.allclose(a, b, atol=1e-9):
        return Verdict(number, True, praise)
    if b.ndim and np.allclose(a, 100 * b, rtol=0, atol=0.5):  # rounded, perhaps
        return Verdict(number, False, "That is in percent, a hundred times too large: probabilities sum to 1.")
    return Verdict(number, False, hint(a))


@cache
def _babbled() -> tuple[pd.DataFrame, bh.ForwardModel]:
    """Another robot's experience than the exercises show."""
    robot = bh.load_robot("car")
    frame = bh.babble(robot, 450, seed=7)
    return frame, bh.ForwardModel.fit(frame, robot.gaits)


def _gait_prior(model: bh.ForwardModel) -> pd.Series:
    """An uneven P(Gait), so that a forgotten prior shows."""
    weights = np.arange(1.0, len(model.gaits) + 1)
    return pd.Series(weights / weights.sum(), index=model.gaits.names)


def _conditional() -> tuple[Any, ...]:
    _, model = _babbled()

    def hint(got: np.ndarray) -> str:
        if np.isclose(got.sum(), 1):
            return "All cells together sum to 1: that is P(Distance, Gait). Divide every column by its own sum."
        if np.allclose(got.sum(axis=1), 1):
            return "The rows sum to 1: that is P(Gait | Distance). Which of the two did the robot choose?"
        return "Every column must sum to 1: one distribution for each gait."

    return (model.counts("Distance"),), model.cpt("Distance"), hint, "Each column is a distribution."


def _total() -> tuple[Any, ...]:
    _, model = _babbled()
    table, prior = model.cpt("Distance"), _gait_prior(model)

    def hint(got: np.ndarray) -> str:
        if np.allclose(got, table.mean(axis=1)):
            return "That is the plain mean over gaits: weigh each column by how probable its gait is."
        return "Sum over gaits of P(Distance | gait) P(gait)."

    return (table, prior), (table * prior).sum(axis=1), hint, "The law of total probability: it sums to 1 by itself."


def _bayes() -> tuple[Any, ...]:
    _, model = _babbled()
    table, prior = model.cpt("Distance"), _gait_prior(model)
    seen = str(table.mean(axis=1).idxmax())
    joint = table.loc[seen] * prior

    def hint(got: np.ndarray) -> str:
        if np.allclose(got, joint):
            return "That is P(Gait, Distance = seen). Divide by its sum, P(Distance = seen)."
        if np.allclose(got, table.loc[seen] / table.loc[seen].sum()):
            return "You took all gaits to be equally probable. Multiply the likelihood by P(Gait) first."
        return "Likelihood times prior, divided by the sum over gaits."

    return (table, prior, seen), joint / joint.sum(), hint, "Bayes' rule. The robot asks exactly this at every step."


def _naive() -> tuple[Any, ...]:
    _, model = _babbled()
    distance, angle = float(model.axes.distance.centres[5]), 0.0
    answer = bh.InverseModel(model).posterior(distance=distance, angle=angle)
    likelihoods = (
        model.cpt("Distance").loc[answer.cell.distance_label],
        model.cpt("Angle").loc[answer.cell.angle_label],
    )
    uniform = pd.Series(1 / len(model.gaits), index=model.gaits.names)

    def hint(got: np.ndarray) -> str:
        total = likelihoods[0] + likelihoods[1]
        if np.allclose(got, total / total.sum()):
            return "You added what the two say. Independent evidence multiplies."
        return "P(Gait) P(Distance | Gait) P(Angle | Gait), then divide by the sum over gaits."

    said = "The same as bh.InverseModel(model).posterior(distance, angle)."
    return (uniform, *likelihoods), answer.probabilities, hint, said


def _prior() -> tuple[Any, ...]:
    frame, model = _babbled()
    careful = bh.ForwardModel.fit(frame, model.gaits, prior=0.5)

    def hint(got: np.ndarray) -> str:
        if not np.allclose(got.sum(axis=0), 1):
            return "The columns no longer sum to 1: the denominator gets the prior once for every cell of the column."
        return "Add the prior to every count, the empty ones too, before you divide."

    return (model.counts("Heading"), 0.5), careful.cpt("Heading"), hint, "Never seen is no longer impossible."


def _information() -> tuple[Any, ...]:
    table = pd.DataFrame([[30.0, 5, 0], [4, 20, 6], [1, 4, 30]])
    p = table.to_numpy() / table.to_numpy().sum()

    def entropy(q: np.ndarray) -> float:
        q = q[q > 0]
        return float(-(q * np.log2(q)).sum())

    expected = entropy(p.sum(0)) + entropy(p.sum(1)) - entropy(p.ravel())

    def hint(got: np.ndarray) -> str:
        if np.isnan(got):
            return "An empty cell gives 0 log 0, which counts as 0: leave such cells out."
        if np.isclose(got, expected * np.log(2)):
            return "That is in nats. Take the logarithm to base 2 for bits."
        return "Sum over cells of p(x, y) log2 of p(x, y) / (p(x) p(y)), with p the counts divided by their total."

    return (table,), expected, hint, "0 bits would be independence, which the naive network assumes given the gait."


def _log_loss() -> tuple[Any, ...]:
    p = np.array([0.9, 0.5, 0.25, 0.05])
    expected = -np.log(p).mean()

    def hint(got: np.ndarray) -> str:
        if np.isclose(got, -expected):
            return "A loss is better when smaller: mind the sign."
        if np.isclose(got, expected * len(p)):
            return "That is the sum over rows; models are compared by the mean of a row."
        return "Minus the mean of ln P(what happened)."

    said = "Surprise, in nats. Held-out rows decide which structure is worth its arrows."
    return (p,), expected, hint, said


_EXERCISES: dict[int, Callable[[], tuple[Any, ...]]] = {
    1: _conditional, 2: _total, 3: _bayes, 4: _naive, 5: _prior, 6: _information, 7: _log_loss,
}  # fmt: skip


def sliders(draw: Callable[..., Any]) -> Any:
    """Knobs for ``draw(prior, bins, structure)``, which returns a figure; needs the extra ``notebook``."""
    import ipywidgets as widgets

    shown = widgets.interactive(
        draw,
        prior=widgets.SelectionSlider(options=[0.0, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0], value=0.03, description="prior"),
        bins=widgets.IntSlider(36, min=8, max=72, step=4, description="bins", continuous_update=False),
        structure=widgets.ToggleButtons(options=["naive", "tan", "joint"], description="structure"),
    )
    shown.auto_display = True  # what draw returns, not only what it prints
    shown.update()
    return shown
