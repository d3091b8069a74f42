"""Waiting for a page without asking it to evaluate code, which its Content-Security-Policy forbids."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TypeVar

Result = TypeVar("Result")


def eventually(check: Callable[[], Result], seconds: float = 20.0) -> Result:
    """Repeat a check until it holds; its own AssertionError if it does not in time."""
    end = time.monotonic() + seconds
    while True:
        try:
            return check()
        except AssertionError:
            if time.monotonic() > end:
                raise
            time.sleep(0.1)


def wait_until(condition: Callable[[], bool], seconds: float = 20.0) -> None:
    """Wait until ``condition`` is true."""

    def check() -> None:
        assert condition()

    eventually(check, seconds)
