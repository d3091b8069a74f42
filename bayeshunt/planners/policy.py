"""Policies and planners: what a policy sees of a situation, any policy as a planner, any planner as a policy.

A policy is a function of an array of numbers, as those that learn by trial make them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from bayeshunt.config.loading import load_robot
from bayeshunt.core.errors import InputError, shown
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.core.geometry import Polar, Pose
from bayeshunt.planners.api import Plan, Planner, Shown, Situation
from bayeshunt.planners.asking import ask, check_can_plan, failure
from bayeshunt.planners.info import PlannerInfo

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["PolicyPlanner", "bounds", "encode", "observation", "planner_policy", "policy_planner"]

#: The unit of lengths in an observation [body lengths].
_UNIT = 10.0
#: Greatest values in an observation: places in those units, a prey's transition, shares and directions.
_PLACE, _MOVE = 20.0, 5.0
_SCALES = (_PLACE,) * 3 + (1.0,) * 4 + (1.0, _MOVE, _MOVE, 1.0, 1.0) + (_PLACE, _PLACE, 1.0, 1.0)
_SIGNED = (True, True, False) + (True,) * 4 + (False,) + (True,) * 8
#: What is said of a transition that was not observed, of a pose that is not known; where the gait before begins.
_NONE_MOVED, _NO_POSE, _BEFORE = (0.0,) * 5, (0.0,) * 4, 17


def bounds(gaits: GaitRepertoire) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return the least and the greatest value of each number of an observation: two read-only arrays [18 + G]."""
    return _bounds(len(gaits))


