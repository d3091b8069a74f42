"""The world that ships: Box2D seen from above, one hunter, any prey, and the catch, checked at every physics step.

A world serves one trial. A reused ``b2World`` carries contact state over and gives another result for the same trial,
so every reset makes a fresh one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from math import inf
from typing import Any

import Box2D
import numpy as np

from bayeshunt.config.schema import ObstacleSettings
from bayeshunt.core.errors import InputError
from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import Pose
from bayeshunt.core.messages import Moment, Reach, Run
from bayeshunt.core.protocols import Map
from bayeshunt.worlds.bodies import body_factory
from bayeshunt.worlds.box2d.bodies import Drive, Parts, bound
from bayeshunt.worlds.box2d.trail import Trail
from bayeshunt.worlds.box2d.version import version
from bayeshunt.worlds.maps import map_of
from bayeshunt.worlds.prey.behaviours import Alone, Context, Prey, build_prey
from bayeshunt.worlds.scene import HUNTER, Scene

__all__ = ["Box2DWorld", "build_obstacles", "build_walls", "new_world"]

#: Box2D units between two surfaces beyond which Box2D does not look for a contact: far more than a step's way.
_MARGIN = 4.0
#: Box2D units by which two bodies come nearer in a step at most: it moves none by more than 2.
_WAY = 4.0
#: A prey: where its place begins among those of all bodies, what takes its wheel speeds, what gives them.
_Steered = tuple[int, Callable[[tuple[float, ...]], None], Callable[..., tuple[float, float]]]


class Box2DWorld:
    """A trial in progress: see ``bayeshunt.protocols.World``."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.physics = scene.physics
        self.map: Map = map_of(scene.arena)
        self.control_interval = scene.physics.control_interval
        self.identity: Mapping[str, str] = {"engine": "box2d", "version": version()}
        self.unit = scene.robot.body.body_length
        self.bodies: dict[str, Drive] = {}
        self._drives: tuple[Drive, ...] = ()
        self._steps = self._phase = 0  # physics steps taken in all, and in the present control interval
        self._prey: list[tuple[int, Drive, Prey]] = []  # those that steer themselves, and their place in the order

    # --- one trial ----------------------------------------------------------------------------

    def reset(self, start: Mapping[str, Pose], streams: Mapping[str, np.random.Generator]) -> Moment:
        """Make the bodies of ``start`` at rest in a fresh world: "hunter" is the robot, every other name a prey."""
        self._begin()
        for name, pose in start.items():
            body = self._add(name, streams[name])
            body.place(pose)
            if name != HUNTER:
                mind = build_prey(Context.of(self.scene, self.control_interval, streams[f"{name}_control"]))
                self._prey.append((len(self._drives) - 1, body, mind))
        return Moment(self.time, {name: body.pose for name, body in self.bodies.items()})

    @property
    def time(self) -> float:
        """Seconds since the reset: whole physics steps."""
        return self._steps * self.physics.step

    def run(self, gaits: Mapping[str, Gait], duration: float, until: Reach | None = None) -> Run:
        """Hold ``gaits`` for ``duration`` [s] (at least one physics step, unless it is 0) or until the catch."""
        for name, gait in gaits.items():
            self._body(name).command(gait)
        self._aim(until)
        trail = Trail(self.bodies, self.unit, self.physics.step)
        if self._gap() <= self._near:
            return Run(trail, until and until.whom)
        self._begin_interval_if_placed()
        steered = [(3 * n, body.drive, mind.act) for n, body, mind in self._prey if body.name not in gaits]
        remaining = self.physics.steps(duration) if duration > 0 else 0
        if not remaining:
            return Run(trail)
        spent = {name: body.energy for name, body in self.bodies.items()}
        stopped = self._hold(remaining, steered, trail)
        energy = {name: body.energy - spent[name] for name, body in self.bodies.items()}
        return Run(trail, until.whom if until is not None and stopped else None, energy)

    def fork(self, *only: str) -> Box2DWorld:
        """Return a noise-free twin; its prey's behaviour starts anew and sees no hunter that is left out."""
        twin = Box2DWorld(self.scene.quiet(alone=bool(only) and HUNTER not in only))
        twin._begin()
        nobody = np.random.default_rng(0)  # every noise is zero: what it draws has no effect
        steered = {body.name for _, body, _ in self._prey}
        for name in only or self.bodies:
            body = twin._add(name, nobody)
            body.continue_as(self._body(name))
            if name in steered:
                mind = build_prey(Context.of(twin.scene, self.control_interval, nobody))
                mind = mind if HUNTER in twin.bodies else Alone(mind, 1e6 * self.unit)
                twin._prey.append((len(twin._drives) - 1, body, mind))
        return twin

    def close(self) -> None:
        """Let go of the Box2D world."""
        self.bodies, self._prey, self._drives = {}, [], ()

    # --- inside -------------------------------------------------------------------------------

    def _begin(self) -> None:
        self.world, physics = new_world(), self.physics
        iterations = physics.velocity_iterations, physics.position_iterations
        self._step = partial(bound(type(self.world).Step, self.world), physics.step, *iterations)
        self._contacts = bound(type(self.world).contactCount.fget, self.world)
        self.bodies, self._prey = {}, []
        self._steps = self._phase = 0
        self._until: object = self  # nothing yet
        arena = self.scene.arena
        if arena.walled:
            build_walls(self.world, arena.width / self.unit, arena.height / self.unit)
        if arena.obstacles:
            build_obstacles(self.world, arena.obstacles, self.unit)

    def _add(self, name: str, rng: np.random.Generator) -> Drive:
        """Make a body at the origin. Bodies are made in the order of their names' coming: it counts in Box2D."""
        source = self.scene.robot if name == HUNTER else self.scene.prey
        if source is None:
            raise InputError(f"the scene has no prey, so there is no body {name!r}")
        settings = source.body
        parts = Parts(name, self.world, settings, source.noise, self.physics, self.unit, rng)
        body = self._make(parts, settings.drive)
        self.bodies[name] = body
        self._drives = tuple(self.bodies.values())
        self._moves = tuple(drive.advance for drive in self._drives)
        self._begins = tuple(drive.next_interval for drive in self._drives)
        self._reads = tuple(drive.read_back for drive in self._drives)
        self._places = tuple(read for drive in self._drives for read in drive.place_of)
        self._hunter = 3 * list(self.bodies).index(HUNTER) if HUNTER in self.bodies else 0
        return body

    def _make(self, parts: Parts, drive: str) -> Drive:
        """A body of a kind by name."""
        made: Drive = body_factory(drive)(parts)
        return made

    def _body(self, name: str) -> Drive:
        if name not in self.bodies:
            raise InputError(f"the world has no body {name!r}; it has {', '.join(self.bodies) or 'none yet'}")
        return self.bodies[name]

    def _aim(self, until: Reach | None) -> None:
        """Keep whose distance is looked at; of nobody, one that is never short enough."""
        if until is self._until:  # the same in every run of a hunt
            return
        self._until = until
        if until is None:
            self._pair, reach, self._near = (0, 0), 0.0, -1.0  # where their places begin among those of all bodies
        else:
            drives = self._drives
            self._pair = 3 * drives.index(self._body(until.who)), 3 * drives.index(self._body(until.whom))
            reach = until.distance / self.unit
            self._near = reach**2
        # Two bodies in the open can touch nothing but each other, and that only when they are near.
        arena, way = self.scene.arena, _WAY * (self.physics.control_steps - 1)
        pair = until is not None and len(self._drives) == 2 and not arena.walled and not arena.obstacles
        touch = 0.5 * sum(body.length for body in self._drives) / self.unit + _MARGIN if pair else inf
        self._within = (reach + way) ** 2, touch**2, (touch + way) ** 2

    def _gap(self) -> float:
        """The square of the pair's distance [Box2D units]."""
        places, (who, whom) = self._places, self._pair
        dx, dy = places[who]() - places[whom](), places[who + 1]() - places[whom + 1]()
        return float(dx * dx + dy * dy)

    def _begin_interval_if_placed(self) -> None:
        for body in self._drives:
            if body.placed:
                self._phase, body.placed = 0, False

    def _hold(self, remaining: int, steered: Sequence[_Steered], trail: Trail) -> bool:
        """Take ``remaining`` physics steps, fewer if there is a catch; return whether there was one.

        At the start of each control interval there is new noise, and every prey that steers itself decides. One loop
        without calls of its own: it is where the time of all hunts goes. Where the bodies are is read once an
        interval; within it, only while the pair is so near that it may meet before the end.
        """
        (who, whom), near, (catch, touch, soon), contacts = self._pair, self._near, self._within, self._contacts
        live, begins, moves, step = self._places, self._begins, self._moves, self._step
        one_x, one_y, _, other_x, other_y, _ = *live[who : who + 3], *live[whom : whom + 3]
        reads, control, unit, hunter = self._reads, self.physics.control_steps, self.unit, self._hunter
        passed, note = trail.steps.append, trail.places.extend
        steps, phase, end = self._steps, self._phase, self._steps + remaining
        places = [read() for read in live]
        gap = self._gap()
        while True:
            if not phase:
                for begin in begins:
                    begin()
                for at, steer, act in steered:
                    x, y = places[hunter] * unit, places[hunter + 1] * unit
                    steer(act(places[at] * unit, places[at + 1] * unit, places[at + 2], x, y))
            left = min(control - phase, end - steps)
            may_catch, may_touch = gap < catch, gap < soon
            phase, steps = (phase + left) % control, steps + left
            while True:
                for move in moves:
                    move()
                step()
                left -= 1
                if not left:
                    break
                if may_touch and contacts():
                    for read_back in reads:
                        read_back()
                if may_catch:
                    dx, dy = one_x() - other_x(), one_y() - other_y()
                    if dx * dx + dy * dy <= near:
                        break
            places = [read() for read in live]
            dx, dy = places[who] - places[whom], places[who + 1] - places[whom + 1]
            gap = dx * dx + dy * dy
            if gap < touch and contacts():
                for read_back in reads:
                    read_back()
            steps, phase = steps - left, (phase - left) % control
            passed(steps)
            note(places)
            if gap <= near or steps == end:
                break
        self._steps, self._phase = steps, phase
        return bool(gap <= near)


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


def build_obstacles(world: Any, obstacles: Sequence[ObstacleSettings], unit: float) -> Any:
    """Add obstacles [m], a Box2D unit being ``unit`` metres; return the body that holds them all."""
    body = world.CreateStaticBody()
    for obstacle in obstacles:
        centre = obstacle.x / unit, obstacle.y / unit
        if obstacle.radius is not None:
            shape = Box2D.b2CircleShape(pos=centre, radius=obstacle.radius / unit)
        else:
            width, height = obstacle.sides
            shape = Box2D.b2PolygonShape(box=(0.5 * width / unit, 0.5 * height / unit, centre, obstacle.angle))
        body.CreateFixture(shape=shape, friction=0.0, restitution=0.0)
    return body
