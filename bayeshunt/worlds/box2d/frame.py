"""A trunk, its legs and the ground under them, in a Box2D world of their own.

The unit of length is one body length, masses are kilograms. A foot is a friction joint to the ground: it is solved
together with the motors, so that it sticks and slips without jitter. Nothing here collides: the disc in the world of
the hunt does that.
"""

from __future__ import annotations

from math import cos, sin
from typing import Any

import Box2D

from bayeshunt.config.schema.legs import LeggedSettings

__all__ = ["LegFrame"]

_LEG_WIDTH = 0.02  # m


class LegFrame:
    """The bodies and joints.

    trunk: the b2Body. hips, feet: a motor and a friction joint for each leg. belly: the friction joint of the trunk.
    places: x, y of the feet at rest from the trunk's centre. reach: of a leg.
    """

    def __init__(self, settings: LeggedSettings, unit: float) -> None:
        legs = settings.legs
        self.revolute = legs.joint == "revolute"
        self.reach = legs.length / unit
        self.world = Box2D.b2World(gravity=(0, 0), doSleep=False)
        self.ground = self.world.CreateStaticBody()
        self.trunk = self._box(settings.body_length / unit, settings.width / unit, settings.mass, (0.0, 0.0), 0.0)
        self.belly = self._friction(self.trunk, (0.0, 0.0))
        self.bodies: list[Any] = [self.trunk]
        self.hips: list[Any] = []
        self.feet: list[Any] = []
        self.places: tuple[tuple[float, float], ...] = ()
        rests = legs.rest if self.revolute else (0.0,) * len(legs.x)
        for x, y, rest in zip(legs.x, legs.y, rests, strict=True):
            self._add((x / unit, y / unit), rest, legs.mass, _LEG_WIDTH / unit)
        rate, torque = legs.max_rate, legs.max_torque / unit**2
        if not self.revolute:
            rate, torque = rate * self.reach, torque / self.reach
        self.max_rate, self.max_effort = rate, torque
        for hip in self.hips:
            if self.revolute:
                hip.maxMotorTorque = torque
            else:
                hip.maxMotorForce = torque
        self.mass = settings.mass + len(self.hips) * legs.mass

    def _add(self, hip: tuple[float, float], rest: float, mass: float, width: float) -> None:
        if self.revolute:
            half = 0.5 * self.reach
            out = cos(rest), sin(rest)
            body = self._box(self.reach, width, mass, (hip[0] + half * out[0], hip[1] + half * out[1]), rest)
            joint = self.world.CreateRevoluteJoint(
                bodyA=self.trunk, bodyB=body, localAnchorA=hip, localAnchorB=(-half, 0.0), referenceAngle=rest,
                enableMotor=True, maxMotorTorque=0.0, motorSpeed=0.0,
            )  # fmt: skip
            foot, place = (half, 0.0), (hip[0] + self.reach * out[0], hip[1] + self.reach * out[1])
        else:
            body = self._box(width, width, mass, hip, 0.0)
            joint = self.world.CreatePrismaticJoint(
                bodyA=self.trunk, bodyB=body, localAnchorA=hip, localAnchorB=(0.0, 0.0), axis=(1.0, 0.0),
                enableMotor=True, maxMotorForce=0.0, motorSpeed=0.0,
            )  # fmt: skip
            foot, place = (0.0, 0.0), hip
        self.bodies.append(body)
        self.hips.append(joint)
        self.feet.append(self._friction(body, foot))
        self.places = (*self.places, place)

    def _box(self, length: float, width: float, mass: float, at: tuple[float, float], angle: float) -> Any:
        shape = Box2D.b2PolygonShape(box=(0.5 * length, 0.5 * width))
        fixture = Box2D.b2FixtureDef(shape=shape, density=mass / (length * width), maskBits=0)
        return self.world.CreateDynamicBody(fixtures=fixture, position=at, angle=angle, allowSleep=False)

    def _friction(self, body: Any, at: tuple[float, float]) -> Any:
        return self.world.CreateFrictionJoint(
            bodyA=self.ground, bodyB=body, localAnchorA=(0.0, 0.0), localAnchorB=at, maxForce=0.0, maxTorque=0.0
        )

    def place(self, x: float, y: float, theta: float) -> None:
        """Move all of it rigidly, velocities turned along: the trunk comes to ``x, y`` [unit] and ``theta`` [rad]."""
        (old_x, old_y), old = self.trunk.position, self.trunk.angle
        c, s = cos(theta - old), sin(theta - old)
        for body in self.bodies:
            (bx, by), (vx, vy) = body.position, body.linearVelocity
            dx, dy = bx - old_x, by - old_y
            body.transform = ((x + c * dx - s * dy, y + s * dx + c * dy), body.angle + theta - old)
            body.linearVelocity = (c * vx - s * vy, s * vx + c * vy)

    def push(self, vx: float, vy: float) -> None:
        """Give all of it one velocity [unit/s]: something has stopped it."""
        for body in self.bodies:
            body.linearVelocity = (vx, vy)

    def copy_state(self, other: LegFrame) -> None:
        """Take over the poses, velocities and motors of another frame of the same kind."""
        for mine, its in zip(self.bodies, other.bodies, strict=True):
            mine.transform = (tuple(its.position), its.angle)
            mine.linearVelocity, mine.angularVelocity = tuple(its.linearVelocity), its.angularVelocity
        for mine, its in zip(self.hips, other.hips, strict=True):
            mine.motorSpeed = its.motorSpeed
        for mine, its in zip((*self.feet, self.belly), (*other.feet, other.belly), strict=True):
            mine.maxForce, mine.maxTorque = its.maxForce, its.maxTorque
