"""The compiled hunt as stable-baselines3 takes it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import gymnasium
import numpy as np
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecEnv

from benchmarks.race.twin import Batch

__all__ = ["Hunts", "Told"]


class Hunts(VecEnv):
    """``count`` hunts at once. limit_ends: the end of the time is told as an end, not as one that was cut off."""

    def __init__(self, arena: str, count: int, seed: int, *, reward: str, limit_ends: bool, side: int = 0) -> None:
        self.batch, self._limit_ends = Batch(arena, count, seed, reward=reward, side=side), limit_ends
        self.render_mode: str | None = None
        low, high = self.batch.bounds
        space = gymnasium.spaces.Box(low, high, dtype=np.float32)
        super().__init__(count, space, gymnasium.spaces.Discrete(self.batch.gaits))
        self._actions = np.zeros(count, dtype=np.int64)

    def reset(self) -> np.ndarray:
        """Begin all."""
        return self.batch.reset()

    def step_async(self, actions: np.ndarray) -> None:
        """Keep what to do."""
        self._actions = np.asarray(actions)

    def step_wait(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        """Do it."""
        seen, rewards, caught, late, ends = self.moved(self._actions)
        done = caught | late
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for n in np.flatnonzero(done):
            cut = bool(late[n]) and not self._limit_ends
            infos[n] = {"terminal_observation": ends[n], "TimeLimit.truncated": cut, "is_success": bool(caught[n])}
        return seen, rewards.astype(np.float32), done, infos

    def moved(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return what the batch says of a step with these actions."""
        return self.batch.step(actions)

    def close(self) -> None:
        """Nothing is open."""

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """The same for all."""
        return [getattr(self, attr_name)] * self.num_envs

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Nothing of one hunt can be set."""
        raise AttributeError(f"{attr_name}: hunts that are compiled together have no attributes of their own")

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> list[Any]:
        """Nothing of one hunt can be called."""
        raise AttributeError(f"{method_name}: hunts that are compiled together have no methods of their own")

    def env_is_wrapped(self, wrapper_class: type, indices: Any = None) -> list[bool]:
        """No hunt is wrapped."""
        return [False] * self.num_envs

    def seed(self, seed: int | None = None) -> Sequence[None]:
        """Seeded when made."""
        return [None] * self.num_envs


class Told(BaseCallback):
    """Tells somebody how many steps were taken."""

    def __init__(self, progress: Callable[[int], None]) -> None:
        super().__init__()
        self._progress = progress

    def _on_step(self) -> bool:
        self._progress(self.num_timesteps)
        return True
