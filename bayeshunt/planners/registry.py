"""Planners by name."""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Callable, Collection, Iterable
from typing import Any

from bayeshunt.core.checks import check_kind
from bayeshunt.core.errors import InputError, did_you_mean
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.api import Planner
from bayeshunt.planners.bounds.kinematic_limit import KinematicLimit
from bayeshunt.planners.bounds.omniscient import Omniscient
from bayeshunt.planners.bounds.reference import Reference
from bayeshunt.planners.guidance.pursuit import ConstantVelocity, ProportionalNavigation, PurePursuit
from bayeshunt.planners.interception.belief import BeliefSettings, belief
from bayeshunt.planners.interception.intercept import InterceptSettings, intercept
from bayeshunt.planners.interception.intercept_room import RoomGuessSettings, intercept_room
from bayeshunt.planners.interception.intercept_walls import SETTINGS as ROOM_SETTINGS
from bayeshunt.planners.interception.intercept_walls import intercept_walls
from bayeshunt.planners.paper.planning import PlanningSettings, planning
from bayeshunt.planners.paper.prediction import PredictionPlanner
from bayeshunt.planners.paper.reactive import ReactivePlanner
from bayeshunt.planners.sequences.frugal import Frugal
from bayeshunt.planners.sequences.memory import Memory, OrderMemory, PlaceMemory

#: Makes a planner from a forward model and settings given by name.
Factory = Callable[..., Planner]


@dataclasses.dataclass(frozen=True)
class _Entry:
    factory: Factory
    settings: tuple[str, ...] | None  # None: the factory checks its own


_REGISTRY: dict[str, _Entry] = {}


def register_planner(name: str, factory: Factory, *, settings: Iterable[str] | None = None) -> None:
    """Make ``factory(model, **settings)`` known as ``name`` in this process.

    settings: the names it accepts; by default the factory's named parameters after the first.
    Raises InputError if the name is empty or taken.
    """
    if not isinstance(name, str) or not name.strip():
        raise InputError(f"a planner needs a name, got {name!r}")
    if name in _REGISTRY:
        raise InputError(f"a planner called {name!r} is registered already; choose another name")
    if not callable(factory):
        raise InputError(f"planner {name!r}: expected a function that makes it, got {factory!r}")
    accepted = _parameters(factory) if settings is None else tuple(settings)
    _REGISTRY[name] = _Entry(factory, accepted)


def planner_names(*, standalone: bool = False) -> tuple[str, ...]:
    """Return the names of all registered planners, in order of registration.

    standalone: only those that a forward model alone makes and a situation alone lets decide; the others
        need a table, the room of their arena or the prey's future, and say so (``standalone = False``).
    """
    return tuple(n for n, e in _REGISTRY.items() if not standalone or getattr(e.factory, "standalone", True))


def is_ab_initio(name: str, given: Collection[str] = ()) -> bool:
    """Return whether a planner learns all it knows within the run (False too for bounds told the future).

    given: names of the settings that the experiment gives it; a room from a file was learned in another run.
    The mark is the attribute ``ab_initio`` of the planner's class; without one, and for a name that is
    not registered, it is taken to be True.
    """
    entry = _REGISTRY.get(name)
    if entry is None:
        return True
    told = getattr(entry.factory, "explores", False) and "room" in given
    return bool(getattr(entry.factory, "ab_initio", True)) and not told


def explores(name: str, given: Collection[str] = ()) -> bool:
    """Return whether a planner is to babble in its arena before it hunts there.

    It is if its class or factory says ``explores = True`` (it takes a RoomModel as setting ``room``) and
    ``given``, the names of the settings that the experiment gives it, does not hold "room".
    """
    entry = _REGISTRY.get(name)
    return entry is not None and bool(getattr(entry.factory, "explores", False)) and "room" not in given


def make_planner(name: str, model: ForwardModel, **settings: Any) -> Planner:
    """Return the planner called ``name`` for a fitted forward model.

    Raises InputError for an unknown name or an unknown or wrong setting.
    """
    factory, accepted = find_planner(name)
    for setting in settings if accepted is not None else ():
        if setting not in accepted:  # type: ignore[operator]
            raise InputError(f"planner {name!r} has no setting {setting!r}{_hint(setting, accepted)}")
    check_kind(model, f"planner {name!r}", ForwardModel, "a ForwardModel to plan with")
    return factory(model, **settings)


def find_planner(name: str) -> tuple[Factory, tuple[str, ...] | None]:
    """Return the factory of a registered planner and the names of its settings (None: it checks its own).

    Raises InputError for an unknown name.
    """
    entry = _REGISTRY.get(name) if isinstance(name, str) else None
    if entry is None:
        hint = did_you_mean(name, planner_names(), listed=False)
        raise InputError(f"unknown planner {name!r}: expected one of {', '.join(planner_names())}{hint}")
    return entry.factory, entry.settings


def _parameters(factory: Factory) -> tuple[str, ...] | None:
    """Names of the settings a factory takes by keyword, or None if it takes any."""
    parameters = list(inspect.signature(factory).parameters.values())
    if any(p.kind is p.VAR_KEYWORD for p in parameters):
        return None
    named = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    return tuple(p.name for p in parameters[1:] if p.kind in named)


def _hint(setting: str, accepted: tuple[str, ...] | None) -> str:
    near = did_you_mean(setting, accepted or (), listed=False)
    return near or (f"; it has {', '.join(accepted)}" if accepted else "; it has none")


register_planner("reactive", ReactivePlanner)
register_planner("prediction", PredictionPlanner)
register_planner("planning", planning, settings=[f.name for f in dataclasses.fields(PlanningSettings)])
register_planner("pure_pursuit", PurePursuit)
register_planner("proportional_navigation", ProportionalNavigation)
register_planner("constant_velocity", ConstantVelocity)
register_planner("omniscient", Omniscient)
register_planner("kinematic_limit", KinematicLimit)
register_planner("frugal", Frugal)
register_planner("reference", Reference)
register_planner("memory", Memory)
register_planner("memory_place", PlaceMemory)
register_planner("memory_previous", OrderMemory)
register_planner("intercept", intercept, settings=[f.name for f in dataclasses.fields(InterceptSettings)])
register_planner("intercept_room", intercept_room, settings=[f.name for f in dataclasses.fields(RoomGuessSettings)])
register_planner("intercept_walls", intercept_walls, settings=ROOM_SETTINGS)
register_planner("belief", belief, settings=[f.name for f in dataclasses.fields(BeliefSettings)])
_SHIPPED = frozenset(_REGISTRY)


def is_shipped(name: str) -> bool:
    """Return whether a planner comes with the package."""
    return name in _SHIPPED


def registered_planners() -> dict[str, tuple[Factory, tuple[str, ...] | None]]:
    """Return the factory and the settings' names of every planner registered beside those that ship."""
    return {n: (e.factory, e.settings) for n, e in _REGISTRY.items() if n not in _SHIPPED}


def adopt_planner(name: str, factory: Factory, settings: tuple[str, ...] | None) -> None:
    """Know in this process a planner that was registered in another; one already known stays as it is."""
    _REGISTRY.setdefault(name, _Entry(factory, settings))
