"""The world of recorded prey: the hunter is a body of Box2D, the prey goes where it was recorded to go.

The prey starts where the hunt starts it, facing as it did; nothing stops or moves it, and it does not see the hunter.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import cos, sin

import numpy as np

from bayeshunt.core.errors import InputError
from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import Pose
from bayeshunt.core.messages import Moment
from bayeshunt.worlds.box2d.bodies import Drive, Parts
from bayeshunt.worlds.box2d.world import Box2DWorld
from bayeshunt.worlds.recorded.path import RecordedPath, path_of
from bayeshunt.worlds.scene import HUNTER, Scene

__all__ = ["Led", "RecordedWorld"]


class Led(Drive):
    """A body that is led along a recorded way: in every physics step it is given the velocity that keeps it there."""

    __slots__ = ("_done", "_interval", "_start", "_way")

    def __init__(self, parts: Parts, way: RecordedPath) -> None:
        super().__init__(parts)
        self.body.fixtures[0].sensor = True  # it pushes nobody, and nobody pushes it
        self._way, self._interval, self._done, self._start = way, parts.physics.step, 0, Pose(0.0, 0.0, 0.0)

    def limits(self, step: float) -> tuple[float, ...]:
        """No actuators."""
        return ()

    def twist(self, *values: float) -> tuple[float, float, float]:
        """Not moved by actuators."""
        return 0.0, 0.0, 0.0

    def command(self, gait: Gait) -> None:
        """Raise InputError: a recorded prey goes where it went."""
        raise InputError(f"{self.name}: a recorded prey holds no gait")

    def next_interval(self) -> None:
        """Nothing is drawn."""

    def begin(self, start: Pose) -> None:
        """Start its way at a pose [m, rad]."""
        self._start, self._done = start, 0
        self.place(start)

    def advance(self) -> None:
        """Set the velocity that takes it to where it is at the end of the physics step."""
        self._done += 1
        gone, start, body = self._way.at(self._done * self._interval), self._start, self.body
        c, s = cos(start.theta), sin(start.theta)
        aim_x, aim_y = start.x + c * gone.x - s * gone.y, start.y + s * gone.x + c * gone.y
        share = self._scale / self._interval
        velocity = self._velocity
        velocity.x = self.vx = aim_x * share - self._position.x / self._interval
        velocity.y = self.vy = aim_y * share - self._position.y / self._interval
        body.angularVelocity = (start.theta + gone.theta - float(body.angle)) / self._interval

    def read_back(self) -> None:
        """Contacts do nothing to it."""

    def continue_as(self, other: Drive) -> None:
        """Go on along the way from where ``other`` is."""
        if isinstance(other, Led):
            self.begin(other._start)
            self._done = other._done
            self.place(other.pose)


class RecordedWorld(Box2DWorld):
    """A trial with prey whose behaviour is "recorded:tracks.parquet#id": see ``bayeshunt.protocols.World``.

    Raises InputError for another behaviour and for an arena with walls or obstacles, through which recorded prey goes.
    """

    def __init__(self, scene: Scene) -> None:
        if scene.arena.walled or scene.arena.obstacles:
            raise InputError("a recorded prey goes through walls and obstacles: choose an arena without, such as open")
        super().__init__(scene)
        self._way = None if scene.prey is None else path_of(scene.prey.behaviour)

    def reset(self, start: Mapping[str, Pose], streams: Mapping[str, np.random.Generator]) -> Moment:
        """Make the bodies of ``start`` in a fresh world; every name but "hunter" is led along the recorded way."""
        self._begin()
        for name, pose in start.items():
            body = self._add(name, streams[name])
            if isinstance(body, Led):
                body.begin(pose)
            else:
                body.place(pose)
        return Moment(self.time, {name: body.pose for name, body in self.bodies.items()})

    def fork(self, *only: str) -> RecordedWorld:
        """Return a noise-free twin, whose prey goes on where it is."""
        twin = RecordedWorld(self.scene.quiet(alone=bool(only) and HUNTER not in only))
        twin._begin()
        nobody = np.random.default_rng(0)
        for name in only or self.bodies:
            twin._add(name, nobody).continue_as(self._body(name))
        return twin

    def _make(self, parts: Parts, drive: str) -> Drive:
        if parts.name == HUNTER or self._way is None:
            return super()._make(parts, drive)
        return Led(parts, self._way)
