"""A Box2D world with one hunter and one prey, driven by bare commands: what many tests of the physics share."""

from __future__ import annotations

import numpy as np

from bayeshunt.core.gaits import Gait
from bayeshunt.core.messages import Reach
from bayeshunt.worlds.box2d.world import Box2DWorld
from bayeshunt.worlds.scene import Scene


class Trial:
    """One hunter, one prey, a catch distance [m]; generators by three seeds: hunter, prey, the prey's behaviour."""

    def __init__(self, robot, prey, arena, physics, *, seeds=(0, 1, 2), hunter_pose, prey_pose, catch_distance):
        roles = ("hunter", "prey", "prey_control")
        streams = {role: np.random.default_rng(seed) for role, seed in zip(roles, seeds, strict=True)}
        self.simulation, self.physics = Box2DWorld(Scene(robot, prey, arena, physics)), physics
        self.simulation.reset({"hunter": hunter_pose, "prey": prey_pose}, streams)
        self.reach = Reach("hunter", "prey", catch_distance)

    def run(self, command, duration, record=None):
        """Hold a command; return whether the prey was caught. record: filled with the moments."""
        run = self.simulation.run({"hunter": Gait("held", tuple(command))}, duration, self.reach)
        if record is not None:
            record.extend(run.moments)
        return run.stopped is not None

    @property
    def hunter(self):
        return self.simulation.bodies["hunter"]

    @property
    def prey(self):
        return self.simulation.bodies["prey"]

    @property
    def world(self):
        return self.simulation.world

    @property
    def unit(self):
        return self.simulation.unit

    @property
    def time(self):
        return self.simulation.time
