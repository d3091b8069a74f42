"""How the prey learned: PPO of Stable-Baselines3 on its side of ``hunt_v0``. Needs the extra ``rl``."""

from __future__ import annotations

import sys
from typing import Any

from bayeshunt.planners.api import Planner
from benchmarks.fleeing.policy import PreyEnv, PreyPolicy

__all__ = ["train"]

#: Hunts that are stepped at once, and their first seeds: far beyond those that results are reported on.
_ENVS, _FIRST_SEED = 64, 1_000_000


def train(
    planner: Planner, arena: str, steps: int, seed: int, start: PreyPolicy | None = None, **settings: Any
) -> PreyPolicy:
    """Return the policy that PPO learns against a planner in so many steps of the hunt.

    Its reward is that of ``hunt_v0``: the seconds that it lives on. start: a policy to go on from.
    """
    import torch
    from stable_baselines3 import PPO
    from stable_baselines3.common.callbacks import BaseCallback
    from stable_baselines3.common.monitor import Monitor
    from stable_baselines3.common.vec_env import DummyVecEnv

    class Progress(BaseCallback):
        def _on_step(self) -> bool:
            return True

        def _on_rollout_end(self) -> None:
            ends = self.model.ep_success_buffer or [0]
            share = sum(ends) / len(ends)
            print(f"\r{self.num_timesteps:,} steps, of late caught {share:.0%}  ", end="", file=sys.stderr, flush=True)

    torch.set_num_threads(1)
    first = _FIRST_SEED * (1 + seed)
    hunts = [PreyEnv(planner, arena, first + 10_000 * i, **settings) for i in range(_ENVS)]
    model = PPO(
        "MlpPolicy", DummyVecEnv([(lambda one=one: Monitor(one)) for one in hunts]), n_steps=32, batch_size=256,
        n_epochs=8, learning_rate=lambda left: 1e-3 * left, gamma=0.99, gae_lambda=0.95, ent_coef=0.005, seed=seed,
        device="cpu", policy_kwargs={"net_arch": [64, 64], "activation_fn": torch.nn.ReLU},
    )  # fmt: skip
    parts = [*model.policy.mlp_extractor.policy_net, model.policy.action_net]
    dense = [part for part in parts if isinstance(part, torch.nn.Linear)]
    for part, (weight, bias) in zip(dense, [] if start is None else start.layers, strict=start is not None):
        part.weight.data, part.bias.data = torch.from_numpy(weight.copy()), torch.from_numpy(bias.copy())
    model.learn(steps, callback=Progress())
    print(file=sys.stderr)
    return PreyPolicy([(part.weight.detach().numpy(), part.bias.detach().numpy()) for part in dense])
