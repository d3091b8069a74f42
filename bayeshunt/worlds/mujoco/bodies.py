"""The bodies of a trial in MuJoCo: a robot whose servos follow its gait, and discs on two wheels.

Each plans its actuators' targets for some physics steps ahead, which MuJoCo then takes in one call.
Letters: A actuators, N physics steps.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from bayeshunt.config.schema import NoiseSettings, PreySettings
from bayeshunt.config.schema.mujoco import MujocoSettings
from bayeshunt.core.errors import InputError
from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import Pose, wrap
from bayeshunt.worlds.mujoco.model import TRUNK
from bayeshunt.worlds.noise import actuator_factors

__all__ = ["Robot", "Wheels"]

#: Physics steps between two targets of a servo.
_UPDATE = 4


class Robot:
    """A body of an MJCF model on a free joint; its clock is never set back, so that phase carries over.

    energy: mechanical work of the servos, what they take up not given back [J]. falls: how often it was set upright.
    """

    def __init__(
        self, name: str, model: Any, data: Any, settings: MujocoSettings, noise: NoiseSettings, interval: float,
        rng: np.random.Generator,
    ) -> None:  # fmt: skip
        self.name, self.length, self.settings = name, settings.body_length, settings
        self.model, self.data, self.placed = model, data, False
        trunk = model.body(TRUNK)
        joint = model.joint(trunk.jntadr[0])
        self.place_at, self.speed_at = int(joint.qposadr[0]), int(joint.dofadr[0])
        self.count = model.nsensor // 2
        self.lead = range(self.count)  # its actuators come first: its MJCF is what the rest is added to
        self.stand = np.array(model.key("stand").qpos[: model.nq])
        self._own = self._own_joints(trunk)
        self._planned = np.array(model.key("stand").ctrl[: self.count]).tolist()
        self._gait: tuple[float, ...] = ()
        self._factors = actuator_factors(noise, interval, rng, self.count)
        self.factors: tuple[float, ...] = (1.0,) * self.count
        self.energy, self.falls, self.tilted = 0.0, 0, 0
        self._upright(Pose(0.0, 0.0, 0.0))

    def _own_joints(self, trunk: Any) -> list[tuple[int, int]]:
        """Addresses in qpos and qvel of the hinges of the robot."""
        model = self.model
        mine = [j for j in range(model.njnt) if model.body_rootid[model.jnt_bodyid[j]] == trunk.id]
        return [(int(model.jnt_qposadr[j]), int(model.jnt_dofadr[j])) for j in mine if model.jnt_type[j] != 0]

    def command(self, gait: Gait) -> None:
        """Follow another gait from now on; InputError unless it has four values for each actuator."""
        if len(gait.command) != 4 * self.count:
            raise InputError(
                f"{self.name}: gait {gait.name!r} commands {len(gait.command) // 4} actuators, not {self.count}"
            )
        self._gait = gait.command

    def next_interval(self) -> None:
        """Draw the noise of the next control interval: amplitudes are larger or smaller by it."""
        self.factors = next(self._factors)

    def targets(self, step: int, count: int) -> np.ndarray:
        """Return the servos' targets [N, A] for ``count`` physics steps after ``step`` of them."""
        if not self._gait:
            return np.tile(self._planned, (count, 1))
        first = -(-step // _UPDATE)
        updates = range(first, -(-(step + count) // _UPDATE))
        dt, n = self.model.opt.timestep * _UPDATE, self.count
        lim = self.settings.max_rate * dt
        made = np.empty((len(updates) + 1, n))
        made[0] = self._planned
        for i in range(n):
            frequency, offset, amplitude, phase = (self._gait[k * n + i] for k in range(4))
            amplitude *= self.factors[i]
            now = self._planned[i]
            for row, update in enumerate(updates, 1):
                aim = amplitude * math.sin(2.0 * math.pi * (frequency * (update + 1) * dt - phase)) + offset
                now += -lim if aim - now < -lim else lim if aim - now > lim else aim - now
                made[row, i] = now
        held = np.arange(step, step + count) // _UPDATE - first + 1
        self._planned = made[-1].tolist()
        return np.asarray(made[held])

    def done(self, targets: np.ndarray, sensors: np.ndarray) -> None:
        """Take over the targets [N, A] of the steps that were taken, and their work by the sensors [N, 2 A]."""
        self._planned = targets[-1].tolist()
        power = sensors[:, : self.count] * sensors[:, self.count :]
        self.energy += float(np.maximum(power, 0.0).sum()) * self.model.opt.timestep

    def fallen(self, states: np.ndarray) -> int | None:
        """Return after how many of the steps of ``states`` [N, nq] it lies too long; None if it does not."""
        x, y = states[:, self.place_at + 4], states[:, self.place_at + 5]
        down = 1.0 - 2.0 * (x * x + y * y) < math.cos(self.settings.fall_angle)
        if not down.any():
            self.tilted = 0
            return None
        most = max(1, round(self.settings.fall_time / self.model.opt.timestep))
        for number, lies in enumerate(down.tolist(), 1):
            self.tilted = self.tilted + 1 if lies else 0
            if self.tilted >= most:
                return number
        return None

    def set_upright(self) -> None:
        """Stand up where it lies."""
        self.falls += 1
        self.tilted = 0
        self._upright(self.pose)

    def _upright(self, pose: Pose) -> None:
        q, v, at = self.data.qpos, self.data.qvel, self.place_at
        q[at : at + 7] = (
            pose.x,
            pose.y,
            self.stand[2],
            math.cos(0.5 * pose.theta),
            0.0,
            0.0,
            math.sin(0.5 * pose.theta),
        )
        v[self.speed_at : self.speed_at + 6] = 0.0
        for position, speed in self._own:
            q[position], v[speed] = self.stand[position], 0.0

    @property
    def pose(self) -> Pose:
        """The trunk's pose, projected to the plane [m, rad]."""
        return self.pose_of(self.data.qpos)

    def pose_of(self, state: np.ndarray) -> Pose:
        """Return the pose in one state [nq]."""
        x, y, _, *quaternion = state[self.place_at : self.place_at + 7].tolist()
        w, a, b, c = quaternion
        return Pose(x, y, math.atan2(2.0 * (w * c + a * b), 1.0 - 2.0 * (b * b + c * c)))

    def ways(self, states: np.ndarray) -> np.ndarray:
        """Return x and y in states [N, nq]: [N, 2]."""
        return states[:, self.place_at : self.place_at + 2]

    def place(self, pose: Pose) -> None:
        """Put it at ``pose`` as it is: its tilt, its hinges and its velocity turn along."""
        q, v, at = self.data.qpos, self.data.qvel, self.place_at
        turn = pose.theta - self.pose.theta
        c, s = math.cos(0.5 * turn), math.sin(0.5 * turn)
        w, a, b, d = q[at + 3 : at + 7].tolist()
        q[at : at + 2] = pose.x, pose.y
        q[at + 3 : at + 7] = c * w - s * d, c * a - s * b, c * b + s * a, c * d + s * w
        vx, vy = v[self.speed_at : self.speed_at + 2].tolist()
        c, s = math.cos(turn), math.sin(turn)
        v[self.speed_at : self.speed_at + 2] = c * vx - s * vy, s * vx + c * vy  # turning is told in its own frame
        self.placed = True

    def continue_as(self, other: Robot) -> None:
        """Take over another robot's state, as it is now."""
        q, at = self.data.qpos, self.place_at
        q[at : at + 7] = other.data.qpos[other.place_at : other.place_at + 7]
        self.data.qvel[self.speed_at : self.speed_at + 6] = other.data.qvel[other.speed_at : other.speed_at + 6]
        for (p, v), (its_p, its_v) in zip(self._own, other._own, strict=True):
            q[p], self.data.qvel[v] = other.data.qpos[its_p], other.data.qvel[its_v]
        self._planned, self._gait, self.tilted = list(other._planned), other._gait, other.tilted


class Wheels:
    """A disc on two driven wheels, as a prey is: the targets of its speeds follow its heading."""

    energy, falls = 0.0, 0

    def __init__(
        self, name: str, model: Any, data: Any, settings: PreySettings, interval: float, rng: np.random.Generator
    ) -> None:
        self.name, self.length, self.settings = name, settings.body.body_length, settings.body
        self.model, self.data, self.placed = model, data, False
        joints = [model.joint(f"{name}_{part}") for part in ("x", "y", "turn")]
        self._at = [int(joint.qposadr[0]) for joint in joints]
        self._speed_at = [int(joint.dofadr[0]) for joint in joints]
        first = int(model.actuator(f"{name}_x").id)
        self.lead = range(first, first + 3)
        self._factors = actuator_factors(settings.noise, interval, rng)
        self.factors: tuple[float, ...] = (1.0, 1.0)
        self.target: tuple[float, float] = (0.0, 0.0)
        self.wheels = [0.0, 0.0]
        self._along: list[list[float]] = []

    def command(self, gait: Gait) -> None:
        """Hold two wheel speeds [m/s]; InputError for another number of them."""
        if len(gait.command) != 2:
            raise InputError(f"{self.name}: gait {gait.name!r} commands {len(gait.command)} actuators, not 2")
        self.drive(gait.command)

    def drive(self, target: tuple[float, ...]) -> None:
        """Set the wheels' targets, unchecked."""
        self.target = (target[0], target[1])

    def next_interval(self) -> None:
        """Draw the noise of the next control interval."""
        self.factors = next(self._factors)

    def targets(self, step: int, count: int) -> np.ndarray:
        """Return the targets of its speed along x and y [m/s] and of turning [rad/s] for the next steps [N, 3]."""
        dt, wheels, self._along = self.model.opt.timestep, list(self.wheels), []
        theta, most = float(self.data.qpos[self._at[2]]), self.settings.max_acceleration * dt
        made = np.empty((count, 3))
        for row in range(count):
            for i in (0, 1):
                gap = self.target[i] - wheels[i]
                wheels[i] += -most if gap < -most else most if gap > most else gap
            left, right = wheels[0] * self.factors[0], wheels[1] * self.factors[1]
            ahead, turn = 0.5 * (left + right), (right - left) / self.settings.axle
            theta += 0.5 * turn * dt
            made[row] = ahead * math.cos(theta), ahead * math.sin(theta), turn
            theta += 0.5 * turn * dt
            self._along.append(list(wheels))
        return made

    def done(self, targets: np.ndarray, sensors: np.ndarray) -> None:
        """Take over the wheels' speeds after the steps that were taken."""
        self.wheels = self._along[len(targets) - 1]

    @property
    def pose(self) -> Pose:
        """Its pose [m, rad]."""
        return self.pose_of(self.data.qpos)

    def pose_of(self, state: np.ndarray) -> Pose:
        """Return the pose in one state [nq]."""
        x, y, theta = (float(state[at]) for at in self._at)
        return Pose(x, y, float(wrap(theta)))

    def ways(self, states: np.ndarray) -> np.ndarray:
        """Return x and y in states [N, nq]: [N, 2]."""
        return states[:, self._at[:2]]

    def place(self, pose: Pose) -> None:
        """Put it at ``pose``; its velocities stay as they are."""
        self.data.qpos[self._at] = pose
        self.placed = True

    def continue_as(self, other: Wheels) -> None:
        """Take over another disc's state, as it is now."""
        self.data.qpos[self._at] = other.data.qpos[other._at]
        self.data.qvel[self._speed_at] = other.data.qvel[other._speed_at]
        self.wheels, self.target = list(other.wheels), other.target
