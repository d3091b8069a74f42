"""How the prey learned: PPO of Stable-Baselines3 on its side of the hunt. Needs the extras ``rl`` and ``bench``.

It learns in the compiled hunt of the race (``benchmarks.race.twin``), so that the time goes into what the hunter
decides: that is its planner's own decision about a situation as the step API makes it. Nothing is reported from the
compiled hunt: what has learned there flees in ``hunt_v0``.
"""

from __future__ import annotations

import sys

import gymnasium
import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback

from bayeshunt.config.loading import load_experiment
from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.geometry import Pose, in_frame, wrap
from bayeshunt.core.messages import Detection
from bayeshunt.envs.hunt_v0 import prey_gaits
from bayeshunt.episodes.perceiver import Perceiver
from bayeshunt.episodes.pursuit import Pursuit
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.perception.sensors.exact import exact_observation
from bayeshunt.perception.setting import PerceptionContext
from bayeshunt.perception.trackers.exact import ExactTracker
from bayeshunt.planners.api import Planner
from benchmarks.fleeing.policy import PreyPolicy
from benchmarks.race.vector import Hunts

__all__ = ["Fleeing", "train"]

_HUNTER, _PREY = 0, 1
#: Hunts that are stepped at once.
_HUNTS = 64


class Fleeing(Hunts):
    """The prey's side of many hunts at once; the hunter of each is the same planner, prepared for the arena."""

    def __init__(self, planner: Planner, arena: str, count: int, seed: int, *, preset: str = "paper") -> None:
        super().__init__(arena, count, seed, reward="time", limit_ends=False, side=_PREY)
        settings = load_experiment(preset)
        self.action_space = gymnasium.spaces.Discrete(len(prey_gaits(settings.prey)))
        self._wheels = np.array([gait.command for gait in prey_gaits(settings.prey)])
        self._planner, self._robot, self._rng = planner, settings.robot.gaits, np.random.default_rng(seed)
        first = Pursuit(settings, arena)  # what a hunter knows of its task and its prey at first
        self._start, self._task, self._axes = first.trial.start, first.trial.task, _axes(first)
        context = PerceptionContext(self._robot.duration, self._robot.body_length, origin=self._start)
        self._tracker = ExactTracker(context)
        self._hunters = [self._hunter() for _ in range(count)]

    def reset(self) -> np.ndarray:
        """Begin all."""
        self._hunters = [self._hunter() for _ in self._hunters]
        return super().reset()

    def moved(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Let every planner choose, and both act."""
        gaits = np.array([self._chosen(n) for n in range(self.num_envs)])
        told = self.batch.step(gaits, self._wheels[actions])
        for n in np.flatnonzero(told[2] | told[3]):
            self._hunters[n] = self._hunter()
        return told

    def _hunter(self) -> Perceiver:
        return Perceiver(self._robot, self._tracker, PreyModel(self._axes), self._task, rng=self._rng)

    def _chosen(self, n: int) -> int:
        """The gait that the planner chooses in one hunt."""
        state, hunter = self.batch.state, self._hunters[n]
        own, prey = (in_frame(Pose(x, y, wrap(theta)), self._start) for x, y, theta in state.pose[n].tolist())
        time = float(state.steps[n] * self.batch.constants.step)
        gait = self._planner.plan(
            hunter.consider(exact_observation(time, own, Detection(pose=prey))), rng=self._rng
        ).gait
        hunter.execute(gait)
        return self._robot.index(gait)


class _Progress(BaseCallback):
    def _on_step(self) -> bool:
        return True

    def _on_rollout_end(self) -> None:
        ends = self.model.ep_success_buffer or [0]
        share = sum(ends) / len(ends)
        print(f"\r{self.num_timesteps:,} steps, of late caught {share:.0%}  ", end="", file=sys.stderr, flush=True)


def train(planner: Planner, arena: str, steps: int, seed: int, *, preset: str = "paper") -> PreyPolicy:
    """Return the policy that PPO learns against a planner in about so many steps of the hunt.

    Its reward is that of ``hunt_v0``: the seconds that it lives on.
    """
    torch.set_num_threads(1)
    model = PPO(
        "MlpPolicy", Fleeing(planner, arena, _HUNTS, seed, preset=preset), n_steps=32, batch_size=256,
        n_epochs=8, learning_rate=lambda left: 1e-3 * left, gamma=0.99, gae_lambda=0.95, ent_coef=0.005, seed=seed,
        device="cpu", policy_kwargs={"net_arch": [64, 64], "activation_fn": torch.nn.ReLU},
    )  # fmt: skip
    model.learn(steps, callback=_Progress())
    print(file=sys.stderr)
    parts = [*model.policy.mlp_extractor.policy_net, model.policy.action_net]
    dense = [part for part in parts if isinstance(part, torch.nn.Linear)]
    return PreyPolicy([(part.weight.detach().numpy(), part.bias.detach().numpy()) for part in dense])


def _axes(pursuit: Pursuit) -> EffectAxes:
    model = pursuit.prey_model
    assert isinstance(model, PreyModel)
    return model.axes
