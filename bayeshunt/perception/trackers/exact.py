"""The exact tracker: what is seen is believed; while nothing is seen, the prey goes on as it went."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import FloatArray, Polar, Pose
from bayeshunt.core.messages import Observation
from bayeshunt.core.protocols import Belief
from bayeshunt.core.trusted import trusted
from bayeshunt.perception.setting import PerceptionContext
from bayeshunt.perception.trackers.common import TOLERANCE

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["ExactBelief", "ExactTracker"]

#: Where the prey is taken to be while it was never seen: so many bodies ahead; a guess, and said to be one.
_GUESS_BODIES = 5.0
#: How sure a heading is that was worked out from two places, and one that was guessed.
_WORKED_OUT, _GUESSED = 0.9, 0.0


@dataclass(frozen=True)
class ExactBelief:
    """One pose; see ``bayeshunt.protocols.Belief``.

    time: seconds, of the observation. spread: metres, standard deviation of the place; 0 while it is seen.
    """

    time: float
    mean: Pose
    resultant: float = 1.0
    last_seen: float = 0.0
    transitions: tuple[Polar, ...] = ()
    spread: float = 0.0

    @cached_property
    def covariance(self) -> FloatArray:
        """Of x, y, theta: [3, 3]."""
        turn = math.inf if self.resultant <= 0 else -2.0 * math.log(self.resultant)  # of a wrapped normal
        matrix = np.diag([self.spread**2, self.spread**2, turn])
        matrix.setflags(write=False)
        return matrix

    def sample(self, n: int, *, rng: np.random.Generator) -> Pose[FloatArray]:
        """Return ``n`` poses around the one believed: while it is seen that one, and nothing is drawn."""
        x, y, theta = (np.full(n, float(part)) for part in self.mean)
        if self.spread > 0 and math.isfinite(self.spread):
            x, y = x + rng.normal(0.0, self.spread, n), y + rng.normal(0.0, self.spread, n)
        if self.resultant <= 0:
            theta = rng.uniform(-np.pi, np.pi, n)
        return Pose(x, y, theta)

    def in_view(self) -> float:
        """1 while it is seen, else 0."""
        return float(self.last_seen == 0.0)

    def table(self) -> pd.DataFrame:
        """Return the one pose, its spread, and when it was last seen."""
        import pandas as pd

        facts = {**self.mean._asdict(), "resultant": self.resultant, "spread": self.spread, "last_seen": self.last_seen}
        return pd.DataFrame([facts])


class ExactTracker:
    """Believes what it sees: see ``bayeshunt.protocols.Tracker``."""

    def __init__(self, context: PerceptionContext) -> None:
        self.step = context.time_step
        self.length = context.body_length

    def start(self, observation: Observation) -> Belief:
        """Return the prey where it was seen; if it was not, a guess straight ahead."""
        own, found = observation.pose, observation.detection
        if found is None:
            ahead = own.compose(Polar(_GUESS_BODIES * (self.length or 0.0), 0.0, 0.0))
            return ExactBelief(observation.time, ahead, _GUESSED, math.inf, spread=math.inf)
        place = found.placed(own)
        if math.isnan(place.theta):  # nothing is known of its heading: away from the hunter is a guess
            away = math.atan2(place.y - own.y, place.x - own.x)
            return ExactBelief(observation.time, Pose(place.x, place.y, away), _GUESSED)
        return ExactBelief(observation.time, place)

    def update(self, belief: Belief, gait: Gait, observation: Observation, *, rng: np.random.Generator) -> Belief:
        """Return the prey where it was seen, and its transition if that is one step's; or else where it should be."""
        assert isinstance(belief, ExactBelief)  # of start or update
        passed = observation.time - belief.time
        detection = observation.detection
        if detection is None:
            return self._unseen(belief, observation.time, passed)
        place, resultant = self._headed(belief, detection.placed(observation.pose))
        known = belief.last_seen == 0.0 and min(belief.resultant, resultant) > _GUESSED and self._one_step(passed)
        transitions = (*belief.transitions, belief.mean.relative(place)) if known else belief.transitions
        return trusted(ExactBelief, {
            "time": observation.time, "mean": place, "resultant": resultant, "transitions": transitions,
        })  # fmt: skip

    def _headed(self, belief: ExactBelief, place: Pose) -> tuple[Pose, float]:
        """A place with its heading and how sure that is: where none was seen, the way from the last sighting."""
        if not math.isnan(place.theta):
            return place, 1.0
        dx, dy = place.x - belief.mean.x, place.y - belief.mean.y
        if belief.last_seen == 0.0 and (dx or dy):
            return Pose(place.x, place.y, math.atan2(dy, dx)), _WORKED_OUT
        return Pose(place.x, place.y, belief.mean.theta), min(belief.resultant, _WORKED_OUT)

    def _unseen(self, belief: ExactBelief, time: float, passed: float) -> ExactBelief:
        """Go on as in the last transition; how far off that may be grows by half of it."""
        last = belief.transitions[-1] if belief.transitions else Polar(0.0, 0.0, 0.0)
        growth = 0.5 * (float(last.distance) if belief.transitions else self.length or 0.0)
        return ExactBelief(
            time, belief.mean.compose(last), belief.resultant, belief.last_seen + passed, belief.transitions,
            belief.spread + growth,
        )  # fmt: skip

    def _one_step(self, passed: float) -> bool:
        return self.step is None or abs(passed - self.step) <= TOLERANCE * self.step
