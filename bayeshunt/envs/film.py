"""A hunt at the pace of the control interval, so that whatever records one frame a step makes a film."""

from __future__ import annotations

from typing import Any

import gymnasium

__all__ = ["Film"]


class Film(gymnasium.Wrapper[Any, Any, Any, Any], gymnasium.utils.RecordConstructorArgs):
    """One step is one control interval: ``RecordVideo(Film(gymnasium.make("bayeshunt.envs:Hunt-v0", ...)), ...)``.

    A gait that was begun is executed to its end whatever actions follow; the observation stays that of its beginning
    until then, and so the same policy takes the same decisions. The whole reward comes with the last interval of a
    gait. Its frames show one interval after the other: one at the reset, then one a step, in real time.
    """

    def __init__(self, env: gymnasium.Env[Any, Any]) -> None:
        gymnasium.utils.RecordConstructorArgs.__init__(self)
        super().__init__(env)
        self._before: tuple[Any, dict[str, Any]] = None, {}
        self._after: tuple[Any, Any, bool, bool, dict[str, Any]] | None = None
        self._left: list[Any] = []

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Start a hunt."""
        self._after, self._left = None, []
        self._before = self.env.reset(seed=seed, options=options)
        return self._before

    def step(self, action: Any) -> tuple[Any, Any, bool, bool, dict[str, Any]]:
        """Show the next control interval of the gait in progress; begin the gait ``action`` if there is none."""
        hunt: Any = self.unwrapped
        if self._after is None:
            self._after = self.env.step(action)
            self._left = list(hunt.moments)[::-1]
        hunt.shown = self._left.pop()
        if self._left:
            seen, info = self._before
            return seen.copy(), 0.0, False, False, dict(info)
        after, self._after = self._after, None
        self._before = after[0], after[4]
        return after
