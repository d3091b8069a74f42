"""The hunt of preset "paper" a second time, compiled by numba: many hunts at once, to learn in (extra ``bench``).

Learning takes up to a million gaits, and this takes some 30 times less processor time than the environment. Nothing is
reported from it: whatever has learned here hunts in ``bayeshunt`` itself. It has the same bodies, noise, sensors, catch
rule and observations; a wall stops a robot where the discs touch, where Box2D lets it go half a millimetre deeper, and
its random numbers are others. A test holds it to the environment, gait by gait, with the noise left out.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from bayeshunt.config.loading import load_experiment
from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.errors import InputError
from bayeshunt.envs.choosing import GAMMA
from bayeshunt.planners.policy import bounds
from bayeshunt.worlds.prey.behaviours import BRAITENBERG, MAX_UNITS
from bayeshunt.worlds.prey.proximity import KHEPERA_DIAMETER, MOUNT_RADIUS
from benchmarks.kernels import sense

__all__ = ["Batch", "Constants"]

_WEIGHTS = np.array(BRAITENBERG, dtype=float)
_HUNTER, _PREY = 0, 1


class Constants(NamedTuple):
    """What a hunt is made of; metres, seconds. half_width, half_height: inf in the open. keep, kick: of the drift."""

    step: float
    control: int
    gait_steps: int
    last: int
    catch: float
    limit: float
    axle: float
    change: float
    radius: float
    half_width: float
    half_height: float
    slip: float
    keep: float
    kick: float
    drift: float
    reach: float
    sensor_noise: float
    prey_speed: float
    unit: float

    @classmethod
    def of(cls, settings: ExperimentSettings, arena: str) -> Constants:
        """Return those of an experiment; InputError for one that this does not know how to run."""
        robot, prey, physics, where = settings.robot, settings.prey, settings.physics, settings.arenas[arena]
        alike = robot.body == prey.body and robot.noise == prey.noise and robot.body.diameter == KHEPERA_DIAMETER
        if not alike or prey.behaviour != "braitenberg" or prey.senses_hunter or where.obstacles:
            raise InputError('the compiled hunt knows two Kheperas alike and a prey that avoids walls: preset "paper"')
        keep = math.exp(-physics.control_interval / robot.noise.drift_time)
        sides = (0.5 * where.width, 0.5 * where.height) if where.walled else (math.inf, math.inf)
        limit, body = settings.protocol.time_limit, robot.body
        return cls(
            physics.step, physics.control_steps, physics.steps(robot.gait_duration),
            math.floor(limit / physics.step + 1e-9), settings.protocol.catch_distance * body.diameter, limit, body.axle,
            body.max_acceleration * physics.step, 0.5 * body.diameter, *sides, robot.noise.slip, keep,
            robot.noise.drift_sd * math.sqrt(1.0 - keep * keep), robot.noise.drift_sd, prey.sensor_range,
            prey.sensor_noise, prey.speed, 10.0 * body.diameter,
        )  # fmt: skip


class State(NamedTuple):
    """N hunts in progress, changed in place: [N, 2 robots, ...] unless said otherwise.

    before: the poses at the last decision. steps: physics steps taken [N]. gait: the last, -1: none [N].
    """

    pose: np.ndarray
    wheels: np.ndarray
    drift: np.ndarray
    before: np.ndarray
    steps: np.ndarray
    gait: np.ndarray


class Batch:
    """N hunts at once: ``observations = reset()``, then ``step(gaits)``; one that has ended begins anew by itself.

    side: whose observations and rewards are told: 0 the hunter's, 1 the prey's, as ``hunt_v0`` tells them.
    """

    def __init__(
        self, arena: str, count: int, seed: int, *, reward: str = "shaped", changes: dict[str, Any] | None = None,
        side: int = _HUNTER,
    ) -> None:  # fmt: skip
        settings = load_experiment("paper", changes)
        self.constants = Constants.of(settings, arena)
        self.gaits, self.count, self._shaped = len(settings.robot.gaits), count, reward == "shaped"
        self._side = side
        self._commands = np.array([gait.command for gait in settings.robot.gaits.gaits])
        self._starts = np.array([settings.starting_poses(theta) for theta in settings.protocol.thetas], dtype=float)
        self.bounds = bounds(settings.robot.gaits)
        self._functions = _compiled()
        self._functions.seed(seed)
        shape = count, 2
        self.state = State(
            np.zeros((*shape, 3)), np.zeros((*shape, 2)), np.zeros((*shape, 2)), np.zeros((*shape, 3)),
            np.zeros(count, dtype=np.int64), np.zeros(count, dtype=np.int64),
        )  # fmt: skip

    def compile(self) -> None:
        """Compile all that is used, so that nobody's time is taken for it later."""
        self.reset()
        self.step(np.zeros(self.count, dtype=np.int64))

    def reset(self) -> np.ndarray:
        """Begin all hunts; return their observations [N, 18 + G]."""
        for n in range(self.count):
            self.begin(n)
        return self._seen()

    def begin(self, n: int, bearing: int | None = None) -> None:
        """Begin one hunt; ``bearing``: its number among those of the protocol, by default drawn."""
        starts = self._starts if bearing is None else self._starts[bearing : bearing + 1]
        self._functions.start(n, self.state, starts, self.constants)

    def step(
        self, gaits: np.ndarray, prey: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Execute a gait in each; return observations, rewards, caught, time was up, and the observations at the end.

        The first are those of the new hunt where one has ended, the last those of the old one. prey: wheel speeds
        [N, 2] m/s that the prey holds meanwhile; None: it steers itself.
        """
        held = np.full((self.count, 2), np.nan) if prey is None else prey
        rewards, caught, late = self._functions.advance(
            self.state, self._commands[gaits], held, np.asarray(gaits), self._shaped, self.constants
        )
        rewards = rewards if self._side == _HUNTER else -rewards
        ends = seen = self._seen()
        if (caught | late).any():
            for n in np.flatnonzero(caught | late):
                self.begin(n)
            seen = self._seen()
        return seen, rewards, caught, late, ends

    def _seen(self) -> np.ndarray:
        return np.clip(self._functions.observe(self.state, self._side, self.gaits, self.constants), *self.bounds)


class _Functions(NamedTuple):
    seed: Any
    start: Any
    advance: Any
    observe: Any


@cache
def _compiled() -> _Functions:
    """Compile all, when first used."""
    import numba

    njit = numba.njit
    rays, weights = njit(sense), _WEIGHTS

    @njit
    def seed(number):  # type: ignore[no-untyped-def]
        np.random.seed(number)  # noqa: NPY002  numba's own generator

    @njit
    def start(n, state, starts, c):  # type: ignore[no-untyped-def]
        state.pose[n] = starts[np.random.randint(len(starts))]  # noqa: NPY002
        state.wheels[n] = 0.0
        for robot in range(2):
            for wheel in range(2):
                state.drift[n, robot, wheel] = c.drift * np.random.standard_normal()  # noqa: NPY002
        state.before[n] = state.pose[n]
        state.steps[n] = 0
        state.gait[n] = -1

    @njit
    def flee(x, y, theta, target, c):  # type: ignore[no-untyped-def]
        """What the prey's wheels are to do: away from what its sensors see."""
        left, right = 3.0, 3.0
        far = MOUNT_RADIUS + c.reach
        if abs(x) + far >= c.half_width or abs(y) + far >= c.half_height:
            values = rays(x, y, theta, c.reach, c.half_width, c.half_height)
            left, right = 0.0, 0.0
            for i in range(8):
                value = values[i]
                if value > 0.0:
                    value *= 1.0 + c.sensor_noise * np.random.standard_normal()  # noqa: NPY002
                left += weights[i, 0] * (1.0 - value / 512.0)
                right += weights[i, 1] * (1.0 - value / 512.0)
        target[0] = max(-MAX_UNITS, min(MAX_UNITS, left)) * c.prey_speed / 3.0
        target[1] = max(-MAX_UNITS, min(MAX_UNITS, right)) * c.prey_speed / 3.0

    @njit
    def move(pose, wheels, target, factors, c):  # type: ignore[no-untyped-def]
        """One physics step of a robot."""
        for w in range(2):
            wheels[w] += max(-c.change, min(c.change, target[w] - wheels[w]))
        left, right = wheels[0] * factors[0], wheels[1] * factors[1]
        speed, turn = 0.5 * (left + right), (right - left) / c.axle
        pose[0] += speed * math.cos(pose[2]) * c.step
        pose[1] += speed * math.sin(pose[2]) * c.step
        pose[2] += turn * c.step
        pose[0] = max(c.radius - c.half_width, min(c.half_width - c.radius, pose[0]))
        pose[1] = max(c.radius - c.half_height, min(c.half_height - c.radius, pose[1]))

    @njit
    def gap(pose):  # type: ignore[no-untyped-def]
        return math.hypot(pose[1, 0] - pose[0, 0], pose[1, 1] - pose[0, 1])

    @njit
    def hunt(n, state, command, held, c):  # type: ignore[no-untyped-def]
        """Hold a gait in one hunt; whether the prey was caught. held: the prey's wheels, NaN where it steers itself."""
        pose, wheels, drift = state.pose[n], state.wheels[n], state.drift[n]
        factors, aims = np.ones((2, 2)), np.zeros((2, 2))
        aims[_HUNTER], aims[_PREY] = command, held
        steers = math.isnan(held[0])
        for _ in range(min(c.gait_steps, c.last - state.steps[n])):
            if state.steps[n] % c.control == 0:
                for robot in range(2):
                    for w in range(2):
                        drift[robot, w] = c.keep * drift[robot, w] + c.kick * np.random.standard_normal()  # noqa: NPY002
                        slip = c.slip * (2.0 * np.random.random() - 1.0)  # noqa: NPY002
                        factors[robot, w] = (1.0 + slip) * (1.0 + drift[robot, w])
                if steers:
                    flee(pose[_PREY, 0], pose[_PREY, 1], pose[_PREY, 2], aims[_PREY], c)
            for robot in range(2):
                move(pose[robot], wheels[robot], aims[robot], factors[robot], c)
            state.steps[n] += 1
            if gap(pose) <= c.catch:
                return True
        return False

    @njit
    def advance(state, commands, held, gaits, shaped, c):  # type: ignore[no-untyped-def]
        count = len(gaits)
        rewards, caught, late = np.zeros(count), np.zeros(count, np.bool_), np.zeros(count, np.bool_)
        for n in range(count):
            begun, potential = state.steps[n], -gap(state.pose[n])
            state.before[n] = state.pose[n]
            state.gait[n] = gaits[n]
            caught[n] = hunt(n, state, commands[n], held[n], c)
            late[n] = not caught[n] and state.steps[n] >= c.last
            rewards[n] = -(state.steps[n] - begun) * c.step / c.limit
            if shaped:
                rewards[n] += (0.0 if caught[n] else -GAMMA * gap(state.pose[n])) - potential
        return rewards, caught, late

    @njit
    def relative(one, other):  # type: ignore[no-untyped-def]
        """Pose ``other`` as seen from ``one``: forward, right, and its turn clockwise."""
        dx, dy = other[0] - one[0], other[1] - one[1]
        c, s = math.cos(one[2]), math.sin(one[2])
        return c * dx + s * dy, s * dx - c * dy, one[2] - other[2]

    @njit
    def observe(state, side, gaits, c):  # type: ignore[no-untyped-def]
        seen = np.zeros((len(state.steps), 18 + gaits), np.float32)
        for n in range(len(state.steps)):
            own, other, row = state.pose[n, side], state.pose[n, 1 - side], seen[n]
            forward, right, heading = relative(own, other)
            angle = math.atan2(right, forward)
            row[0], row[1], row[2] = forward / c.unit, right / c.unit, math.hypot(forward, right) / c.unit
            row[3], row[4], row[5], row[6] = math.cos(angle), math.sin(angle), math.cos(heading), math.sin(heading)
            if state.gait[n] >= 0:
                forward, right, heading = relative(state.before[n, 1 - side], other)
                row[7], row[8], row[9] = 1.0, forward / c.unit, right / c.unit
                row[10], row[11] = math.cos(heading), math.sin(heading)
            row[12], row[13] = own[0] / c.unit, own[1] / c.unit
            row[14], row[15] = math.cos(own[2]), math.sin(own[2])
            row[16] = 1.0 - state.steps[n] * c.step / c.limit
            if side == _HUNTER:  # a prey is not told what it did last
                row[18 + state.gait[n]] = 1.0
        return seen

    return _Functions(seed, start, advance, observe)
