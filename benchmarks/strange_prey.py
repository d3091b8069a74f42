"""Prey that no planner was chosen on: one that zigzags, one that circles, one that stops and goes."""

from __future__ import annotations

from typing import ClassVar

from bayeshunt.worlds.prey.behaviours import Context, register_prey, registered_prey

__all__ = ["Circling", "StopAndGo", "Zigzag", "register"]


class Zigzag:
    """Turns left and right in turn: at 1.2 rad/s in two fifths of every 2.5 s, and straight on in the others."""

    period: ClassVar[float] = 2.5

    def __init__(self, context: Context) -> None:
        self.context, self.calls = context, 0
        self.each = max(1, round(self.period / context.interval))

    def act(self, x: float, y: float, theta: float, hunter_x: float, hunter_y: float) -> tuple[float, float]:
        """Return left and right wheel speed [m/s]."""
        self.calls += 1
        side = 1.0 if self.calls // self.each % 2 else -1.0
        turns = self.calls % self.each < 0.4 * self.each
        return self.context.wheels(self.context.settings.speed, 1.2 * side if turns else 0.0)


class Circling:
    """Turns to the left all the time, at 0.35 rad/s."""

    def __init__(self, context: Context) -> None:
        self.wheels = context.wheels(context.settings.speed, 0.35)

    def act(self, x: float, y: float, theta: float, hunter_x: float, hunter_y: float) -> tuple[float, float]:
        """Return left and right wheel speed [m/s]."""
        return self.wheels


class StopAndGo(Zigzag):
    """Goes straight for 6 s and stands for 6 s."""

    period = 6.0

    def act(self, x: float, y: float, theta: float, hunter_x: float, hunter_y: float) -> tuple[float, float]:
        """Return left and right wheel speed [m/s]."""
        self.calls += 1
        speed = self.context.settings.speed if self.calls // self.each % 2 == 0 else 0.0
        return speed, speed


def register() -> None:
    """Make them known as zigzag, circling and stop_and_go."""
    for name, behaviour in (("zigzag", Zigzag), ("circling", Circling), ("stop_and_go", StopAndGo)):
        if name not in registered_prey():
            register_prey(name, behaviour)
