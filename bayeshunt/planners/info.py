"""What sets a planner apart, said once where it is registered: what it needs beside a model and a situation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from bayeshunt.core.arguments import check_fields
from bayeshunt.core.errors import InputError, did_you_mean

__all__ = ["FUTURE", "ROOM", "PlannerInfo", "own_foresight", "read_marks"]

#: A need that only an evaluation can meet: the prey's true future.
FUTURE = "future"
#: A need that an evaluation meets beforehand: the walls of the arena, learned by babbling there.
ROOM = "room"
#: Settings that an evaluation can prepare.
_PREPARED = (ROOM,)
#: What a planner is taken to need that says no more than that a model alone does not make it.
_SETTING = "a setting"


@dataclass(frozen=True)
class PlannerInfo:
    """What sets a planner apart from one that a forward model alone makes and a situation alone lets decide.

    ab_initio: whether it learns all it knows within the run; tables mark the others with *.
    needs: names of the settings that it cannot do without (files, mostly), and "future" for the prey's true future,
        which only an evaluation hands in (an upper bound, not a hunter).
    foresight: seconds of that future that a decision of a planner needs.
    prepare: the setting that an evaluation fills in each arena unless the experiment does; "room", the arena's
        walls, learned by babbling there, is the one it can.
    hunts: False for a bound that is computed from the start of a hunt and makes no plans.
    maker: the command that makes the file it needs, such as "bayeshunt reference".
    deprecated: what to write instead, and until when this name works; empty if it is here to stay.

    Raises InputError for values of another kind.
    """

    ab_initio: bool = True
    needs: tuple[str, ...] = ()
    foresight: Callable[[Any], float] | None = None
    prepare: str | None = None
    hunts: bool = True
    maker: str = ""
    deprecated: str = ""

    def __post_init__(self) -> None:
        if not isinstance(self.needs, (tuple, list, set, frozenset)) or not all(
            isinstance(need, str) for need in self.needs
        ):
            raise InputError(f"PlannerInfo: needs: expected a list of names of settings, got {self.needs!r}")
        object.__setattr__(self, "needs", tuple(self.needs))
        check_fields(self)
        if self.prepare is not None and self.prepare not in _PREPARED:
            hint = did_you_mean(self.prepare, _PREPARED)
            raise InputError(f"PlannerInfo: prepare: nothing called {self.prepare!r} can be prepared{hint}")

    @property
    def standalone(self) -> bool:
        """Whether a forward model alone makes it and a situation alone lets it decide."""
        return not self.needs

    def check_given(self, planner: str, settings: Mapping[str, Any]) -> None:
        """Raise InputError unless ``settings`` hold every setting that the planner of this name cannot do without."""
        for need in self.needs:
            if need not in (FUTURE, _SETTING, self.prepare) and settings.get(need) is None:
                made = f'make it with "{self.maker} --out FILE" and give it' if self.maker else "give it"
                raise InputError(f"{planner}: needs the setting {need}; {made} as planner.{planner}.{need}")

    def seconds(self, planner: Any) -> float:
        """Return how much of the prey's future a decision of ``planner`` needs [s]; 0: none."""
        return 0.0 if FUTURE not in self.needs or self.foresight is None else float(self.foresight(planner))


def own_foresight(planner: Any) -> float:
    """Return the attribute ``foresight`` of a planner: seconds."""
    return float(planner.foresight)


def read_marks(thing: object, below: PlannerInfo | None = None) -> PlannerInfo:
    """Return what a class, factory or planner says of itself by its attributes: the one place that reads them.

    info: a :class:`PlannerInfo`, as the planners that ship have; over it the single marks of a class of a user's
    own: ab_initio, standalone, needs_future (with foresight, in seconds) and explores. below: what counts where
    it says nothing.
    """
    info = getattr(thing, "info", below)
    info = info if isinstance(info, PlannerInfo) else below or PlannerInfo()

    def mark(name: str, default: bool) -> bool:
        value = getattr(thing, name, default)
        return default if isinstance(value, property) else bool(value)

    needs = [need for need in info.needs if need != FUTURE]
    if mark("needs_future", FUTURE in info.needs):
        needs.append(FUTURE)
    explores = mark("explores", info.prepare == ROOM)
    if explores and ROOM not in needs:
        needs.append(ROOM)
    if mark("standalone", not needs):
        needs = [need for need in needs if need == FUTURE]
    elif not needs:
        needs.append(_SETTING)
    return replace(
        info,
        ab_initio=mark("ab_initio", info.ab_initio),
        needs=tuple(needs),
        foresight=own_foresight if hasattr(thing, "foresight") else info.foresight,
        prepare=ROOM if explores else None,
    )
