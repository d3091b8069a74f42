"""Simple motions that a residual table adds to: where a path goes on to if nothing new happens."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bayeshunt.core.geometry import FloatArray

__all__ = ["BASES", "constant_velocity", "stands"]


def constant_velocity(seen: FloatArray, steps: int) -> FloatArray:
    """Return complex [N, steps]: the last step of ``seen`` [N, T] goes on."""
    return np.asarray(seen[:, -1:] + (seen[:, -1:] - seen[:, -2:-1]) * np.arange(1, steps + 1))


def stands(seen: FloatArray, steps: int) -> FloatArray:
    """Return complex [N, steps]: the last place of ``seen`` [N, T] is kept."""
    return np.repeat(seen[:, -1:], steps, axis=1)


#: Name -> motion.
BASES: dict[str, Callable[[FloatArray, int], FloatArray]] = {"constant_velocity": constant_velocity, "stands": stands}
