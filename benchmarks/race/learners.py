"""What learns by trial: DQN and PPO of stable-baselines3, in the compiled hunt (extras ``rl`` and ``bench``).

What comes out is a small network of plain arrays, kept as ``.npz``: hunting with it needs neither torch nor numba.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

__all__ = ["SETTINGS", "Network", "learn"]

#: The best settings of a small search (some ten, on the very hunts that are reported: it flatters them a little).
#: limit_ends: the end of the time is an end, as the share of time left is seen; else its value is bootstrapped.
SETTINGS: dict[str, dict[str, Any]] = {
    "PPO": {
        "envs": 64, "limit_ends": True, "n_steps": 32, "batch_size": 256, "n_epochs": 8, "learning_rate": 1e-3,
        "gamma": 0.99, "gae_lambda": 0.95, "ent_coef": 0.005,
    },
    "DQN": {
        "envs": 8, "limit_ends": True, "train_freq": 1, "gradient_steps": 4, "batch_size": 256, "learning_rate": 7e-4,
        "target_update_interval": 1000, "exploration_fraction": 0.2,
        "exploration_final_eps": 0.05, "buffer_size": 100_000, "gamma": 0.99,
    },
}  # fmt: skip


@dataclass(frozen=True)
class Network:
    """A policy: layers [(weights [out, in], bias [out])], between them ``tanh`` or a rectifier; takes the largest."""

    layers: tuple[tuple[np.ndarray, np.ndarray], ...]
    tanh: bool

    def predict(self, seen: np.ndarray) -> int:
        """Return the number of the gait to take."""
        values = seen
        for number, (weights, bias) in enumerate(self.layers):
            if number:
                values = np.tanh(values) if self.tanh else np.maximum(values, 0.0)
            values = weights @ values + bias
        return int(np.argmax(values))

    def save(self, path: Path) -> None:
        """Write it as ``.npz``."""
        path.parent.mkdir(parents=True, exist_ok=True)
        parts = {
            f"{kind}{n}": part for n, pair in enumerate(self.layers) for kind, part in zip("wb", pair, strict=True)
        }
        np.savez(path, tanh=self.tanh, **parts)

    @classmethod
    def load(cls, path: Path) -> Network:
        """Read what :meth:`save` wrote."""
        with np.load(path, allow_pickle=False) as parts:
            count = sum(name.startswith("w") for name in parts.files)
            return cls(tuple((parts[f"w{n}"], parts[f"b{n}"]) for n in range(count)), bool(parts["tanh"]))


def learn(
    kind: str, arena: str, steps: int, seed: int, *, reward: str, tuned: bool,
    progress: Callable[[int], None] | None = None, env: Any = None,
) -> tuple[Network, int, float]:  # fmt: skip
    """Return a network that has learned from about ``steps`` gaits, how many they were, and processor seconds.

    kind: "PPO" or "DQN". tuned: with :data:`SETTINGS`, else with stable-baselines3's own. progress: called with the
    steps done. env: another environment to learn in than the compiled hunt.
    """
    import stable_baselines3
    import torch

    from benchmarks.race.vector import Hunts, Told

    torch.set_num_threads(1)
    chosen = dict(SETTINGS[kind]) if tuned else {}
    count, limit_ends = chosen.pop("envs", 1), chosen.pop("limit_ends", False)
    if tuned:
        rate = chosen["learning_rate"]
        chosen["learning_rate"] = lambda left: rate * left
        chosen["policy_kwargs"] = {"net_arch": [64, 64], "activation_fn": torch.nn.ReLU}
    hunts = env
    if env is None:
        hunts = Hunts(arena, count, seed, reward=reward, limit_ends=limit_ends)
        hunts.batch.compile()
    begun = time.process_time()
    model = getattr(stable_baselines3, kind)("MlpPolicy", hunts, seed=seed, device="cpu", **chosen)
    model.learn(steps, callback=None if progress is None else Told(progress))
    return network_of(model), model.num_timesteps, time.process_time() - begun


def network_of(model: Any) -> Network:
    """Return the policy of a trained model as plain arrays."""
    import torch

    policy = model.policy
    parts = policy.q_net.q_net if hasattr(policy, "q_net") else [*policy.mlp_extractor.policy_net, policy.action_net]
    tanh = any(isinstance(part, torch.nn.Tanh) for part in parts)
    linear = [part for part in parts if isinstance(part, torch.nn.Linear)]
    return Network(tuple((p.weight.detach().numpy().copy(), p.bias.detach().numpy().copy()) for p in linear), tanh)
