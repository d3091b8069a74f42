"""A prey that a small network steers, its side of ``hunt_v0``, and a hunt with it: numpy alone, no learner."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from bayeshunt.core.errors import InputError
from bayeshunt.envs import hunt_v0
from bayeshunt.envs.hunt_v0 import HUNTER, PREY
from bayeshunt.planners.api import Planner
from bayeshunt.planners.policy import planner_policy

__all__ = ["PreyEnv", "PreyPolicy", "hunt"]

#: Weights and biases of a network's layers: [out, in] and [out].
Layers = list[tuple[NDArray[np.float32], NDArray[np.float32]]]


class PreyPolicy:
    """A network of dense layers, ReLU between them: what the prey sees to the numbers of its actions."""

    def __init__(self, layers: Layers) -> None:
        self.layers = layers

    def values(self, seen: NDArray[Any]) -> NDArray[np.float32]:
        """Return one number per action [..., A] for observations [..., D]; the greatest is taken."""
        value = np.asarray(seen, dtype=np.float32)
        for weight, bias in self.layers[:-1]:
            value = np.maximum(value @ weight.T + bias, np.float32(0.0))
        weight, bias = self.layers[-1]
        return np.asarray(value @ weight.T + bias)

    def act(self, seen: NDArray[Any]) -> int:
        """Return the prey's action."""
        return int(self.values(seen).argmax())

    def save(self, path: Path) -> None:
        """Write the weights in half precision, as an .npz without pickles."""
        named = {f"{kind}{i}": part.astype(np.float16) for i, layer in enumerate(self.layers)
                 for kind, part in zip(("weight", "bias"), layer, strict=True)}  # fmt: skip
        path.parent.mkdir(parents=True, exist_ok=True)
        np.savez_compressed(path, **named)

    @classmethod
    def load(cls, path: Path) -> PreyPolicy:
        """Read the weights of a file; InputError if it holds none."""
        try:
            with np.load(path, allow_pickle=False) as stored:
                count = len(stored.files) // 2
                parts = [[stored[f"{kind}{i}"].astype(np.float32) for kind in ("weight", "bias")] for i in range(count)]
        except (OSError, ValueError, KeyError):
            raise InputError(f"{path}: expected the weights of a prey, an .npz of benchmarks.fleeing") from None
        return cls([(weight, bias) for weight, bias in parts])


class PreyEnv(gymnasium.Env[NDArray[np.float32], int]):
    """The prey's side of a hunt: the hunter is a planner, prepared for the arena.

    first_seed: each reset starts the next hunt from this seed on, whatever seed it is given. settings: those of
    ``hunt_v0.parallel_env``.
    """

    def __init__(self, planner: Planner, arena: str, first_seed: int = 0, **settings: Any) -> None:
        self.hunt = hunt_v0.parallel_env(arena=arena, **settings)
        self._choose, self._next = planner_policy(planner, self.hunt), first_seed
        self.observation_space, self.action_space = self.hunt.observation_space(PREY), self.hunt.action_space(PREY)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Start the next hunt, at a bearing that its seed draws, or that of ``options``: "theta" and "hunt_seed"."""
        super().reset(seed=seed)
        given = options or {"hunt_seed": self._next}
        self._next += options is None
        seen, info = self.hunt.reset(seed=given["hunt_seed"], options=given)
        return seen[PREY], info[PREY]

    def step(self, action: int) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Let the planner choose its gait, and both act."""
        seen, reward, ended, late, info = self.hunt.step({HUNTER: self._choose(), PREY: action})
        return seen[PREY], reward[PREY], ended[PREY], late[PREY], info[PREY]


def hunt(env: PreyEnv, policy: PreyPolicy, theta: float, seed: int) -> tuple[float, bool]:
    """Return the time [s] of one hunt and whether the prey was caught."""
    seen, info = env.reset(options={"theta": theta, "hunt_seed": seed})
    over = False
    while not over:
        seen, _, ended, late, info = env.step(policy.act(seen))
        over = ended or late
    return float(info["time"]), bool(info["is_success"])
