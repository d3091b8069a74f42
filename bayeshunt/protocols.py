"""The protocols of the road on one page; see :mod:`bayeshunt.core.protocols`, of which this is the public name."""

from bayeshunt.core.protocols import (
    Belief,
    Body,
    Detection,
    Frame,
    Map,
    Moment,
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
    "Belief", "Body", "Detection", "Frame", "Map", "Moment", "Observation", "PreyBehaviour", "Ray", "Reach", "Run",
    "Sensor", "TargetModel", "Task", "Tracker", "World",
]  # fmt: skip
