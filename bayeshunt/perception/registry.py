"""Sensors and trackers by name: ``sensing.sensor`` and ``sensing.tracker`` in an experiment's settings."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from bayeshunt.core.arguments import checked
from bayeshunt.core.checks import conforms
from bayeshunt.core.errors import InputError, did_you_mean, shown
from bayeshunt.core.protocols import Sensor, Tracker
from bayeshunt.perception.sensors.camera import Camera
from bayeshunt.perception.sensors.exact import ExactSensor
from bayeshunt.perception.setting import PerceptionContext
from bayeshunt.perception.trackers.exact import ExactTracker

__all__ = [
    "check_sensing", "make_sensor", "make_tracker", "register_sensor", "register_tracker", "registered_sensors",
    "registered_trackers",
]  # fmt: skip

#: Makes a sensor or a tracker from a context and settings given by name.
Factory = Callable[..., Any]


def _particles(context: PerceptionContext, **settings: Any) -> Tracker:
    from bayeshunt.perception.trackers.particles import ParticleTracker  # brings models, and pandas

    return ParticleTracker(context, **settings)


def _kalman(context: PerceptionContext, **settings: Any) -> Tracker:
    from bayeshunt.perception.trackers.kalman import KalmanTracker  # brings pykalman

    return KalmanTracker(context, **settings)


_SENSORS: dict[str, Factory] = {"exact": ExactSensor, "camera": Camera}
_TRACKERS: dict[str, Factory] = {"exact": ExactTracker, "particles": _particles, "kalman": _kalman}
_SHIPPED = {"sensor": frozenset(_SENSORS), "tracker": frozenset(_TRACKERS)}


@checked
def register_sensor(name: str, factory: Factory) -> None:
    """Give a sensor a name that ``sensing.sensor`` may use.

    factory: called with a ``PerceptionContext`` and the settings ``sensing.sensor_settings`` by name, once a hunt;
    gives a ``bayeshunt.protocols.Sensor``. Worker processes are told of it. Raises InputError for a name that ships.
    """
    _register("sensor", _SENSORS, name, factory)


@checked
def register_tracker(name: str, factory: Factory) -> None:
    """Give a tracker a name that ``sensing.tracker`` may use.

    factory: called with a ``PerceptionContext`` and the settings ``sensing.tracker_settings`` by name, once a hunt;
    gives a ``bayeshunt.protocols.Tracker``. Worker processes are told of it. Raises InputError for a name that ships.
    """
    _register("tracker", _TRACKERS, name, factory)


def registered_sensors() -> Mapping[str, Factory]:
    """Return the sensors registered beside those that ship, by name."""
    return {name: made for name, made in _SENSORS.items() if name not in _SHIPPED["sensor"]}


def registered_trackers() -> Mapping[str, Factory]:
    """Return the trackers registered beside those that ship, by name."""
    return {name: made for name, made in _TRACKERS.items() if name not in _SHIPPED["tracker"]}


def make_sensor(name: str, context: PerceptionContext, settings: Mapping[str, Any]) -> Sensor:
    """Return a sensor for one hunt; InputError for an unknown name or setting."""
    made: Sensor = _make("sensor", _SENSORS, name, context, settings)
    if not conforms(made, Sensor):
        raise InputError(f"sensor {name!r}: {shown(made)} is no bayeshunt.protocols.Sensor")
    return made


def make_tracker(name: str, context: PerceptionContext, settings: Mapping[str, Any]) -> Tracker:
    """Return a tracker for one hunt; InputError for an unknown name or setting."""
    made: Tracker = _make("tracker", _TRACKERS, name, context, settings)
    if not conforms(made, Tracker):
        raise InputError(f"tracker {name!r}: {shown(made)} is no bayeshunt.protocols.Tracker")
    return made


def check_sensing(sensor: str, tracker: str) -> None:
    """Raise InputError for a sensor or a tracker that nobody knows."""
    _check("sensor", _SENSORS, sensor)
    _check("tracker", _TRACKERS, tracker)


def _register(kind: str, known: dict[str, Factory], name: str, factory: Factory) -> None:
    if not isinstance(name, str) or not name.strip():
        raise InputError(f"a {kind} needs a name, got {shown(name)}")
    if name in _SHIPPED[kind]:
        raise InputError(f"a {kind} called {name!r} ships already; choose another name")
    if not callable(factory):
        raise InputError(f"{kind} {name!r}: expected a class or function that makes it, got {shown(factory)}")
    known[name] = factory


def _check(kind: str, known: Mapping[str, Factory], name: str) -> None:
    if name not in known:
        raise InputError(f"sensing.{kind}: unknown {kind} {name!r}{did_you_mean(name, sorted(known))}")


def _make(
    kind: str, known: Mapping[str, Factory], name: str, context: PerceptionContext, settings: Mapping[str, Any]
) -> Any:
    _check(kind, known, name)
    try:
        return known[name](context, **settings)
    except TypeError as error:
        raise InputError(f"sensing.{kind}_settings of {kind} {name!r}: {error}") from error
