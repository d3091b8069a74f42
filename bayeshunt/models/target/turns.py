"""How a prey that mostly goes straight turns: its speed, how often it turns, and by how much.

Learned online from the prey's pose transitions, beside the transition counts of
:mod:`bayeshunt.models.target.prey`. The tables say something from the first decision on, because the prior
is borrowed from the hunter's own forward model ("it moves as I do"). Letters: L different turns.
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import pandas as pd

from bayeshunt.core.arguments import check_fields
from bayeshunt.core.checks import check_kind, check_numbers, check_polar
from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import Polar, Pose, wrap
from bayeshunt.models.body.forward import ForwardModel

__all__ = ["OwnMotion", "TurnModel", "earlier_poses", "in_legs", "joined"]


class OwnMotion(NamedTuple):
    """What a hunter knows of its own mean motion.

    top_speed: metres per time-step of the fastest straight gait (of the fastest gait if none is straight).
    turns: heading changes per time-step [L, radians clockwise] of the gaits that turn, in table order.
    softest_turn: radians, the least absolute turn among the gaits that reach half the top speed; pi if none does.
    drift: radians, the spread (circular standard deviation) of the heading after one step of the gait of ``top_speed``.
    """

    top_speed: float
    turns: np.ndarray
    softest_turn: float
    drift: float

    @classmethod
    def of(cls, model: ForwardModel, threshold: float, steps: int = 1) -> OwnMotion:
        """Read each gait's mean outcome; a gait whose heading changes by ``threshold`` [rad] or more turns.

        steps: time-steps for which each gait is held; all that is said is then of so many.
        """
        outcomes = [joined([model.predict(gait)] * steps) for gait in model.gaits]
        reach = np.array([float(outcome.distance) for outcome in outcomes])
        turn = np.array([float(outcome.heading) for outcome in outcomes])
        turning = np.abs(turn) >= threshold
        fastest = int(np.where(turning, -1.0, reach).argmax() if not turning.all() else reach.argmax())
        top = float(reach[fastest])
        fast = np.abs(turn[turning & (reach >= 0.5 * top)])
        softest = float(fast.min()) if fast.size else math.pi
        return cls(top, turn[turning], softest, math.sqrt(steps) * _heading_spread(model, fastest))


def _heading_spread(model: ForwardModel, gait: int) -> float:
    """Return the circular standard deviation [rad] of the heading after one step of a gait: of the rows, or of bins."""
    if model.has_counts:
        return model.joint.heading_spread(gait)
    chances, centres = model.probabilities("Heading")[:, gait], model.axes.heading.centres
    resultant = math.hypot(chances @ np.cos(centres), chances @ np.sin(centres))
    return math.sqrt(-2.0 * math.log(min(max(resultant, 1e-12), 1.0)))


def joined(transitions: Sequence[Polar]) -> Polar:
    """Return the one transition that several make, each in the frame that the one before ends in."""
    if len(transitions) == 1:
        return transitions[0]
    forward = right = heading = 0.0
    for distance, angle, turn in transitions:
        forward += distance * math.cos(heading + angle)
        right += distance * math.sin(heading + angle)
        heading += turn
    return Polar(math.hypot(forward, right), math.atan2(right, forward), float(wrap(heading)))


def in_legs(transitions: Sequence[Polar], steps: int) -> tuple[Polar, ...]:
    """Return transitions over ``steps`` time-steps each, from those over one; the newest leg ends now.

    The oldest leg may lack steps; its distance is then what it would be at the same pace.
    """
    if steps == 1:
        return tuple(transitions)
    ends = range(len(transitions), 0, -steps)
    legs = []
    for end in reversed(ends):
        part = transitions[max(0, end - steps) : end]
        leg = joined(part)
        legs.append(leg._replace(distance=leg.distance * steps / len(part)))
    return tuple(legs)


def earlier_poses(pose: Pose, transitions: Sequence[Polar]) -> list[Pose]:
    """Return the poses before each of ``transitions``, oldest first, of what is now at ``pose``."""
    poses = []
    for distance, angle, heading in reversed(transitions):
        theta = pose.theta + heading
        bearing = theta - angle
        pose = Pose(pose.x - distance * math.cos(bearing), pose.y - distance * math.sin(bearing), theta)
        poses.append(pose)
    return poses[::-1]


@dataclass(frozen=True, eq=False)
class TurnModel:
    """Speed, turning hazard and turns of a prey; a value: :meth:`learn` returns a new model.

    prior_speed: metres per time-step, > 0; believed until a transition without a turn has been seen.
    prior_turns: heading changes [rad, clockwise] believed possible beforehand, [L0].
    prior_hazard: chance of a turn per time-step believed beforehand, in [0, 1].
    prior_steps: how many observed time-steps that belief is worth, > 0.
    turn_weight: how many observed turns all of ``prior_turns`` together are worth, > 0.
    threshold: a transition whose heading changes by this [rad] or more is a turn, > 0.
    prior_drift: radians by which its heading wanders per time-step when it does not turn (standard
        deviation), believed beforehand, >= 0; worth ``prior_steps`` observed time-steps as well.
    drifts: heading changes [rad] of the transitions that did not turn.
    speeds: metres per time-step of the transitions seen that did not turn. turns: heading changes of those that did.
    """

    prior_speed: float
    prior_turns: np.ndarray = field(default_factory=lambda: np.zeros(0))
    prior_hazard: float = 0.1
    prior_steps: float = 4.0
    turn_weight: float = 0.5
    threshold: float = 0.4
    prior_drift: float = 0.1
    speeds: tuple[float, ...] = ()
    turns: tuple[float, ...] = ()
    drifts: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        check_fields(self)
        for name in ("prior_turns", "speeds", "turns", "drifts"):
            check_numbers(getattr(self, name), f"turn model: {name}")
        for name in ("prior_speed", "prior_steps", "turn_weight", "threshold"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise InputError(f"turn model: {name} must be a positive number, got {getattr(self, name)!r}")
        if not 0.0 <= self.prior_hazard <= 1.0:
            raise InputError(f"turn model: prior_hazard must be a probability, got {self.prior_hazard!r}")
        if not 0.0 <= self.prior_drift < math.inf:
            raise InputError(f"turn model: prior_drift must be a number >= 0, got {self.prior_drift!r}")
        turns = np.array(self.prior_turns, dtype=float)
        if not np.isfinite(turns).all():
            raise InputError(f"turn model: prior_turns must be finite, got {turns.tolist()}")
        turns.setflags(write=False)
        object.__setattr__(self, "prior_turns", turns)

    def learn(self, transitions: Iterable[Polar]) -> TurnModel:
        """Return a model that has also seen ``transitions`` (poses in the prey's own earlier frame)."""
        check_kind(transitions, "transitions", Iterable, "Polars")
        seen = []
        for transition in transitions:
            check_polar(transition, "transitions")
            seen.append((float(transition.distance), float(transition.heading)))
        straight = [pair for pair in seen if abs(pair[1]) < self.threshold]
        turns = tuple(heading for _, heading in seen if abs(heading) >= self.threshold)
        return replace(
            self,
            speeds=self.speeds + tuple(distance for distance, _ in straight),
            turns=self.turns + turns,
            drifts=self.drifts + tuple(heading for _, heading in straight),
        )

    @property
    def speed(self) -> float:
        """Metres per time-step when not turning: the median seen, before that the prior's."""
        return statistics.median(self.speeds) if self.speeds else self.prior_speed

    @property
    def hazard(self) -> float:
        """Chance that the prey turns within one time-step.

        ``(turns seen + prior_hazard prior_steps) / (transitions seen + prior_steps)``
        """
        turned = len(self.turns)
        return (turned + self.prior_hazard * self.prior_steps) / (turned + len(self.speeds) + self.prior_steps)

    @property
    def drift(self) -> float:
        """Radians by which the heading wanders per time-step without a turn (standard deviation about 0).

        ``drift^2 = (prior_steps prior_drift^2 + sum of squared changes seen) / (prior_steps + changes seen)``
        """
        squares = math.fsum(change * change for change in self.drifts)
        return math.sqrt((self.prior_steps * self.prior_drift**2 + squares) / (self.prior_steps + len(self.drifts)))

    @cached_property
    def turn_table(self) -> tuple[np.ndarray, np.ndarray]:
        """Heading changes [L, rad clockwise] and P(heading change | a turn) [L], which sums to 1.

        Every turn seen weighs 1, every one of the L0 prior turns ``turn_weight / L0``. Both arrays
        are empty if there is neither.
        """
        prior = self.prior_turns
        weights = np.concatenate([np.full(len(prior), self.turn_weight / max(len(prior), 1)), np.ones(len(self.turns))])
        turns = np.asarray(wrap(np.concatenate([prior, np.array(self.turns)])), dtype=float).reshape(-1)
        chances = weights / weights.sum() if weights.size else weights
        for array in (turns, chances):
            array.setflags(write=False)
        return turns, chances

    def cpt(self) -> pd.DataFrame:
        """Return what the prey does within a time-step: rows "straight" and every turn, summing to 1.

        Columns heading [rad, clockwise], probability, seen (observed count; 0 for a prior turn).
        """
        turns, chances = self.turn_table
        hazard = self.hazard if len(turns) else 0.0
        prior = len(self.prior_turns)
        columns = {
            "heading": [0.0, *turns],
            "probability": [1.0 - hazard, *(hazard * chances)],
            "seen": [len(self.speeds)] + [0] * prior + [1] * len(self.turns),
        }
        names = ["straight"] + [f"own turn {i}" for i in range(prior)] + [f"turn {i}" for i in range(len(self.turns))]
        return pd.DataFrame(columns, index=pd.Index(names, name="Motion"))
