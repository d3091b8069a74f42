"""The Kalman tracker: a prey of constant velocity, by the filter of pykalman; the baseline for the particles."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import FloatArray, Polar, Pose, wrap
from bayeshunt.core.messages import Detection, Frame, Observation
from bayeshunt.core.protocols import Belief
from bayeshunt.perception.setting import PerceptionContext
from bayeshunt.perception.trackers.common import BODIES_PER_SECOND, LEAST_RESULTANT, SURE, TOLERANCE
from bayeshunt.perception.trackers.sightings import Eye

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["KalmanBelief", "KalmanTracker"]

#: A sighting farther off than so many standard deviations is not the prey; so many of them in a row, and it is.
_GATE, _REJECTED = 4.0, 3
#: Standard deviation of the prey's acceleration, in its expected speeds per second.
_WANDER = 0.15
#: Standard deviation of a velocity that was never seen, in expected speeds.
_UNKNOWN_SPEED = 1.0


@dataclass(frozen=True, eq=False)
class KalmanBelief:
    """A normal distribution of place and velocity; see ``bayeshunt.protocols.Belief``.

    state: x, y [m], velocity along x and y [m/s]; spread: its covariance [4, 4]. rejected: sightings in a row that were
    taken to be false.
    """

    time: float
    own: Pose
    state: FloatArray
    spread: FloatArray
    eye: Eye
    last_seen: float
    transitions: tuple[Polar, ...] = ()
    rejected: int = 0

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, KalmanBelief):
            return NotImplemented
        same = (self.time, self.own, self.last_seen, self.transitions, self.rejected) == (
            other.time, other.own, other.last_seen, other.transitions, other.rejected
        )  # fmt: skip
        return same and np.array_equal(self.state, other.state) and np.array_equal(self.spread, other.spread)

    __hash__ = None  # type: ignore[assignment]  # arrays inside

    @cached_property
    def mean(self) -> Pose:
        """Its expected pose: it faces where it goes; as long as that is a guess, away from the hunter."""
        x, y, ux, uy = (float(part) for part in self.state)
        theta = math.atan2(uy, ux) if self.resultant >= LEAST_RESULTANT else math.atan2(y - self.own.y, x - self.own.x)
        return Pose(x, y, theta)

    @cached_property
    def resultant(self) -> float:
        """How sure the heading is: that of a normal distribution of the velocity, across its mean."""
        speed = math.hypot(self.state[2], self.state[3])
        across = math.sqrt(max(float(np.trace(self.spread[2:, 2:])) / 2.0, 0.0))
        return math.exp(-0.5 * (across / speed) ** 2) if speed > 0.0 else 0.0

    @cached_property
    def covariance(self) -> FloatArray:
        """Of x, y, theta: [3, 3]."""
        matrix = np.zeros((3, 3))
        matrix[:2, :2] = self.spread[:2, :2]
        matrix[2, 2] = -2.0 * math.log(max(self.resultant, 1e-12))
        matrix.setflags(write=False)
        return matrix

    def sample(self, n: int, *, rng: np.random.Generator) -> Pose[FloatArray]:
        """Return ``n`` poses that it may have."""
        x, y, ux, uy = rng.multivariate_normal(self.state, self.spread, size=n, method="cholesky").T
        return Pose(x, y, np.arctan2(uy, ux) if self.resultant >= LEAST_RESULTANT else np.full(n, self.mean.theta))

    def in_view(self) -> float:
        """Return the probability that it is in view now, from 200 samples."""
        seen = self.own.relative(self.sample(200, rng=np.random.default_rng(0)))
        return float(self.eye.camera.in_view(seen, self.eye.width).mean())

    def table(self) -> pd.DataFrame:
        """Return the mean and the standard deviations of place [m] and velocity [m/s]."""
        import pandas as pd

        index = pd.Index(["x", "y", "velocity x", "velocity y"], name="Part")
        return pd.DataFrame({"mean": self.state, "sd": np.sqrt(np.diag(self.spread))}, index=index)


class KalmanTracker:
    """A Kalman filter of constant velocity: see ``bayeshunt.protocols.Tracker``.

    Sightings are turned into places; one that is too far off is taken to be false. It knows of no walls, and nothing
    follows from where the prey was not seen: a baseline. Reference: pykalman, whose filter it is.
    """

    def __init__(self, context: PerceptionContext) -> None:
        import pykalman

        self.context = context
        self.camera = context.own_camera
        self.eye = Eye(self.camera, context.target_width)
        self.step = 1.0 if context.time_step is None else context.time_step
        known = None if context.motion is None else context.motion.prior_speed / self.step
        self.speed = known or BODIES_PER_SECOND * context.target_width
        self.filter: Any = pykalman.KalmanFilter(n_dim_state=4, n_dim_obs=2)

    def start(self, observation: Observation) -> Belief:
        """Return the belief about the first sighting, at rest, or about where the hunter is, very unsure."""
        frame = observation.frames[-1] if observation.frames else Frame(observation.time, observation.pose)
        if frame.detections:
            place, noise = self._place(frame.detections[0], frame.pose)
            state, spread, last = np.array([*place, 0.0, 0.0]), self._unsure(noise), 0.0
        else:
            ahead = observation.pose.compose(Polar(5.0 * self.context.target_width, 0.0, 0.0))
            state, last = np.array([ahead.x, ahead.y, 0.0, 0.0]), math.inf
            spread = self._unsure(np.eye(2) * 0.3**2)
        return self._belief(observation, state, spread, last, (), 0)

    def update(self, belief: Belief, gait: Gait, observation: Observation, *, rng: np.random.Generator) -> Belief:
        """Return the belief after the frames of a step, each of them at its own time and from its own pose."""
        assert isinstance(belief, KalmanBelief)  # of start or update
        state, spread, time, rejected = belief.state, belief.spread, belief.time, belief.rejected
        last = belief.time - belief.last_seen
        for frame in observation.frames:
            state, spread = self._moved(state, spread, frame.time - time)
            time = frame.time
            found = [self._place(detection, frame.pose) for detection in frame.detections]
            if not found:
                continue
            off = [self._distance(state, spread, *one) for one in found]
            place, noise = found[int(np.argmin(off))]
            if min(off) <= _GATE or rejected + 1 >= _REJECTED:
                if min(off) > _GATE:
                    state, spread = np.array([*place, 0.0, 0.0]), self._unsure(noise)
                else:
                    state, spread = self._corrected(state, spread, place, noise)
                last, rejected = frame.time, 0
            else:
                rejected += 1
        state, spread = self._moved(state, spread, observation.time - time)
        made = self._belief(observation, state, spread, observation.time - last, belief.transitions, rejected)
        passed = observation.time - belief.time
        whole = abs(passed - self.step) <= TOLERANCE * self.step
        if whole and last > belief.time and min(belief.resultant, made.resultant) >= SURE:
            transitions = (*belief.transitions, belief.mean.relative(made.mean))
            return self._belief(observation, state, spread, observation.time - last, transitions, rejected)
        return made

    def _belief(
        self, observation: Observation, state: FloatArray, spread: FloatArray, last: float,
        transitions: tuple[Polar, ...], rejected: int,
    ) -> KalmanBelief:  # fmt: skip
        return KalmanBelief(observation.time, observation.pose, state, spread, self.eye, last, transitions, rejected)

    def _unsure(self, noise: FloatArray) -> FloatArray:
        spread = np.zeros((4, 4))
        spread[:2, :2] = noise
        spread[2:, 2:] = np.eye(2) * (_UNKNOWN_SPEED * self.speed) ** 2
        return spread

    def _place(self, detection: Detection, own: Pose) -> tuple[FloatArray, FloatArray]:
        """Where a detection is [m], and the covariance of that."""
        known = self.eye.measured(detection, own)
        seen, sd = known.seen, known.sd
        assert seen is not None
        assert sd is not None
        far = 0.5 * self.camera.clutter_range if math.isnan(seen.distance) else seen.distance
        along = far if math.isnan(seen.distance) else max(sd.distance, 1e-3)
        place = own.compose(Polar(far, seen.angle, 0.0))
        bearing = wrap(own.theta - seen.angle)
        turn = np.array([[math.cos(bearing), -math.sin(bearing)], [math.sin(bearing), math.cos(bearing)]])
        return np.array([place.x, place.y]), turn @ np.diag([along**2, (far * sd.angle) ** 2 + 1e-6]) @ turn.T

    def _moved(self, state: FloatArray, spread: FloatArray, passed: float) -> tuple[FloatArray, FloatArray]:
        if passed <= 0.0:
            return state, spread
        move, noise = self._motion(passed)
        return self._update(state, spread, None, move, noise)

    def _corrected(
        self, state: FloatArray, spread: FloatArray, place: FloatArray, noise: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        return self._update(state, spread, place, np.eye(4), np.zeros((4, 4)), noise)

    def _update(
        self, state: FloatArray, spread: FloatArray, place: FloatArray | None, move: FloatArray, noise: FloatArray,
        seen: FloatArray | None = None,
    ) -> tuple[FloatArray, FloatArray]:  # fmt: skip
        """One call of the library's filter."""
        state, spread = self.filter.filter_update(
            state, spread, place, transition_matrix=move, transition_offset=np.zeros(4), transition_covariance=noise,
            observation_matrix=np.eye(2, 4), observation_offset=np.zeros(2),
            observation_covariance=np.eye(2) if seen is None else seen,
        )  # fmt: skip
        return np.asarray(state), 0.5 * (np.asarray(spread) + np.asarray(spread).T)

    def _motion(self, passed: float) -> tuple[FloatArray, FloatArray]:
        """The transition matrix, and the noise of a prey whose acceleration is white."""
        move = np.eye(4)
        move[0, 2] = move[1, 3] = passed
        one = np.array([[passed**3 / 3.0, passed**2 / 2.0], [passed**2 / 2.0, passed]])
        return move, np.kron(one, np.eye(2)) * (_WANDER * self.speed) ** 2

    def _distance(self, state: FloatArray, spread: FloatArray, place: FloatArray, noise: FloatArray) -> float:
        """How many standard deviations a sighting is off."""
        off = place - state[:2]
        return math.sqrt(float(off @ np.linalg.solve(spread[:2, :2] + noise, off)))
