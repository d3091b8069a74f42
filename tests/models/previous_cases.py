"""Rows in which the gait before matters, and the full joint distribution of the network fitted to them."""

from __future__ import annotations

import numpy as np
import pandas as pd

import bayeshunt as bh
from bayeshunt.core.bins import EFFECTS, EffectAxes

GAITS = ("a", "b", "c")
AXES = EffectAxes.standard(0.05, distance_bin=1.0, angle_bins=5, heading_bins=4)
#: The variables in the order of :func:`enumerate_joint`.
ORDER = ("PreviousGait", "Gait", *EFFECTS)


def momentum(rows: int, seed: int, *, gaits: tuple[str, ...] = GAITS, starts: int = 1) -> pd.DataFrame:
    """Random rows: each effect depends on the gait and the one before. starts: rows that no gait went before."""
    rng = np.random.default_rng(seed)
    gait = rng.integers(0, len(gaits), rows)
    before = np.r_[0, gait[:-1]]
    distance = np.minimum(rng.poisson(0.5 + gait), 3)
    angle = (gait + 2 * before + (rng.random(rows) < 0.3)) % 5
    heading = (before + (rng.random(rows) < 0.4)) % 4
    names = np.array(gaits, dtype=object)
    previous = names[before]
    previous[np.linspace(0, rows, starts, endpoint=False).astype(int)] = None
    return pd.DataFrame(
        {
            "gait": names[gait],
            "distance": 0.05 * (distance + rng.random(rows)),
            "angle": AXES.angle.centres[angle],
            "heading": AXES.heading.centres[heading],
            "previous_gait": previous,
        }
    )


def fit(frame: pd.DataFrame, prior: float = 0.0, gait_prior: str = "uniform") -> bh.ForwardModel:
    model = bh.ForwardModel.fit(
        frame, GAITS, prior, axes=AXES, gait_prior=gait_prior, structure="previous_gait", backoff=None
    )
    assert model.structure.name == "previous_gait"
    return model


def enumerate_joint(model: bh.ForwardModel) -> np.ndarray:
    """P(PreviousGait, Gait, Distance, Angle, Heading) by pgmpy: the product of the network's own factors."""
    first, *others = (cpd.to_factor() for cpd in model.network.get_cpds())
    for factor in others:
        first = first * factor
    return np.transpose(first.values, [first.variables.index(v) for v in ORDER])
