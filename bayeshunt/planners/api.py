"""What every planner shares: a situation in, an inspectable plan out.

A planner is a function of the situation and of ``rng``: it keeps no state between decisions and
never changes what it is given, so the same situation and seed give the same plan.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, runtime_checkable

import numpy as np

from bayeshunt.core import displays
from bayeshunt.core.arguments import check_fields
from bayeshunt.core.checks import (
    check_kind,
    check_number,
    check_positive,
    check_radians,
    check_whole,
    conforms,
    warn_of_degrees,
)
from bayeshunt.core.errors import InputError, shown
from bayeshunt.core.gaits import GIVE_MEASURES
from bayeshunt.core.geometry import FloatArray, Polar, Pose
from bayeshunt.core.task import Task
from bayeshunt.core.trusted import trusted
from bayeshunt.planners.info import FUTURE, PlannerInfo

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Future", "Plan", "Planner", "PreyPredictor", "Shown", "Situation"]


@runtime_checkable
class PreyPredictor(Protocol):
    """What a planner asks of a prey model; :class:`bayeshunt.models.target.prey.PreyModel` is one."""

    @property
    def is_empty(self) -> bool:
        """True while nothing has been observed."""

    def predict_path(self, steps: int) -> Polar[FloatArray]:
        """Expected poses 0..steps ahead in the prey's present frame: Polar of arrays [steps + 1]."""


