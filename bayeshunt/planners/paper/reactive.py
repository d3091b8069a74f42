"""The paper's reactive hunter: the gait most probable to have led to where the prey is now."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.geometry import Polar
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel
from bayeshunt.models.certainty.factors import check_counted
from bayeshunt.planners.api import Plan, Shown, Situation
from bayeshunt.planners.requests import check_request

__all__ = ["ReactivePlanner", "aim"]


class ReactivePlanner(Shown):
    """argmax of P(Gait | Distance, Angle) at the prey's present position (paper, reactive model).

    In a model of structure "previous_gait", given the gait just executed as well. A tie goes to the
    first gait in table order. ``rng`` is not used.
    """

    name = "reactive"

    def __init__(self, model: ForwardModel) -> None:
        self.inverse = InverseModel(model)
        self.hunter = model.gaits
        self.gaits = tuple(model.gaits.names)

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Return the gait of highest posterior at the prey's present position."""
        situation = check_request(situation, rng, self.hunter)
        inverse = self.inverse.after(situation.previous_gait)
        return aim(inverse, self.gaits, situation.prey, situation.interval)


def aim(
    inverse: InverseModel, gaits: tuple[str, ...], target: Polar, interval: float | None = None, **known: Any
) -> Plan:
    """Return the plan to execute the gait of highest posterior at ``target``.

    interval: level of the intervals of the posterior that the trace is to have; None: none.
    known: further Plan fields (``prey_known``, ``predicted_prey``).
    Raises InputError if intervals are asked of an imported network.
    """
    if interval is not None:
        check_counted(inverse.model.source)
    distance, angle = float(target.distance), float(target.angle)
    answer = inverse.posterior(distance, angle)
    posterior = answer.values
    best = int(posterior.argmax())  # the first of equals
    aimed_at = Polar(distance, angle, float(target.heading))
    return Plan(
        gait=gaits[best],
        gaits=(gaits[best],),
        value=float(posterior[best]),
        objective="posterior probability of the gait",
        nodes=len(gaits),
        make_trace=partial(_trace, gaits, answer, aimed_at, best, interval),
        target=aimed_at,
        evidence_probability=answer.evidence_probability,
        support=answer.support,
        posterior=posterior,
        answer=answer,
        **known,
    )


def _trace(gaits: tuple[str, ...], answer: Any, target: Polar, best: int, interval: float | None) -> pd.DataFrame:
    """One row per gait: its posterior, where asked its interval, and the learned cell that all of them share."""
    cell = answer.cell
    ends = {} if interval is None else answer.interval(interval)[["low", "high"]].to_dict("list")
    unknown = pd.array([None] * len(gaits), dtype="Int64")  # an imported network carries no counts
    return pd.DataFrame(
        {
            "node": np.arange(len(gaits)),
            "gait": list(gaits),
            "posterior": answer.values,
            **ends,
            "evidence_probability": answer.evidence_probability,
            "support": unknown if answer.support is None else answer.support,
            "target_distance": target.distance,
            "target_angle": target.angle,
            "cell_distance": cell.distance,
            "cell_angle": cell.angle,
            "distance_bin": cell.distance_bin,
            "angle_bin": cell.angle_bin,
            "chosen": np.arange(len(gaits)) == best,
        }
    )
