"""Babbling tables, random networks and full enumeration for the models' tests."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from bayeshunt.core.bins import Axis, EffectAxes
from bayeshunt.core.gaits import Gait, GaitRepertoire
from bayeshunt.core.geometry import wrap
from bayeshunt.data.babbling_table import path_column_names
from bayeshunt.models.body.forward import ForwardModel

#: Left and right wheel speeds [m/s].
WHEELS = {
    "straight": (0.0576, 0.0576),
    "soft right": (0.0576, 0.0432),
    "soft left": (0.0432, 0.0576),
    "spin right": (0.0576, -0.01152),
    "slow": (0.0288, 0.0288),
}
AXLE, STEP = 0.052, 3.328  # m, s


def repertoire(names: list[str] | None = None) -> GaitRepertoire:
    return GaitRepertoire(tuple(Gait(n, WHEELS[n]) for n in names or list(WHEELS)), body_length=0.057, duration=STEP)


def babbled(rows: int, seed: int, *, points: int = 0, noise: float = 0.08) -> pd.DataFrame:
    """Arcs of constant wheel speeds with multiplicative noise, as a babbling table."""
    rng = np.random.default_rng(seed)
    names = list(WHEELS)
    codes = np.r_[np.arange(len(names)), rng.integers(0, len(names), rows)][:rows]
    wheels = np.array(list(WHEELS.values()))[codes] * (1.0 + noise * rng.standard_normal((rows, 2)))
    speed, turn = wheels.mean(axis=1), (wheels[:, 0] - wheels[:, 1]) / AXLE

    def arc(time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        heading = turn * time
        chord = speed * time * np.sinc(heading / 2.0 / math.pi)
        return chord * np.cos(heading / 2.0), chord * np.sin(heading / 2.0), wrap(heading)

    forward, right, heading = arc(STEP)
    table = {
        "gait": np.array(names, dtype=object)[codes],
        "distance": np.hypot(forward, right),
        "angle": wrap(np.arctan2(right, forward)),
        "heading": heading,
    }
    columns = path_column_names(points)
    for point in range(points):
        pose = arc(STEP * (point + 1) / (points + 1))
        table.update(zip(columns[3 * point : 3 * point + 3], pose, strict=True))
    return pd.DataFrame(table)


def small_axes(distance: int = 1, angle: int = 4, heading: int = 4, width: float = 0.1) -> EffectAxes:
    return EffectAxes(
        Axis.linear("Distance", width, distance),
        Axis.full_turn("Angle", angle),
        Axis.full_turn("Heading", heading),
    )


def frame_of(cells: list[tuple[str, int, int, int]], axes: EffectAxes) -> pd.DataFrame:
    """One row at the centre of each (gait, Distance bin, Angle bin, Heading bin)."""
    columns = list(zip(*cells, strict=True))
    return pd.DataFrame(
        {
            "gait": list(columns[0]),
            "distance": [(i + 0.5) * axes.distance.width for i in columns[1]],
            "angle": [axes.angle.centres[i] for i in columns[2]],
            "heading": [axes.heading.centres[i] for i in columns[3]],
        }
    )


def random_model(seed: int) -> ForwardModel:
    """A model with random cardinalities, few rows (so that zeros abound), priors on or off."""
    rng = np.random.default_rng(seed)
    gaits, distances, angles, headings = rng.integers(1, [6, 7, 8, 6], endpoint=True).tolist()
    axes = small_axes(1, angles, headings)
    names = [f"g{i}" for i in range(gaits)]
    cells = []
    for name in names:
        # Each gait reaches a random corner of the table only.
        tops = [rng.integers(1, n, endpoint=True) for n in (distances, angles, headings)]
        for _ in range(rng.integers(1, 12)):
            cells.append((name, *(int(rng.integers(0, top)) for top in tops)))
    prior = float(rng.choice([0.0, 0.0, 0.3]))
    gait_prior = str(rng.choice(["uniform", "empirical"]))
    return ForwardModel.empty(names, prior, axes=axes, gait_prior=gait_prior).update(frame_of(cells, axes))


def full_joint(model: ForwardModel) -> np.ndarray:
    """P(Gait, Distance, Angle, Heading), every cell of it: [G, D, A, H]."""
    prior, distance, angle, heading = (model.probabilities(v) for v in ("Gait", "Distance", "Angle", "Heading"))
    joint = np.empty((len(model.gaits), *model.axes.shape))
    for g, d, a, h in np.ndindex(joint.shape):
        joint[g, d, a, h] = prior[g] * distance[d, g] * angle[a, g] * heading[h, g]
    return joint
