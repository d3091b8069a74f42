"""The world of bodies in MuJoCo: hunter, prey, walls and obstacles in one model, the catch checked at every step.

Gaits are open loop, so that the steps up to the next decision are taken in one call, ``mujoco.rollout``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from math import ceil
from typing import Any

import numpy as np

from bayeshunt.config.schema.mujoco import MujocoSettings
from bayeshunt.core.errors import InputError
from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import Pose
from bayeshunt.core.messages import Moment, Reach, Run
from bayeshunt.core.protocols import Map
from bayeshunt.worlds.maps import map_of
from bayeshunt.worlds.mujoco.bodies import Robot, Wheels
from bayeshunt.worlds.mujoco.engine import load
from bayeshunt.worlds.mujoco.model import Disc, build
from bayeshunt.worlds.prey.behaviours import Alone, Context, Prey, build_prey
from bayeshunt.worlds.scene import HUNTER, Scene

__all__ = ["MujocoWorld"]


class MujocoWorld:
    """A trial in progress: see ``bayeshunt.protocols.World``."""

    def __init__(self, scene: Scene) -> None:
        self.engine, self.scene = load(), scene
        body: Any = scene.robot.body  # of the drive's own settings
        if not isinstance(body, MujocoSettings):
            raise InputError(
                f"world 'mujoco': robot {scene.robot.name!r} has a {scene.robot.body.drive} drive, which moves in "
                "'box2d'; it moves robots of drive 'mujoco'"
            )
        self.settings: MujocoSettings = body
        self.map: Map = map_of(scene.arena)
        self.control_interval = scene.physics.control_interval
        self.identity: Mapping[str, str] = {"engine": "mujoco", "version": str(self.engine.__version__)}
        self._fine = ceil(scene.physics.step / self.settings.step - 1e-9)  # steps of MuJoCo in one of the experiment's
        self._step = scene.physics.step / self._fine
        self._interval = self._fine * scene.physics.control_steps
        self.bodies: dict[str, Robot | Wheels] = {}
        self._minds: dict[str, Prey] = {}
        self._steps = self._phase = 0

    # --- one trial ----------------------------------------------------------------------------

    def reset(self, start: Mapping[str, Pose], streams: Mapping[str, np.random.Generator]) -> Moment:
        """Make the bodies of ``start`` at rest: "hunter" is the robot, every other name a prey."""
        self._begin(tuple(start), streams)
        for name, pose in start.items():
            self.bodies[name].place(pose)
            if name != HUNTER:
                self._minds[name] = build_prey(
                    Context.of(self.scene, self.control_interval, streams[f"{name}_control"])
                )
        return self._moment(self.data.qpos, 0)

    @property
    def time(self) -> float:
        """Seconds since the reset."""
        return self._steps * self._step

    def run(self, gaits: Mapping[str, Gait], duration: float, until: Reach | None = None) -> Run:
        """Hold ``gaits`` for ``duration`` [s] (at least one step of the experiment, unless it is 0) or to the catch."""
        for name, gait in gaits.items():
            self._body(name).command(gait)
        if until is not None and self._gaps(until, self.data.qpos[None])[0] <= until.distance:
            return Run((), until.whom)
        self._begin_interval_if_placed()
        left = self.scene.physics.steps(duration) * self._fine if duration > 0 else 0
        spent = {name: body.energy for name, body in self.bodies.items()}
        moments: list[Moment] = []
        stopped = False
        while left > 0 and not stopped:
            ahead = left if not self._minds else min(self._interval - self._phase, left)
            begun, since = self._steps, self._phase
            taken, stopped, places = self._advance(ahead, until, gaits)
            left -= taken
            ends = [n for n in range(self._interval - since, taken + 1, self._interval) if n]
            ends += [taken] if (stopped or not left) and taken not in ends else []
            moments += [self._moment(places[n - 1], begun + n) for n in ends]
        energy = {name: body.energy - spent[name] for name, body in self.bodies.items()}
        return Run(moments, until.whom if until is not None and stopped else None, energy)

    def fork(self, *only: str) -> MujocoWorld:
        """Return a noise-free twin; its prey's behaviour starts anew and sees no hunter that is left out."""
        names = only or tuple(self.bodies)
        twin = MujocoWorld(self.scene.quiet(alone=HUNTER not in names))
        nobody = np.random.default_rng(0)
        twin._begin(names, dict.fromkeys(names, nobody))
        for name in names:
            twin.bodies[name].continue_as(self._body(name))  # type: ignore[arg-type]  # of one kind
            if name in self._minds:
                mind = build_prey(Context.of(twin.scene, self.control_interval, nobody))
                twin._minds[name] = mind if HUNTER in names else Alone(mind, 1e6 * self.settings.body_length)
        twin._steps = self._steps - self._steps % self._interval  # the clock of its gaits goes on
        return twin

    def close(self) -> None:
        """Let go of the model."""
        self.bodies, self._minds = {}, {}

    # --- inside -------------------------------------------------------------------------------

    def _begin(self, names: tuple[str, ...], streams: Mapping[str, np.random.Generator]) -> None:
        scene, prey = self.scene, self.scene.prey
        others = [name for name in names if name != HUNTER]
        if others and prey is None:
            raise InputError(f"the scene has no prey, so there is no body {others[0]!r}")
        discs = () if prey is None else tuple(Disc(n, prey.body.diameter, prey.body.max_traction) for n in others)
        self.model = build(self.settings if HUNTER in names else None, discs, scene.arena, self._step)
        self.data = self.engine.MjData(self.model)
        self.bodies, self._minds, self._steps, self._phase = {}, {}, 0, 0
        for name in names:
            if name == HUNTER:
                noise = scene.robot.noise
                self.bodies[name] = Robot(
                    name, self.model, self.data, self.settings, noise, self.control_interval, streams[name]
                )
            else:
                assert prey is not None
                self.bodies[name] = Wheels(name, self.model, self.data, prey, self.control_interval, streams[name])
        self._kind = int(self.engine.mjtState.mjSTATE_FULLPHYSICS)
        self._state = np.zeros(self.engine.mj_stateSize(self.model, self._kind))

    def _body(self, name: str) -> Robot | Wheels:
        if name not in self.bodies:
            raise InputError(f"the world has no body {name!r}; it has {', '.join(self.bodies) or 'none yet'}")
        return self.bodies[name]

    def _begin_interval_if_placed(self) -> None:
        if any(body.placed for body in self.bodies.values()):
            self._phase = 0
            for body in self.bodies.values():
                body.placed = False

    def _decide(self, held: Mapping[str, Gait]) -> None:
        """At the start of a control interval: new noise, and every prey decides."""
        for body in self.bodies.values():
            body.next_interval()
        hunter = self.bodies.get(HUNTER)
        x, y = (hunter.pose.x, hunter.pose.y) if hunter is not None else (0.0, 0.0)
        for name, mind in self._minds.items():
            body = self.bodies[name]
            if name not in held and isinstance(body, Wheels):
                body.drive(mind.act(*body.pose, x, y))

    def _advance(self, count: int, until: Reach | None, held: Mapping[str, Gait]) -> tuple[int, bool, np.ndarray]:
        """Take up to ``count`` steps of MuJoCo; return how many, whether the last was the catch, and states [N, nq].

        Fewer where the robot lay too long: it is set upright.
        """
        mujoco, model, data = self.engine, self.model, self.data
        control = np.zeros((1, count, model.nu))
        for part in self._parts(count):
            if part.start or not self._phase:  # a control interval begins
                self._decide(held)
            for body in self.bodies.values():
                control[0, part, body.lead.start : body.lead.stop] = body.targets(
                    self._steps + part.start, part.stop - part.start
                )
        mujoco.mj_getState(model, data, self._state, self._kind)
        start = {"initial_state": self._state[None], "initial_warmstart": data.qacc_warmstart[None].copy()}
        states, sensors = mujoco.rollout.rollout(model, data, control=control, **start)
        places = states[0][:, 1 : 1 + model.nq]  # time comes first
        caught = False
        if until is not None:
            near = np.flatnonzero(self._gaps(until, places) <= until.distance)
            if len(near):
                caught, count = True, int(near[0]) + 1
        hunter = self.bodies.get(HUNTER)
        fallen = hunter.fallen(places[:count]) if isinstance(hunter, Robot) else None
        if fallen is not None:
            caught, count = caught and fallen == count, fallen
        mujoco.mj_setState(model, data, states[0][count - 1], self._kind)
        for body in self.bodies.values():
            body.done(control[0, :count, body.lead.start : body.lead.stop], sensors[0][:count])
        if fallen is not None and isinstance(hunter, Robot):
            hunter.set_upright()
        self._steps += count
        self._phase = (self._phase + count) % self._interval
        return count, caught, places

    def _parts(self, count: int) -> Iterator[slice]:
        """Cut the next steps where a control interval begins."""
        edges = [0, *range(self._interval - self._phase, count, self._interval), count]
        return (slice(a, b) for a, b in pairwise(edges))

    def _gaps(self, until: Reach, places: np.ndarray) -> np.ndarray:
        """Distance [N] between the two bodies of a reach in states [N, nq]."""
        apart = self._body(until.who).ways(places) - self._body(until.whom).ways(places)
        return np.asarray(np.hypot(apart[:, 0], apart[:, 1]))

    def _moment(self, state: np.ndarray, steps: int) -> Moment:
        return Moment(steps * self._step, {name: body.pose_of(state) for name, body in self.bodies.items()})
