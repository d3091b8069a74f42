"""Ctrl-C and SIGTERM: one line that says what is kept and how to go on; exit status 130."""

from __future__ import annotations

import contextlib
import signal
from collections.abc import Callable, Iterator

__all__ = ["StoppedError", "stoppable"]


class StoppedError(Exception):
    """The user stopped the work; the text says what is kept."""


@contextlib.contextmanager
def stoppable(kept: Callable[[], str]) -> Iterator[None]:
    """Turn Ctrl-C and SIGTERM within the block into :class:`StoppedError`.

    kept: called once the work has stopped; returns what is kept and how to go on.
    """
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    except KeyboardInterrupt:
        raise StoppedError(f"stopped; {kept()}") from None
    finally:
        signal.signal(signal.SIGTERM, before)
