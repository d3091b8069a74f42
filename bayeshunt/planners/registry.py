"""Planners by name."""

from __future__ import annotations

import contextlib
import inspect
import typing
import warnings
from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Any, NamedTuple
from weakref import WeakKeyDictionary

from bayeshunt.core.arguments import checked, checked_but
from bayeshunt.core.checks import check_kind
from bayeshunt.core.errors import BayesHuntError, DeprecatedNameWarning, InputError, did_you_mean
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.api import Planner
from bayeshunt.planners.asking import Timed, check_can_plan, failure
from bayeshunt.planners.bounds.kinematic_limit import KinematicLimit
from bayeshunt.planners.bounds.omniscient import Omniscient
from bayeshunt.planners.bounds.reference import Reference
from bayeshunt.planners.detour.detour import DetourPlanner
from bayeshunt.planners.guidance.pursuit import ConstantVelocity, ProportionalNavigation, PurePursuit
from bayeshunt.planners.info import PlannerInfo, read_marks
from bayeshunt.planners.interception.belief import BeliefPlanner
from bayeshunt.planners.interception.intercept import InterceptPlanner
from bayeshunt.planners.interception.intercept_evader import InterceptEvaderPlanner
from bayeshunt.planners.interception.intercept_room import InterceptRoomPlanner
from bayeshunt.planners.interception.intercept_walls import InterceptWallsPlanner
from bayeshunt.planners.paper.planning import PlanningPlanner
from bayeshunt.planners.paper.prediction import PredictionPlanner
from bayeshunt.planners.paper.reactive import ReactivePlanner
from bayeshunt.planners.sequences.frugal import Frugal
from bayeshunt.planners.sequences.memory import Memory, OrderMemory, PlaceMemory
from bayeshunt.planners.settings import settings_fields
from bayeshunt.planners.uncertainty.search import SearchPlanner

__all__ = [
    "Factory",
    "Registered",
    "adopt_planner",
    "check_hunts",
    "check_needs",
    "check_sections",
    "explores",
    "find_planner",
    "foresight_of",
    "info_of",
    "is_ab_initio",
    "is_shipped",
    "made_by",
    "make_planner",
    "model_of",
    "planner_info",
    "planner_names",
    "register_planner",
    "registered_planners",
]

#: Makes a planner from a forward model and settings given by name.
Factory = Callable[..., Planner]


class Registered(NamedTuple):
    """A registered planner: what makes it, the names of its settings, what sets it apart.

    settings: None if the factory checks its own. said: whether ``info`` was given, not read from its marks.
    typed: the class of its settings, which checks their values; None if only the factory does.
    """

    factory: Factory
    settings: tuple[str, ...] | None
    info: PlannerInfo
    said: bool
    typed: type | None


_REGISTRY: dict[str, Registered] = {}
#: Classes that have been made by a factory registered with an ``info``, which says more than their marks.
_MADE: dict[type, PlannerInfo] = {}
#: What the planners that were made plan with.
_MODELS: WeakKeyDictionary[Planner, ForwardModel] = WeakKeyDictionary()


@checked_but("info")
def register_planner(
    name: str,
    factory: Factory,
    *,
    settings: Iterable[str] | type | None = None,
    info: PlannerInfo | None = None,
) -> None:
    """Make ``factory(model, **settings)`` known as ``name`` in this process.

    settings: the names it accepts, or a class made by :func:`~bayeshunt.planners.settings.planner_settings`, whose
        fields they are; by default the factory's named parameters after the first.
    info: what sets it apart; by default the marks of the factory, and of the class that it returns, say it.
    Raises InputError if the name is empty or taken, or an argument is of another kind.
    """
    if not isinstance(name, str) or not name.strip():
        raise InputError(f"a planner needs a name, got {name!r}")
    if name in _REGISTRY:
        raise InputError(f"a planner called {name!r} is registered already; choose another name")
    if not callable(factory):
        raise InputError(f"planner {name!r}: expected a function that makes it, got {factory!r}")
    if info is not None:
        check_kind(info, f"planner {name!r}: info", PlannerInfo, "a PlannerInfo")
    typed = settings if isinstance(settings, type) else None
    if typed is not None:
        settings = [field.name for field in settings_fields(typed)]
    accepted = _parameters(factory) if settings is None else tuple(settings)  # type: ignore[arg-type]
    known = read_marks(factory, read_marks(made_by(factory))) if info is None else info
    _REGISTRY[name] = Registered(factory, accepted, known, info is not None, typed)


def made_by(factory: Factory) -> Any:
    """Return the class that a factory makes, as far as it says so; else the factory itself."""
    if isinstance(factory, type):
        return factory
    try:
        return typing.get_type_hints(factory).get("return", factory)
    except (NameError, TypeError, AttributeError):  # somebody's own annotations that cannot be looked up
        return factory


@checked
def planner_names(*, standalone: bool = False) -> tuple[str, ...]:
    """Return the names of all registered planners, in order of registration.

    standalone: only those that a forward model alone makes and a situation alone lets decide; the others
        need a table, the room of their arena or the prey's future, and say so.
    """
    return tuple(name for name, entry in _REGISTRY.items() if not standalone or entry.info.standalone)


def planner_info(name: str) -> PlannerInfo:
    """Return what sets a registered planner apart; nothing does for a name that is not registered."""
    entry = _REGISTRY.get(name)
    return PlannerInfo() if entry is None else entry.info


