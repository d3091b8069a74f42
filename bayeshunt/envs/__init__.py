"""Hunts as environments that others use: ``gymnasium.make("bayeshunt.envs:Hunt-v0")``, PettingZoo's ``hunt_v0``.

Importing this registers ``Hunt-v0`` and ``bayeshunt/Hunt-v0`` with Gymnasium; ``import bayeshunt`` does not. Needs the
extra ``gym``. PettingZoo is imported with ``from bayeshunt.envs import hunt_v0`` only.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import gymnasium

if TYPE_CHECKING:
    from bayeshunt.envs.film import Film
    from bayeshunt.envs.gym import HuntEnv

__all__ = ["Film", "HuntEnv"]

_HOMES = {"Film": "bayeshunt.envs.film", "HuntEnv": "bayeshunt.envs.gym"}

for _name in ("Hunt-v0", "bayeshunt/Hunt-v0"):
    if _name not in gymnasium.registry:
        # The time limit is the hunt's own: its last gait is cut short, which no number of steps can say.
        gymnasium.register(_name, entry_point="bayeshunt.envs.gym:HuntEnv", max_episode_steps=None)


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'bayeshunt.envs' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
