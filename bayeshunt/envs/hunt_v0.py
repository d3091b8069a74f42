"""The hunt as a PettingZoo environment: ``hunter_0`` and ``prey_0`` both act, and what one gains the other loses.

``parallel_env()`` makes it with both acting at once, ``env()`` with one after the other; importing this registers both
as "bayeshunt/hunt-v0" with a PettingZoo that has a registry.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
import pettingzoo
from gymnasium.utils import EzPickle
from numpy.typing import NDArray
from pettingzoo import AECEnv, ParallelEnv
from pettingzoo.utils import parallel_to_aec, wrappers

from bayeshunt.config.schema import PreySettings
from bayeshunt.core.checks import check_whole
from bayeshunt.core.errors import InputError, shown
from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import Pose
from bayeshunt.envs.choosing import FPS
from bayeshunt.envs.gym import HuntEnv
from bayeshunt.episodes.pursuit import Pursuit
from bayeshunt.planners.policy import encode

__all__ = ["HuntParallelEnv", "env", "parallel_env", "prey_gaits", "raw_env"]

HUNTER, PREY = "hunter_0", "prey_0"
_ID = "bayeshunt/hunt-v0"
#: What the prey can do at its free speed: its turn in units of ``prey.turn_rate``, counter-clockwise.
TURNS = (("hard left", 1.0), ("left", 0.5), ("straight", 0.0), ("right", -0.5), ("hard right", -1.0))
#: Greatest length in an observation [ten bodies of the hunter].
_PLACE = 20.0

_Step = tuple[dict[str, Any], dict[str, float], dict[str, bool], dict[str, bool], dict[str, dict[str, Any]]]


class HuntParallelEnv(ParallelEnv, EzPickle):  # type: ignore[misc]  # PettingZoo has no types
    """Hunter and prey act at once, each for one time-step of the hunter. See docs/environments.md.

    arena, robot, preset, sensing, theta, overrides, reward, render_mode: see ``bayeshunt.envs.HuntEnv``.
    max_cycles: steps after which an episode is truncated; None: its time limit alone does it. The prey is steered
    through the hunt, whatever its behaviour in the settings. A copy is a new environment of the same arguments.

    Raises InputError in one line for an argument that cannot be used.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012
        "name": "hunt_v0", "render_modes": ["human", "rgb_array"], "is_parallelizable": True, "render_fps": FPS,
    }  # fmt: skip

    def __init__(
        self, arena: str = "walled", robot: str | None = None, preset: str | None = None,
        sensing: str | Mapping[str, Any] | None = None, theta: float | None = None,
        overrides: Mapping[str, Any] | None = None, reward: str = "time", max_cycles: int | None = None,
        render_mode: str | None = None,
    ) -> None:  # fmt: skip
        EzPickle.__init__(self, arena, robot, preset, sensing, theta, overrides, reward, max_cycles, render_mode)
        if max_cycles is not None:
            check_whole(max_cycles, "max_cycles", 1)
        self._hunt = HuntEnv(arena, robot, preset, sensing, theta, overrides, reward, render_mode)
        self.metadata = {**self.metadata, "render_fps": self._hunt.metadata["render_fps"]}
        self.render_mode, self.max_cycles = render_mode, max_cycles
        settings = self._hunt.settings
        self._gaits = prey_gaits(settings.prey)
        self._unit = 10.0 * settings.robot.gaits.need("body_length")
        self.possible_agents = [HUNTER, PREY]
        self.agents: list[str] = []
        self.observation_spaces = dict.fromkeys(self.possible_agents, self._hunt.observation_space)
        self.action_spaces = {HUNTER: self._hunt.action_space, PREY: gymnasium.spaces.Discrete(len(TURNS))}
        high = np.array([_PLACE, _PLACE, 1.0, 1.0] * 2 + [1.0], dtype=np.float32)
        self.state_space = gymnasium.spaces.Box(np.append(-high[:-1], np.float32(0.0)), high, dtype=np.float32)
        self._cycles = 0
        self._hunter_before: Pose | None = None

    @property
    def pursuit(self) -> Pursuit | None:
        """The hunt itself, to look at, None before the first: :func:`bayeshunt.planner_policy` asks a planner of it."""
        return self._hunt.pursuit

    def observation_space(self, agent: str) -> gymnasium.spaces.Space[Any]:
        """Return the space of what an agent sees: always the same object."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> gymnasium.spaces.Space[Any]:
        """Return the space of what an agent can do: always the same object."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
        """Start a hunt; ``options``: its "theta" [rad] and "hunt_seed"."""
        seen, info = self._hunt.reset(seed=seed, options=options)
        self.agents, self._cycles, self._hunter_before = list(self.possible_agents), 0, None
        return {HUNTER: seen, PREY: self._seen_by_prey()}, {agent: dict(info) for agent in self.agents}

    def step(self, actions: Mapping[str, Any]) -> _Step:
        """Take both actions; at the end nobody is left in ``agents``. InputError for an action that is none."""
        if not self.agents:
            raise InputError("step: no hunt is running; call reset() first")
        if set(actions) != set(self.agents):
            raise InputError(f"step: expected an action of {HUNTER} and of {PREY}, got {', '.join(actions) or 'none'}")
        self._hunter_before = self._poses()[0]
        seen, reward, caught, late, info = self._hunt.advance(actions[HUNTER], self._prey_gait(actions[PREY]))
        self._cycles += 1
        late = late or (self.max_cycles is not None and self._cycles >= self.max_cycles and not caught)
        agents = self.agents
        if caught or late:
            self.agents = []
        return (
            {HUNTER: seen, PREY: self._seen_by_prey()}, {HUNTER: reward, PREY: -reward},
            dict.fromkeys(agents, caught), dict.fromkeys(agents, late), {agent: dict(info) for agent in agents},
        )  # fmt: skip

    def state(self) -> NDArray[np.float32]:
        """Return all there is: x, y [ten bodies], cos and sin of both robots in the arena, the share of time left."""
        hunter, prey = self._poses()
        state = np.array([*self._place(hunter), *self._place(prey), self._left()], dtype=np.float32)
        return np.clip(state, self.state_space.low, self.state_space.high)

    def render(self) -> NDArray[np.uint8] | None:
        """Return a frame [400, 400, 3] in the mode "rgb_array"; "human" draws by itself."""
        return self._hunt.render()

    def close(self) -> None:
        """Close the window, if there is one; may be called twice."""
        self._hunt.close()

    def _prey_gait(self, action: Any) -> Gait:
        number = action.item() if isinstance(action, (np.ndarray, np.generic)) and np.size(action) == 1 else action
        if isinstance(number, bool) or not isinstance(number, int) or not 0 <= number < len(self._gaits):
            names = ", ".join(gait.name for gait in self._gaits)
            raise InputError(f"{PREY}: expected a whole number from 0 to 4 ({names}), got {shown(number)}")
        return self._gaits[number]

    def _poses(self) -> tuple[Pose, Pose]:
        if self._hunt.pursuit is None:
            raise InputError("state: no hunt is running; call reset() first")
        poses = self._hunt.pursuit.moment.poses
        return poses["hunter"], poses["prey"]

    def _seen_by_prey(self) -> NDArray[np.float32]:
        """The hunter's observation the other way round; the own pose is that in the arena, the last action untold."""
        hunter, prey = self._poses()
        moved = None if self._hunter_before is None else self._hunter_before.relative(hunter)
        return encode(prey.relative(hunter), moved, prey, self._left(), self._hunt.settings.robot.gaits)

    def _place(self, pose: Pose) -> list[float]:
        return [pose.x / self._unit, pose.y / self._unit, math.cos(pose.theta), math.sin(pose.theta)]

    def _left(self) -> float:
        assert self._hunt.pursuit is not None
        return 1.0 - self._hunt.pursuit.time / self._hunt.settings.protocol.time_limit


