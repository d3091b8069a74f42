"""What a camera would see of the prey on the way of every gait. Letters: G gaits, F looks a step, K futures."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bayeshunt.config.schema.camera import CameraSettings
from bayeshunt.core.geometry import FloatArray
from bayeshunt.planners.interception.futures import Futures
from bayeshunt.planners.interception.lookahead import PairPaths

__all__ = ["Sight", "sight"]


@dataclass(frozen=True, eq=False)
class Sight:
    """P(the prey is found at least once): in the first step [G, K], in the second [G, G, K]."""

    first: FloatArray
    second: FloatArray


def sight(pairs: PairPaths, camera: CameraSettings | None, reach: float, futures: Futures) -> Sight:
    """Return P(found) in both steps on the mean paths of pairs, in every future; with no camera all is seen.

    reach: metres.
    """
    gaits, points = pairs.first.shape[1:3]
    count = len(futures.weights)
    if camera is None:
        return Sight(np.ones((gaits, count)), np.ones((gaits, gaits, count)))
    looks = np.unique(np.rint(np.arange(1, camera.frames + 1) * points / camera.frames).astype(int) - 1)
    looks = looks[looks >= 0]
    forward, right = (part.T for part in futures.at(pairs.times[np.concatenate([looks, points + looks])]))
    half = len(looks)
    one = _found(pairs.first[..., looks, 0], forward[:half], right[:half], camera, reach)
    two = _found(pairs.second[..., looks, 0], forward[half:], right[half:], camera, reach)
    return Sight(one, two)


def _found(
    hunter: FloatArray, forward: FloatArray, right: FloatArray, camera: CameraSettings, reach: float
) -> FloatArray:
    """P(found in at least one look): hunter [3, ..., F] against prey [F, K] gives [..., K]."""
    x, y, heading = (part[..., None] for part in hunter)
    ahead, across = forward - x, right - y
    distance = np.sqrt(ahead * ahead + across * across)
    edge = math.cos(min(0.5 * camera.fov, math.pi)) if camera.fov < 2.0 * math.pi else -2.0
    seen = (ahead * np.cos(heading) + across * np.sin(heading) >= edge * distance) & (distance <= reach)
    missed: FloatArray = (1.0 - min(camera.detection, 0.999)) ** seen.sum(axis=-2)
    return 1.0 - missed
