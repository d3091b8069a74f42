"""The road on one page: World -> Observation -> Belief -> Situation -> Plan -> Gait -> World.

SI units; fixed frames counter-clockwise, :class:`Polar` clockwise; A actuators, N samples, J times. Every class here is
a promise, not a base: whatever has these members will do. ``rng`` is always a required keyword and the only source of
chance. Each door has a check to run over your own:
``bayeshunt.check_world`` and its like.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol, runtime_checkable

import numpy as np

from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import FloatArray, Polar, Pose
from bayeshunt.core.messages import Detection, Frame, Moment, Observation, Ray, Reach, Run
from bayeshunt.core.task import Task

__all__ = [
    "Belief", "Body", "Detection", "ExpectingModel", "Frame", "Map", "Moment", "MovingBelief", "Observation",
    "PreyBehaviour", "Ray", "Reach", "Run",
    "Sensor", "TargetModel", "Task", "Tracker", "World",
]  # fmt: skip


@runtime_checkable
class Body(Protocol):
    """One robot in a world; its own sub-steps and its own actuators inside."""

    @property
    def name(self) -> str:
        """What the world calls it: "hunter", "prey"."""

    @property
    def length(self) -> float:
        """Body length [m], the unit of distances that are given in bodies."""

    @property
    def pose(self) -> Pose:
        """Its pose in the world, projected to the plane [m, rad]."""

    @property
    def energy(self) -> float:
        """Joules spent since the reset; 0 if the body does not know."""

    @property
    def falls(self) -> int:
        """How often it had to be set upright since the reset."""

    def command(self, gait: Gait) -> None:
        """Hold ``gait`` from now on."""

    def place(self, pose: Pose) -> None:
        """Put it at ``pose`` as it is, its momentum kept; a real robot raises InputError."""


@runtime_checkable
class Map(Protocol):
    """What stands where."""

    def free(self, x: Any, y: Any) -> Any:
        """Return whether a point [m] is neither in a wall nor beyond one: bool, or an array of them."""

    def blocked(self, ray: Ray) -> bool:
        """Return whether something stands in the way of a straight line."""


@runtime_checkable
class World(Protocol):
    """Moves bodies. A trial gets a world of its own."""

    @property
    def bodies(self) -> Mapping[str, Body]:
        """Every body by name, in the order in which they were made; known after :meth:`reset`."""

    @property
    def map(self) -> Map:
        """What stands where."""

    @property
    def control_interval(self) -> float:
        """Seconds between two decisions of the prey and two draws of noise."""

    @property
    def identity(self) -> Mapping[str, str]:
        """``engine`` and ``version``: what a result depends on beside the settings."""

    def reset(self, start: Mapping[str, Pose], streams: Mapping[str, np.random.Generator]) -> Moment:
        """Make the bodies that ``start`` names, at rest at its poses. streams: by role (``bayeshunt.core.streams``)."""

    def run(self, gaits: Mapping[str, Gait], duration: float, until: Reach | None = None) -> Run:
        """Hold gaits for ``duration`` [s] or until one body reaches another; a body not named is its own master.

        duration 0 only tells whether it is reached already; a run that begins so ends at once.
        """

    def fork(self, *only: str) -> World:
        """Return a noise-free twin of now, with the bodies named (none: all); this world stays as it is."""

    def close(self) -> None:
        """Give back what the world holds; it is not used again."""


@runtime_checkable
class PreyBehaviour(Protocol):
    """Steers a prey, one control interval at a time; made anew for every trial, and may keep a state."""

    def act(self, x: float, y: float, theta: float, hunter_x: float, hunter_y: float) -> tuple[float, float]:
        """Return left and right wheel speed [m/s] for the next interval; poses in the world [m, rad]."""


@runtime_checkable
class Sensor(Protocol):
    """Looks at what a world did. One that needs only the last moment of a run may say so by ``at_end = True``."""

    def sense(self, run: Run, map: Map, *, rng: np.random.Generator) -> Observation:
        """Return what was seen of ``run``, empty looks too. The start of a hunt is a run of one moment."""


@runtime_checkable
class Belief(Protocol):
    """Where the prey may be, in the odometry frame, and what of its motion was seen. A value: it never changes."""

    @property
    def mean(self) -> Pose:
        """Its expected pose [m, rad]; a guess as long as it was never seen."""

    @property
    def resultant(self) -> float:
        """How sure the heading is, 0 (unknown) to 1 (known): the mean resultant length of its direction."""

    @property
    def covariance(self) -> FloatArray:
        """Of x, y, theta: [3, 3]; inf where nothing is known."""

    @property
    def last_seen(self) -> float:
        """Seconds since it was last seen; inf if it never was."""

    @property
    def transitions(self) -> tuple[Polar, ...]:
        """Its pose transitions that were observed, oldest first, each in its own earlier frame, one per time-step."""

    def sample(self, n: int, *, rng: np.random.Generator) -> Pose[FloatArray]:
        """Return ``n`` poses that it may have: a Pose of arrays [N]."""

    def in_view(self) -> float:
        """Return the probability that it is in view now."""

    def table(self) -> Any:
        """Return what is believed, as a table to look at: a DataFrame."""


@runtime_checkable
class MovingBelief(Protocol):
    """What a belief may tell besides, if it is one of how the prey moves too."""

    @property
    def expected(self) -> tuple[Polar[FloatArray], FloatArray] | None:
        """What the prey's transition in the last step may have been, [N], and how probable each is; None: not known."""

    def sample_motion(self, n: int, *, rng: np.random.Generator) -> tuple[Pose[FloatArray], FloatArray]:
        """Return ``n`` poses that it may have, and its speed [m/s] in each."""


@runtime_checkable
class Tracker(Protocol):
    """Turns observations into beliefs. Pure: it keeps nothing, and a belief that it was given stays as it is."""

    def start(self, observation: Observation) -> Belief:
        """Return the belief after the first observation."""

    def update(self, belief: Belief, gait: Gait, observation: Observation, *, rng: np.random.Generator) -> Belief:
        """Return the belief after ``gait`` was executed and ``observation`` made at its end."""


@runtime_checkable
class ExpectingModel(Protocol):
    """What a model of the prey may do besides: learn from a transition of which only probabilities are known."""

    def expect(self, transitions: Polar[FloatArray], weights: FloatArray) -> None:
        """Learn one transition: what it may have been, [N], and how probable each is."""


@runtime_checkable
class TargetModel(Protocol):
    """What is learned of the prey's motion, online: exactly what the hunt, its record and the planners use."""

    @property
    def is_empty(self) -> bool:
        """True while nothing has been observed."""

    @property
    def observations(self) -> int:
        """How many transitions were observed."""

    def observe(self, transition: Polar) -> None:
        """Learn one pose transition, given in the prey's own earlier frame, one time-step long."""

    def predict_path(self, steps: int) -> Polar[FloatArray]:
        """Return its expected poses 0..steps ahead in its present frame: Polar of arrays [steps + 1]."""

    def copy(self) -> TargetModel:
        """Return an independent model that knows the same."""

    def cells(self) -> Sequence[Sequence[float]]:
        """Return [distance m, angle rad, heading rad, count] of every cell seen, for the record; may be empty."""
