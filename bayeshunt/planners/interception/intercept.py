"""The interception hunter: the gait that leads to the earliest expected capture, in a room that it may be in."""

from __future__ import annotations

import math
from typing import Any, ClassVar

import numpy as np
import pandas as pd

from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import Polar, Pose
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.target.turns import TurnModel, earlier_poses
from bayeshunt.planners.api import Situation
from bayeshunt.planners.interception.bouncing import Walls, rooms_futures
from bayeshunt.planners.interception.futures import NEGLIGIBLE, Futures, mix
from bayeshunt.planners.interception.turning import TurningPlanner, TurningSettings
from bayeshunt.planners.settings import Count, Number, planner_settings, setting

__all__ = ["InterceptPlanner", "InterceptSettings", "intercept"]

_NORMALS = ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))
_TOWARDS = np.array(_NORMALS)
_REACH = (
    "distance from the start to where the prey turns away from a wall, of the smallest and the largest "
    "room, body lengths"
)


@planner_settings("intercept")
class InterceptSettings(TurningSettings):
    """Settings of the interception hunter, and the belief about rooms before anything is seen."""

    name: ClassVar[str] = "intercept"
    room_chance: Number = setting(0.3, "probability that there is a room at all", ge=0, lt=1)
    nearest: Number = setting(4.5, _REACH, range="0 < nearest < farthest", gt=0)
    farthest: Number = setting(18.0, _REACH, range="0 < nearest < farthest", gt=0)
    sizes: Count | None = setting(
        None, "rooms between them, log-spaced; by default so many that the smallest two are a body length apart", ge=2
    )
    slack: Number = setting(0.6, "body lengths over which a turn before or after the wall is believed", gt=0)
    error: Number | None = setting(
        None,
        "probability that a prey turns away from the walls, or meets one without turning; by default hazard",
        gt=0,
        lt=0.5,
    )

    def __post_init__(self) -> None:
        if not self.nearest < self.farthest:
            raise InputError(f"{self.name}: expected nearest < farthest, got {self.nearest:g} and {self.farthest:g}")

    @property
    def rooms(self) -> int:
        """Number of rooms from the smallest to the largest."""
        if self.sizes is not None:
            return self.sizes
        return 1 + math.ceil(math.log(self.farthest / self.nearest) / math.log1p(1.0 / self.nearest))


