"""What a camera would see of the prey on the way of every gait, and what that tells.

Letters: G gaits, F looks a step, K futures.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bayeshunt.config.schema.camera import CameraSettings
from bayeshunt.core.geometry import FloatArray
from bayeshunt.planners.interception.futures import Futures
from bayeshunt.planners.interception.lookahead import PairPaths

__all__ = ["Sight", "sight"]

#: The most that a single look is trusted to show, or not to show, the prey.
_SUREST = 0.999


@dataclass(frozen=True, eq=False)
class Sight:
    """P(the prey is found at least once): in the first step [G, K], in the second [G, G, K]; and what that tells.

    told: P(it is future j | what the looks of the first step show if it is future k, found in it) [G, K, K], sums to 1
    over the last axis.
    """

    first: FloatArray
    second: FloatArray
    told: FloatArray


def sight(pairs: PairPaths, camera: CameraSettings | None, width: float, futures: Futures, spread: float) -> Sight:
    """Return what is seen in both steps on the mean paths of pairs, in every future.

    With no camera all is seen, as often as a camera of the default frames looks. width: of the prey [m]. spread: metres
    by which the robots are off their mean paths: futures that are nearer to each other cannot be told apart.
    """
    gaits, points = pairs.first.shape[1:3]
    count, frames = len(futures.weights), (CameraSettings() if camera is None else camera).frames
    looks = np.unique(np.rint(np.arange(1, frames + 1) * points / frames).astype(int) - 1)
    looks = looks[looks >= 0]
    forward, right = (part.T for part in futures.at(pairs.times[np.concatenate([looks, points + looks])]))
    half = len(looks)
    if camera is None:
        seen, sd = np.ones((gaits, half, count)), np.zeros((gaits, half, count))
        first, second = np.ones((gaits, count)), np.ones((gaits, gaits, count))
    else:
        reach, lost = camera.reach(width), 1.0 - min(camera.detection, _SUREST)
        seen, distance = _view(pairs.first[..., looks, 0], forward[:half], right[:half], camera, reach)
        sd = np.hypot(camera.bearing_sd * distance, camera.inverse_sd(width) * distance**2)
        first = 1.0 - lost ** seen.sum(axis=-2)
        again, _ = _view(pairs.second[..., looks, 0], forward[half:], right[half:], camera, reach)
        second = 1.0 - lost ** again.sum(axis=-2)
    chance = 1.0 - _SUREST if camera is None else lost
    told = _told(seen.astype(float), sd, forward[:half], right[:half], spread, math.log(chance))
    told *= (first * futures.weights)[:, None] + 1e-12
    return Sight(first, second, told / told.sum(axis=-1, keepdims=True))


def _view(
    hunter: FloatArray, forward: FloatArray, right: FloatArray, camera: CameraSettings, reach: float
) -> tuple[np.ndarray, FloatArray]:
    """Whether the prey [F, K] is in view of the hunter [3, ..., F], bool [..., F, K], and how far away it is [m]."""
    x, y, heading = (part[..., None] for part in hunter)
    ahead, across = forward - x, right - y
    distance = np.sqrt(ahead * ahead + across * across)
    edge = math.cos(min(0.5 * camera.fov, math.pi)) if camera.fov < 2.0 * math.pi else -2.0
    seen = (ahead * np.cos(heading) + across * np.sin(heading) >= edge * distance) & (distance <= reach)
    return seen, distance


def _told(
    seen: FloatArray, sd: FloatArray, forward: FloatArray, right: FloatArray, spread: float, unseen: float
) -> FloatArray:
    """How well the looks at future k [G, F, K] fit future j: [G, K, K], 1 where they cannot be told apart.

    Looks that show both tell them apart by the distance between them [F, K], beside the camera's standard deviation
    ``sd`` [m] and the ``spread``, which is the same in all looks. A look that shows one of them alone costs ``unseen``.
    """
    both = seen.sum(axis=1)  # [G, K]
    variance = 2.0 * (sd * sd + np.maximum(both, 1.0)[:, None] * spread**2 + 1e-12)
    square = np.square(forward[:, :, None] - forward[:, None]) + np.square(right[:, :, None] - right[:, None])
    near = np.einsum("gfk,gfj,fkj->gkj", seen / variance, seen, square)
    common = np.swapaxes(seen, 1, 2) @ seen
    fit: FloatArray = np.exp(unseen * (both[:, :, None] + both[:, None] - 2.0 * common) - 0.5 * near)
    return fit
