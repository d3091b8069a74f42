"""Which Box2D runs here. Two packages bring it under one name, so only the library itself can say."""

from __future__ import annotations

__all__ = ["version"]


def version() -> str:
    """Return the version of Box2D, whichever package brought it."""
    import Box2D

    return str(Box2D.__version__)
