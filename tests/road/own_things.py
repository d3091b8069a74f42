"""Things of somebody's own, made with public names alone: a body, a world, a prey model, a tracker."""

import math
from collections import deque
from typing import NamedTuple

import numpy as np

import bayeshunt as bh
from bayeshunt.protocols import Moment, Run


# --- a body with three actuators, in the world that ships -------------------------------------------
class Omni(bh.Drive):
    """Three omniwheels at 60, 180 and 300 degrees from ahead; a command is three wheel speeds [m/s]."""

    def limits(self, step):
        return (self.settings.max_acceleration * step,) * 3

    def twist(self, *wheels):
        directions = [math.radians(degrees + 90) for degrees in (60, 180, 300)]
        ahead = 2 / 3 * sum(w * math.cos(d) for w, d in zip(wheels, directions, strict=True))
        left = 2 / 3 * sum(w * math.sin(d) for w, d in zip(wheels, directions, strict=True))
        return ahead, left, sum(wheels) / (3 * self.settings.arm)


class OmniSettings(bh.DriveSettings):
    """An omniwheeled body."""

    arm: float = 0.025


def wheels(ahead, left, turn, arm=0.025):
    """Speeds [m/s] of the three wheels."""
    directions = [math.radians(degrees + 90) for degrees in (60, 180, 300)]
    return [ahead * math.cos(d) + left * math.sin(d) + arm * turn for d in directions]


OMNI_GAITS = {
    "ahead": (0.06, 0.0, 0.0), "left": (0.0, 0.06, 0.0), "right": (0.0, -0.06, 0.0), "back": (-0.06, 0.0, 0.0),
    "ahead left": (0.042, 0.042, 0.0), "ahead right": (0.042, -0.042, 0.0), "turn": (0.02, 0.0, 0.3),
}  # fmt: skip


# --- a world that is not Box2D ----------------------------------------------------------------------
class Point:
    """A body that moves by kinematics alone."""

    energy, falls = 0.0, 0

    def __init__(self, name, length, pose, rng):
        self.name, self.length, self.pose, self.rng, self.held = name, length, pose, rng, (0.0, 0.0)

    def command(self, gait):
        self.held = gait.command

    def place(self, pose):
        self.pose = pose

    def move(self, interval, noise):
        left, right = (wheel * (1 + noise * self.rng.standard_normal()) for wheel in self.held)
        x, y, theta = self.pose
        ahead = 0.5 * (left + right) * interval
        self.pose = bh.Pose(
            x + ahead * math.cos(theta), y + ahead * math.sin(theta), theta + (right - left) / 0.052 * interval
        )


class Kinematic:
    """Unicycles on an open plane."""

    control_interval, identity = 0.064, {"engine": "kinematic", "version": "1"}

    def __init__(self, scene):
        self.scene, self.bodies, self.noise, self.time, self.map = scene, {}, 0.05, 0.0, Plane()

    def reset(self, start, streams):
        lengths = {"hunter": self.scene.robot.body.diameter}
        self.bodies = {n: Point(n, lengths.get(n, 0.057), pose, streams[n]) for n, pose in start.items()}
        self.time = 0.0
        if "prey" in self.bodies:
            self.bodies["prey"].held = (self.scene.prey.speed,) * 2
        return self.moment()

    def moment(self):
        return Moment(self.time, {name: body.pose for name, body in self.bodies.items()})

    def run(self, gaits, duration, until=None):
        for name, gait in gaits.items():
            self.bodies[name].command(gait)
        moments = []
        for _ in range(round(duration / self.control_interval)):
            if self.reached(until):
                break
            for body in self.bodies.values():
                body.move(self.control_interval, self.noise)
            self.time += self.control_interval
            moments.append(self.moment())
        return Run(moments, until.whom if self.reached(until) else None)

    def reached(self, until):
        if until is None:
            return False
        one, other = self.bodies[until.who].pose, self.bodies[until.whom].pose
        return math.hypot(one.x - other.x, one.y - other.y) <= until.distance

    def fork(self, *only):
        twin = Kinematic(self.scene)
        twin.noise = 0.0
        for name in only or self.bodies:
            body = self.bodies[name]
            twin.bodies[name] = Point(name, body.length, body.pose, np.random.default_rng(0))
            twin.bodies[name].held = body.held
        return twin

    def close(self):
        self.bodies = {}


class Plane:
    """No walls."""

    def free(self, x, y):
        return np.ones(np.shape(x), dtype=bool) if np.ndim(x) else True

    def blocked(self, ray):
        return False


# --- a prey model that is not ours ------------------------------------------------------------------
class LastSeen:
    """The prey does again what it did last."""

    def __init__(self, axes=None):
        self.last, self.observations = None, 0

    @property
    def is_empty(self):
        return self.last is None

    def observe(self, transition):
        self.last, self.observations = transition, self.observations + 1

    def predict_path(self, steps):
        path = [bh.Polar(0.0, 0.0, 0.0)]
        for _ in range(steps):
            path.append(path[-1].compose(self.last))
        return bh.Polar(*np.array(path, dtype=float).T)

    def copy(self):
        twin = LastSeen()
        twin.last, twin.observations = self.last, self.observations
        return twin

    def cells(self):
        return [] if self.last is None else [[*self.last, 1.0]]

    def __eq__(self, other):
        return isinstance(other, LastSeen) and (self.last, self.observations) == (other.last, other.observations)

    __hash__ = None


# --- a tracker that delays --------------------------------------------------------------------------
class Late(NamedTuple):
    """A belief that lags: where the prey was some observations ago."""

    mean: bh.Pose
    waiting: tuple = ()
    transitions: tuple = ()
    resultant: float = 1.0
    last_seen: float = 0.0

    @property
    def covariance(self):
        return np.zeros((3, 3))

    def sample(self, n, *, rng):
        return bh.Pose(*(np.full(n, float(part)) for part in self.mean))

    def in_view(self):
        return 1.0

    def table(self):
        import pandas as pd

        return pd.DataFrame([self.mean])


class Delaying:
    """Believes every sighting ``delay`` observations late."""

    def __init__(self, context, delay=1):
        self.delay = delay

    def start(self, observation):
        place = observation.detection.placed(observation.pose)
        return Late(place, (place,) * self.delay)

    def update(self, belief, gait, observation, *, rng):
        queue = deque((*belief.waiting, observation.detection.placed(observation.pose)))
        now = queue.popleft()
        return Late(now, tuple(queue), (*belief.transitions, belief.mean.relative(now)))
