"""Which robot rows are of: what names of gaits leave open, the record of the table or the bins may say."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from bayeshunt.config.loading import recorded_gaits
from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.errors import ConfigError, InputError
from bayeshunt.core.gaits import Gait, GaitRepertoire

__all__ = ["measured"]


def measured(
    gaits: Iterable[Gait | str] | GaitRepertoire, axes: EffectAxes | None, record: Mapping[str, Any] | None = None
) -> tuple[GaitRepertoire, EffectAxes]:
    """Return a repertoire that knows what can be known of its robot, and the bins, by default the standard ones.

    record: the provenance of the rows. A measure that the repertoire does not know is that of the robot which the
        record names, or of the body that ``axes`` were made for.

    Raises InputError if no bins are given and nobody knows the body length that they are made for.
    """
    given = GaitRepertoire.of(gaits)
    body, duration = given.body_length, given.duration
    if record and (body is None or duration is None):
        with contextlib.suppress(InputError, ConfigError):  # a table may say nothing of its robot, or nothing of use
            robot = recorded_gaits(record)
            body, duration = body or robot.body_length, duration or robot.duration
    if body is None and axes is not None:
        body = axes.body_length
    return replace(given, body_length=body, duration=duration), axes or EffectAxes.standard(body)
