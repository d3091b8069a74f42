"""The camera: looks several times a step from where the hunter then is; finds the prey's bearing and apparent width."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from bayeshunt.core.geometry import Polar, Pose, wrap
from bayeshunt.core.messages import Detection, Frame, Moment, Observation, Ray, Run
from bayeshunt.core.protocols import Map
from bayeshunt.perception.sensors.odometry import Odometry
from bayeshunt.perception.setting import PerceptionContext

__all__ = ["Camera", "look_moments"]


class Camera:
    """Sees the prey where it is in view, near enough and not hidden: see ``bayeshunt.protocols.Sensor``.

    The prey is a disc of known width: its apparent width in pixels tells its distance. Noise is that of bearing and of
    apparent width, so a distance is the less sure the farther away it is, as its square. Finds it with a probability in
    each frame, and now and then something that is not there. Detections are in order of their bearings: nothing tells
    the prey from a false one. It keeps the hunter's odometry from step to step, so every hunt has a camera of its own.
    """

    def __init__(self, context: PerceptionContext) -> None:
        self.context = context
        self.camera = context.own_camera
        self.width = context.target_width
        self.odometry = Odometry(context.origin, self.camera)
        self._begun: float | None = None

    def sense(self, run: Run, map: Map, *, rng: np.random.Generator) -> Observation:
        """Return the frames of ``run``; the first of a hunt is one frame, in which the prey may be shown."""
        shown = self._begun is None and self.context.start == "shown" and len(run.moments) == 1
        begun = self._begun if self._begun is not None else run.moments[0].time
        self.odometry.begin_step(rng)
        looks = set(look_moments([m.time for m in run.moments], begun, self.context.time_step, self.camera.frames))
        frames, pose = [], Pose(0.0, 0.0, 0.0)
        for number, moment in enumerate(run.moments):
            pose = self.odometry.follow(moment.poses[self.context.hunter])
            if number in looks:
                frames.append(Frame(moment.time, pose, self._look(moment, map, shown, rng)))
        self._begun = run.moments[-1].time
        return Observation(run.moments[-1].time, pose, tuple(frames))

    def _look(self, moment: Moment, map: Map, shown: bool, rng: np.random.Generator) -> tuple[Detection, ...]:
        """What one frame shows."""
        own, prey = moment.poses[self.context.hunter], moment.poses[self.context.prey]
        seen = own.relative(prey)
        # Always the same number of draws a frame, so that a frame does not depend on those before it.
        noise, chance, false = rng.normal(size=3), rng.random(), rng.poisson(self.camera.clutter)
        found = []
        if shown or (chance < self.camera.detection and self._visible(seen, own, prey, map)):
            found.append(self._measured(seen, noise))
        if not shown:
            found += [self._false(rng) for _ in range(false)]
        return tuple(sorted(found, key=_bearing))

    def _visible(self, seen: Polar, own: Pose, prey: Pose, map: Map) -> bool:
        return bool(self.camera.in_view(seen, self.width)) and not map.blocked(Ray(own.x, own.y, prey.x, prey.y))

    def _measured(self, seen: Polar, noise: np.ndarray) -> Detection:
        camera = self.camera
        width_px = max(camera.focal * self.width / max(seen.distance, 1e-6) + camera.pixel_noise * noise[0], 1.0)
        heading = math.nan if camera.heading_sd is None else wrap(float(seen.heading + camera.heading_sd * noise[2]))
        bearing = wrap(float(seen.angle + camera.bearing_sd * noise[1]))
        return camera.detection_of(bearing, width_px=float(width_px), heading=heading, width=self.width)

    def _false(self, rng: np.random.Generator) -> Detection:
        """Something anywhere in view: uniform over the area up to ``clutter_range``."""
        far, across, turned = rng.random(3)
        distance = self.camera.clutter_range * math.sqrt(max(far, 1e-6))
        bearing = (across - 0.5) * self.camera.fov
        heading = math.nan if self.camera.heading_sd is None else float(wrap(2.0 * math.pi * turned))
        return self.camera.detection_of(bearing, distance=distance, heading=heading, width=self.width)


def look_moments(times: Sequence[float], begun: float, time_step: float | None, frames: int) -> list[int]:
    """Return the indices of the moments at which a camera looks: evenly over a time-step, the last one always.

    times: of the moments [s]. begun: when the step began. A step that was cut short has fewer looks.
    """
    if len(times) == 1 or time_step is None:
        return [len(times) - 1]
    due = [begun + time_step * (look + 1) / frames for look in range(frames)]
    chosen = {int(np.abs(np.asarray(times) - at).argmin()) for at in due if at <= times[-1] + 1e-9}
    return sorted(chosen | {len(times) - 1})


def _bearing(detection: Detection) -> float:
    assert detection.seen is not None
    return float(detection.seen.angle)
