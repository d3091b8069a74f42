"""Robot bodies in Box2D: from a gait to a velocity, one physics step at a time.

Box2D's unit of length is one hunter body, so that its float32 numbers stay near 1. These classes run once per physics
step: plain floats, slots, and live vectors that Box2D hands out once, read and written past their proxies
(:func:`bound`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import cos, hypot, nan, sin
from operator import mul
from types import MethodType
from typing import Any

import Box2D
import numpy as np

from bayeshunt.config.schema import DiscSettings, NoiseSettings, PhysicsSettings
from bayeshunt.core.errors import InputError
from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import Pose, wrap
from bayeshunt.worlds.noise import actuator_factors

__all__ = ["Drive", "Parts", "bound"]


@dataclass(frozen=True)
class Parts:
    """What a body in Box2D is made from.

    world: the ``b2World``. unit: metres per Box2D unit. rng: of the actuators' noise.
    """

    name: str
    world: Any
    settings: DiscSettings
    noise: NoiseSettings
    physics: PhysicsSettings
    unit: float
    rng: np.random.Generator


class Drive:
    """A disc that any number A of actuators moves; they are tracked under rate limits and carry noise.

    Subclasses say how fast the actuators may change (:meth:`limits`) and how they move the body (:meth:`twist`). Every
    actuator starts at rest, and a gait's command holds their targets, in the unit of the body's gaits.
    """

    __slots__ = (
        "_angular_sent", "_factors", "_limits", "_most", "_position", "_scale", "_send", "_send_turn", "_traction",
        "_velocity", "angle", "body", "energy", "factors", "falls", "length", "moving", "name", "place_of", "placed",
        "settings", "slide", "speed", "state", "target", "turn", "unit", "vx", "vy",
    )  # fmt: skip

    def __init__(self, parts: Parts) -> None:
        """Put a disc at the origin of the parts' world."""
        settings, self.unit, self.name = parts.settings, parts.unit, parts.name
        fixture = Box2D.b2FixtureDef(
            shape=Box2D.b2CircleShape(radius=0.5 * settings.diameter / self.unit),
            density=1.0,
            friction=0.0,
            restitution=0.0,
        )
        self.body = parts.world.CreateDynamicBody(
            fixtures=fixture, allowSleep=False, linearDamping=0.0, angularDamping=0.0, bullet=False
        )
        self.settings, self.length = settings, settings.body_length
        self.energy, self.falls, self.placed = 0.0, 0, False
        self._position = self.body.position  # live: follows the body
        self._velocity = self.body.linearVelocity  # live: writing it moves the body
        vector, kind = type(self._velocity), type(self.body)
        self._send, self._send_turn = bound(vector.Set, self._velocity), bound(kind.angularVelocity.fset, self.body)
        self.angle = bound(kind.angle.fget, self.body)
        #: Calls that read x, y [Box2D units] and the angle [rad].
        self.place_of = bound(vector.x.fget, self._position), bound(vector.y.fget, self._position), self.angle
        self._scale = 1.0 / self.unit
        self._limits = tuple(self.limits(parts.physics.step))
        count = len(self._limits)
        self._factors: Iterator[tuple[float, ...]] = actuator_factors(
            parts.noise, parts.physics.control_interval, parts.rng, count
        )
        self._traction = getattr(settings, "max_traction", float("inf")) * parts.physics.step / self.unit
        self._most = self._traction * self._traction
        self.state: tuple[float, ...] = (0.0,) * count
        self.target = self.state
        self.factors = (1.0,) * count
        self.speed = self.slide = self.turn = self.vx = self.vy = self._angular_sent = 0.0
        self.moving = False  # an actuator has not reached its target yet

    def limits(self, step: float) -> tuple[float, ...]:
        """Return the largest change of each actuator in one physics step of ``step`` [s]; as many as there are."""
        raise TypeError(f"{type(self).__name__} must say its rate limits")

    def twist(self, *values: float) -> tuple[float, float, float]:
        """Return metres per second ahead and to the left, and radians per second counter-clockwise, of noisy values."""
        raise TypeError(f"{type(self).__name__} must say how its actuators move it")

    def command(self, gait: Gait) -> None:
        """Set the actuators' targets; InputError unless there is one for each."""
        if len(gait.command) != len(self.state):
            raise InputError(
                f"{self.name}: gait {gait.name!r} commands {len(gait.command)} actuators, not {len(self.state)}"
            )
        self.drive(gait.command)

    def drive(self, target: tuple[float, ...]) -> None:
        """Set the actuators' targets, unchecked: called once per control interval."""
        if target != self.target:
            self.target = target
            self.moving = True

    def next_interval(self) -> None:
        """Draw the noise of the next control interval."""
        self.factors = next(self._factors)
        if not self.moving:
            self._move()

    def _move(self) -> None:
        """Take over how fast the actuators, with their noise, now move the body."""
        ahead, left, self.turn = self.twist(*map(mul, self.state, self.factors))
        self.speed, self.slide = ahead * self._scale, left * self._scale

    def _track(self) -> None:
        """Move every actuator towards its target by at most one step's change."""
        moving, state = False, []
        for now, aim, limit in zip(self.state, self.target, self._limits, strict=True):
            gap = aim - now
            if gap > limit:
                gap, moving = limit, True
            elif gap < -limit:
                gap, moving = -limit, True
            state.append(now + gap)
        self.moving = moving
        self.state = tuple(state) if moving else self.target
        self._move()

    def advance(self) -> None:
        """Set the body's velocity for the next physics step."""
        if self.moving:
            self._track()
        angle, speed = self.angle(), self.speed
        c, s = cos(angle), sin(angle)
        vx, vy = speed * c, speed * s
        if self.slide:
            vx, vy = vx - self.slide * s, vy + self.slide * c
        dx, dy = vx - self.vx, vy - self.vy
        if dx * dx + dy * dy > self._most:
            # the tyres carry only so much: |change of velocity| <= traction limit x step
            share = self._traction / hypot(dx, dy)
            vx, vy = self.vx + share * dx, self.vy + share * dy
        self._send(vx, vy)
        self.vx, self.vy = vx, vy
        if self.turn != self._angular_sent:
            self._angular_sent = self.turn
            self._send_turn(self.turn)

    def read_back(self) -> None:
        """Take over the velocity that a contact has left the body with."""
        self.vx, self.vy = self._velocity.x, self._velocity.y
        self._angular_sent = nan  # whatever it is now, it is sent anew

    @property
    def position(self) -> Any:
        """The live position vector [Box2D units]: read its x and y, never keep it as a value."""
        return self._position

    @property
    def pose(self) -> Pose:
        """The pose in metres and radians."""
        return Pose(self._position.x * self.unit, self._position.y * self.unit, wrap(float(self.body.angle)))

    def continue_as(self, other: Drive) -> None:
        """Take over another body's pose, velocity and actuators, as they are now."""
        self.place(other.pose)
        self._velocity.x, self._velocity.y = other._velocity.x, other._velocity.y
        self.body.angularVelocity = other.body.angularVelocity
        self.state, self.target, self.moving = other.state, other.target, other.moving
        self.read_back()

    def place(self, pose: Pose) -> None:
        """Put the body at ``pose`` [m, rad]; velocities and actuators stay as they are, a control interval begins."""
        self.body.transform = ((pose.x / self.unit, pose.y / self.unit), pose.theta)
        self.placed = True


def bound(method: Any, thing: Any) -> Any:
    """A method of a Box2D object as a call that does not look up the object behind its proxy: keep the proxy."""
    return MethodType(getattr(method, "__func__", method), thing.this)


#: Makes a body in Box2D: usually a subclass of :class:`Drive`.
BodyFactory = Callable[[Parts], Drive]
