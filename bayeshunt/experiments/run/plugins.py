"""Planners, prey, bodies, worlds and so on of one's own: from a file, and on to the worker processes."""

from __future__ import annotations

import contextlib
import hashlib
import importlib
import importlib.util
import os
import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.errors import BayesHuntError, InputError
from bayeshunt.models.target.registry import check_prey_model_name, register_prey_model, registered_prey_models
from bayeshunt.perception.registry import (
    check_sensing,
    register_sensor,
    register_tracker,
    registered_sensors,
    registered_trackers,
)
from bayeshunt.planners.registry import adopt_planner, registered_planners
from bayeshunt.worlds.bodies import BodyEntry, register_body, registered_bodies
from bayeshunt.worlds.prey.behaviours import check_behaviour, register_prey, registered_prey
from bayeshunt.worlds.prey.names import is_recorded
from bayeshunt.worlds.recorded.path import path_of
from bayeshunt.worlds.registry import check_world_name, register_world, registered_worlds

__all__ = ["Additions", "check_names", "load_plugin", "used_additions"]

_REGISTER = (
    "call bayeshunt.register_prey(name, class) or bayeshunt.register_planner(name, class), or another register_, in it"
)


class _Door(NamedTuple):
    """A kind of thing that can be registered."""

    registered: Callable[[], Mapping[str, Any]]
    adopt: Callable[[str, Any], None]
    factory: Callable[[Any], Any]  # of an entry: the class or function behind it


def _itself(entry: Any) -> Any:
    return entry


def _behind(entry: Any) -> Any:
    return entry.factory


def _adopt_body(name: str, entry: BodyEntry) -> None:
    register_body(name, entry.factory, commands=entry.commands, settings=entry.settings, speed=entry.speed)


_DOORS = {
    "prey": _Door(registered_prey, register_prey, _itself),
    "planners": _Door(registered_planners, adopt_planner, _behind),
    "bodies": _Door(registered_bodies, _adopt_body, _behind),
    "worlds": _Door(registered_worlds, register_world, _itself),
    "sensors": _Door(registered_sensors, register_sensor, _itself),
    "trackers": _Door(registered_trackers, register_tracker, _itself),
    "prey_models": _Door(registered_prey_models, register_prey_model, _itself),
}


class Additions(NamedTuple):
    """What has been registered in one process beside what ships, by name."""

    prey: Mapping[str, Any]
    planners: Mapping[str, Any]
    bodies: Mapping[str, Any]
    worlds: Mapping[str, Any]
    sensors: Mapping[str, Any]
    trackers: Mapping[str, Any]
    prey_models: Mapping[str, Any]

    @classmethod
    def here(cls) -> Additions:
        """Return the additions of this process."""
        return cls(**{kind: dict(door.registered()) for kind, door in _DOORS.items()})

    def adopt(self) -> None:
        """Know them in this process too; one already known stays as it is."""
        for kind, door in _DOORS.items():
            known = door.registered()
            for name, entry in getattr(self, kind).items():
                if name not in known:
                    door.adopt(name, entry)


def used_additions(
    planners: Iterable[str], behaviour: str, settings: ExperimentSettings | None = None
) -> dict[str, Any]:
    """Return the class or function behind each planner, and behind the prey, that does not ship, by what it is.

    settings: those whose body, world, sensor, tracker and prey model are looked at too.
    """
    used = [("planner", "planners", name) for name in planners] + [("prey", "prey", behaviour)]
    if settings is not None:
        used += [
            ("body", "bodies", settings.robot.body.drive), ("world", "worlds", settings.world),
            ("sensor", "sensors", settings.sensing.sensor), ("tracker", "trackers", settings.sensing.tracker),
            ("prey model", "prey_models", settings.prey.model),
        ]  # fmt: skip
    here = Additions.here()
    return {
        f"with {what} {name}": _DOORS[kind].factory(getattr(here, kind)[name])
        for what, kind, name in used
        if name in getattr(here, kind)
    }


def check_names(settings: ExperimentSettings) -> None:
    """Raise InputError if the settings name a prey, prey model, world, sensor or tracker that nobody knows."""
    if is_recorded(settings.prey.behaviour):
        path_of(settings.prey.behaviour)
    else:
        check_behaviour(settings.prey.behaviour)
    check_prey_model_name(settings.prey.model)
    check_world_name(settings.world)
    check_sensing(settings.sensing.sensor, settings.sensing.tracker)


def load_plugin(path: str | os.PathLike[str]) -> ModuleType:
    """Run a Python file of the user's that calls ``register_prey`` or ``register_planner``.

    Raises InputError in one line if the file is missing, fails or registers nothing.
    """
    file = Path(path)
    if not file.is_file():
        raise InputError(f"{file}: no such file; expected a Python file that registers prey or planners")
    # Two files may have one name.
    name = f"bayeshunt_plugin_{file.stem}_{hashlib.sha256(os.fsencode(file.resolve())).hexdigest()[:8]}"
    spec = importlib.util.spec_from_file_location(name, file)
    if spec is None or spec.loader is None:
        raise InputError(f"{file}: expected a Python file (.py)")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    before = Additions.here()
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        del sys.modules[name]
        kind = "" if isinstance(error, BayesHuntError) else f"{type(error).__name__}: "
        raise InputError(f"{file}: {kind}{error}") from error
    if Additions.here() == before:
        raise InputError(f"{file}: registers nothing; {_REGISTER}")
    _send_by_value(module)
    return module


def _send_by_value(module: ModuleType) -> None:
    """Let workers get the plugin's classes whole: they cannot import a file that only this process has read."""
    for name in ("cloudpickle", "joblib.externals.cloudpickle"):  # joblib brought its own copy before 1.6
        with contextlib.suppress(ImportError):
            importlib.import_module(name).register_pickle_by_value(module)
