"""What a prey's behaviour is called when it is no program but a recording."""

from __future__ import annotations

__all__ = ["RECORDED", "is_recorded"]

#: How ``prey.behaviour`` names a recorded prey: "recorded:tracks.parquet#17".
RECORDED = "recorded:"


def is_recorded(behaviour: str) -> bool:
    """Return whether a prey's behaviour is the name of a recorded one."""
    return behaviour.startswith(RECORDED)
