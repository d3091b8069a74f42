"""One hunt as the world has it: bodies, catch rule and clock; who decides is outside."""

from __future__ import annotations

import math

import numpy as np

from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.errors import BayesHuntError
from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import FloatArray, Polar
from bayeshunt.core.messages import Moment, Reach, Run
from bayeshunt.core.task import Task
from bayeshunt.worlds.foresight import foresee
from bayeshunt.worlds.registry import make_world
from bayeshunt.worlds.scene import HUNTER, PREY, Scene

__all__ = ["Trial"]


class Trial:
    """A hunt in progress, from the reset to the catch or the time limit.

    moment: where both robots are. caught: whether the prey is. time_left: seconds in whole physics steps until the
    time limit. done: whether it is caught or time is up. distance [m], energy [J]: of the hunter, so far.
    """

    def __init__(
        self, settings: ExperimentSettings, arena: str, theta: float, streams: dict[str, np.random.Generator]
    ) -> None:
        """Start a fresh world; ``streams``: a generator by role."""
        body = settings.robot.body.body_length
        self.settings = settings
        # whole physics steps until the time limit, which a catch must not outlast; at least one in all
        self._steps = max(1, math.floor(settings.protocol.time_limit / settings.physics.step + 1e-9))
        self._step, self._held = settings.physics.step, settings.robot.gait_duration
        self.task = Task(settings.protocol.catch_distance * body, settings.protocol.time_limit)
        self.reach = Reach(HUNTER, PREY, settings.protocol.catch_distance * body)
        scene = Scene(settings.robot, settings.prey, settings.arenas[arena], settings.physics)
        self.world = make_world(settings.world, scene)
        hunter, prey = settings.starting_poses(theta)
        moment = self.world.reset({HUNTER: hunter, PREY: prey}, streams)
        self.start = moment.poses[HUNTER]  # the origin of its odometry
        self._arrive(moment, self.world.run({}, 0.0, self.reach))
        self.distance = self.energy = 0.0

    @property
    def falls(self) -> int:
        """How often the hunter fell so far."""
        return self.world.bodies[HUNTER].falls

    @property
    def time(self) -> float:
        """Seconds to the catch; the time limit if there was none."""
        return self.moment.time if self.caught else self.settings.protocol.time_limit

    def step(self, gait: Gait, prey: Gait | None = None, *, thought: float = 0.0, held: Gait | None = None) -> Run:
        """Let the hunter hold ``gait`` for a time-step, or for what is left; ``prey``: the prey's gait, if any.

        thought: seconds of the time-step for which it still thinks, in whole physics steps; the world goes on, and it
        holds ``held``, the gait before (None: it stands).
        """
        before, left = self.moment, min(self._held, self.time_left)
        gaits = {HUNTER: gait} if prey is None else {HUNTER: gait, PREY: prey}
        run = self._thinking(gaits, held, left, thought) if thought else self.world.run(gaits, left, self.reach)
        now = run.moments[-1] if run.moments else before
        if not now.time > before.time:
            raise BayesHuntError(f"world {self.settings.world!r}: a run of a gait took no time; run check_world on it")
        self._arrive(now, run)
        start, end = before.poses[HUNTER], now.poses[HUNTER]
        self.distance += math.hypot(end.x - start.x, end.y - start.y)
        self.energy += run.energy.get(HUNTER, 0.0)
        return run

    def _arrive(self, moment: Moment, run: Run) -> None:
        self.moment, self.caught = moment, run.stopped is not None
        self.time_left = (self._steps - round(moment.time / self._step)) * self._step
        self.done = self.caught or not self.time_left > 0

    def _thinking(self, gaits: dict[str, Gait], held: Gait | None, left: float, thought: float) -> Run:
        """Run for ``left`` [s], while the hunter still holds the gait before (None: it stands)."""
        step = self._step
        wait = min(math.floor(thought / step + 1e-9) * step, left)
        run = Run(())
        if wait > 0:
            others = {name: gait for name, gait in gaits.items() if name != HUNTER}
            run = self.world.run(others if held is None else {HUNTER: held, **others}, wait, self.reach)
        if run.stopped is None and left - wait > 0.5 * step:
            run = _joined(run, self.world.run(gaits, left - wait, self.reach))
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
