"""The hunt as a Gymnasium environment: one step is one gait."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium.utils import EzPickle
from numpy.typing import NDArray

from bayeshunt.core.checks import check_radians
from bayeshunt.core.errors import InputError, did_you_mean
from bayeshunt.core.gaits import Gait
from bayeshunt.core.messages import Moment
from bayeshunt.envs.choosing import FPS, Rewards, experiment_of, report, start_of
from bayeshunt.envs.drawing import Canvas
from bayeshunt.episodes.pursuit import Pursuit
from bayeshunt.planners.policy import bounds, observation

__all__ = ["HuntEnv"]


class HuntEnv(gymnasium.Env[NDArray[np.float32], Any], EzPickle):
    """A robot hunts a prey; an action is a gait, held for one time-step. See docs/environments.md.

    arena: one of the experiment's. robot: a robot's preset name or TOML path; None: the preset's own.
    preset: an experiment's name or TOML path; None: the one that runs where none is named. sensing: the name of a
    sensor, or values of the group "sensing". theta: bearing of the prey at the start [rad, clockwise]; None: one of
    the protocol's. overrides: settings by dotted key. reward: "time" or "shaped". render_mode: None, "rgb_array" or
    "human".

    pursuit: the hunt itself, to look at. moments: what the last step did, interval by interval. ``render`` draws
    ``shown``, one of them: the last, unless a :class:`~bayeshunt.envs.film.Film` says another. A pickle or a copy of
    it is a new environment made with the same arguments.

    Raises InputError in one line for an argument that cannot be used.
    """

    metadata: dict[str, Any] = {"render_modes": ["human", "rgb_array"], "render_fps": FPS}  # noqa: RUF012
    #: Bumped when the same seed and actions give other numbers.
    version: ClassVar[int] = 0

    def __init__(
        self, arena: str = "walled", robot: str | None = None, preset: str | None = None,
        sensing: str | Mapping[str, Any] | None = None, theta: float | None = None,
        overrides: Mapping[str, Any] | None = None, reward: str = "time", render_mode: str | None = None,
    ) -> None:  # fmt: skip
        EzPickle.__init__(self, arena, robot, preset, sensing, theta, overrides, reward, render_mode)
        modes = self.metadata["render_modes"]
        if render_mode is not None and render_mode not in modes:
            raise InputError(f"render_mode: unknown mode {render_mode!r}{did_you_mean(render_mode, modes)}")
        self.settings = experiment_of(preset, robot, sensing, overrides)
        if theta is not None:
            check_radians(theta, "theta")
        self.settings.check_arena(arena, theta)
        self.arena, self.theta, self.render_mode = arena, theta, render_mode
        self.metadata = {**self.metadata, "render_fps": 1.0 / self.settings.physics.control_interval}
        self._rewards = Rewards(reward, self.settings.protocol.time_limit)
        gaits = self.settings.robot.gaits
        self.action_space = gymnasium.spaces.Discrete(len(gaits))
        low, high = bounds(gaits)
        self.observation_space = gymnasium.spaces.Box(low, high, dtype=np.float32)
        self.pursuit: Pursuit | None = None
        self.moments: Sequence[Moment] = ()
        self.shown: Moment | None = None
        self._episode = 0.0, 0
        self._over = True
        self._canvas: Canvas | None = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Start a hunt; ``options``: its "theta" [rad] and "hunt_seed", those of :func:`bayeshunt.hunt`."""
        super().reset(seed=seed)
        theta, hunt_seed = self._episode = start_of(self.settings, self.theta, options, self.np_random)
        self.pursuit = Pursuit(self.settings, self.arena, theta, hunt_seed)
        self._rewards.start(self.pursuit)
        self._over = False
        self._show((self.pursuit.moment,))
        return observation(self.pursuit.situation, self.pursuit.gaits), report(self.pursuit, *self._episode)

    def step(self, action: Any) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Hold a gait for one time-step, until the catch (terminated) or the time limit (truncated).

        Raises InputError naming the gaits for another action, and after the end.
        """
        return self.advance(action, None)

    def advance(self, action: Any, prey: Gait | None) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Step, while the prey holds a gait of its own, its wheel speeds [m/s]; None: it steers itself."""
        pursuit = self.pursuit
        if pursuit is None or self._over:
            raise InputError("step: no hunt is running; call reset() first")
        number = pursuit.gaits.number(action)
        if not pursuit.done:  # a prey that starts within reach is caught before the first gait
            pursuit.step(number, prey)
            self._show(pursuit.moments)
        reward = self._rewards.step(pursuit)
        caught, done = bool(pursuit.caught), bool(pursuit.done)
        self._over = done
        seen = observation(pursuit.situation, pursuit.gaits)
        return seen, reward, caught, done and not caught, report(pursuit, *self._episode)

    def render(self) -> NDArray[np.uint8] | None:
        """Return a frame [400, 400, 3] in the mode "rgb_array"; "human" draws by itself."""
        if self.render_mode is None:
            gymnasium.logger.warn('render: no render_mode was given; make the environment with render_mode="rgb_array"')
            return None
        if self.shown is None:
            raise InputError("render: no hunt is running; call reset() first")
        if self.render_mode == "rgb_array":
            return self._drawn(self.shown).frame()
        return None

    def close(self) -> None:
        """Close the window, if there is one; may be called twice."""
        if self._canvas is not None:
            self._canvas.close()
            self._canvas = None

    def _show(self, moments: Sequence[Moment]) -> None:
        self.moments, self.shown = moments, moments[-1]
        if self.render_mode == "human":
            for moment in moments:
                self._drawn(moment).flip(self.metadata["render_fps"])

    def _drawn(self, moment: Moment) -> Canvas:
        if self._canvas is None:
            self._canvas = Canvas(self.settings, self.arena, window=self.render_mode == "human")
        self._canvas.draw(moment)
        return self._canvas
