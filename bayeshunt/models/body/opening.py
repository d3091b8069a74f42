"""Every number of a model can be opened: labelled tables, the counts and intervals behind them, the rows."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

import numpy as np
import pandas as pd

from bayeshunt.core import statistics
from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.checks import check_number
from bayeshunt.core.errors import InputError
from bayeshunt.core.gaits import Gait, GaitRepertoire
from bayeshunt.models.tables import network
from bayeshunt.models.tables.probability_table import ProbabilityTable

if TYPE_CHECKING:
    from bayeshunt.models.body.rows import CountedRows
    from bayeshunt.models.counting.joint import JointCounts

_LEVEL = "a probability between 0 and 1"


class OpenTables(ABC):
    """What a person asks of a model's tables; a forward model is one.

    joint: the counts behind every table. prior: Dirichlet pseudo-count per cell.
    gait_prior: "uniform" (P(Gait) is set) or "empirical" (estimated).
    """

    joint: JointCounts
    prior: float
    gait_prior: str
    known: ClassVar[Mapping[str, str]] = {}  # states of other variables that the tables are conditioned on

    @property
    def gaits(self) -> GaitRepertoire:
        """The repertoire, in table order."""
        return self.joint.gaits

    @property
    def axes(self) -> EffectAxes:
        """The bins of Distance, Angle and Heading."""
        return self.joint.axes

    @abstractmethod
    def probabilities(self, variable: str) -> np.ndarray:
        """Return a read-only CPT: [K, G] P(variable | Gait), or [G] for "Gait"."""

    @property
    @abstractmethod
    def _counted_rows(self) -> CountedRows:
        """The rows that the model has counted."""

    def cpt(self, variable: str) -> pd.DataFrame:
        """Return a CPT to look at: rows = bins, columns = gaits; "Gait": one column "probability"."""
        return self._labelled(variable, self.probabilities(variable), "probability")

    def counts(self, variable: str) -> pd.DataFrame:
        """Return the integer counts behind :meth:`cpt`, same rows and columns ("Gait": "count")."""
        self._check_variable(variable)
        return self._labelled(variable, self.joint.marginal(variable), "count")

    def rows(self, variable: str, bin: str | int, gait: Gait | str | None = None) -> pd.DataFrame:
        """Return the babbling rows behind a table cell, as many as :meth:`counts` says, in their order.

        variable: "Distance", "Angle" or "Heading"; "Gait" then takes a gait as ``bin``.
        bin: label or number of the bin. gait: column of the table; None: the rows of every gait.

        Raises DataError if the model holds no rows (see :meth:`with_data`), InputError for an unknown name.
        """
        self._check_variable(variable)
        return self._counted_rows.find(self, variable, bin, gait)

    def table(self, variable: str, level: float = 0.95) -> ProbabilityTable:
        """Return a CPT with its counts and credible intervals, a table that shows itself in a notebook.

        P(Gait) has no intervals (None) where it is set to uniform: nobody estimated it.
        """
        low = high = None
        if not self._is_set(variable):
            low, high = self.credible_interval(variable, level)
        return ProbabilityTable(
            variable, self.cpt(variable), self.counts(variable), low, high, level, self.prior, self.known
        )

    def credible_interval(self, variable: str, level: float = 0.95) -> tuple[pd.DataFrame, pd.DataFrame]:
        """Return the lower and upper bound of each cell's credible interval, shaped as :meth:`cpt`.

        level: probability inside the interval, in (0, 1). With prior 0, the Jeffreys interval.
        Raises InputError for a P(Gait) that is set to uniform: what nobody estimated has no interval.
        """
        self._check_variable(variable)
        if self._is_set(variable):
            raise InputError(
                "P(Gait) is set to uniform, not estimated, so it has no interval; fit with gait_prior='empirical'"
            )
        if not 0.0 < check_number(level, "level", _LEVEL) < 1.0:
            raise InputError(f"level: expected {_LEVEL}, got {level}")
        counts = self.joint.marginal(variable)
        column = counts[:, None] if variable == "Gait" else counts
        low, high = statistics.credible_interval(column, self.prior, level=level)
        if variable == "Gait":
            low, high = low[:, 0], high[:, 0]
        return self._labelled(variable, low, "low"), self._labelled(variable, high, "high")

    def _is_set(self, variable: str) -> bool:
        """Whether a table was chosen rather than estimated."""
        return variable == "Gait" and self.gait_prior == "uniform"

    def _check_variable(self, variable: str) -> None:
        if variable not in network.VARIABLES:
            raise InputError(f"unknown variable {variable!r}: expected one of {', '.join(network.VARIABLES)}")

    def _labelled(self, variable: str, values: np.ndarray, column: str) -> pd.DataFrame:
        if variable == "Gait":
            return pd.DataFrame({column: values}, index=pd.Index(self.gaits.names, name="Gait"))
        index = pd.Index(self.axes[variable].labels, name=variable)
        return pd.DataFrame(values.copy(), index=index, columns=pd.Index(self.gaits.names, name="Gait"))
