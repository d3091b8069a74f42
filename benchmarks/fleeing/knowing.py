"""A hunter that knows the prey's policy, and so what the prey will do wherever it goes itself: a yardstick.

Letters: N sequences of gaits so far, G gaits, P part-way poses of a gait.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.geometry import Polar, Pose, placed, wrap
from bayeshunt.envs.hunt_v0 import TURNS, HuntParallelEnv
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.api import Plan, Situation
from bayeshunt.planners.interception.lookahead import gait_paths
from benchmarks.fleeing.policy import PreyPolicy

__all__ = ["Knowing"]

#: Metres that a radian between the hunter's heading and the way to the prey is worth at the end.
_RADIAN = 0.03
#: Seconds that a capture at the very edge of the reach is worth less than one at the prey's centre.
_EDGE = 0.5


class Knowing:
    """Follows every sequence of ``depth`` gaits along mean paths, the prey answering each gait as its policy does.

    It is told both true poses (``hunt``). The sequence of earliest capture is begun; where none captures, that which
    ends nearest.
    """

    name = "knows the prey's policy"

    def __init__(
        self, model: ForwardModel, policy: PreyPolicy, settings: ExperimentSettings, arena: str, depth: int = 3
    ) -> None:
        self.policy, self.depth, self.gaits = policy, depth, model.gaits.names
        self.paths = np.moveaxis(gait_paths(model), -1, 0)  # [3, G, P]
        body, room = model.gaits.need("body_length"), settings.arenas[arena]
        self.duration, self.limit = model.gaits.need("duration"), settings.protocol.time_limit
        self.reach, self.unit = settings.protocol.catch_distance * body, 10.0 * body
        self.speed = settings.prey.speed
        self.turns = np.array([share for _, share in TURNS]) * settings.prey.turn_rate
        radius = 0.5 * settings.prey.body.diameter
        sides = (0.5 * room.width - radius, 0.5 * room.height - radius) if room.walled else (np.inf, np.inf)
        self.inside = np.array(sides)
        self.hunt: HuntParallelEnv | None = None

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Return the first gait of the best sequence."""
        assert self.hunt is not None
        assert self.hunt.pursuit is not None
        poses, before = self.hunt.pursuit.moment.poses, None
        if situation.transitions:
            was = situation.approaches[-1].seen_from(situation.transitions[-1])  # as the prey has it now
            before = np.array([list(map(float, poses["prey"].compose(was)))])
        hunter, prey_now = (np.array([list(map(float, poses[name]))]) for name in ("hunter", "prey"))
        return Plan(self.gaits[self._best(hunter, before, prey_now, situation.time)])

    def _best(self, hunter: NDArray[Any], before: NDArray[Any] | None, prey: NDArray[Any], time: float) -> int:
        """The first gait of the sequence of earliest capture; poses x, y, theta [1, 3]."""
        count = self.paths.shape[1]
        first = np.arange(count)[None]
        for step in range(self.depth):
            left = max(0.0, 1.0 - (time + step * self.duration) / self.limit)
            action = self.policy.values(self._seen(hunter, before, prey, left)).argmax(axis=1)
            fled = self._prey_paths(prey, action)  # [3, N, P]
            went = self._hunter_paths(hunter)  # [3, N, G, P]
            gap = np.hypot(went[0] - fled[0][:, None], went[1] - fled[1][:, None])
            hit = gap <= self.reach
            if hit.any():
                when = hit.argmax(axis=2) * (self.duration / gap.shape[2]) + _EDGE * gap.min(axis=2) / self.reach
                return int(first.flat[np.where(hit.any(axis=2), when, np.inf).argmin()])
            before = np.repeat(hunter, count, axis=0)
            hunter = np.moveaxis(went[..., -1], 0, -1).reshape(-1, 3)
            prey = np.repeat(fled[..., -1].T, count, axis=0)
            first = np.repeat(first.reshape(-1, 1), count, axis=1) if step + 1 < self.depth else first
        first = first.ravel()
        ahead, aside = (prey[:, :2] - hunter[:, :2]).T
        turn = np.abs(wrap(np.arctan2(aside, ahead) - hunter[:, 2]))
        return int(first[(np.hypot(ahead, aside) + _RADIAN * turn).argmin()])

    def _hunter_paths(self, hunter: NDArray[Any]) -> NDArray[Any]:
        pose = Pose(*(part[:, None, None] for part in hunter.T))
        x, y = placed(pose, self.paths[0], self.paths[1])
        return np.stack([*self._kept(x, y), np.broadcast_to(pose.theta - self.paths[2], x.shape)])

    def _prey_paths(self, prey: NDArray[Any], action: NDArray[Any]) -> NDArray[Any]:
        """Arcs of its actions [N], without noise; walls hold its centre."""
        time = np.arange(1, self.paths.shape[2] + 1) * (self.duration / self.paths.shape[2])
        turned = self.turns[action][:, None] * time
        half = np.where(np.abs(turned) > 1e-9, 0.5 * turned, 1e-9)
        chord, theta = self.speed * time * np.sin(half) / half, prey[:, 2:]
        x, y = prey[:, :1] + chord * np.cos(theta + half), prey[:, 1:2] + chord * np.sin(theta + half)
        return np.stack([*self._kept(x, y), theta + turned])

    def _kept(self, x: NDArray[Any], y: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
        return np.clip(x, -self.inside[0], self.inside[0]), np.clip(y, -self.inside[1], self.inside[1])

    def _seen(self, hunter: NDArray[Any], before: NDArray[Any] | None, prey: NDArray[Any], left: float) -> NDArray[Any]:
        """What the prey sees [N, 18 + G], as ``hunt_v0`` tells it."""
        seen = np.zeros((len(hunter), 18 + self.paths.shape[1]))
        there = Pose(*prey.T).relative(Pose(*hunter.T))
        seen[:, :7] = np.stack([
            there.forward / self.unit, there.right / self.unit, there.distance / self.unit, *_direction(there.angle),
            *_direction(there.heading),
        ], axis=1)  # fmt: skip
        if before is not None:
            moved: Polar[Any] = Pose(*before.T).relative(Pose(*hunter.T))
            seen[:, 7] = 1.0
            seen[:, 8:12] = np.stack(
                [moved.forward / self.unit, moved.right / self.unit, *_direction(moved.heading)], axis=1
            )
        seen[:, 12:16] = np.stack([prey[:, 0] / self.unit, prey[:, 1] / self.unit, *_direction(prey[:, 2])], axis=1)
        seen[:, 16] = left
        return seen


def _direction(angle: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    return np.cos(angle), np.sin(angle)
