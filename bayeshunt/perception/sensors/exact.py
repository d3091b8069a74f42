"""The exact sensor: both poses after every step, in the hunter's odometry, to the last bit. It draws nothing."""

from __future__ import annotations

import numpy as np

from bayeshunt.core.geometry import Pose, in_frame
from bayeshunt.core.messages import Detection, Frame, Moment, Observation, Run
from bayeshunt.core.protocols import Map
from bayeshunt.perception.setting import PerceptionContext

__all__ = ["ExactSensor", "exact_observation"]


class ExactSensor:
    """Sees the prey at the end of a step, wherever it is: see ``bayeshunt.protocols.Sensor``."""

    at_end = True

    def __init__(self, context: PerceptionContext) -> None:
        self.context = context

    def sense(self, run: Run, map: Map, *, rng: np.random.Generator) -> Observation:
        """Return the poses at the end of ``run``."""
        moment: Moment = run.moments[-1]
        own, prey = moment.poses[self.context.hunter], moment.poses[self.context.prey]
        origin = self.context.origin
        return exact_observation(moment.time, in_frame(own, origin), Detection(pose=in_frame(prey, origin)))


def exact_observation(time: float, own: Pose, detection: Detection | None) -> Observation:
    """Return the observation of one look, now."""
    found = () if detection is None else (detection,)
    return Observation(time, own, (Frame(time, own, found),))