@dataclass(frozen=True, eq=False)
class Future:
    """Where the prey will be: what an evaluation may tell a planner that asks for it (``needs_future``).

    times: seconds from now [M], increasing from 0. prey: Polar of arrays [M], in the hunter's present frame.
    """

    times: np.ndarray
    prey: Polar[FloatArray]

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return metres forward and right of the prey at ``times`` [s], linear between the known poses.

        After the last known pose it goes on as between the last two.
        """
        ahead, right = self.prey.forward, self.prey.right
        beyond = np.maximum(np.asarray(times, dtype=float) - self.times[-1], 0.0)
        step = self.times[-1] - self.times[-2]
        return (
            np.interp(times, self.times, ahead) + beyond * (ahead[-1] - ahead[-2]) / step,
            np.interp(times, self.times, right) + beyond * (right[-1] - right[-2]) / step,
        )

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Future):
            return NotImplemented
        return np.array_equal(self.times, other.times) and all(map(np.array_equal, self.prey, other.prey))

    __hash__ = None  # type: ignore[assignment]  # arrays inside


_UNKNOWN = Task()
_LEVEL = "a probability between 0 and 1"


@dataclass(frozen=True)
class Situation:
    """What the hunter knows when it decides; what it does not know is None, and a planner that needs it says so.

    prey: the prey's present pose as the hunter sees it.
    prey_model: what has been learned of the prey's pose transitions, one per time-step.
    body_length: metres, > 0; distances that the paper gives in bodies are multiples of it. None: the planner's
        model's own; another than that is refused.
    time: seconds since the hunt began. step: number of decisions taken before this one.
    previous_gait: the gait just executed, None at the first step.
    time_step: seconds that one gait is held, > 0. None: the planner's model's own; another than that is refused.
    transitions: the prey's pose transitions observed in this hunt, oldest first, each in the prey's
        own earlier frame, one per time-step: the raw data behind ``prey_model``.
    pose: the hunter's own pose (dead reckoning) in the frame it started in, None if it does not know.
    future: the prey's true, noise-free future; handed in by an evaluation, and only to a planner that is
        registered as one that needs it (an upper bound, not a hunter).
    task: what counts as a catch, and until when.
    belief: where the prey may be, where it is not simply seen. models: of the hunter's body and of its prey.
    map: the walls and obstacles that the hunter knows of. camera: what its camera sees, and where it looks.
    approaches: of each of ``transitions``, where the hunter was when it began, in the same frame of the prey; empty if
        that is not known.
    interval: the level, in (0, 1), at which a planner that asks its inverse model is to say how sure the posterior is:
        its trace then has the ends, low and high (``answer.interval``). None: not asked.

    Raises InputError, naming the argument, for one of another kind or out of range.
    """

    prey: Polar
    prey_model: PreyPredictor
    body_length: float | None = None
    time: float = 0.0
    step: int = 0
    previous_gait: str | None = None
    time_step: float | None = None
    transitions: tuple[Polar, ...] = ()
    pose: Pose | None = None
    future: Future | None = None
    task: Task = _UNKNOWN
    belief: object | None = None
    models: object | None = None
    map: object | None = None
    camera: object | None = None
    approaches: Sequence[Polar] = ()
    interval: float | None = None

    @classmethod
    def of(cls, parts: dict[str, Any]) -> Situation:
        """Return that of a hunt in progress: of its fields, all but ``prey`` are known to be right."""
        return trusted(cls, parts) if _in_range(parts["prey"]) else cls(**parts)

    def __post_init__(self) -> None:
        if not _in_range(self.prey):
            self._check_prey()
        if not conforms(self.prey_model, PreyPredictor):
            model = shown(self.prey_model)
            raise InputError(f"prey_model: expected a prey model, such as bayeshunt.PreyModel(), got {model}")
        if self.body_length is not None:
            check_positive(self.body_length, "body_length", "metres")
        if self.time_step is not None:
            check_positive(self.time_step, "time_step", "seconds")
        check_number(self.time, "time", "seconds since the hunt began")
        check_whole(self.step, "step", 0)
        if self.previous_gait is not None:
            check_kind(self.previous_gait, "previous_gait", str, "the name of a gait, or None")
        if self.pose is not None:
            check_kind(self.pose, "pose", Pose, "a Pose, or None")
            if self.step == 0:
                warn_of_degrees(self.pose.theta, "pose")
        if self.future is not None:
            check_kind(self.future, "future", Future, "a Future, or None")
        if type(self.transitions) is not tuple or not set(map(type, self.transitions)) <= {Polar}:
            check_kind(self.transitions, "transitions", Sequence, "a list of Polar")
            for transition in self.transitions:
                check_kind(transition, "transitions", Polar, "a list of Polar")
            object.__setattr__(self, "transitions", tuple(self.transitions))
        if self.interval is not None and not 0.0 < check_number(self.interval, "interval", _LEVEL) < 1.0:
            raise InputError(f"interval: expected {_LEVEL}, got {self.interval}")
        check_kind(self.task, "task", Task, "a Task, with a catch distance [m] and a time limit [s]")

    def need(self, measure: str) -> float:
        """Return ``body_length`` [m] or ``time_step`` [s]; InputError in one line if it is not known."""
        value: float | None = getattr(self, measure)
        if value is None:
            raise InputError(f"neither the situation nor the planner's model says {measure}: {GIVE_MEASURES}")
        return value

    def _check_prey(self) -> None:
        check_kind(self.prey, "prey", Polar, "its pose as a Polar")
        try:
            possible = all(map(math.isfinite, self.prey)) and self.prey.distance >= 0
        except TypeError:  # arrays, texts
            possible = False
        if not possible:
            raise InputError(f"prey pose must be finite numbers with distance >= 0, got {self.prey}")
        check_radians(self.prey.angle, "prey angle")
        check_radians(self.prey.heading, "prey heading")


_FLOATS = (float, np.float64)


def _in_range(prey: Any) -> bool:
    """Whether a pose is plainly one: told at a glance, as every decision begins with it; if not, it is looked into."""
    if type(prey) is not Polar:
        return False
    distance, angle, heading = prey
    plain = type(distance) in _FLOATS and type(angle) in _FLOATS and type(heading) in _FLOATS
    return plain and 0 <= distance < math.inf and abs(angle) <= math.pi and abs(heading) <= math.pi


@dataclass(frozen=True, eq=False, repr=False)
class Plan(displays.Displayed):
    """A decision and the reasons for it.

    Only ``gait`` is required: ``Plan("straight")`` is a plan of one gait that a rule chose.

    gait: name of the gait to execute now. gaits: the whole sequence, ``gaits[0] == gait``; default: that gait alone.
    value: what the decision was taken by; ``objective`` says what it is and in which unit.
        Texts for people show a value whose objective ends in "[m]" in millimetres.
    nodes: number of alternatives considered, the rows of ``trace``. expansions: nodes expanded.
    make_trace: called without arguments, gives ``trace``: a DataFrame with a row per node; default: one row.
        Displays know the columns gait and value (value_m in metres, value_s in seconds) and, of a search tree, node,
        parent, T (gaits so far) and chosen, and of a posterior low and high, the ends of its interval; others are
        shown as they are.
    target: where the hunter aims, as it sees it now; its heading is NaN where the prey's there is not known.
    evidence_probability: P(Distance, Angle) of the target's learned cell; None if not asked.
    support: babbling rows in that cell; None if not asked, or if unknown (an imported network).
    posterior: P(Gait | target) [G] in table order; None if not asked.
    answer: the inverse model's answer that it rests on, which ``bayeshunt.trace`` opens; not sent to other processes.
    prey_known: True if the decision rests on what the prey model has observed. False if the planner
        does not ask it, or if it is empty and the prey was taken to stand still.
    predicted_prey: Polar of arrays [T + 1], the prey 0..T steps ahead as the hunter sees it now; headings are
        NaN where the planner predicts places only.
    """

    gait: str
    gaits: tuple[str, ...] = None  # type: ignore[assignment]  # filled in below
    value: float = 0.0
    objective: str = "no value, a rule decides"
    nodes: int = 1
    make_trace: Callable[[], pd.DataFrame] = None  # type: ignore[assignment]  # filled in below
    expansions: int = 0
    target: Polar | None = None
    evidence_probability: float | None = None
    support: int | None = None
    posterior: np.ndarray | None = None
    prey_known: bool = False
    predicted_prey: Polar[FloatArray] | None = None
    answer: Any = None

    def __post_init__(self) -> None:
        if self.gaits is None:
            object.__setattr__(self, "gaits", (self.gait,))
        if self.make_trace is None:
            object.__setattr__(self, "make_trace", partial(_one_row, self.gait, self.value))
        check_fields(self)

    @cached_property
    def trace(self) -> pd.DataFrame:
        """One row per node considered; built when first asked for, as a table costs more than a decision."""
        return self.make_trace()

    def __getstate__(self) -> dict[str, Any]:
        # A plan that is sent to another process carries its finished trace, not the planner's tables.
        state = {name: value for name, value in self.__dict__.items() if name != "trace"}
        state["make_trace"], state["answer"] = partial(_given, self.trace), None
        return state

    def __repr__(self) -> str:
        return f"<Plan: {self.gait} ({len(self.gaits)} steps), value {self.value:.4g}, {self.nodes} nodes>"


@runtime_checkable
class Planner(Protocol):
    """Anything that turns situations into plans."""

    @property
    def name(self) -> str:
        """What tables and the command line call this planner."""

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Decide; ``rng`` is the only source of chance."""


