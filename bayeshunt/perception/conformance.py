"""The checks that every sensor and every tracker must pass; run them over your own too."""

from __future__ import annotations

import copy
import math
from typing import Any

import numpy as np

from bayeshunt.core.arguments import checked
from bayeshunt.core.checks import check_whole
from bayeshunt.core.errors import BayesHuntError, shown
from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import Pose
from bayeshunt.core.messages import Detection, Frame, Moment, Observation, Ray, Run
from bayeshunt.core.protocols import Belief
from bayeshunt.core.streams import global_generator
from bayeshunt.perception.registry import make_sensor, make_tracker
from bayeshunt.perception.setting import PerceptionContext

__all__ = ["check_sensor", "check_tracker"]

_STEP, _FRAMES = 2.0, 4
_CONTEXT = PerceptionContext(time_step=_STEP, body_length=0.06, prey_length=0.06)
_GAIT = Gait("ahead", (0.05, 0.05))


@checked
def check_sensor(name: str, seed: int = 0, **settings: Any) -> None:
    """Raise BayesHuntError, naming the sensor and the fault, unless a registered one keeps the rules.

    settings: of the sensor, by name. The rules: ``rng`` is a required keyword; it gives an Observation of now with at
    least one frame, the last of them now, and the robot's own pose in every one; it leaves the run and numpy's global
    generator as they were; the same seed gives the same observation.
    """
    check_whole(seed, "seed", 0)
    for number, run in enumerate(_runs()):
        seen = []
        for _ in range(2):
            before, chance = copy.deepcopy(run), global_generator()
            sensor = make_sensor(name, _CONTEXT, settings)
            _demand(name, "sensor", _needs_rng(lambda s=sensor, r=run: s.sense(r, _Plane())), "senses without rng")
            seen.append(sensor.sense(run, _Plane(), rng=np.random.default_rng([seed, number])))
            _demand(name, "sensor", run == before, "changed the run")
            _demand(name, "sensor", global_generator() == chance, "used numpy's global generator")
        _check_observation(name, seen[0], run)
        _demand(name, "sensor", repr(seen[0]) == repr(seen[1]), "is not reproducible")


@checked
def check_tracker(name: str, seed: int = 0, **settings: Any) -> None:
    """Raise BayesHuntError, naming the tracker and the fault, unless a registered one keeps the rules.

    settings: of the tracker, by name. The rules: ``rng`` is a required keyword; it gives a Belief, with a finite mean,
    whether or not the prey is seen, from the first observation on; its covariance is [3, 3], its samples are as many as
    asked for, its probability of being in view is one; transitions are only ever added; the belief and the observation
    that it is given, and numpy's global generator, stay as they were; the same seed gives the same beliefs.
    """
    check_whole(seed, "seed", 0)
    for seen in (range(8), (0, 1, 4, 5, 6), (), (3, 4)):
        histories = [_history(name, settings, seed, set(seen)) for _ in range(2)]
        same = all(one.mean == other.mean for one, other in zip(*histories, strict=True))
        _demand(name, "tracker", same, "is not reproducible")


def _history(name: str, settings: dict[str, Any], seed: int, seen: set[int]) -> list[Belief]:
    """The beliefs of eight steps, the prey seen in some of them."""
    tracker = make_tracker(name, _CONTEXT, settings)
    chance, rng = global_generator(), np.random.default_rng(seed)
    belief = tracker.start(_observation(0, 0 in seen))
    beliefs = [belief]
    for number in range(1, 8):
        observation = _observation(number, number in seen)
        facts, table = _facts(belief), repr(observation)
        missing = _needs_rng(lambda b=belief, o=observation: tracker.update(b, _GAIT, o))  # type: ignore[call-arg]
        _demand(name, "tracker", missing, "updates without rng")
        belief = tracker.update(belief, _GAIT, observation, rng=rng)
        _demand(name, "tracker", _facts(beliefs[-1]) == facts, "changed the belief that it was given")
        _demand(name, "tracker", repr(observation) == table, "changed the observation")
        kept = belief.transitions[: len(beliefs[-1].transitions)] == beliefs[-1].transitions
        _demand(name, "tracker", kept, "took back transitions")
        beliefs.append(belief)
    _demand(name, "tracker", global_generator() == chance, "used numpy's global generator")
    for one in beliefs:
        _check_belief(name, one)
    return beliefs


