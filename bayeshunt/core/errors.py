"""Every error that bayeshunt raises on purpose: what went wrong, where, and what to do about it.

The command line prints the message on one line and exits with 2 for an :class:`InputError`
and with 1 for any other :class:`BayesHuntError`.
"""

from __future__ import annotations

import contextlib
import difflib
import sys
import warnings
from collections.abc import Iterable, Iterator
from typing import Any

__all__ = [
    "BayesHuntError",
    "ConfigError",
    "DataError",
    "DataWarning",
    "DeprecatedNameWarning",
    "FolderInUseError",
    "ImpossibleEvidenceError",
    "InputError",
    "ModelFileError",
    "NothingObservedError",
    "ResultsError",
    "WorkerError",
    "ZeroCountError",
    "did_you_mean",
    "shown",
    "unwarned",
    "warn",
]


class BayesHuntError(Exception):
    """Base class of every error raised on purpose by bayeshunt."""


class InputError(BayesHuntError, ValueError):
    """What the caller gave is wrong: the message names the place and the fix."""


class ConfigError(InputError):
    """A settings file or preset is wrong: file, key, what was expected."""


class DataError(InputError):
    """A babbling table is wrong: file, row or column, what was expected."""


class DataWarning(UserWarning):
    """Numbers that can be right but hardly are: degrees for radians, millimetres for metres. Says the fix."""


class DeprecatedNameWarning(DeprecationWarning):
    """A name that is to go. Says what to write instead, and in which version it goes."""


class ModelFileError(InputError):
    """A model file cannot be read: damaged, edited, of another kind or of a newer format."""


class ResultsError(InputError):
    """A folder of results cannot be used: damaged, of another experiment, or of a newer format."""


class FolderInUseError(BayesHuntError):
    """Another process is working in the same results folder."""


class WorkerError(BayesHuntError):
    """Worker processes keep dying, so the work cannot be finished."""


class ImpossibleEvidenceError(BayesHuntError, ValueError):
    """P(evidence) = 0 under the model, so there is no posterior to give."""


class ZeroCountError(BayesHuntError, ValueError):
    """A probability was asked of a table column in which nothing has been counted."""


class NothingObservedError(BayesHuntError, ValueError):
    """A prediction was asked of an online model that has not observed anything yet."""


def warn(message: str) -> None:
    """Issue a DataWarning at the line outside of bayeshunt that led here."""
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and str(frame.f_globals.get("__name__", "")).partition(".")[0] == "bayeshunt":
        frame, level = frame.f_back, level + 1
    warnings.warn(message, DataWarning, stacklevel=level)


@contextlib.contextmanager
def unwarned() -> Iterator[None]:
    """Issue no DataWarning meanwhile: for work on numbers that no user has given, such as what a hunt asks a model."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DataWarning)
        yield


def shown(value: Any) -> str:
    """Return what an error says of ``value``, in one line: plain values as they are written, others by their type."""
    if value is None or isinstance(value, (bool, int, float, str)):
        return repr(value)
    return f"a value of type {type(value).__name__}"


def did_you_mean(name: Any, known: Iterable[str], *, listed: bool = True) -> str:
    """Return how an error about an unknown ``name`` ends: "; did you mean 'planning'?", or else what there is.

    known: the names that there are. listed: end with "; expected one of ..." where none of them is near; without
        it, or if there are none, return "".
    """
    names = list(map(str, known))
    near = difflib.get_close_matches(name, names, n=1) if isinstance(name, str) else []
    if near:
        return f"; did you mean {near[0]!r}?"
    return f"; expected one of {', '.join(names)}" if listed and names else ""
