"""The check that every model of a prey must pass; run it over your own too."""

from __future__ import annotations

import numpy as np

from bayeshunt.core.arguments import checked
from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.errors import BayesHuntError
from bayeshunt.core.geometry import Polar
from bayeshunt.models.target.registry import make_prey_model

__all__ = ["check_prey_model"]

_SEEN = (Polar(0.16, 0.0, 0.0), Polar(0.15, 0.3, 0.6), Polar(0.16, -0.1, -0.2), Polar(0.0, 0.0, 0.0))


@checked
def check_prey_model(name: str) -> None:
    """Raise BayesHuntError, naming the model and the fault, unless a registered prey model keeps the rules.

    The rules: a fresh one is empty; each observation counts as one; paths have a pose for now and for every step
    ahead, the first of them (0, 0, 0) and all finite, and are the same when asked again; a copy knows the same and
    goes its own way; every row of its cells has four numbers.
    """
    model = make_prey_model(name, EffectAxes.standard(0.057))
    _demand(name, model.is_empty and model.observations == 0, "knows something before it has observed anything")
    for number, transition in enumerate(_SEEN, 1):
        model.observe(transition)
        _demand(name, model.observations == number, f"has {model.observations} observations after {number}")
        _demand(name, not model.is_empty, "is empty although it has observed something")
        for steps in (0, 1, 5):
            path = model.predict_path(steps)
            sizes = {np.shape(part) for part in path}
            _demand(name, sizes == {(steps + 1,)}, f"predicts {steps} steps as shapes {sizes}, not [{steps + 1}]")
            _demand(name, bool(np.isfinite(path).all()), "predicts what is not finite")
            _demand(name, all(part[0] == 0.0 for part in path), "does not start its path at the prey")
            _demand(name, np.array_equal(path, model.predict_path(steps)), "predicts another path when asked again")
    twin = model.copy()
    _demand(name, np.array_equal(twin.predict_path(3), model.predict_path(3)), "has a copy that predicts otherwise")
    twin.observe(Polar(0.05, 1.0, 2.0))
    _demand(name, model.observations == len(_SEEN), "learns what its copy observes")
    _demand(name, all(len(row) == 4 for row in model.cells()), "has cells that are not rows of four numbers")


def _demand(name: str, kept: bool, fault: str) -> None:
    if not kept:
        raise BayesHuntError(f"prey model {name!r} {fault}")