def prey_gaits(prey: PreySettings) -> list[Gait]:
    """Return what a prey can do, in the order of :data:`TURNS`: wheel speeds [m/s]."""
    differences = [0.5 * share * prey.turn_rate * prey.body.axle for _, share in TURNS]
    return [
        Gait(name, (prey.speed - part, prey.speed + part)) for (name, _), part in zip(TURNS, differences, strict=True)
    ]


def parallel_env(**settings: Any) -> HuntParallelEnv:
    """Return the environment in which both act at once; ``settings``: see :class:`HuntParallelEnv`."""
    return HuntParallelEnv(**settings)


def raw_env(**settings: Any) -> AECEnv:
    """Return the environment in which one acts after the other, without checks of the actions."""
    return parallel_to_aec(HuntParallelEnv(**settings))


def env(**settings: Any) -> AECEnv:
    """Return the environment in which one acts after the other; an action outside its space is an error."""
    return wrappers.OrderEnforcingWrapper(wrappers.AssertOutOfBoundsWrapper(raw_env(**settings)))


def _register() -> None:
    """Give both a name in PettingZoo's registry, which it has from 1.27 on."""
    if not hasattr(pettingzoo, "register"):
        return
    for kind, registry, maker in (
        ("aec", pettingzoo.aec_registry, "env"), ("parallel", pettingzoo.parallel_registry, "parallel_env"),
    ):  # fmt: skip
        if _ID not in registry:
            pettingzoo.register(kind, _ID, entry_point=f"{__name__}:{maker}")


_register()
