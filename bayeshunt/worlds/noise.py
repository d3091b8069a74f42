"""Actuator noise, drawn in blocks: a hunt's whole noise costs a few numpy calls."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import chain, repeat

import numpy as np

from bayeshunt.config.schema import NoiseSettings

__all__ = ["actuator_factors", "gaussians"]

_BLOCK = 256  # control intervals drawn at a time


def actuator_factors(
    settings: NoiseSettings, interval: float, rng: np.random.Generator, actuators: int = 2
) -> Iterator[tuple[float, ...]]:
    """Return an iterator of the factors [A] of a robot's actuators, one tuple per control interval, without end.

    factor = (1 + slip) (1 + drift): slip is uniform in +-``settings.slip``, drift an
    Ornstein-Uhlenbeck process, stationary from the start, sampled every ``interval`` [s].
    """
    return chain.from_iterable(_blocks(settings, interval, rng, actuators))  # whose next() runs no Python


def _blocks(
    settings: NoiseSettings, interval: float, rng: np.random.Generator, actuators: int
) -> Iterator[Iterator[tuple[float, ...]]]:
    # x' = a x + sqrt(1 - a^2) sd n: the exact discretisation of the process
    a = math.exp(-interval / settings.drift_time)
    scale = settings.drift_sd * math.sqrt(1.0 - a * a)
    drifts = (rng.standard_normal(actuators) * settings.drift_sd).tolist()
    while True:
        slips = (1.0 + rng.uniform(-settings.slip, settings.slip, (actuators, _BLOCK))).tolist()
        kicks = (scale * rng.standard_normal((actuators, _BLOCK))).tolist()
        factors = []
        for number, drift in enumerate(drifts):
            own: list[float] = []
            for slip, kick in zip(slips[number], kicks[number], strict=True):
                drift = a * drift + kick
                own.append(slip * (1.0 + drift))
            factors.append(own)
            drifts[number] = drift
        yield zip(*factors, strict=True)


def gaussians(rng: np.random.Generator, block: int = 512) -> Iterator[float]:
    """Return an iterator of standard normal numbers without end, drawn ``block`` at a time."""
    return chain.from_iterable(rng.standard_normal(block).tolist() for _ in repeat(None))
