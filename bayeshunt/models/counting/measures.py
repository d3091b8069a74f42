"""Which robot rows are of: what names of gaits leave open, the record of the table or the bins may say."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from bayeshunt.config.loading import recorded_gaits
from bayeshunt.config.plausibility import warn_of_mixed_motion
from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.errors import ConfigError, InputError
from bayeshunt.core.gaits import Gait, GaitRepertoire

__all__ = ["check_record", "check_rows", "measured"]


def measured(
    gaits: Iterable[Gait | str] | GaitRepertoire, axes: EffectAxes | None, record: Mapping[str, Any] | None = None
) -> tuple[GaitRepertoire, EffectAxes]:
    """Return a repertoire that knows what can be known of its robot, and the bins, by default the standard ones.

    record: the provenance of the rows. A measure that the repertoire does not know is that of the robot which the
        record names, or of the body that ``axes`` were made for.

    Raises InputError if the record names another robot, see :func:`check_record`, or if no bins are given and nobody
    knows the body length that they are made for.
    """
    given = GaitRepertoire.of(gaits)
    robot = check_record(given, record, "the gaits given")
    body, duration = given.body_length, given.duration
    if robot is not None:
        body, duration = body or robot.body_length, duration or robot.duration
    if body is None and axes is not None:
        body = axes.body_length
    return replace(given, body_length=body, duration=duration), axes or EffectAxes.standard(body)


def check_record(gaits: GaitRepertoire, record: Mapping[str, Any] | None, whose: str) -> GaitRepertoire | None:
    """Return the gaits of the robot that the record of rows names; None if it names none.

    whose: what a message calls ``gaits``.

    Raises InputError in one line if body length, duration or the command of a gait of that name are others than those
    of ``gaits``: its rows say nothing of this robot.
    """
    try:
        robot = recorded_gaits(record or {})
    except (InputError, ConfigError):  # a table may say nothing of its robot, or nothing of use
        return None
    names = [name for name in gaits.names if name in robot.names]  # any choice and order of them
    if names:
        own, its = (replace(each, gaits=tuple(each[name] for name in names)) for each in (gaits, robot))
        if record and record.get("body_length_given") is False:  # a guess, made for the bins
            its = replace(its, body_length=None)
        if (difference := its.difference(own, "the table's robot", whose)) is not None:
            raise InputError(f"{difference}; give a table of this robot, or the gaits of the robot that made it")
    return robot


def check_rows(gaits: GaitRepertoire, provenance: Mapping[str, Any], record: Mapping[str, Any] | None) -> None:
    """Hold the record of rows to a model of ``gaits`` and ``provenance``, which is to count or to foresee them.

    Raises InputError if they are of another robot, see :func:`check_record`; issues a DataWarning if theirs has the
    same gaits, but a body or a noise that moves it otherwise.
    """
    check_record(gaits, record, "the model's robot")
    warn_of_mixed_motion(record, provenance)
