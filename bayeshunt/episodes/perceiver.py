"""What a hunter knows between two decisions, whoever decides: belief, prey model, the gait before, the time.

The world is outside: whoever owns it says where the hunter is and what it sees, and executes the gait that was chosen.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, cast, overload

import numpy as np

from bayeshunt.config.schema.camera import CameraSettings
from bayeshunt.core.checks import check_kind, check_number, conforms, warn_of_degrees
from bayeshunt.core.errors import InputError, shown
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.core.geometry import Polar, Pose, in_frame
from bayeshunt.core.messages import Detection, Frame, Observation
from bayeshunt.core.protocols import Belief, ExpectingModel, Map, MovingBelief, TargetModel, Tracker
from bayeshunt.core.task import Task
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.planners.api import Future, Situation

__all__ = ["Approaches", "Perceiver"]

#: The hunter in its own frame.
_OWN = Polar(0.0, 0.0, 0.0)


class Approaches(Sequence[Polar]):
    """Where the hunter was, as the prey had it, when each transition began: worked out when somebody asks.

    sightings: where the hunter then saw the prey.
    """

    def __init__(self, sightings: tuple[Polar, ...] = ()) -> None:
        self.sightings = sightings

    def __len__(self) -> int:
        return len(self.sightings)

    @overload
    def __getitem__(self, index: int) -> Polar: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Polar, ...]: ...
    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return tuple(map(_OWN.seen_from, self.sightings[index]))
        return _OWN.seen_from(self.sightings[index])

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and tuple(self) == tuple(other)

    __hash__ = None  # type: ignore[assignment]  # compares with lists

    def __repr__(self) -> str:
        return repr(tuple(self))


class Perceiver:
    """Turns what a hunter sees into situations, and remembers which gait followed each of them.

    gaits: the hunter's repertoire. tracker: what turns sightings into a belief. prey_model: what is known of the prey;
    it goes on learning. task: what counts as a catch. rng: of all that the tracker draws. camera: what the hunter sees
    with, for planners that mind where it looks; None: it sees all. map: where obstacles stand, if it is told.

    belief, prey_model, situation, time [s] and steps are there to look at; ``observed`` is the prey transition that
    the last situation has learned, or None; ``skipped`` counts the steps whose transition was not learned.
    """

    def __init__(
        self, gaits: GaitRepertoire, tracker: Tracker, prey_model: TargetModel, task: Task, *,
        rng: np.random.Generator, camera: CameraSettings | None = None, map: Map | None = None,
    ) -> None:  # fmt: skip
        _check_time_step(prey_model, gaits)
        self.gaits, self.task, self.prey_model, self.camera = gaits, task, prey_model, camera
        self.map = map
        self._always = {  # what every situation holds
            "prey_model": prey_model, "body_length": gaits.body_length, "time_step": gaits.duration, "task": task,
            "camera": camera, "map": map,
        }  # fmt: skip
        self._tracker, self._belief_rng = tracker, rng
        self._origin: Pose | None = None  # of the odometry, in the caller's frame
        self._passed = 0.0
        self._approaches = Approaches()
        self.belief: Belief | None = None
        self.situation: Situation | None = None
        self.previous: str | None = None
        self.observed: Polar | None = None
        self.observation: Observation | None = None
        self.time, self.steps, self.skipped = 0.0, 0, 0

    def perceive(
        self, own_pose: Pose, seen: Pose | Observation | list[Detection] | None, time: float | None = None, *,
        future: Future | None = None,
    ) -> Situation:  # fmt: skip
        """Return what is known now; say with :meth:`execute` which gait follows, then perceive again at its end.

        own_pose: the hunter's pose [m, rad] in any fixed counter-clockwise frame, the same in every call.
        seen: the prey's pose in that frame, whose heading may be NaN; a list of detections of one look now; an
        Observation, of several looks; None: not seen.
        time: seconds; by default one gait's duration after the call before. future: the prey's true future.

        Raises InputError for a pose that is not of finite numbers or a time that does not go on.
        """
        if future is not None:
            check_kind(future, "future", Future, "a Future, or None")
        return self.consider(self._observe(own_pose, seen, self._clock(time)), future)

    def consider(self, observation: Observation, future: Future | None = None) -> Situation:
        """Return what is known after ``observation``, which is in the odometry frame as every sensor's is."""
        self._believe(observation)
        assert self.belief is not None
        self.observation = observation
        self.situation = Situation.of({
            **self._always, "prey": observation.pose.relative(self.belief.mean), "time": observation.time,
            "step": self.steps, "previous_gait": self.previous, "transitions": self.belief.transitions,
            "pose": observation.pose, "future": future, "belief": self.belief, "approaches": self._approaches,
        })  # fmt: skip
        return self.situation

    def execute(self, gait: str) -> None:
        """Note that the gait of this name follows the present situation."""
        assert self.situation is not None
        self.previous = gait
        self.time, self.steps = self.situation.time, self.steps + 1

    # --- inside -------------------------------------------------------------------------------

    def _clock(self, time: float | None) -> float:
        """Seconds of this call."""
        if time is None:
            return 0.0 if not self.steps else self.time + self.gaits.need("duration")
        now = check_number(time, "time", "seconds")
        if self.steps and not now > self.time:
            raise InputError(f"time: expected seconds after the {self.time:g} of the call before, got {now:g}")
        return now

    def _observe(self, own_pose: Pose, seen: Pose | Observation | list[Detection] | None, time: float) -> Observation:
        """Bring what the caller says into the odometry frame, in which the hunter started at (0, 0, 0)."""
        own = _pose(own_pose, "own_pose")
        if self._origin is None:
            self._origin = own
            warn_of_degrees(own.theta, "own_pose")
        origin = self._origin
        if isinstance(seen, Observation):
            frames = tuple(_moved(frame, origin) for frame in seen.frames)
            return Observation(time, in_frame(own, origin), frames, seen.covariance)
        if isinstance(seen, list):  # of detections: one look, now
            for one in seen:
                check_kind(one, "seen", Detection, "a Pose, an Observation, a list of Detections or None")
            pose = in_frame(own, origin)
            return Observation(time, pose, (_moved(Frame(time, own, tuple(seen)), origin),))
        found = () if seen is None else (Detection(pose=in_frame(_pose(seen, "seen", heading=False), origin)),)
        pose = in_frame(own, origin)
        return Observation(time, pose, (Frame(time, pose, found),))

    def _believe(self, observation: Observation) -> None:
        """Update the belief; learn the prey's transitions that it has gained."""
        before = self.belief
        self.observed = None
        if before is None or self.previous is None:
            self.belief = self._tracker.start(observation)
            return
        gait = self.gaits[self.previous]
        self._passed = observation.time - self.time
        self.belief = self._tracker.update(before, gait, observation, rng=self._belief_rng)
        gained = self.belief.transitions[len(before.transitions) :]
        if gained:
            assert self.situation is not None
            self._approaches = Approaches((*self._approaches.sightings, *(self.situation.prey,) * len(gained)))
        self.skipped += not self._learn(gained)

    def _learn(self, transitions: tuple[Polar, ...]) -> bool:
        """Learn the transitions that the belief has gained, or what they may have been; return whether any was."""
        belief, model = self.belief, self.prey_model
        self.observed = transitions[-1] if transitions else None
        if conforms(belief, MovingBelief) and conforms(model, ExpectingModel):
            expected = cast(MovingBelief, belief).expected
            if expected is not None:
                cast(ExpectingModel, model).expect(*expected)
            return expected is not None
        for transition in transitions:
            model.observe(transition)
        return bool(transitions)


