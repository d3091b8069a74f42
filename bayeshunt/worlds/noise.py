"""Actuator noise, drawn in blocks: a hunt's whole noise costs a few numpy calls."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import accumulate

import numpy as np

from bayeshunt.config.schema import NoiseSettings

_BLOCK = 256  # control intervals drawn at a time


def actuator_factors(
    settings: NoiseSettings, interval: float, rng: np.random.Generator
) -> Iterator[tuple[float, float]]:
    """Yield the factors of a robot's two actuators, one pair per control interval, for ever.

    factor = (1 + slip) (1 + drift): slip is uniform in +-``settings.slip``, drift an
    Ornstein-Uhlenbeck process, stationary from the start, sampled every ``interval`` [s].
    """
    # x' = a x + sqrt(1 - a^2) sd n: the exact discretisation of the process
    a = math.exp(-interval / settings.drift_time)
    scale = settings.drift_sd * math.sqrt(1.0 - a * a)
    last = (rng.standard_normal(2) * settings.drift_sd).tolist()
    while True:
        slip = 1.0 + rng.uniform(-settings.slip, settings.slip, (2, _BLOCK))
        kicks = (scale * rng.standard_normal((2, _BLOCK))).tolist()
        drift = [list(accumulate(kicks[i], lambda x, kick: a * x + kick, initial=last[i]))[1:] for i in (0, 1)]
        last = [drift[0][-1], drift[1][-1]]
        factors = slip * (1.0 + np.array(drift))
        yield from zip(factors[0].tolist(), factors[1].tolist(), strict=True)


def gaussians(rng: np.random.Generator, block: int = 512) -> Iterator[float]:
    """Yield standard normal numbers for ever, drawn ``block`` at a time."""
    while True:
        yield from rng.standard_normal(block).tolist()