def info_of(planner: Planner) -> PlannerInfo:
    """Return what sets apart a planner that was made: what its registration said, or else its own marks."""
    planner = planner.planner if isinstance(planner, Timed) else planner
    return _MADE.get(type(planner)) or read_marks(planner)


def foresight_of(planner: Planner) -> float:
    """Return how much of the prey's true future a decision of a planner needs [s]; 0: none."""
    return info_of(planner).seconds(planner.planner if isinstance(planner, Timed) else planner)


def is_ab_initio(name: str, given: Collection[str] = ()) -> bool:
    """Return whether a planner learns all it knows within the run (False too for bounds told the future).

    given: names of the settings that the experiment gives it; a room from a file was learned in another run.
    A name that is not registered is taken to be ab initio.
    """
    info = planner_info(name)
    return info.ab_initio and info.prepare not in given


def explores(name: str, given: Collection[str] = ()) -> bool:
    """Return whether a planner is to babble in its arena before it hunts there.

    It is if an evaluation prepares its room and ``given``, the names of the settings that the experiment
    gives it, does not hold that.
    """
    info = planner_info(name)
    return info.prepare is not None and info.prepare not in given


@checked_but("model")
def make_planner(name: str, model: ForwardModel, **settings: Any) -> Planner:
    """Return the planner called ``name`` for a fitted forward model.

    Raises InputError for an unknown name or an unknown or wrong setting, or if somebody's own factory fails.
    """
    entry = find_planner(name)
    _warn_if_deprecated(name)
    _check_names(name, settings)
    check_kind(model, f"planner {name!r}", ForwardModel, "a ForwardModel to plan with")
    try:
        planner = entry.factory(model, **settings)
    except BayesHuntError:
        raise
    except Exception as error:
        if is_shipped(name):
            raise
        raise InputError(f"planner {name!r} cannot be made: {failure(error)}") from error
    try:
        check_can_plan(planner, named=False)
    except InputError as error:
        raise InputError(f"planner {name!r}: its factory does not return a planner; {error}") from None
    if entry.said:
        _MADE[type(planner)] = entry.info
    with contextlib.suppress(TypeError):  # somebody's own may have no weak references
        _MODELS[planner] = model
    return planner


def model_of(planner: Planner) -> ForwardModel | None:
    """Return the model that a planner was made with by :func:`make_planner`; None if that is not known."""
    try:
        return _MODELS.get(planner)
    except TypeError:
        return None


def find_planner(name: str) -> Registered:
    """Return a registered planner; InputError for an unknown name."""
    entry = _REGISTRY.get(name) if isinstance(name, str) else None
    if entry is None:
        raise InputError(f"unknown planner {name!r}{did_you_mean(name, planner_names())}")
    return entry


def check_sections(sections: Mapping[str, Mapping[str, Any]]) -> None:
    """Raise InputError unless every section is one of a registered planner's settings: name -> settings by name."""
    for name, settings in sections.items():
        if name not in _REGISTRY:
            raise InputError(f"unknown planner {name!r}{did_you_mean(name, planner_names())}")
        _check_names(name, settings)
        if (typed := _REGISTRY[name].typed) is not None:
            typed(**settings)


def check_hunts(name: str) -> None:
    """Raise InputError unless the planner called ``name`` is one that hunts."""
    _warn_if_deprecated(name)
    if not find_planner(name).info.hunts:
        raise InputError(f"{name} is a bound that no gaits reach: it can be evaluated, not hunted with")


def check_needs(name: str, given: Mapping[str, Any]) -> None:
    """Raise InputError unless the settings ``given`` to a planner hold all that it cannot do without."""
    find_planner(name).info.check_given(name, given)


def _warn_if_deprecated(name: str) -> None:
    """Warn of a name that is to go."""
    if said := planner_info(name).deprecated:
        warnings.warn(f"planner {name!r} is deprecated: {said}", DeprecatedNameWarning, stacklevel=4)


def _check_names(name: str, settings: Mapping[str, Any]) -> None:
    """Raise InputError for a setting that the planner called ``name`` does not have."""
    accepted = find_planner(name).settings
    for setting in settings if accepted is not None else ():
        if setting not in accepted:  # type: ignore[operator]
            raise InputError(f"planner {name!r} has no setting {setting!r}{_hint(setting, accepted)}")


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


#: The planners that ship, in the order in which they are listed.
_KINDS: tuple[type[Any], ...] = (
    ReactivePlanner, PredictionPlanner, PlanningPlanner, PurePursuit, ProportionalNavigation, ConstantVelocity,
    Omniscient, KinematicLimit, Frugal, Reference, Memory, PlaceMemory, OrderMemory, InterceptPlanner,
    InterceptRoomPlanner, InterceptWallsPlanner, InterceptEvaderPlanner, BeliefPlanner, SearchPlanner, DetourPlanner,
)  # fmt: skip
for _kind in _KINDS:
    register_planner(_kind.name, _kind, settings=_kind.Settings or (), info=_kind.info)
_SHIPPED = frozenset(_REGISTRY)


def is_shipped(name: str) -> bool:
    """Return whether a planner comes with the package."""
    return name in _SHIPPED


def registered_planners() -> dict[str, Registered]:
    """Return every planner registered beside those that ship."""
    return {name: entry for name, entry in _REGISTRY.items() if name not in _SHIPPED}


def adopt_planner(name: str, entry: Registered) -> None:
    """Know in this process a planner that was registered in another; one already known stays as it is."""
    _REGISTRY.setdefault(name, entry)