class InterceptPlanner(TurningPlanner):
    """Minimises the expected time of the first capture, not the distance at a step's end.

    1. The hunter: the babbled mean part-way poses of every pair of gaits, composed once; in a model of
       structure "previous_gait" each those after the gait before it.
    2. The prey: weighted futures from a :class:`TurnModel` that is learned from the transitions of
       this hunt: straight on, or one turn in one of the next steps. Its priors come from the hunter's
       own forward model: the prey goes nearly as fast as the fastest straight gait, wanders as that
       does, and turns by what the hunter's own gaits turn by.
    3. Both steps: P(captured by t) at every part-way pose, hence the expected time of capture.
    4. Beyond them: the time in which the hunter, heading straight for the meeting point at top speed,
       would meet the prey, and a price for the turns that this takes (:class:`Homing`).
    5. The second gait may depend on whether the prey was seen to turn in the first step.

    Everything is learned by babbling and within the hunt; ``rng`` is not used.

    Where the prey turns is also evidence of a room. The belief: no room, where it turns by chance; or a square
    room about the place where the hunter began, squared up with its first heading, of one of a few sizes
    (log-uniform). This is a strong assumption about the form of rooms, none about the size of the present one; a
    room elsewhere or askew is seen as a prey that turns by chance.

    ``P(room | prey so far) ~ P(room) product over legs of P(turned or not | room)``, where
    ``P(turn | room) = error + (1 - 2 error) / (1 + exp((gap to the wall - leg) / slack))``, and a prey that has come
    beyond a wall is hardly in that room: ``P(comes beyond | room) = exp(-farthest beyond / slack)``; a size stands for
    those half-way to the next as well. The prey's futures are those of every hypothesis, weighted; :meth:`rooms` opens
    the table. Without ``situation.pose``, or with ``room_chance = 0``, there is no room.
    """

    name = "intercept"
    Settings: ClassVar[type[InterceptSettings]] = InterceptSettings
    settings: InterceptSettings

    def __init__(self, model: ForwardModel, settings: InterceptSettings | None = None, **given: Any) -> None:
        super().__init__(model, settings, **given)
        chosen = self.settings
        body = model.gaits.need("body_length")
        self.sizes = np.geomspace(chosen.nearest, chosen.farthest, chosen.rooms) * body
        #: The largest rooms that each size stands for: half-way to the next.
        self.largest = self.sizes * (self.sizes[-1] / self.sizes[0]) ** (0.5 / max(len(self.sizes) - 1, 1))
        self.slack = chosen.slack * body
        self.walls = [Walls(_NORMALS, (float(size),) * 4, chosen.rebound) for size in self.sizes]
        chance, count = chosen.room_chance, len(self.sizes)
        #: The logarithm of the probability of each room, and last of none, before anything is seen.
        with np.errstate(divide="ignore"):  # of no chance of a room
            self.before = np.log(np.append(np.full(count, chance / count), 1.0 - chance))

    def futures(self, situation: Situation) -> Futures:
        """Return the prey's futures under every hypothesis about the room."""
        if situation.pose is None or self.settings.room_chance == 0.0:
            return self.turning(situation)
        if not (self.settings.prior or situation.transitions):
            return self.turning(situation)
        legs = self.legs(situation)
        known = self.prior.learn(legs)
        chances = self._posterior(situation.pose.compose(situation.prey), legs, known)
        likely = [(c, walls) for walls, c in zip(self.walls, chances.tolist(), strict=False) if c >= NEGLIGIBLE]
        speed = known.speed / self.leg
        chance, bounced = rooms_futures(situation.prey, situation.pose, likely, speed, known.drift, self.leg)
        parts = [(float(chances[-1]), self.turning(situation, known))]
        if bounced is not None:
            parts.append((chance, bounced))
        return mix(parts)

    def rooms(self, situation: Situation) -> pd.DataFrame:
        """Return the belief, one row per size and the last for no room: size [m, inf: none], probability, before."""
        if situation.pose is None:
            raise InputError(f"{self.name}: the situation must tell the hunter's own pose")
        legs = self.legs(situation)
        chances = self._posterior(situation.pose.compose(situation.prey), legs, self.prior.learn(legs))
        columns = {"size": [*self.sizes, math.inf], "probability": chances, "before": np.exp(self.before)}
        return pd.DataFrame(columns).rename_axis("Room")

    def _posterior(self, now: Pose, legs: tuple[Polar, ...], known: TurnModel) -> np.ndarray:
        """Return the probability of each room and, last, of none; sums to 1.

        now: the prey's pose in the frame in which the hunter started. legs: those it has come; known: what they tell.
        """
        logs = self._joint(now, legs, known)
        weights: np.ndarray = np.exp(logs - logs.max())
        weights /= weights.sum()
        return weights

    def own_way(self, situation: Situation) -> float:
        """Return the logarithm of the probability that the prey turned where it did, and nowhere else."""
        assert situation.pose is not None
        legs = self.legs(situation)
        logs = self._joint(situation.pose.compose(situation.prey), legs, self.prior.learn(legs))
        return float(np.logaddexp.reduce(logs))

    def _joint(self, now: Pose, legs: tuple[Polar, ...], known: TurnModel) -> np.ndarray:
        """Return log P(room and the prey so far), last of no room; arguments as of :meth:`_posterior`."""
        chosen = self.settings
        logs: np.ndarray = self.before.copy()
        poses = earlier_poses(now, legs)
        turned = np.array([abs(leg.heading) >= known.threshold for leg in legs])
        # What a prey that turns by chance was believed to do, from the legs before each.
        hazards = np.cumsum(np.append(chosen.hazard * chosen.hazard_steps, turned))[:-1]
        hazards = hazards / (chosen.hazard_steps + np.arange(len(legs)))
        for pose, turn, hazard in zip(poses, turned.tolist(), hazards.tolist(), strict=True):
            chance = np.append(self._turn_chance(pose, known.speed), hazard)
            logs += np.log(np.maximum(chance if turn else 1.0 - chance, 1e-12))
        come = max((max(abs(pose.x), abs(pose.y)) for pose in (*poses, now)[1:]), default=0.0)
        logs[:-1] -= np.maximum((come - self.largest) / self.slack, 0.0)
        return logs

    def _turn_chance(self, pose: Pose, step: float) -> np.ndarray:
        """Return P(the prey turns within a time-step | room) for each size, the prey starting at ``pose``."""
        towards = _TOWARDS @ np.array([math.cos(pose.theta), math.sin(pose.theta)])
        along = _TOWARDS @ np.array([pose.x, pose.y])
        ahead = towards > 1e-9
        gaps = np.maximum((self.sizes[:, None] - along[ahead]) / towards[ahead], 0.0).min(axis=1)
        chosen = self.settings
        error = chosen.hazard if chosen.error is None else chosen.error
        chance: np.ndarray = 1.0 / (1.0 + np.exp(np.clip((gaps - step) / self.slack, -50.0, 50.0)))
        return error + (1.0 - 2.0 * error) * chance


#: The planner by the name that it is registered under.
intercept = InterceptPlanner
