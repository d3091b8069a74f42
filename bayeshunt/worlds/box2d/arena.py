"""The arena: one hunter, one prey, Box2D, and the catch rule, checked at every physics step.

An arena serves one trial. A reused ``b2World`` carries contact state over and gives another
result for the same trial, so every trial gets a fresh one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import Box2D
import numpy as np

from bayeshunt.config.schema import ArenaSettings, PhysicsSettings, PreySettings, RobotSettings
from bayeshunt.core.geometry import Pose
from bayeshunt.worlds.box2d.bodies import build_drive
from bayeshunt.worlds.prey.behaviours import Context, build_prey


class Streams(NamedTuple):
    """One random generator per role, so that planners meet the same noise."""

    hunter: np.random.Generator
    prey_noise: np.random.Generator
    prey_control: np.random.Generator


class Moment(NamedTuple):
    """One recorded instant: time [s], hunter and prey poses [m, rad]."""

    time: float
    hunter: Pose
    prey: Pose


class Arena:
    """A trial in progress. The one mutable object of the world."""

    def __init__(
        self,
        robot: RobotSettings,
        prey: PreySettings,
        arena: ArenaSettings,
        physics: PhysicsSettings,
        streams: Streams,
        *,
        hunter_pose: Pose,
        prey_pose: Pose,
        catch_distance: float,
    ) -> None:
        """Start a trial with both robots at rest; ``catch_distance`` is in metres."""
        self.unit = robot.body.diameter
        self.catch_distance = catch_distance
        self.physics = physics
        self.world = new_world()
        if arena.walled:
            build_walls(self.world, arena.width / self.unit, arena.height / self.unit)
        self.hunter = build_drive(self.world, robot.body, robot.noise, physics, self.unit, streams.hunter)
        self.prey = build_drive(self.world, prey.body, prey.noise, physics, self.unit, streams.prey_noise)
        self.hunter.place(hunter_pose)
        self.prey.place(prey_pose)
        self.context = Context(prey, arena, robot.body.diameter, physics.control_interval, streams.prey_control)
        self._controller = build_prey(self.context)
        self._catch = (catch_distance / self.unit) ** 2
        self._steps = 0
        self.caught = self._within_reach()

    @property
    def time(self) -> float:
        """Seconds since the start: whole physics steps."""
        return self._steps * self.physics.step

    def run(self, command: Sequence[float], duration: float, record: list[Moment] | None = None) -> bool:
        """Hold ``command`` for ``duration`` [s] or until the catch; return whether there was one.

        record: filled with a :class:`Moment` per control interval.
        """
        self.hunter.command(*command)
        remaining = self.physics.steps(duration)
        while remaining > 0 and not self.caught:
            self._control()
            count = min(self.physics.control_steps - self._steps % self.physics.control_steps, remaining)
            self._advance(count)
            remaining -= count
            if record is not None:
                record.append(Moment(self.time, self.hunter.pose, self.prey.pose))
        return self.caught

    def _control(self) -> None:
        """At the start of a control interval: new noise, and the prey decides."""
        if self._steps % self.physics.control_steps:
            return
        hunter, prey, unit = self.hunter, self.prey, self.unit
        hunter.next_interval()
        prey.next_interval()
        at, hunter_at = prey.position, hunter.position
        prey.command(
            *self._controller.act(at.x * unit, at.y * unit, prey.body.angle, hunter_at.x * unit, hunter_at.y * unit)
        )

    def _advance(self, count: int) -> None:
        """Take up to ``count`` physics steps, stopping at the catch."""
        world, physics = self.world, self.physics
        step = world.Step
        hunter, prey = self.hunter, self.prey
        at, hunter_at = prey.position, hunter.position
        for _ in range(count):
            hunter.advance()
            prey.advance()
            step(physics.step, physics.velocity_iterations, physics.position_iterations)
            self._steps += 1
            if world.contactCount:
                hunter.read_back()
                prey.read_back()
            dx, dy = hunter_at.x - at.x, hunter_at.y - at.y
            if dx * dx + dy * dy <= self._catch:
                self.caught = True
                return

    def _within_reach(self) -> bool:
        dx = self.hunter.position.x - self.prey.position.x
        dy = self.hunter.position.y - self.prey.position.y
        return bool(dx * dx + dy * dy <= self._catch)


def new_world() -> Any:
    """Return an empty Box2D world seen from above: no gravity, nothing sleeps."""
    return Box2D.b2World(gravity=(0, 0), doSleep=False)


def build_walls(world: Any, width: float, height: float) -> Any:
    """Add four walls around a rectangle [Box2D units] centred on the origin; return their body."""
    thick = 1.0
    x, y = 0.5 * width, 0.5 * height
    boxes = (
        ((x + thick, 0.0), (thick, y + 2 * thick)),
        ((-x - thick, 0.0), (thick, y + 2 * thick)),
        ((0.0, y + thick), (x + 2 * thick, thick)),
        ((0.0, -y - thick), (x + 2 * thick, thick)),
    )
    walls = world.CreateStaticBody()
    for centre, half in boxes:
        walls.CreateFixture(shape=Box2D.b2PolygonShape(box=(*half, centre, 0.0)), friction=0.0, restitution=0.0)
    return walls
