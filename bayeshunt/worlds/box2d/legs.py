"""A body on legs: a pattern generator moves servos, feet stick and slip, and a load outside its support stumbles.

The legs walk in a Box2D world of their own with a fine step of their own; the disc in the world of the hunt goes where
the trunk went, and pushes it back where it meets something.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil, cos, hypot, pi, sin, sqrt

import numpy as np

from bayeshunt.config.schema.legs import LeggedSettings
from bayeshunt.core.errors import InputError
from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import Pose
from bayeshunt.worlds.box2d.bodies import Drive, Parts, bound
from bayeshunt.worlds.box2d.frame import LegFrame
from bayeshunt.worlds.box2d.support import supports

__all__ = ["Legs"]

_GRAVITY = 9.81
#: Most of the weight that the belly takes, and how long it does so in a fall [s]: longer than between two bounds.
_LYING, _FALL = 0.8, 0.25
#: Box2D units between disc and trunk that come of rounding, not of a contact.
_ROUNDING = 1e-4
#: Steps of which one is metered; not a divisor of the strides of usual gaits.
_SAMPLED = 3
_BEFORE_PHASES = 4  # values of a command: frequency, duty, left stroke, right stroke, then the phases


class Legs(Drive):
    """A trunk on any number of legs.

    energy: mechanical work of the servos, what they take up not given back [J]. falls: how often it lay on its belly.
    The common clock of the legs is never set back: a gait begins in the phase in which the one before ended.
    """

    __slots__ = (
        "_bearing",
        "_belly",
        "_clock",
        "_count",
        "_coupling",
        "_dt",
        "_duty",
        "_fallen",
        "_feet",
        "_frame",
        "_frequency",
        "_gain",
        "_grip",
        "_grips",
        "_lag",
        "_last",
        "_legs",
        "_lying",
        "_mask",
        "_number",
        "_phase",
        "_servos",
        "_settling",
        "_sides",
        "_standing",
        "_step",
        "_stroke",
        "_supports",
        "_swing",
        "_tilt",
        "_unmeasured",
        "_weight",
        "gait",
    )  # fmt: skip
    settings: LeggedSettings

    def __init__(self, parts: Parts) -> None:
        super().__init__(parts)
        settings, legs = self.settings, self.settings.legs
        frame = self._frame = LegFrame(settings, self.unit)
        self._count = max(1, ceil(parts.physics.step / settings.step - 1e-9))
        self._dt = parts.physics.step / self._count
        self._number = len(legs.x)
        turns, effort = ("angle", "GetMotorTorque") if frame.revolute else ("translation", "GetMotorForce")
        kind = type(frame.hips[0])
        self._legs = [
            (i, 1 << i, bound(getattr(kind, turns).fget, hip), bound(kind.motorSpeed.fset, hip))
            for i, hip in enumerate(frame.hips)
        ]
        self._servos = [(bound(getattr(kind, effort), hip), bound(kind.speed.fget, hip)) for hip in frame.hips]
        self._step = bound(type(frame.world).Step, frame.world)
        self._feet = [bound(type(foot).maxForce.fset, foot) for foot in frame.feet]
        # a revolute leg of the left goes forwards as it turns clockwise
        self._sides = [-1.0 if frame.revolute and y > 0 else 1.0 for y in legs.y]
        self._supports = supports(frame.places)
        self._coupling, self._gain = legs.coupling, legs.gain
        self._weight = frame.mass * _GRAVITY / self.unit  # kg unit/s2
        spread = legs.friction_spread if parts.noise.slip or parts.noise.drift_sd else 0.0
        self._grips = _grips(legs.friction, spread, parts.rng)
        self._grip = [legs.friction] * self._number
        self._phase, self._lag = [0.0] * self._number, [0.0] * self._number
        self._last, self._stroke, self._swing = ([0.0] * self._number for _ in range(3))
        self._standing = 0  # bit i: foot i is down
        self._tilt = (0.0, 0.0, 0.0)
        self._settling = min(1.0, self._dt / legs.tilt_time)
        self._bearing = (legs.tilt_margin, legs.tilt_scale, legs.belly_friction)
        self._clock = self._belly = self._frequency = 0.0
        self._unmeasured = 0
        self._duty, self._mask, self._lying = 0.5, -1, 0
        self.gait: tuple[float, ...] = ()  # the command that is held; none: it stands
        self._fallen = max(1, round(_FALL / self._dt))

    def limits(self, step: float) -> tuple[float, ...]:
        """One actuator a leg; what limits it is its servo."""
        return (float("inf"),) * len(self.settings.legs.x)

    def command(self, gait: Gait) -> None:
        """Change to a gait: frequency, duty, strokes and phases; InputError unless there is a phase for each leg."""
        values = gait.command
        if len(values) != _BEFORE_PHASES + self._number:
            raise InputError(
                f"{self.name}: gait {gait.name!r} commands {len(values) - _BEFORE_PHASES} legs, not {self._number}"
            )
        if values == self.gait:
            return
        first, self.gait = not self.gait, values
        self._frequency, self._duty = values[:2]
        self._lag = list(values[_BEFORE_PHASES:])
        legs, revolute = self.settings.legs, self._frame.revolute
        strokes = values[2:4] if revolute else [self._frame.reach * sin(stroke) for stroke in values[2:4]]
        # signed as the hip turns, here and wherever a leg is
        sides = zip(self._sides, legs.y, strict=True)
        self._swing = [side * (strokes[0] if y > 0 else strokes[1]) for side, y in sides]
        # a foot that is down sweeps by the new stroke at once; only the phase carries over
        self._stroke = [stroke * factor for stroke, factor in zip(self._swing, self.factors, strict=True)]
        if first:  # from rest it starts in step
            self._phase = [-lag % 1.0 for lag in self._lag]
            self._standing = sum(1 << i for i, phase in enumerate(self._phase) if phase < self._duty)
            self._last = list(self._swing)

    def next_interval(self) -> None:
        """Draw the noise of the next control interval: a step that begins in it is longer or shorter by it."""
        self.factors = next(self._factors)

    def advance(self) -> None:
        """Walk for one physics step, and set the disc's velocity so that it ends where the trunk is."""
        trunk = self._frame.trunk
        if self.gait:
            walk, step, dt = self._walk, self._step, self._dt
            for _ in range(self._count):
                walk()
                step(dt, 6, 2)
                self._unmeasured += 1
                if self._unmeasured == _SAMPLED:
                    self._measure()
        rate = 1.0 / (self._count * self._dt)
        here, there = self._position, trunk.position
        self._velocity.x, self._velocity.y = (there.x - here.x) * rate, (there.y - here.y) * rate
        self.body.angularVelocity = (trunk.angle - self.body.angle) * rate

    def _walk(self) -> None:
        """Move every servo's target by one step of the legs' own, and load the feet that are down.

        The hot loop of legs: a wrap is a comparison, and what is the same for all legs is read once.
        """
        frame, dt, duty, frequency = self._frame, self._dt, self._duty, self._frequency
        coupling, gain, most = self._coupling, self._gain, frame.max_rate
        clock = self._clock + frequency * dt
        if clock >= 1.0:
            clock %= 1.0
        self._clock = clock
        phases, strokes, standing, mask, share = self._phase, self._stroke, self._standing, 0, pi / (1.0 - duty)
        for (i, bit, angle, drive), lag, phase, stroke in zip(self._legs, self._lag, phases, strokes, strict=True):
            gap = clock - lag - phase
            half = gap + 0.5
            if half >= 1.0:
                gap -= 1.0
            elif half < 0.0:
                gap += 1.0 if half >= -1.0 else 2.0
            rate = frequency + coupling * gap
            if rate < 0.0:
                rate = 0.0  # a leg waits, it does not walk backwards
            phase += rate * dt
            if phase >= 1.0:
                phase %= 1.0
            phases[i] = phase
            if phase < duty:
                if not standing & bit:
                    self._grip[i] = next(self._grips)
                mask |= bit
                full = 2.0 * stroke
                speed = gain * (stroke - full * phase / duty) - full * rate / duty - gain * angle()
            else:
                if standing & bit:  # the next step begins: how far it goes has noise
                    self._last[i] = stroke
                    stroke = strokes[i] = self._swing[i] * self.factors[i]
                last = self._last[i]
                ahead = stroke - last - (stroke + last) * cos((phase - duty) * share)
                speed = gain * (0.5 * ahead - angle())
            drive(most if speed > most else -most if speed < -most else speed)
        self._standing = mask
        self._bear(mask)

    def _bear(self, mask: int) -> None:
        """Share the weight among the feet that are down and, as far as the load lies outside them, the belly."""
        margin, scale, friction = self._bearing
        shares, (ahead, left, up) = self._supports[mask]
        share, (x, y, z) = self._settling, self._tilt
        x, y, z = self._tilt = x + share * (ahead - x), y + share * (left - y), z + share * (up - z)
        belly = (sqrt(x * x + y * y + z * z) - margin) / scale
        belly = 0.0 if belly < 0.0 else _LYING if belly > _LYING else belly
        if belly == _LYING:
            self._lying += 1
            self.falls += self._lying == self._fallen
        elif not belly:
            self._lying = 0
        if mask == self._mask and belly == self._belly:
            return
        self._mask, self._belly = mask, belly
        weight = self._weight * (1.0 - belly)
        for load, grip, share in zip(self._feet, self._grip, shares, strict=True):
            load(grip * share * weight)
        rubbing = friction * belly * self._weight
        self._frame.belly.maxForce = rubbing
        self._frame.belly.maxTorque = 0.25 * rubbing  # of a pressure spread along one body length

    def _measure(self) -> None:
        """Add the work of the servos in the last few steps [J]: their power now stands for all of them."""
        power, rate = 0.0, 1.0 / self._dt
        for effort, speed in self._servos:
            one = effort(rate) * speed()
            if one > 0.0:
                power += one
        self.energy += power * self._unmeasured * self._dt * self.unit * self.unit
        self._unmeasured = 0

    def read_back(self) -> None:
        """Where a contact has kept the disc from following, the trunk goes back to it and stops as it did."""
        here, there = self._position, self._frame.trunk.position
        if hypot(here.x - there.x, here.y - there.y) > _ROUNDING:
            self._frame.place(here.x, here.y, self.body.angle)
            self._frame.push(self._velocity.x, self._velocity.y)

    def place(self, pose: Pose) -> None:
        """Put the body at ``pose`` [m, rad] as it is: its legs and their velocities turn along."""
        super().place(pose)
        self._frame.place(pose.x / self.unit, pose.y / self.unit, pose.theta)

    def continue_as(self, other: Drive) -> None:
        """Take over another body's legs, as they are now."""
        if not isinstance(other, Legs):
            raise InputError(f"{self.name}: a body on legs cannot go on as a {type(other).__name__}")
        self.body.transform = (tuple(other.body.position), other.body.angle)
        self._frame.copy_state(other._frame)
        for name in ("_phase", "_lag", "_last", "_stroke", "_swing", "_grip"):
            setattr(self, name, list(getattr(other, name)))
        for name in (
            "_clock", "_tilt", "_belly", "_frequency", "_duty", "_mask", "_standing", "_lying", "_unmeasured", "gait",
            "factors",
        ):  # fmt: skip
            setattr(self, name, getattr(other, name))


def _grips(friction: float, spread: float, rng: np.random.Generator) -> Iterator[float]:
    """Yield the friction coefficients of footholds for ever."""
    while True:
        yield from rng.uniform(friction * (1.0 - spread), friction * (1.0 + spread), 256).tolist()
