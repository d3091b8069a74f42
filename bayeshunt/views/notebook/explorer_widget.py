"""The widget behind :mod:`bayeshunt.views.notebook.explorer`; importing it needs anywidget."""

from __future__ import annotations

import math
from typing import Any

import anywidget
import numpy as np
import traitlets

from bayeshunt.core import displays
from bayeshunt.core.errors import InputError
from bayeshunt.core.units import bounds, label, true_minus
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel
from bayeshunt.models.body.posterior import Posterior
from bayeshunt.views import grounds, theme
from bayeshunt.views.opened import opened
from bayeshunt.views.pages.page import asset, number

__all__ = ["Explorer", "outcome_table"]

#: Outcomes less probable than this share of the most probable one are not drawn.
_FAINT = 0.01
#: At most so many outcomes are drawn.
_MOST = 400


class Explorer(anywidget.AnyWidget):
    """An interactive look at P(Gait | Distance, Angle): drag the target, or move it with the arrow keys.

    The picture shows the robot from above, facing up, with the mean path of every gait (the more
    probable, the stronger), the learned cell that answers, and where the robot would end up if it
    drew its gait from the posterior: P(Distance, Angle) = sum over gaits of
    P(Distance, Angle | Gait) P(Gait | target).

    model: a fitted forward model, or its inverse. distance [m] and angle [rad, clockwise]: the
    target; setting them moves it. Raises InputError for a target out of range or another model.
    """

    _esm = asset("dom.js") + asset("units.js") + asset("trace.js") + asset("explorer.js")
    _css = theme.palette(".bh-explorer") + asset("explorer.css") + asset("trace.css")

    distance = traitlets.Float(0.10).tag(sync=True)  # metres, >= 0
    angle = traitlets.Float(0.5).tag(sync=True)  # radians, clockwise
    _scene = traitlets.Dict().tag(sync=True)  # what does not move
    _answer = traitlets.Dict().tag(sync=True)  # what moves with the target

    def __init__(self, model: ForwardModel | InverseModel, distance: float = 0.10, angle: float = 0.5) -> None:
        if not isinstance(model, (ForwardModel, InverseModel)):
            raise InputError(f"the explorer needs a ForwardModel or an InverseModel, got {type(model).__name__}")
        inverse = model if isinstance(model, InverseModel) else InverseModel(model)
        self.inverse = inverse
        _check(distance, angle)
        super().__init__(
            distance=float(distance),
            angle=float(angle),
            _scene=_scene(inverse),
            _answer=_describe(inverse, inverse.posterior(distance, angle)),
        )
        self.observe(self._ask, names=["distance", "angle"])

    def _repr_mimebundle_(self, **options: Any) -> Any:
        """The widget, and for readers without a kernel (GitHub, nbviewer, a printed page) its present answer."""
        bundle = super()._repr_mimebundle_(**options)
        if bundle is None:
            return None
        data, metadata = bundle
        shown = displays.to_html(self.answer)
        return {**data, "text/plain": str(self.answer), **({"text/html": shown} if shown else {})}, metadata

    @property
    def answer(self) -> Posterior:
        """The inverse model's answer for the present target."""
        return self.inverse.posterior(self.distance, self.angle)

    @traitlets.validate("distance", "angle")
    def _in_range(self, proposal: Any) -> float:
        value = float(proposal["value"])
        _check(value, 0.0) if proposal["trait"].name == "distance" else _check(0.0, value)
        return value

    def _ask(self, _: Any) -> None:
        self._answer = _describe(self.inverse, self.answer)


def _check(distance: float, angle: float) -> None:
    if not (0.0 <= distance < math.inf and math.isfinite(angle)):
        raise InputError(f"target ({distance}, {angle}): expected distance >= 0 [m] and a finite angle [rad]")


def _scene(inverse: InverseModel) -> dict[str, Any]:
    """The robot, its gaits' mean paths [forward, right] in metres, and the cells that can answer.

    cells: [distance bin, angle bin, support], the support None where nobody knows.
    """
    model, table = inverse.model, inverse.table()
    axes, counted = model.axes, model.has_counts
    cells = [
        [int(axes.distance.index(float(d))), int(axes.angle.index(float(a))), int(support) if counted else None]
        for d, a, support in zip(table["distance"], table["angle"], table["support"], strict=True)
    ]
    return {
        "gaits": list(model.gaits.names),
        "paths": [_path(model, gait) for gait in range(len(model.gaits))],
        "cells": cells,
        "counted": counted,
        "radius": (model.gaits.body_length or 0.0) / 2,
        "distance_width": axes.distance.width,
        "angle_bins": axes.angle.bins,
        "reach": axes.distance.edges[-1].item(),
        "duration": model.gaits.duration,
    }


def _path(model: ForwardModel, gait: int) -> list[list[float | None]]:
    """Points [forward, right] of a gait's mean path; its end alone where no path was babbled; none if never babbled."""
    if model.has_counts and not model.joint.marginal("Gait")[gait]:
        return []
    if model.mean_paths is not None:
        return [[number(v, 4) for v in pose[:2]] for pose in model.mean_paths[gait].tolist()]
    end = model.predict(model.gaits[gait])
    return [[0.0, 0.0], [number(end.forward, 4), number(end.right, 4)]]


def _describe(inverse: InverseModel, answer: Posterior) -> dict[str, Any]:
    """The answer as plain values: full precision where it is read, four digits where it is drawn."""
    return {
        "probabilities": answer.values.tolist(),
        "best": answer.best,
        "evidence_probability": answer.evidence_probability,
        "support": answer.support,
        "rows": grounds.support(answer),
        **_certainty(answer),
        "snapped": answer.snapped,
        "cell": [answer.cell.distance_bin, answer.cell.angle_bin],
        "labels": [true_minus(label(name)) for name in (answer.cell.distance_label, answer.cell.angle_label)],
        "outcomes": _outcomes(inverse, answer),
        "opened": opened(answer),
    }


def _certainty(answer: Posterior) -> dict[str, Any]:
    """Low and high end of each probability's interval, and in words how sure the answer is; None where nobody knows."""
    found = grounds.interval(answer)
    if found is None:
        return {"within": None, "sure": None}
    within = [[low, high, bounds(low, high)] for low, high in grounds.within(found).values()]
    return {"within": within, "sure": grounds.how_sure(answer, found)}


def _outcomes(inverse: InverseModel, answer: Posterior) -> list[list[float | None]]:
    """The most probable [distance bin, angle bin, P(Distance, Angle)] if the gait is drawn from the posterior."""
    joint = outcome_table(inverse, answer)
    chosen = np.argwhere(joint > _FAINT * joint.max())
    order = np.argsort(-joint[tuple(chosen.T)], kind="stable")[:_MOST]
    return [[int(d), int(a), number(joint[d, a], 4)] for d, a in chosen[order]]


def outcome_table(inverse: InverseModel, answer: Posterior) -> np.ndarray:
    """Return P(Distance, Angle) [K, A] of one step whose gait is drawn from ``answer``.

    ``P(D, A) = sum_g P(D, A | g) P(g | target)``, with ``P(D, A | g) = P(g, D, A) / P(g)``.
    """
    model = inverse.model
    distance, angle = (np.arange(axis.bins) for axis in (model.axes.distance, model.axes.angle))
    joint = model.evidence(distance[:, None], angle[None, :])  # [K, A, G]
    gaits = model.probabilities("Gait")
    weights = np.divide(answer.values, gaits, out=np.zeros_like(gaits), where=gaits > 0)
    found: np.ndarray = joint @ weights
    return found
