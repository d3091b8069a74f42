"""The hot parts of a hunt and of a fit, rewritten for numba: only ``benchmarks.compiled`` uses them."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from bayeshunt.core.bins import EffectAxes
from bayeshunt.worlds.prey import proximity as sensors

MOUNTS, MAX_VALUE = sensors._MOUNTS, sensors.MAX_VALUE


class Kernels(NamedTuple):
    """The compiled parts, with the signatures of what they stand in for."""

    sensors: Callable[..., Any]
    values: Callable[..., Any]
    captures: Callable[..., Any]
    counting: Callable[..., Any]


def sense(x: float, y: float, theta: float, reach: float, half_width: float, half_height: float) -> Any:
    values = np.zeros(8)
    for i in range(8):
        distance, mount, direction = MOUNTS[i]
        ox, oy = x + distance * math.cos(theta + mount), y + distance * math.sin(theta + mount)
        dx, dy = math.cos(theta + direction), math.sin(theta + direction)
        along_x = (half_width - ox) / dx if dx > 0 else (-half_width - ox) / dx if dx < 0 else math.inf
        along_y = (half_height - oy) / dy if dy > 0 else (-half_height - oy) / dy if dy < 0 else math.inf
        nearest = max(0.0, min(along_x, along_y))
        values[i] = MAX_VALUE * (1.0 - nearest / reach) if nearest < reach else 0.0
    v = values
    return v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7]


def _mean_distance(forward: Any, right: Any, steps: Any, ahead: Any, across: Any) -> Any:
    samples, nodes = forward.shape
    values = np.zeros(nodes)
    for s in range(samples):
        for n in range(nodes):
            dx, dy = forward[s, n] - ahead[steps[n]], right[s, n] - across[steps[n]]
            values[n] += math.sqrt(dx * dx + dy * dy)
    return values / samples


def _chances(x: Any, y: Any, forward: Any, right: Any, reach: float, spread: float) -> Any:
    chances = np.empty((x.shape[0], x.shape[1], forward.shape[1]))
    for n in range(x.shape[0]):
        for p in range(x.shape[1]):
            for k in range(forward.shape[1]):
                dx, dy = x[n, p] - forward[p, k], y[n, p] - right[p, k]
                square = dx * dx + dy * dy
                if spread == 0.0:
                    chances[n, p, k] = 1.0 if square <= reach * reach else 0.0
                else:
                    share = (reach + spread - math.sqrt(square)) / (2.0 * spread)
                    chances[n, p, k] = min(1.0, max(0.0, share))
    return chances


def _count(codes: Any, distance: Any, angle: Any, heading: Any, first: Any, width: Any, shape: Any) -> Any:
    table = np.zeros((shape[0], shape[1], shape[2], shape[3]), dtype=np.int64)
    for n in range(len(codes)):
        d = math.floor((distance[n] - first[0]) / width[0])
        a = math.floor((angle[n] - first[1]) / width[1])
        h = math.floor((heading[n] - first[2]) / width[2])
        table[codes[n], d, a if a < shape[2] else a - shape[2], h if h < shape[3] else h - shape[3]] += 1
    return table


def compile_kernels(cache: bool = False) -> Kernels:
    """Compile the parts, by calling each once as it will be called; ImportError without numba."""
    import numba

    rays, mean, chance, count = (numba.njit(cache=cache)(f) for f in (sense, _mean_distance, _chances, _count))

    def proximity(x: float, y: float, theta: float, reach: float, walls: Any, disc: Any, solids: Any = ()) -> Any:
        if disc is not None or solids:
            raise ValueError("the preset's prey senses neither the hunter nor obstacles")
        far = sensors.MOUNT_RADIUS + reach  # nothing in reach: Python is as fast as the call would be
        if walls is None or (abs(x) + far < walls[0] and abs(y) + far < walls[1]):
            return None
        return rays(x, y, theta, reach, walls[0], walls[1])

    def mean_distance(hunter: Any, path: Any) -> Any:
        return mean(hunter.forward, hunter.right, hunter.steps, path.forward, path.right)

    def chances(hunter: Any, forward: Any, right: Any, reach: float, spread: float) -> Any:
        x, y = hunter[:2].reshape(2, -1, hunter.shape[-2])  # one outcome; the heading does not count
        found = chance(x, y, forward, right, reach, spread)
        return found.reshape(*hunter.shape[1:-1], forward.shape[1])

    def cells(codes: np.ndarray, values: list[np.ndarray], axes: EffectAxes, gaits: int) -> tuple[Any, Any]:
        first, width = np.array([(axis.edges[0], axis.width) for axis in axes]).T
        table = count(codes, *values, first, width, np.array([gaits, *axes.shape]))
        return np.argwhere(table), table[table > 0]

    return Kernels(proximity, mean_distance, chances, cells)
