"""What of a belief goes into an episode's table, where the hunter sees by a camera."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from bayeshunt.core.messages import Observation
from bayeshunt.core.protocols import Belief
from bayeshunt.planners.api import Situation

__all__ = ["belief_record"]

#: Places drawn from a belief for its picture.
_SHOWN = 120


def belief_record(situation: Situation, observation: Observation | None) -> dict[str, Any]:
    """Return columns of one decision; none where the prey is told.

    belief_spread [m], belief_resultant, belief_last_seen [s, inf: never], belief_in_view. Lists, as the hunter sees
    them now: cloud_distance, cloud_angle of places drawn from the belief; sighted_distance, sighted_angle of all that
    the frames of the step before have shown, false ones too. belief_table: [nearest m, farthest m, from rad, to rad,
    probability, sightings] of the cells of ``belief.table()`` that hold at least half a percent, the likeliest first.
    """
    belief, own = situation.belief, situation.pose
    if situation.camera is None or own is None or not isinstance(belief, Belief):
        return {}
    cloud = own.relative(belief.sample(_SHOWN, rng=np.random.default_rng(0)))
    frames = () if observation is None else observation.frames
    sighted = [own.relative(d.placed(frame.pose)) for frame in frames for d in frame.detections]
    covariance = belief.covariance
    cells = getattr(belief, "cells", None)  # of particles
    return {
        "belief_spread": math.sqrt(float(covariance[0, 0] + covariance[1, 1])),
        "belief_resultant": float(belief.resultant),
        "belief_last_seen": float(belief.last_seen),
        "belief_in_view": float(belief.in_view()),
        "cloud_distance": cloud.distance.tolist(),
        "cloud_angle": cloud.angle.tolist(),
        "sighted_distance": [float(one.distance) for one in sighted],
        "sighted_angle": [float(one.angle) for one in sighted],
        "belief_table": None if cells is None else cells(),
    }
