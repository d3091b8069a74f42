"""How well a frame of a camera fits a particle: what was seen there, and what was not."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from bayeshunt.config.schema.camera import CameraSettings
from bayeshunt.core.geometry import FloatArray, Polar, Pose, wrap
from bayeshunt.core.messages import Detection, Frame
from bayeshunt.perception.setting import KnownObstacles

__all__ = ["Eye", "Fit"]

#: False detections per frame, at the least: no camera is without.
_LEAST_CLUTTER = 1e-3
#: What the model misses, as standard deviations: of the prey's way within a frame [m].
_PLACE_SPREAD = 0.0005
#: Share of the reach over which a prey at the limit of being found is found less and less often.
_SOFT_REACH = 0.1
#: Standard deviations of a bearing over which the edge of the field of view is soft.
_SOFT_EDGE = 2.0
#: A map of cells is coarse: where it says that a prey is hidden, it is found all the same so often, beside one in the
#: open; and where it says that there is an obstacle, a prey is so much less probable, frame by frame.
_FOUND_HIDDEN, _INSIDE = 0.1, 0.1


class Fit(NamedTuple):
    """How a frame fits each of N particles.

    likelihood: of the frame [N], in units of a frame without the prey. explained: of each detection, how much likelier
    it is if the prey is where a particle says than if it is false, [Z, N].
    """

    likelihood: FloatArray
    explained: FloatArray


class Eye(NamedTuple):
    """What a tracker knows of the camera. width: of the prey [m]. obstacles: what stands in the way; None: nothing."""

    camera: CameraSettings
    width: float
    obstacles: KnownObstacles | None = None

    def found(self, seen: Polar[FloatArray]) -> FloatArray:
        """Return the probability that a prey is found in a frame, [N]; seen: from the hunter."""
        camera = self.camera
        chance = np.full(np.shape(seen.distance), camera.detection)
        if camera.fov < 2.0 * math.pi:
            over = (0.5 * camera.fov - np.abs(seen.angle)) / (_SOFT_EDGE * camera.bearing_sd)
            chance = chance * _step(over)
        reach = camera.reach(self.width)
        return np.asarray(chance * _step((reach - seen.distance) / (_SOFT_REACH * reach)))

    def fit(self, frame: Frame, x: FloatArray, y: FloatArray, theta: FloatArray) -> Fit:
        """Return how a frame fits prey at poses in the odometry frame [N]."""
        seen = frame.pose.relative(Pose(x, y, theta))
        chance, there = self.found(seen), np.ones(len(x))
        if self.obstacles is not None:
            chance = np.where(self.obstacles.hidden(frame.pose.x, frame.pose.y, x, y), _FOUND_HIDDEN * chance, chance)
            there = np.where(self.obstacles.inside(x, y), _INSIDE, 1.0)
        explained = np.zeros((len(frame.detections), len(x)))
        for number, detection in enumerate(frame.detections):
            explained[number] = chance * self._ratio(self.measured(detection, frame.pose), seen)
        return Fit(there * np.maximum(1.0 - chance + explained.sum(axis=0), 1e-12), there * explained)

    def measured(self, detection: Detection, own: Pose) -> Detection:
        """Return a detection as it was seen, with the camera's standard deviations where it tells none."""
        seen = detection.seen
        if seen is None:
            assert detection.pose is not None
            seen = own.relative(detection.pose)
        sd = detection.sd
        if sd is None:
            heading = self.camera.heading_sd
            sd = Polar(
                seen.distance**2 * self.camera.inverse_sd(self.width), self.camera.bearing_sd,
                math.nan if heading is None else heading,
            )  # fmt: skip
        return Detection(seen, sd=sd)

    def _ratio(self, detection: Detection, seen: Polar[FloatArray]) -> FloatArray:
        """P(detection | prey there and found) over the density of false detections, [N]."""
        got, sd = detection.seen, detection.sd
        assert got is not None
        assert sd is not None
        distance = np.maximum(seen.distance, 1e-3)
        bearing_sd = np.hypot(sd.angle if sd.angle > 0 else 1e-3, _PLACE_SPREAD / distance)
        ratio = _normal(np.asarray(wrap(got.angle - seen.angle)), bearing_sd)
        clutter = max(self.camera.clutter, _LEAST_CLUTTER)
        if math.isnan(got.distance):
            ratio = ratio * self.camera.fov / clutter
        else:
            # In the inverse of the distance, as the apparent width is: there the noise is the same everywhere.
            far = max(got.distance, 1e-3)
            inverse_sd = np.hypot(max(sd.distance, 1e-4) / far**2, _PLACE_SPREAD / distance**2)
            area = 0.5 * self.camera.fov * self.camera.clutter_range**2
            ratio = ratio * _normal(1.0 / far - 1.0 / distance, inverse_sd) * area / (clutter * far**3)
        if not math.isnan(got.heading) and not math.isnan(sd.heading):
            off = np.asarray(wrap(got.heading - seen.heading))
            ratio = ratio * _normal(off, np.full(off.shape, sd.heading)) * 2.0 * np.pi
        return ratio

    def places(self, detection: Detection, own: Pose, count: int, rng: np.random.Generator) -> Pose[FloatArray]:
        """Return ``count`` poses that a detection may be of; a heading that was not seen is anything."""
        known = self.measured(detection, own)
        got, sd = known.seen, known.sd
        assert got is not None
        assert sd is not None
        if math.isnan(got.distance):
            distance = self.camera.clutter_range * np.sqrt(rng.random(count))
        else:
            far = max(got.distance, 1e-3)
            inverse = 1.0 / far + max(sd.distance, 1e-4) / far**2 * rng.normal(size=count)
            distance = 1.0 / np.maximum(inverse, 0.1 / far)
        bearing = got.angle + sd.angle * rng.normal(size=count)
        if math.isnan(got.heading):
            heading = rng.uniform(-np.pi, np.pi, count)
        else:
            heading = got.heading + (0.0 if math.isnan(sd.heading) else sd.heading) * rng.normal(size=count)
        return own.compose(Polar(distance, bearing, heading))


def _normal(off: FloatArray, sd: FloatArray) -> FloatArray:
    """Density of a normal distribution."""
    return np.exp(-0.5 * np.square(off / sd)) / (math.sqrt(2.0 * math.pi) * sd)


def _step(over: FloatArray) -> FloatArray:
    """A soft step from 0 to 1 about 0."""
    return 1.0 / (1.0 + np.exp(-np.clip(4.0 * over, -50.0, 50.0)))
