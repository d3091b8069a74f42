"""MuJoCo, imported when it is needed: it is an extra, and one line says how it is installed."""

from __future__ import annotations

from typing import Any

from bayeshunt.core.errors import InputError

__all__ = ["load"]


def load() -> Any:
    """Return the module ``mujoco`` with its ``rollout``; InputError with the pip command where it is absent."""
    try:
        import mujoco
        import mujoco.rollout
    except ImportError:
        raise InputError(
            "this robot moves in MuJoCo, which is not installed; install it with: pip install '.[mujoco]' "
            "in bayeshunt's folder"
        ) from None
    return mujoco
