"""What a prey model has to beat: standing still, constant velocity, the same with noise, linear autoregression."""

from __future__ import annotations

import numpy as np

from bayeshunt.core.geometry import FloatArray
from bayeshunt.models.target.base_motion import constant_velocity

__all__ = ["Autoregression", "NoisyVelocity"]

_ROUNDS = 20  # of reweighting
_RIDGE = 0.1  # towards constant velocity


class NoisyVelocity:
    """Constant velocity whose direction and speed are noisy; both spreads are those of the paths it is made from."""

    def __init__(self, paths: FloatArray, seen: int) -> None:
        """paths: complex [N, seen + S], forward facing."""
        steps = paths.shape[1] - seen
        ahead = constant_velocity(paths[:, :seen], steps)[:, -1]
        moved = np.abs(ahead) > 0.1 * np.median(np.abs(ahead)) + 1e-12
        ratio = paths[moved, -1] / ahead[moved]
        self.turn = float(np.sqrt(np.mean(np.angle(ratio) ** 2))) if moved.any() else 0.0  # [rad]
        self.stretch = float(np.sqrt(np.mean((np.abs(ratio).clip(max=3) - 1) ** 2))) if moved.any() else 0.0

    def draw(self, seen: FloatArray, n: int, steps: int, *, rng: np.random.Generator) -> FloatArray:
        """Return complex [N, n, steps]."""
        noise = rng.normal(size=(2, len(seen), n))
        factor = np.exp(1j * self.turn * noise[0]) * np.maximum(1 + self.stretch * noise[1], 0.0)
        step = seen[:, -1] - seen[:, -2]
        along = (step[:, None] * factor)[..., None] * np.arange(1, steps + 1)
        return np.asarray(seen[:, -1][:, None, None] + along)


class Autoregression:
    """The places that follow are linear in the steps seen, divided by their mean speed; least mean distance (L1).

    Forward and right have coefficients of their own; both are drawn towards constant velocity.
    """

    def __init__(self, paths: FloatArray, seen: int, scale: float) -> None:
        """paths: complex [N, seen + S], forward facing. scale: metres, the typical step."""
        self.scale = scale
        steps, speed = self._scaled(paths[:, :seen])
        ahead = paths[:, seen:] / speed[:, None]
        count = steps.shape[1]
        self.forward, self.right = (np.zeros((ahead.shape[1], count)) for _ in range(2))
        for t in range(ahead.shape[1]):
            left = ahead[:, t] - (t + 1) * steps[:, -1]
            weight = np.ones(len(left))
            for _ in range(_ROUNDS):
                along = _solve(steps.real, left.real, weight)
                across = _solve(steps.imag, left.imag, weight)
                weight = 1.0 / np.maximum(np.abs(left - (steps.real @ along + 1j * (steps.imag @ across))), 0.02)
            last = (t + 1) * np.eye(count)[-1]
            self.forward[t], self.right[t] = along + last, across + last

    def _scaled(self, seen: FloatArray) -> tuple[FloatArray, FloatArray]:
        steps = np.diff(seen, axis=1)
        speed = np.maximum(np.abs(steps).mean(axis=1), 0.1 * self.scale)
        return np.asarray(steps / speed[:, None]), speed

    def predict(self, seen: FloatArray) -> FloatArray:
        """Return complex [N, S] for forward facing paths [N, T] that end at 0."""
        steps, speed = self._scaled(seen)
        return np.asarray((steps.real @ self.forward.T + 1j * (steps.imag @ self.right.T)) * speed[:, None])


def _solve(inputs: FloatArray, outputs: FloatArray, weight: FloatArray) -> FloatArray:
    weighted = inputs * weight[:, None]
    penalty = (_RIDGE * weight.sum() + 1e-12) * np.eye(inputs.shape[1])
    return np.asarray(np.linalg.solve(weighted.T @ inputs + penalty, weighted.T @ outputs))