def _check_time_step(prey_model: TargetModel, gaits: GaitRepertoire) -> None:
    """Raise InputError for a prey model of recorded transitions that last longer or shorter than a gait."""
    conditions = prey_model.conditions if isinstance(prey_model, PreyModel) else None
    if conditions is None or gaits.duration is None:
        return
    if not math.isclose(conditions.time_step, gaits.duration, rel_tol=0.02):
        raise InputError(
            f"the prey model is of transitions of {conditions.time_step:g} s, a gait lasts {gaits.duration:g} s; fit "
            f"one: bayeshunt prey fit --time-step {gaits.duration:g}"
        )


def _pose(value: Any, name: str, *, heading: bool = True) -> Pose:
    """A pose of floats; ``heading``: whether its heading must be known."""
    try:
        pose = Pose(*(float(part) for part in value))
    except (TypeError, ValueError):
        raise InputError(f"{name}: expected a Pose(x, y, theta) of numbers [m, rad], got {shown(value)}") from None
    finite = math.isfinite(pose.x) and math.isfinite(pose.y)
    if not finite or math.isinf(pose.theta) or (heading and math.isnan(pose.theta)):
        raise InputError(f"{name}: expected finite numbers{'' if heading else ', or a heading of NaN'}, got {pose}")
    return pose


def _moved(frame: Frame, origin: Pose) -> Frame:
    """A frame of a sensor, told in the odometry frame."""
    found = tuple(
        one if one.pose is None else one._replace(pose=in_frame(_pose(one.pose, "seen", heading=False), origin))
        for one in frame.detections
    )
    return Frame(frame.time, in_frame(_pose(frame.pose, "seen"), origin), found)
