"""The interception hunter that guesses the room it is in from where the prey has turned."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import Pose
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.target.turns import TurnModel, earlier_poses, in_legs
from bayeshunt.planners.api import Situation
from bayeshunt.planners.interception.bouncing import Walls, room_futures
from bayeshunt.planners.interception.futures import Futures, mix, turning_futures
from bayeshunt.planners.interception.intercept import InterceptPlanner, InterceptSettings
from bayeshunt.planners.settings import Count, Number, planner_settings, setting

__all__ = ["InterceptRoomPlanner", "RoomGuessSettings", "intercept_room"]

_NORMALS = ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))
#: Rooms less probable than this are left out of a decision.
_NEGLIGIBLE = 0.01
#: Straight runs of a path among guessed walls.
_LEGS = 4


_REACH = (
    "distance from the start to where the prey turns away from a wall, of the smallest and the largest "
    "room, body lengths"
)


@planner_settings("intercept_room")
class RoomGuessSettings(InterceptSettings):
    """Settings of the interception hunter, and the belief about rooms before anything is seen."""

    hazard: Number = setting(
        0.02, "chance per time-step that the prey turns, believed beforehand; 0: it never turns", ge=0, le=1
    )
    room_chance: Number = setting(0.3, "probability that there is a room at all", ge=0, lt=1)
    nearest: Number = setting(6.2, _REACH, range="0 < nearest < farthest", gt=0)
    farthest: Number = setting(24.2, _REACH, range="0 < nearest < farthest", gt=0)
    sizes: Count = setting(12, "rooms between them, log-spaced", ge=2)
    slack: Number = setting(0.6, "body lengths over which a turn before or after the wall is believed", gt=0)
    error: Number = setting(
        0.03, "probability that a prey turns away from the walls, or meets one without turning", gt=0, lt=0.5
    )
    rebound: Number = setting(
        0.4, "angle between a wall and the prey that has turned away from it, radians", ge=0, le=1.5
    )

    def __post_init__(self) -> None:
        if not self.nearest < self.farthest:
            raise InputError(f"intercept_room: expected nearest < farthest, got {self.nearest:g} and {self.farthest:g}")


class InterceptRoomPlanner(InterceptPlanner):
    """Interception, averaged over the rooms that the hunter may be in; all is learned within the hunt.

    The belief: no room, where the prey turns by chance as for :class:`InterceptPlanner`; or a square
    room about the place where the hunter began, squared up with its first heading, of one of a few
    sizes (log-uniform). This is a strong assumption about the form of rooms, none about the size of
    the present one; a room elsewhere or askew is seen as a prey that turns by chance.

    ``P(room | prey so far) ~ P(room) product over time-steps of P(turned or not | room)``, where
    ``P(turn | room) = error + (1 - 2 error) / (1 + exp((gap to the wall - step) / slack))``. The prey's
    futures are those of every hypothesis, weighted; :meth:`rooms` opens the table. It needs to know
    where it is: ``situation.pose``.
    """

    name = "intercept_room"
    Settings = RoomGuessSettings
    settings: RoomGuessSettings

    def __init__(self, model: ForwardModel, settings: RoomGuessSettings | None = None, **given: Any) -> None:
        super().__init__(model, settings, **given)
        chosen = self.settings
        body = model.gaits.need("body_length")
        self.sizes = np.geomspace(chosen.nearest, chosen.farthest, chosen.sizes) * body
        self.slack = chosen.slack * body
        self.walls = [Walls(_NORMALS, (float(size),) * 4, chosen.rebound) for size in self.sizes]

    def futures(self, situation: Situation) -> Futures:
        """Return the prey's futures under every hypothesis about the room."""
        if situation.pose is None or self.settings.room_chance == 0.0:
            return super().futures(situation)
        if not (self.settings.prior or situation.transitions):
            return super().futures(situation)
        known = self.prey(situation)
        chances = self._posterior(situation, known)
        free = turning_futures(situation.prey, known, self.leg, self.settings.turn_steps)
        parts = [(float(chances[-1]), free)]
        speed = known.speed / self.leg
        for walls, chance in zip(self.walls, chances.tolist(), strict=False):
            if chance >= _NEGLIGIBLE:
                bounced = room_futures(situation.prey, situation.pose, walls, speed, known.drift, self.leg, legs=_LEGS)
                if bounced is not None:
                    parts.append((chance, bounced))
        return mix(parts)

    def rooms(self, situation: Situation) -> pd.DataFrame:
        """Return the belief: one row per size, the last for no room; columns size [m, inf: none], probability."""
        if situation.pose is None:
            raise InputError(f"{self.name}: the situation must tell the hunter's own pose")
        chances = self._posterior(situation, self.prey(situation))
        return pd.DataFrame({"size": [*self.sizes, math.inf], "probability": chances}).rename_axis("Room")

    def _posterior(self, situation: Situation, known: TurnModel) -> np.ndarray:
        """Return the probability of each room and, last, of none; sums to 1."""
        chosen = self.settings
        logs = np.full(len(self.sizes) + 1, math.log(1.0 - chosen.room_chance))
        logs[:-1] = math.log(chosen.room_chance / len(self.sizes))
        assert situation.pose is not None
        seen = self.prior
        legs = in_legs(situation.transitions, self.steps)
        poses = earlier_poses(situation.pose.compose(situation.prey), legs)
        for pose, transition in zip(poses, legs, strict=True):
            chance = np.append(self._turn_chance(pose, known.speed), seen.hazard)
            turned = abs(transition.heading) >= seen.threshold
            logs += np.log(np.maximum(chance if turned else 1.0 - chance, 1e-12))
            seen = seen.learn([transition])
        weights = np.exp(logs - logs.max())
        found: np.ndarray = weights / weights.sum()
        return found

    def _turn_chance(self, pose: Pose, step: float) -> np.ndarray:
        """Return P(the prey turns within a time-step | room) for each size, the prey starting at ``pose``."""
        towards = np.array(_NORMALS) @ np.array([math.cos(pose.theta), math.sin(pose.theta)])
        along = np.array(_NORMALS) @ np.array([pose.x, pose.y])
        ahead = towards > 1e-9
        gaps = np.maximum((self.sizes[:, None] - along[ahead]) / towards[ahead], 0.0).min(axis=1)
        error = self.settings.error
        found: np.ndarray = error + (1.0 - 2.0 * error) / (
            1.0 + np.exp(np.clip((gaps - step) / self.slack, -50.0, 50.0))
        )
        return found


#: The planner by the name that it is registered under.
intercept_room = InterceptRoomPlanner
