"""A hunter with ten arc gaits, babbled from a formula: no physics engine needed."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from bayeshunt.core.gaits import Gait, GaitRepertoire
from bayeshunt.core.geometry import Polar
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.planners.api import Situation

BODY, STEP, AXLE = 0.057, 3.328, 0.052  # m, s, m
WHEELS = {  # left, right [m/s]
    "straight": (0.0576, 0.0576),
    "right": (0.0576, 0.0432),
    "left": (0.0432, 0.0576),
    "hard right": (0.0576, 0.03456),
    "hard left": (0.03456, 0.0576),
    "spin right": (0.0576, -0.01152),
    "spin left": (-0.01152, 0.0576),
    "slow": (0.0288, 0.0288),
    "slow right": (0.0288, 0.01728),
    "slow left": (0.01728, 0.0288),
}


def arcs(left: np.ndarray, right: np.ndarray) -> Polar:
    """Where constant wheel speeds [m/s] lead in one step: circular arcs."""
    turn = (left - right) / AXLE * STEP  # clockwise
    length = (left + right) / 2 * STEP
    half = np.where(np.abs(turn) < 1e-9, 1e-9, turn / 2)
    chord = length * np.sin(half) / half
    return Polar.from_cartesian(chord * np.cos(half), chord * np.sin(half), turn)


def babble(names: list[str], rows: int, seed: int, slip: float = 0.1) -> pd.DataFrame:
    """A babbling table: so much slip on each wheel."""
    rng = np.random.default_rng(seed)
    gait = rng.integers(len(names), size=rows)
    slips = rng.uniform(1.0 - slip, 1.0 + slip, size=(rows, 2))
    wheels = np.array([WHEELS[name] for name in names])[gait] * slips
    seen = arcs(wheels[:, 0], wheels[:, 1])
    return pd.DataFrame(
        {
            "gait": np.array(names)[gait],
            "distance": seen.distance,
            "angle": seen.angle,
            "heading": seen.heading,
        }
    )


def fit(names: list[str], rows: int = 1500, slip: float = 0.1) -> ForwardModel:
    repertoire = GaitRepertoire(tuple(Gait(n, WHEELS[n]) for n in names), BODY, STEP)
    return ForwardModel.fit(babble(names, rows, seed=5, slip=slip), repertoire)


def seen_prey(transitions: int = 6, seed: int = 3) -> PreyModel:
    """A prey that goes about 16 cm a step and drifts to its right."""
    rng = np.random.default_rng(seed)
    prey = PreyModel()
    for _ in range(transitions):
        prey.observe(Polar(0.16 + 0.01 * rng.standard_normal(), 0.1 * rng.standard_normal(), 0.2 * rng.random()))
    return prey


def situations(count: int, seed: int = 11, *, known: bool = True) -> list[Situation]:
    """Random prey poses within 12 bodies."""
    rng = np.random.default_rng(seed)
    prey = seen_prey() if known else PreyModel()
    turns = rng.uniform(-math.pi, math.pi, size=(count, 2)).tolist()
    distances = rng.uniform(0.05, 12 * BODY, size=count).tolist()
    return [
        Situation(Polar(d, a, h), prey, body_length=BODY, time=i * STEP, step=i, time_step=STEP)
        for i, (d, (a, h)) in enumerate(zip(distances, turns, strict=True))
    ]
