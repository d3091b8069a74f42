"""The protocols of the road on one page; see :mod:`bayeshunt.core.protocols`, of which this is the public name."""

from bayeshunt.core.protocols import (
    Belief,
    Body,
    Detection,
    ExpectingModel,
    Frame,
    Map,
    Moment,
    MovingBelief,
    Observation,
    PreyBehaviour,
    Ray,
    Reach,
    Run,
    Sensor,
    TargetModel,
    Task,
    Tracker,
    World,
)

__all__ = [
    "Belief", "Body", "Detection", "ExpectingModel", "Frame", "Map", "Moment", "MovingBelief", "Observation",
    "PreyBehaviour", "Ray", "Reach", "Run", "Sensor", "TargetModel", "Task", "Tracker", "World",
]  # fmt: skip
