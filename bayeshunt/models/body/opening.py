"""Every number of a model can be opened: labelled tables, the counts and intervals behind them, the rows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any, Self

import numpy as np
import pandas as pd

from bayeshunt.core import statistics
from bayeshunt.core.bins import ENERGY, EffectAxes
from bayeshunt.core.checks import check_number
from bayeshunt.core.errors import DataError, InputError
from bayeshunt.core.gaits import Gait, GaitRepertoire
from bayeshunt.models.body.leaving_out import cells_of_row, remaining
from bayeshunt.models.body.rows import CountedRows
from bayeshunt.models.counting.cells import CountedCells
from bayeshunt.models.counting.energy import LEANING, energy_table, expected
from bayeshunt.models.counting.joint import JointCounts
from bayeshunt.models.counting.previous import PreviousCounts
from bayeshunt.models.tables import network
from bayeshunt.models.tables.probability_table import ProbabilityTable
from bayeshunt.models.tables.sources import TableSource
from bayeshunt.models.tables.structures import Structure

__all__ = ["OpenTables"]

_LEVEL = "a probability between 0 and 1"


class OpenTables:
    """What a person asks of a model's tables; a forward model is one.

    source: where the tables come from. data: the babbling tables counted, if they are at hand.
    """

    source: TableSource
    whole: Self | None
    data: tuple[pd.DataFrame, ...]

    @property
    def gaits(self) -> GaitRepertoire:
        """The repertoire, in table order."""
        return self.source.gaits

    @property
    def axes(self) -> EffectAxes:
        """The bins of Distance, Angle and Heading."""
        return self.source.axes

    @property
    def structure(self) -> Structure:
        """The edges among Gait, PreviousGait, Distance, Angle and Heading."""
        return self.source.structure

    @property
    def joint(self) -> JointCounts:
        """The counts behind every table; nothing is counted in those of an imported network."""
        return self.source.joint

    @property
    def prior(self) -> float:
        """Dirichlet pseudo-count per cell, >= 0; 0 gives maximum-likelihood tables."""
        return self.source.prior

    @property
    def gait_prior(self) -> str:
        """How P(Gait) is made: "uniform" (it is set, as in the paper) or "empirical" (estimated)."""
        return self.source.gait_prior

    @property
    def backoff(self) -> float | None:
        """Rows that P(effect | Gait) is worth in the tables given the gait before; None: no back-off."""
        return self.source.backoff

    @property
    def known(self) -> Mapping[str, str]:
        """States of other variables that the tables are conditioned on: {"PreviousGait": name} or {}."""
        return self.source.known

    @property
    def support(self) -> np.ndarray | None:
        """Int64 [D, A]: rows that fell into each (Distance, Angle) cell; None in an imported network."""
        return self.source.support

    @property
    def has_counts(self) -> bool:
        """Whether the counts behind the tables are known; False for an imported network."""
        return self.source.support is not None

    @property
    def by_previous(self) -> PreviousCounts | None:
        """The counts by the gait before; None unless the structure has it as a cause."""
        counted = self.source.counted
        return counted if isinstance(counted, PreviousCounts) else None

    @property
    def counted_cells(self) -> CountedCells:
        """The counts over every variable of the network."""
        return self.source.cells

    @property
    def knows_energy(self) -> bool:
        """Whether the rows counted say what each gait cost."""
        return bool(self._whole().joint.energy.size)

    def energy(
        self, gait: Gait | str | None = None, previous_gait: Gait | str | None = None, level: float = 0.95
    ) -> pd.DataFrame:
        """Return what gaits cost, E[energy | gait, gait before], with its counts and intervals.

        One row for each gait whatever went before it (``previous_gait`` None), then one for each pair babbled:
        previous_gait, gait, rows, mean_j [J], low_j and high_j (Student's interval of the mean), sd_j.
        gait, previous_gait: only the rows of these; of the model after a gait, only what follows that gait.

        Raises InputError if no row counted says its energy, or for a gait that is not in the repertoire.
        """
        if not 0.0 < check_number(level, "level", _LEVEL) < 1.0:
            raise InputError(f"level: expected {_LEVEL}, got {level}")
        frame = energy_table(self._tally(), self.gaits.names, level)
        before = self.known.get("PreviousGait") if previous_gait is None else previous_gait
        if before is not None:
            frame = frame[frame["previous_gait"] == self.gaits.names[self.gaits.index(before)]]
        if gait is not None:
            frame = frame[frame["gait"] == self.gaits.names[self.gaits.index(gait)]]
        return frame.reset_index(drop=True)

    def expected_energy(self, previous_gait: Gait | str | None = None) -> np.ndarray:
        """Return the expected energy [J] of every gait [G], after ``previous_gait`` if one is given.

        After a gait it leans on the mean of all rows of the gait, as the tables do with back-off: that is worth
        ``backoff`` rows, 5 where the model has none. NaN for a gait that was never babbled.

        Raises InputError if no row counted says its energy.
        """
        before = self.known.get("PreviousGait") if previous_gait is None else previous_gait
        number = None if before is None else self.gaits.index(before)
        return expected(self._tally(), number, LEANING if self.backoff is None else self.backoff)

    def _whole(self) -> Self:
        return self if self.whole is None else self.whole

    def _tally(self) -> np.ndarray:
        tally = self._whole().joint.energy
        if not tally.size:
            raise InputError(
                "the rows of this model do not say what gaits cost: babble with a body that measures its energy, "
                "or give the table a column energy [J]"
            )
        return tally

    def probabilities(self, variable: str) -> np.ndarray:
        """Return a read-only CPT: [K, G] P(variable | Gait), columns sum to 1; [G] for "Gait".

        In other structures than the paper's, other parents are summed over; see :attr:`local_tables`.

        Raises ZeroCountError if a gait has neither rows nor prior, InputError for another variable.
        """
        self._check_variable(variable)
        return self._tables[variable]

    @property
    def local_tables(self) -> dict[str, np.ndarray]:
        """The network's own tables: P(cause) [G] of each cause and P(effect | parents) [K, ...parents] of each effect.

        Parents are in alphabetical order (``structure.parents``). In the paper's structure these are
        the tables of :meth:`probabilities`. Otherwise, with prior 0, a column whose parents were
        never seen together is 0 throughout: it cannot be reached.
        """
        return self.source.local

    @property
    def states(self) -> dict[str, list[str]]:
        """Names of the states of each variable of the network, in table order: gait names and bin labels."""
        return self.source.states

    @cached_property
    def network(self) -> Any:
        """The model as a pgmpy DiscreteBayesianNetwork; its states are :attr:`states` (of residuals: of ``binned``)."""
        tables = self.source.binned
        return network.build(tables.local, tables.states, tables.structure)

    @property
    def mean_paths(self) -> np.ndarray | None:  # [G, P + 1, 3]: forward m, right m, heading rad
        """Mean pose of each gait after each of its P + 1 equal intervals; None without path columns.

        The last is the mean final pose; heading is clockwise. Exact sums of the rows, not of bins. In the part
        of a model: of a gait that never followed there, over all rows.
        """
        return self.source.mean_paths

    @property
    def learned_cells(self) -> np.ndarray:
        """Int64 [M, 2]: the (Distance, Angle) bins that babbled rows fell into, sorted.

        Of an imported network: those of positive probability. Of a part without rows: those of the whole model.
        """
        return self.source.learned_cells

    @cached_property
    def _tables(self) -> dict[str, np.ndarray]:
        derived = {effect: self.source.marginal(effect) for effect in self.structure.effects}
        for table in derived.values():
            table.setflags(write=False)
        return {**derived, "Gait": self.source.causes["Gait"]}

    @cached_property
    def _counted_rows(self) -> CountedRows:
        """The rows that the model has counted."""
        frames = (self.source.select(frame) for frame in self.data)
        return CountedRows(self.joint, [frame for frame in frames if len(frame)], self.source.recast)

    def cpt(self, variable: str) -> pd.DataFrame:
        """Return a CPT to look at: rows = bins, columns = gaits; "Gait": one column "probability"."""
        return self._labelled(variable, self.probabilities(variable), "probability")

    def counts(self, variable: str) -> pd.DataFrame:
        """Return the integer counts behind :meth:`cpt`, same rows and columns ("Gait": "count").

        Raises InputError for an imported network.
        """
        self._check_variable(variable)
        if not self.has_counts:
            raise InputError("an imported network has probabilities but no counts; ask for its cpt")
        return self._labelled(variable, self.joint.marginal(variable), "count")

    def rows(self, variable: str, bin: str | int, gait: Gait | str | None = None) -> pd.DataFrame:
        """Return the babbling rows behind a table cell, as many as :meth:`counts` says, in their order.

        variable: "Distance", "Angle" or "Heading"; "Gait" then takes a gait as ``bin``.
        bin: label or number of the bin. gait: column of the table; None: the rows of every gait.

        Raises DataError if the model holds no rows (see :meth:`with_data`), InputError for an unknown name.
        """
        self._check_variable(variable)
        self._check_rows()
        return self._counted_rows.find(variable, bin, gait)

    def uses(self, row: Any) -> pd.DataFrame:
        """Return the table cells that count a row: variable, state, given (the parents' states), count, probability.

        row: its index label, the row itself (a Series), or a table of one row.
        Raises DataError if the model holds no rows (see :meth:`with_data`), InputError for a row that it never counted.
        """
        self._check_rows()
        return cells_of_row(self.source, self._counted_rows, row)

    def without(self, rows: Any) -> Self:
        """Return the model fitted to all rows but these, with the same edges, prior and bins (as far as rows reach).

        rows: a table of some of the rows (those of :meth:`rows`), or index labels.
        Raises DataError if the model holds no rows (see :meth:`with_data`) or if a gait loses its last; InputError for
        rows that it never counted, and for the part of a model.
        """
        self._check_rows()
        if self.known:
            raise InputError("this is the part of a model; leave rows out of the whole model")
        axes, reach = self.source.outcome_axes, self.joint.cells[:, 1].max(initial=0) + 1
        grown = axes.distance.bins == reach or self.source.residuals is not None  # else the bins were given so many
        if grown:
            energy = None if axes.energy is None else replace(axes.energy, bins=1)
            axes = replace(axes, distance=replace(axes.distance, bins=1), energy=energy)
        whole: Any = type(self)
        fitted: Self = whole.fit(
            remaining(self._counted_rows, rows), self.gaits, self.prior,
            axes=axes, gait_prior=self.gait_prior, structure=self.structure, backoff=self.backoff,
            residual_of=self.source.residuals,
        )  # fmt: skip
        return fitted

    def _check_rows(self) -> None:
        if not self.has_counts:
            raise DataError("an imported network has no counts, so it has no rows behind them")

    def table(self, variable: str, level: float = 0.95) -> ProbabilityTable:
        """Return a CPT with its counts and credible intervals, a table that shows itself in a notebook.

        P(Gait) has no intervals (None) where it is set to uniform: nobody estimated it. An imported network
        has no counts either. Where the structure gives the variable other parents than the gait, they are summed
        over; ``local_tables`` has the tables with all parents.
        """
        self._check_variable(variable)
        others = tuple(p for p in self.structure.parents(variable) if p not in ("Gait", *self.known))
        if not self.has_counts:
            probability = self.cpt(variable)
            return ProbabilityTable(
                self._named(variable), probability, None, None, None, level, None, summed_over=others
            )
        low = high = None
        if not self._is_set(variable):
            low, high = self.credible_interval(variable, level)
        return ProbabilityTable(
            self._named(variable), self.cpt(variable), self.counts(variable), low, high, level, self.prior, self.known,
            others, self,
        )  # fmt: skip

    def credible_interval(self, variable: str, level: float = 0.95) -> tuple[pd.DataFrame, pd.DataFrame]:
        """Return the lower and upper bound of each cell's credible interval, shaped as :meth:`cpt`.

        level: probability inside the interval, in (0, 1). With prior 0, the Jeffreys interval.
        Raises InputError for a P(Gait) that is set to uniform: what nobody estimated has no interval.
        """
        self._check_variable(variable)
        if not self.has_counts:
            raise InputError("an imported network has probabilities but no counts, so it has no intervals")
        if self._is_set(variable):
            raise InputError(
                "P(Gait) is set to uniform, not estimated, so it has no interval; fit with gait_prior='empirical'"
            )
        if not 0.0 < check_number(level, "level", _LEVEL) < 1.0:
            raise InputError(f"level: expected {_LEVEL}, got {level}")
        counts = self.joint.marginal(variable)
        column = counts[:, None] if variable == "Gait" else counts
        low, high = statistics.credible_interval(column, self.source.pseudo_counts(variable), level=level)
        if variable == "Gait":
            low, high = low[:, 0], high[:, 0]
        return self._labelled(variable, low, "low"), self._labelled(variable, high, "high")

    def _named(self, variable: str) -> str:
        """What a table is of: "Distance", in a model of residuals "Distance residual"."""
        return f"{variable} residual" if self.source.residual_of and variable != "Gait" else variable

    def _is_set(self, variable: str) -> bool:
        """Whether a table was chosen rather than estimated."""
        return variable == "Gait" and self.gait_prior == "uniform"

    def _check_variable(self, variable: str) -> None:
        known = ("Gait", *self.structure.effects)
        if variable not in known:
            fix = "; fit it with effects=[..., 'Energy']" if variable == ENERGY else ""
            raise InputError(f"unknown variable {variable!r}: expected one of {', '.join(known)}{fix}")

    def _labelled(self, variable: str, values: np.ndarray, column: str) -> pd.DataFrame:
        if variable == "Gait":
            return pd.DataFrame({column: values}, index=pd.Index(self.gaits.names, name="Gait"))
        index = pd.Index(self.axes[variable].labels, name=self._named(variable))
        return pd.DataFrame(values.copy(), index=index, columns=pd.Index(self.gaits.names, name="Gait"))