@lru_cache
def _bounds(gaits: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    high = np.array([*_SCALES, *[1.0] * (gaits + 2)], dtype=np.float32)
    signed = np.array([*_SIGNED, *[False] * (gaits + 2)])
    low = np.where(signed, -high, np.float32(0.0))
    for bound in (low, high):
        bound.setflags(write=False)
    return low, high


def observation(situation: Situation, gaits: GaitRepertoire) -> NDArray[np.float32]:
    """Return what a policy sees of a situation: a new array [18 + G] of float32 inside :func:`bounds`.

    Lengths are in units of ten bodies. In order: the prey's place forward, right, its distance; cos and sin of its
    bearing and of its heading; whether a transition of the prey was observed, and the last one: forward, right, cos
    and sin of its turn; the hunter's own x, y, cos and sin of its direction (dead reckoning); the share of the time
    that is left; one-hot: no gait yet, or which gait came before. Angles are clockwise but for the hunter's own. A
    heading that is not certain is as much shorter than 1 as its mean resultant length; what is not known is 0.
    """
    limit = situation.task.time_limit
    return encode(
        situation.prey, situation.transitions[-1] if situation.transitions else None, situation.pose,
        1.0 if limit is None else 1.0 - situation.time / limit, gaits,
        before=0 if situation.previous_gait is None else 1 + gaits.index(situation.previous_gait),
        sure=float(getattr(situation.belief, "resultant", 1.0)),
    )  # fmt: skip


def encode(
    seen: Polar, moved: Polar | None, own: Pose | None, left: float, gaits: GaitRepertoire, *,
    before: int | None = None, sure: float = 1.0,
) -> NDArray[np.float32]:  # fmt: skip
    """Return an :func:`observation` of its parts: another robot as seen, its last transition, the own pose, time left.

    gaits: the hunter's, which give the scale and the size. before: which of the 1 + G last numbers is 1; None: none.
    sure: mean resultant length of the heading seen.
    """
    cos, sin, unit = math.cos, math.sin, _UNIT * gaits.need("body_length")
    _, bearing, heading = seen
    numbers = [
        seen.forward / unit, seen.right / unit, seen.distance / unit, cos(bearing), sin(bearing),
        sure * cos(heading), sure * sin(heading),
    ]  # fmt: skip
    if moved is None:
        numbers += _NONE_MOVED
    else:
        turn = moved.heading
        numbers += (1.0, moved.forward / unit, moved.right / unit, cos(turn), sin(turn))
    numbers += _NO_POSE if own is None else (own.x / unit, own.y / unit, cos(own.theta), sin(own.theta))
    numbers += (left, *[0.0] * (1 + len(gaits)))
    if before is not None:
        numbers[_BEFORE + before] = 1.0
    low, high = _bounds(len(gaits))
    values = np.array(numbers, dtype=np.float32)
    np.maximum(values, low, out=values)
    return np.minimum(values, high, out=values)


class PolicyPlanner(Shown):
    """A planner whose decisions a policy takes; called with a forward model it is the planner of that robot."""

    info = PlannerInfo(ab_initio=False)

    def __init__(self, predict: Callable[[Any], Any], gaits: GaitRepertoire | None, name: str) -> None:
        self.predict, self.hunter, self.name = predict, gaits, name

    def __call__(self, model: Any) -> PolicyPlanner:
        """Return the planner for the gaits of a fitted model, of which it uses nothing else."""
        return PolicyPlanner(self.predict, model.gaits, self.name)

    def chosen(self) -> dict[str, Any]:
        """It has no settings."""
        return {}

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Ask the policy; InputError if it fails, its answer is no gait, or nobody has said which gaits there are."""
        if self.hunter is None:
            raise InputError(f"planner {self.name!r}: which robot? give policy_planner(predict, robot=...)")
        try:
            answer = self.predict(observation(situation, self.hunter))
        except Exception as error:
            raise InputError(f"planner {self.name!r}: its policy failed: {failure(error)}") from error
        action = answer[0] if isinstance(answer, tuple) else answer  # others return (action, state)
        try:
            number = self.hunter.number(action)
        except InputError as error:
            raise InputError(f"planner {self.name!r}: its policy's answer: {error}") from None
        return Plan(self.hunter.names[number], objective="no value, a policy decides")


def policy_planner(predict: Callable[[Any], Any], robot: Any = None, *, name: str = "policy") -> PolicyPlanner:
    """Return any policy as a planner: for :func:`bayeshunt.hunt`, or for ``register_planner`` as what makes it.

    predict: takes an :func:`observation`, returns a gait's place in the repertoire (or its name), or a tuple that
        begins with it: what the ``predict`` of many libraries does.
    robot: whose gaits they are: a preset's name, a TOML path, settings or a repertoire; in ``register_planner`` the
        model says it. name: what tables call it; a registered one has its registered name there.

    Raises InputError if ``predict`` cannot be called or there is no such robot.
    """
    if not callable(predict):
        raise InputError(f"predict: expected a function of an observation, got {shown(predict)}")
    gaits = robot if robot is None or isinstance(robot, GaitRepertoire) else load_robot(robot).gaits
    return PolicyPlanner(predict, gaits, name)


class _Policy:
    """A planner that decides in the hunt that an environment runs."""

    def __init__(self, planner: Planner, env: Any) -> None:
        self.planner, self.env = planner, env
        self._asked: tuple[Situation | None, int] = None, 0

    def predict(
        self, observation: Any = None, state: Any = None, episode_start: Any = None, deterministic: bool = True
    ) -> tuple[int, Any]:
        """Return the number of the gait planned for now, and ``state`` as it is; the other arguments are not used."""
        pursuit = self.env.unwrapped.pursuit
        situation = pursuit.situation
        if self._asked[0] is not situation:  # asked once: a second draw would make it another hunt
            plan = ask(self.planner, situation, pursuit.rng, pursuit.gaits)
            self._asked = situation, pursuit.gaits.index(plan.gait)
        return self._asked[1], state

    def __call__(self, observation: Any = None) -> int:
        """Return the number of the gait planned for now."""
        return self.predict()[0]


def planner_policy(planner: Planner, env: Any) -> _Policy:
    """Return a planner as a policy for an environment of ``bayeshunt.envs``: ``action = policy(observation)``.

    It asks the planner about the environment's own situation, with the hunt's own generator, so that it decides as in
    :func:`bayeshunt.hunt`, to the last bit. It has ``predict`` as learning libraries have it: for their evaluations,
    and to record demonstrations. env: an environment, wrapped or not.

    Raises InputError if ``planner`` is none or ``env`` has no hunt to look at.
    """
    check_can_plan(planner)
    if not hasattr(getattr(env, "unwrapped", None), "pursuit"):
        raise InputError(f"env: expected an environment of bayeshunt.envs, got {shown(env)}")
    return _Policy(planner, env)