def _check_belief(name: str, belief: Belief) -> None:
    _demand(name, "tracker", isinstance(belief, Belief), f"gave {shown(belief)}, expected a bayeshunt.protocols.Belief")
    _demand(name, "tracker", bool(np.isfinite(belief.mean).all()), f"believes in {belief.mean}")
    _demand(name, "tracker", np.shape(belief.covariance) == (3, 3), "has a covariance that is not [3, 3]")
    _demand(name, "tracker", 0.0 <= belief.resultant <= 1.0, f"has a resultant of {belief.resultant}")
    _demand(name, "tracker", belief.last_seen >= 0.0, f"was last seen {belief.last_seen} s ago")
    _demand(name, "tracker", 0.0 <= belief.in_view() <= 1.0, f"gives a probability of {belief.in_view()}")
    sizes = {np.shape(part) for part in belief.sample(7, rng=np.random.default_rng(0))}
    _demand(name, "tracker", sizes == {(7,)}, f"gave samples of shape {sizes} where 7 were asked for")
    _demand(name, "tracker", len(belief.table()) > 0, "has an empty table")


def _check_observation(name: str, seen: Observation, run: Run) -> None:
    now = run.moments[-1]
    _demand(name, "sensor", isinstance(seen, Observation), f"gave {shown(seen)}, expected an Observation")
    _demand(name, "sensor", math.isclose(seen.time, now.time), f"tells {seen.time} s at {now.time} s")
    _demand(name, "sensor", bool(np.isfinite(seen.pose).all()), f"tells the own pose {seen.pose}")
    _demand(name, "sensor", len(seen.frames) > 0, "tells no frame: an empty one says something too")
    _demand(name, "sensor", math.isclose(seen.frames[-1].time, now.time), "has a last frame that is not of now")
    times = [frame.time for frame in seen.frames]
    _demand(name, "sensor", times == sorted(times), "tells frames that are not in order of time")


def _runs() -> list[Run]:
    """The start of a hunt, and a step of it."""

    def moment(time: float) -> Moment:
        return Moment(time, {"hunter": Pose(0.04 * time, 0.0, 0.0), "prey": Pose(0.2, 0.02 * time, 1.2)})

    return [Run((moment(0.0),)), Run(tuple(moment(_STEP * (i + 1) / _FRAMES) for i in range(_FRAMES)))]


def _observation(number: int, seen: bool) -> Observation:
    """The prey on a straight way, and the hunter on another."""
    time, own = _STEP * number, Pose(0.03 * number, 0.01 * number, 0.1 * number)
    found = (Detection(own.relative(Pose(0.3 + 0.05 * number, 0.1, 0.0))),) if seen else ()
    return Observation(time, own, (Frame(time, own, found),))


class _Plane:
    def free(self, x: Any, y: Any) -> Any:
        return np.ones(np.shape(x), dtype=bool) if np.ndim(x) else True

    def blocked(self, ray: Ray) -> bool:
        return False


def _facts(belief: Belief) -> str:
    return repr((belief.mean, belief.resultant, belief.last_seen, belief.transitions, np.asarray(belief.covariance)))


def _needs_rng(call: Any) -> bool:
    try:
        call()
    except TypeError:
        return True
    return False


def _demand(name: str, kind: str, kept: bool, fault: str) -> None:
    if not kept:
        raise BayesHuntError(f"{kind} {name!r} {fault}")
