"""Prey behaviours: what a prey does with its two wheels, one control interval at a time.

A behaviour is anything with the :class:`Prey` protocol; :func:`register_prey` gives it a name
that settings files can use.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from bayeshunt.config.schema import ArenaSettings, PreySettings
from bayeshunt.core.arguments import checked_but
from bayeshunt.core.errors import InputError, did_you_mean, shown
from bayeshunt.core.geometry import wrap
from bayeshunt.worlds.noise import gaussians
from bayeshunt.worlds.prey.proximity import KHEPERA_DIAMETER, MOUNT_RADIUS, Solid, proximity
from bayeshunt.worlds.scene import Scene

__all__ = [
    "BRAITENBERG",
    "MAX_UNITS",
    "Alone",
    "Braitenberg",
    "Checked",
    "Context",
    "Evader",
    "Prey",
    "RandomWalk",
    "Straight",
    "behaviours",
    "build_prey",
    "check_behaviour",
    "prey_names",
    "register_prey",
    "registered_prey",
]

#: Braitenberg weights of the eight sensors on (left, right) wheel: Webots' Khepera controller.
BRAITENBERG = ((-2, 4), (-3, 5), (-7, 7), (7, -6), (5, -4), (4, -2), (-0.5, -0.5), (-0.5, -0.5))
#: Wheel speed units that the controller may ask for.
MAX_UNITS = 10.0


class Prey(Protocol):
    """A prey's controller. It is made anew for every trial and may keep a state."""

    def act(self, x: float, y: float, theta: float, hunter_x: float, hunter_y: float) -> tuple[float, float]:
        """Return left and right wheel speed [m/s] for the next control interval.

        x, y [m], theta [rad, counter-clockwise]: the prey's pose in the arena; hunter_x, hunter_y [m].
        """
        ...


class Context:
    """What a behaviour may know when it is made.

    settings: the prey's settings. arena: the arena's. hunter_diameter: metres.
    interval: seconds between two calls of ``act``. rng: the prey's own random generator.
    """

    def __init__(
        self,
        settings: PreySettings,
        arena: ArenaSettings,
        hunter_diameter: float,
        interval: float,
        rng: np.random.Generator,
    ) -> None:
        self.settings = settings
        self.arena = arena
        self.hunter_diameter = hunter_diameter
        self.interval = interval
        self.rng = rng

    @classmethod
    def of(cls, scene: Scene, interval: float, rng: np.random.Generator) -> Context:
        """Return that of the prey of a scene."""
        assert scene.prey is not None  # a body that is a prey has been made
        return cls(scene.prey, scene.arena, scene.robot.body.diameter, interval, rng)

    @property
    def walls(self) -> tuple[float, float] | None:
        """Half width and half height [m], None in an open arena."""
        return (0.5 * self.arena.width, 0.5 * self.arena.height) if self.arena.walled else None

    def wheels(self, speed: float, turn: float) -> tuple[float, float]:
        """Wheel speeds [m/s] for a forward speed [m/s] and a turning rate [rad/s, counter-clockwise]."""
        difference = 0.5 * turn * self.settings.body.axle
        return speed - difference, speed + difference


class Braitenberg:
    """Webots' Khepera obstacle avoider: straight ahead in free space, away from what its sensors see.

    ``wheel_i = sum_j M[j][i] (1 - s_j / 512)``, clipped to +-10 units; 3 units are the free speed.
    A body of another size is a Khepera drawn to scale: its sensors sit where they do on a Khepera, and
    reach as far as its settings say.
    """

    def __init__(self, context: Context) -> None:
        # The sensors see in the measure of a Khepera: every length is brought to it.
        scale = self._scale = KHEPERA_DIAMETER / context.settings.body.diameter
        self._range = context.settings.sensor_range * scale
        self._noise = context.settings.sensor_noise
        self._walls = None if context.walls is None else (context.walls[0] * scale, context.walls[1] * scale)
        self._solids = tuple(Solid.of(obstacle, scale) for obstacle in context.arena.obstacles)
        self._hunter_radius = 0.5 * context.hunter_diameter * scale if context.settings.senses_hunter else None
        self._reach = MOUNT_RADIUS + self._range
        # what alone can come within reach: half width and half height, infinite in the open; None: other things too
        alone = self._hunter_radius is None and not self._solids
        self._only = (self._walls or (math.inf, math.inf)) if alone else None
        self._metres_per_unit = context.settings.speed / sum(row[0] for row in BRAITENBERG)
        self._normals = gaussians(context.rng)
        self._free = self._wheels([0.0] * 8)

    def act(self, x: float, y: float, theta: float, hunter_x: float, hunter_y: float) -> tuple[float, float]:
        """See :class:`Prey`."""
        scale, only, reach = self._scale, self._only, self._reach
        if only is not None and abs(x * scale) + reach < only[0] and abs(y * scale) + reach < only[1]:
            return self._free  # what proximity() would find, without asking it: it is so most of the time
        disc = None if self._hunter_radius is None else (hunter_x * scale, hunter_y * scale, self._hunter_radius)
        values = proximity(x * scale, y * scale, theta, self._range, self._walls, disc, self._solids)
        if values is None:
            return self._free
        return self._wheels(values)

    def _wheels(self, values: list[float]) -> tuple[float, float]:
        """Wheel speeds [m/s] for noise-free sensor values; those that are not 0 have noise."""
        noise, normals = self._noise, self._normals
        left = right = 0.0
        for (to_left, to_right), value in zip(BRAITENBERG, values, strict=True):
            excitation = 1.0 - value * (1.0 + noise * next(normals)) / 512.0 if value else 1.0
            left += to_left * excitation
            right += to_right * excitation
        scale = self._metres_per_unit
        return _clip(left) * scale, _clip(right) * scale


