"""One hunt as the world has it: bodies, catch rule and clock; who decides is outside."""

from __future__ import annotations

import math

import numpy as np

from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.errors import BayesHuntError
from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import FloatArray, Polar
from bayeshunt.core.messages import Reach, Run
from bayeshunt.core.task import Task
from bayeshunt.worlds.foresight import foresee
from bayeshunt.worlds.registry import make_world
from bayeshunt.worlds.scene import HUNTER, PREY, Scene

__all__ = ["Trial"]


class Trial:
    """A hunt in progress, from the reset to the catch or the time limit."""

    def __init__(
        self, settings: ExperimentSettings, arena: str, theta: float, streams: dict[str, np.random.Generator]
    ) -> None:
        """Start a fresh world; ``streams``: a generator by role."""
        body = settings.robot.body.body_length
        self.settings = settings
        # whole physics steps until the time limit, which a catch must not outlast; at least one in all
        self._steps = max(1, math.floor(settings.protocol.time_limit / settings.physics.step + 1e-9))
        self._step = settings.physics.step
        self.task = Task(settings.protocol.catch_distance * body, settings.protocol.time_limit)
        self.reach = Reach(HUNTER, PREY, settings.protocol.catch_distance * body)
        scene = Scene(settings.robot, settings.prey, settings.arenas[arena], settings.physics)
        self.world = make_world(settings.world, scene)
        hunter, prey = settings.starting_poses(theta)
        self.moment = self.world.reset({HUNTER: hunter, PREY: prey}, streams)
        self.start = self.moment.poses[HUNTER]  # the origin of its odometry
        self.caught = self.world.run({}, 0.0, self.reach).stopped is not None
        self.distance = self.energy = 0.0

    @property
    def falls(self) -> int:
        """How often the hunter fell so far."""
        return self.world.bodies[HUNTER].falls

    @property
    def time_left(self) -> float:
        """Seconds in whole physics steps until the time limit."""
        return (self._steps - round(self.moment.time / self._step)) * self._step

    @property
    def done(self) -> bool:
        """Whether the prey is caught or time is up."""
        return self.caught or not self.time_left > 0

    @property
    def time(self) -> float:
        """Seconds to the catch; the time limit if there was none."""
        return self.moment.time if self.caught else self.settings.protocol.time_limit

    def step(self, gait: Gait, prey: Gait | None = None, *, thought: float = 0.0, held: Gait | None = None) -> Run:
        """Let the hunter hold ``gait`` for a time-step, or for what is left; ``prey``: the prey's gait, if any.

        thought: seconds of the time-step for which it still thinks, in whole physics steps; the world goes on, and it
        holds ``held``, the gait before (None: it stands).
        """
        before, step = self.moment, self._step
        left = min(self.settings.robot.gait_duration, self.time_left)
        wait = min(math.floor(thought / step + 1e-9) * step, left) if thought else 0.0
        others = {} if prey is None else {PREY: prey}
        run = Run(())
        if wait > 0:
            run = self.world.run(others if held is None else {HUNTER: held, **others}, wait, self.reach)
        if run.stopped is None and left - wait > 0.5 * step:
            run = _joined(run, self.world.run({HUNTER: gait, **others}, left - wait, self.reach))
        now = run.moments[-1] if run.moments else before
        if not now.time > before.time:
            raise BayesHuntError(f"world {self.settings.world!r}: a run of a gait took no time; run check_world on it")
        self.moment, self.caught = now, run.stopped is not None
        start, end = before.poses[HUNTER], self.moment.poses[HUNTER]
        self.distance += math.hypot(end.x - start.x, end.y - start.y)
        self.energy += run.energy.get(HUNTER, 0.0)
        return run

    def future(self, duration: float) -> tuple[FloatArray, Polar[FloatArray]]:
        """Return times [M] from now [s] and the prey's noise-free poses then, as the hunter sees them now."""
        times, poses = foresee(self.world, duration)
        return times, self.moment.poses[HUNTER].relative(poses)


def _joined(one: Run, other: Run) -> Run:
    """Two runs, one after the other, as one."""
    if not one.moments:
        return other
    energy = {name: spent + one.energy.get(name, 0.0) for name, spent in other.energy.items()}
    return Run([*one.moments, *other.moments], other.stopped, energy)