class Shown(displays.Displayed):
    """A planner that shows itself: in one line, as text, and in a notebook; ``info`` says what sets it apart."""

    name: str
    info: ClassVar[PlannerInfo] = PlannerInfo()
    #: The class of its settings, made by :func:`~bayeshunt.planners.settings.planner_settings`; None: it has none.
    Settings: ClassVar[type | None] = None

    @property
    def ab_initio(self) -> bool:
        """Whether it learns all it knows within the run."""
        return self.info.ab_initio

    @property
    def standalone(self) -> bool:
        """Whether a forward model alone makes it and a situation alone lets it decide."""
        return self.info.standalone

    @property
    def needs_future(self) -> bool:
        """Whether it is to be told the prey's true future."""
        return FUTURE in self.info.needs

    def chosen(self) -> dict[str, Any]:
        """Return the settings that were chosen, by name: plain values only."""
        settings = getattr(self, "settings", None)
        values = vars(self) if settings is None else vars(settings)
        return {k: v for k, v in values.items() if isinstance(v, (bool, int, float, str)) and not k.startswith("_")}

    def __repr__(self) -> str:
        settings = ", ".join(f"{key} {value}" for key, value in self.chosen().items())
        return f"<planner {self.name}: {settings}>" if settings else f"<planner {self.name}>"


def _one_row(gait: str, value: float) -> pd.DataFrame:
    import pandas as pd  # a loop of one's own may never look at a trace

    return pd.DataFrame({"gait": [gait], "value": [value]})


def _given(frame: pd.DataFrame) -> pd.DataFrame:
    return frame
