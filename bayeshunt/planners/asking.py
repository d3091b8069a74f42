"""Asking a planner for a decision: what it may be asked, and what its answer must be.

A planner may be somebody's own: whatever it does wrong is one line that names it.
"""

from __future__ import annotations

import time
import traceback
from pathlib import Path
from typing import Any

import numpy as np

from bayeshunt.core.errors import BayesHuntError, InputError, did_you_mean, shown
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.planners.api import Plan, Planner, Shown, Situation

__all__ = ["Timed", "ask", "check_can_plan", "check_robot", "failure"]


class Timed:
    """A planner whose decisions are timed.

    planner: who decides. seconds: processor time of each decision, which other programs do not disturb.
    """

    def __init__(self, planner: Planner, seconds: list[float] | None = None) -> None:
        self.planner, self.seconds = planner, [] if seconds is None else seconds

    @property
    def name(self) -> str:
        """The planner's own."""
        return self.planner.name

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Plan, and note the time taken."""
        start = time.thread_time()
        plan = self.planner.plan(situation, rng=rng)
        self.seconds.append(time.thread_time() - start)
        return plan


def check_can_plan(planner: Any, *, named: bool = True) -> None:
    """Raise InputError unless ``planner`` can be asked to plan, and, if it is to be ``named``, has a name."""
    if isinstance(planner, type) or not callable(getattr(planner, "plan", None)):
        raise InputError(f'planner: expected one made by make_planner("planning", model), got {_thing(planner)}')
    name = getattr(planner, "name", None)
    if named and not (isinstance(name, str) and name.strip()):
        raise InputError(
            f'planner: a planner of class {type(planner).__name__} has no name; give the class one: name = "mine"'
        )


def check_robot(planner: Planner, robot: GaitRepertoire, name: str) -> None:
    """Raise InputError if a planner's model is of another robot than ``robot``, which is called ``name``.

    A planner says what gaits it plans for by its attribute ``hunter``; without that it is not checked.
    """
    hunter = getattr(planner, "hunter", None)
    if isinstance(hunter, GaitRepertoire) and (difference := hunter.difference(robot, "the planner's robot", name)):
        raise InputError(f"{difference}; give a planner with a model of this robot")


def ask(planner: Planner, situation: Situation, rng: np.random.Generator, gaits: GaitRepertoire) -> Plan:
    """Return a planner's plan; InputError in one line that names it if it fails or the plan is none for ``gaits``."""
    try:
        plan = planner.plan(situation, rng=rng)
    except BayesHuntError:
        raise
    except Exception as error:
        if isinstance(planner, Shown):  # a defect of ours, which deserves its traceback
            raise
        raise InputError(f"planner {_name(planner)!r} failed to plan: {failure(error)}") from error
    if not isinstance(plan, Plan):
        raise InputError(
            f"planner {_name(planner)!r}: plan() returned {shown(plan)}, expected a Plan: return bayeshunt.Plan(gait)"
        )
    if plan.gait not in gaits.names:
        raise InputError(
            f"planner {_name(planner)!r} chose the gait {plan.gait!r}, which the robot does not have"
            f"{did_you_mean(plan.gait, gaits.names)}"
        )
    return plan


def failure(error: BaseException) -> str:
    """Return what went wrong in somebody's own code, and where, in one line."""
    frames = traceback.extract_tb(error.__traceback__)
    place = f" ({Path(frames[-1].filename).name}, line {frames[-1].lineno})" if frames else ""
    return f"{type(error).__name__}: {error}{place}"


def _name(planner: Any) -> str:
    return str(getattr(planner, "name", type(planner).__name__))


def _thing(planner: Any) -> str:
    return f"the class {planner.__name__}" if isinstance(planner, type) else shown(planner)