class Straight:
    """Drives straight ahead at its free speed, whatever comes; at speed 0 a lure that stays where it is."""

    def __init__(self, context: Context) -> None:
        self._wheels = (context.settings.speed, context.settings.speed)

    def act(self, x: float, y: float, theta: float, hunter_x: float, hunter_y: float) -> tuple[float, float]:
        """See :class:`Prey`."""
        return self._wheels


class RandomWalk:
    """Drives at its free speed; its turning rate is an Ornstein-Uhlenbeck process."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._keep = math.exp(-context.interval / context.settings.turn_time)
        self._kick = context.settings.turn_sd * math.sqrt(1.0 - self._keep**2)
        self._turn = 0.0
        self._normals = gaussians(context.rng)

    def act(self, x: float, y: float, theta: float, hunter_x: float, hunter_y: float) -> tuple[float, float]:
        """See :class:`Prey`."""
        self._turn = self._keep * self._turn + self._kick * next(self._normals)
        return self._context.wheels(self._context.settings.speed, self._turn)


class Evader:
    """Drives straight ahead and turns away from the hunter when that is near."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._near = context.settings.flee_distance * context.hunter_diameter

    def act(self, x: float, y: float, theta: float, hunter_x: float, hunter_y: float) -> tuple[float, float]:
        """See :class:`Prey`."""
        settings = self._context.settings
        away_x, away_y = x - hunter_x, y - hunter_y
        if math.hypot(away_x, away_y) > self._near:
            return settings.speed, settings.speed
        error = wrap(math.atan2(away_y, away_x) - theta)
        turn = max(-settings.turn_rate, min(settings.turn_rate, error / self._context.interval))
        return self._context.wheels(settings.speed, turn)


class Alone:
    """A behaviour that never sees a hunter: it is told of one that is ``far`` [m] away."""

    def __init__(self, behaviour: Prey, far: float) -> None:
        self._act, self._far = behaviour.act, far

    def act(self, x: float, y: float, theta: float, hunter_x: float, hunter_y: float) -> tuple[float, float]:
        """See :class:`Prey`."""
        return self._act(x, y, wrap(float(theta)), self._far, self._far)


_ACT = "act(x, y, theta, hunter_x, hunter_y) -> (left, right)"
_WHEELS = "expected (left, right), two finite wheel speeds [m/s]"


class Checked:
    """A behaviour that does not ship: what it answers is looked at, so that its mistakes carry its name."""

    def __init__(self, name: str, behaviour: Any) -> None:
        """Raise InputError if ``behaviour`` has no ``act``."""
        if not callable(getattr(behaviour, "act", None)):
            raise InputError(f"prey {name!r} has no method {_ACT}")
        self.name = name
        self._act = behaviour.act

    def act(self, x: float, y: float, theta: float, hunter_x: float, hunter_y: float) -> tuple[float, float]:
        """See :class:`Prey`; InputError unless the answer is two finite numbers."""
        answer = self._act(x, y, theta, hunter_x, hunter_y)
        try:
            left, right = answer
            wheels = float(left), float(right)
        except (TypeError, ValueError):
            raise InputError(f"prey {self.name!r}: act() gave {shown(answer)}; {_WHEELS}") from None
        if not (math.isfinite(wheels[0]) and math.isfinite(wheels[1])):
            raise InputError(f"prey {self.name!r}: act() gave ({left}, {right}); {_WHEELS}")
        return wheels


_BEHAVIOURS: dict[str, Callable[[Context], Prey]] = {
    "braitenberg": Braitenberg,
    "straight": Straight,
    "random_walk": RandomWalk,
    "evader": Evader,
}
_SHIPPED = frozenset(_BEHAVIOURS)


@checked_but("behaviour")
def register_prey(name: str, behaviour: Callable[[Context], Prey]) -> None:
    """Give a behaviour a name that ``prey.behaviour`` in a settings file may use.

    Worker processes of an evaluation are told of it too. Raises InputError if the name is one that ships,
    or the behaviour cannot be one: a class without ``act``, or nothing that can be called with a context.
    """
    if name in _SHIPPED:
        raise InputError(f"a prey behaviour called {name!r} ships already; choose another name")
    if not callable(behaviour):
        raise InputError(f"prey {name!r}: expected a class that is made from a Context, got {shown(behaviour)}")
    if isinstance(behaviour, type) and not callable(getattr(behaviour, "act", None)):
        raise InputError(f"prey {name!r}: class {behaviour.__name__} has no method {_ACT}")
    _BEHAVIOURS[name] = behaviour


def registered_prey() -> dict[str, Callable[[Context], Prey]]:
    """Return the behaviours registered beside those that ship, by name."""
    return {name: behaviour for name, behaviour in _BEHAVIOURS.items() if name not in _SHIPPED}


def behaviours() -> dict[str, Callable[[Context], Prey]]:
    """Return every behaviour by name: those that ship, then those registered."""
    return dict(_BEHAVIOURS)


def prey_names() -> list[str]:
    """Return the names of all behaviours."""
    return sorted(_BEHAVIOURS)


def check_behaviour(name: str) -> None:
    """Raise InputError if no behaviour is called ``name``."""
    if name not in _BEHAVIOURS:
        raise InputError(f"prey.behaviour: unknown behaviour {name!r}{did_you_mean(name, prey_names())}")


def build_prey(context: Context) -> Prey:
    """Return a fresh controller; InputError if the settings name no known behaviour."""
    name = context.settings.behaviour
    check_behaviour(name)
    controller = _BEHAVIOURS[name](context)
    return controller if name in _SHIPPED else Checked(name, controller)


def _clip(units: float) -> float:
    return max(-MAX_UNITS, min(MAX_UNITS, units))
