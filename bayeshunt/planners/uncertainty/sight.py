"""What a camera would see of the prey on the way of every gait. Letters: G gaits, F looks a step, K futures."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bayeshunt.config.schema.camera import CameraSettings
from bayeshunt.core.geometry import FloatArray
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.tables.structures import depends_on_previous
from bayeshunt.planners.interception.futures import Futures
from bayeshunt.planners.interception.lookahead import gait_paths

__all__ = ["Looks", "Sight"]


@dataclass(frozen=True, eq=False)
class Sight:
    """P(the prey is found at least once): in the first step [G, K], in the second [G, G, K]."""

    first: FloatArray
    second: FloatArray


@dataclass(frozen=True, eq=False)
class Looks:
    """From where the hunter looks, on the mean path of every gait and pair of gaits.

    first: forward, right [m], heading [rad] at every part-way pose [3, G, P]. second: [3, G, G, P]. times: [2 P].
    """

    first: FloatArray
    second: FloatArray
    times: FloatArray

    @classmethod
    def of(cls, model: ForwardModel, previous_gait: str | None = None) -> Looks:
        """Return those of a model's mean paths after the gait just executed."""
        paths = np.moveaxis(gait_paths(model.after(previous_gait)), -1, 0)  # [3, G, P]
        then = paths[:, None]
        if depends_on_previous(model.structure):
            then = np.moveaxis(np.stack([gait_paths(model.after(gait)) for gait in model.gaits]), -1, 0)
        start = paths[:, :, -1][:, :, None, None]
        cos, sin = np.cos(start[2]), np.sin(start[2])
        second = np.stack(
            [
                start[0] + cos * then[0] - sin * then[1],
                start[1] + sin * then[0] + cos * then[1],
                start[2] + then[2],
            ]
        )
        points = paths.shape[2]
        times = np.arange(1, 2 * points + 1) * (model.gaits.need("duration") / points)
        return cls(paths, second, times)

    def sight(self, camera: CameraSettings | None, reach: float, futures: Futures) -> Sight:
        """Return P(found) in both steps in every future; with no camera all is seen. reach: metres."""
        points, count = self.first.shape[2], len(futures.weights)
        gaits = self.first.shape[1]
        if camera is None:
            return Sight(np.ones((gaits, count)), np.ones((gaits, gaits, count)))
        looks = np.unique(np.rint(np.arange(1, camera.frames + 1) * points / camera.frames).astype(int) - 1)
        looks = looks[looks >= 0]
        forward, right = (part.T for part in futures.at(self.times[np.concatenate([looks, points + looks])]))
        half = len(looks)
        one = _found(self.first[:, :, looks], forward[:half], right[:half], camera, reach)
        two = _found(self.second[:, :, :, looks], forward[half:], right[half:], camera, reach)
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
