"""How a model of residuals is fitted: the motion first, then tables of what it misses, beside the poses' own counts."""

from __future__ import annotations

import contextlib
from typing import Any, NamedTuple

import pandas as pd

from bayeshunt.config.loading import recorded_gaits
from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.errors import BayesHuntError, InputError, did_you_mean
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.data import babbling_table
from bayeshunt.models.counting.joint import JointCounts
from bayeshunt.models.counting.previous import PreviousCounts
from bayeshunt.models.motion.residuals import UNICYCLE, Residuals, with_commands
from bayeshunt.models.tables.counted import ContextTables, CountedTables
from bayeshunt.models.tables.residual import ResidualTables

__all__ = ["ResidualFit", "residual_tables"]


class ResidualFit(NamedTuple):
    """What tables of residuals are counted from.

    table: the rows with residuals instead of poses. rows: as given. residuals: the motion and its bins. grid: ordinary
    bins, of the poses.
    """

    table: pd.DataFrame
    rows: pd.DataFrame
    residuals: Residuals
    grid: EffectAxes

    def source(self, inner: Any) -> ResidualTables:
        """Return the tables of residuals, given those that count ``table``."""
        assert isinstance(inner, (CountedTables, ContextTables))
        seen = type(inner.counted).of(self.rows, self.residuals.gaits, self.grid)
        assert isinstance(seen, (JointCounts, PreviousCounts))
        return ResidualTables(inner, self.residuals, seen)


def residual_tables(
    frame: pd.DataFrame, gaits: GaitRepertoire, grid: EffectAxes, residual_of: str | Residuals, *, lags: bool = False
) -> ResidualFit:
    """Fit the motion and choose the bins of what it misses, unless ``residual_of`` is one that was fitted.

    lags: the motion lags behind its commands, for tables that depend on the gait before.

    Raises DataError for a table that is none or a gait without a command, InputError for an unknown motion.
    """
    babbling_table.validate(frame, gaits.names)
    if isinstance(residual_of, Residuals):
        residuals = residual_of.after(None)
    elif residual_of == UNICYCLE:
        known = None
        with contextlib.suppress(BayesHuntError):  # a table may say nothing of its robot
            known = recorded_gaits(frame)
        residuals = Residuals.fit(frame, with_commands(gaits, frame, known), lags=lags)
    else:
        hint = did_you_mean(str(residual_of), [UNICYCLE])
        raise InputError(f"residual_of: unknown motion {residual_of!r}{hint}")
    return ResidualFit(residuals.of(frame), frame, residuals, grid)
