"""The forward model: what each gait does, as probability tables learned from babbling.

Naive Bayes network Gait -> Distance, Angle, Heading (the paper, section "Forward model"): complete
data, known structure, uniform P(Gait), maximum-likelihood tables or a symmetric Dirichlet prior.
Other structures can be chosen (``models.structures``); everything asked of the model stays the same.
Letters: G gaits, K bins of a variable, P part-way poses of a gait.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from operator import methodcaller
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core import displays
from bayeshunt.core.arguments import checked, checked_but
from bayeshunt.core.bins import ENERGY, EffectAxes
from bayeshunt.core.errors import DataError, InputError
from bayeshunt.core.gaits import Gait, GaitRepertoire
from bayeshunt.data import babbling_table
from bayeshunt.data.plausibility import warn_implausible
from bayeshunt.models.body.foreseeing import ForeseeingModel
from bayeshunt.models.body.residual_fit import residual_tables
from bayeshunt.models.body.storing import WritableModel
from bayeshunt.models.counting.auto_axes import chosen_axes, with_energy
from bayeshunt.models.counting.joint import JointCounts
from bayeshunt.models.counting.measures import check_rows, measured
from bayeshunt.models.counting.previous import PreviousCounts, counts_for
from bayeshunt.models.motion.residuals import Residuals
from bayeshunt.models.tables import network, structures
from bayeshunt.models.tables.counted import ContextTables, CountedTables, check_every_gait_seen, shares, tables_of
from bayeshunt.models.tables.given import GivenTables
from bayeshunt.models.tables.sources import TableSource
from bayeshunt.models.tables.structures import PREVIOUS, Structure, check_hunting, depends_on_previous

__all__ = ["ForwardModel"]


@dataclass(frozen=True, eq=False, repr=False, init=False)
class ForwardModel(displays.Displayed, ForeseeingModel, WritableModel):
    """P(Gait), P(Distance | Gait), P(Angle | Gait), P(Heading | Gait), and the counts behind them.

    source: where the tables come from: counted rows, rows counted by the gait before, or another program's network.
    provenance: where the rows came from: ``{"sources": [record of each babbling table]}``.
    data: the babbling tables counted, kept by reference for :meth:`rows`; a loaded model has none.
    whole: the model that this is a part of, see :meth:`given`; None: it is whole.
    """

    source: TableSource
    provenance: Mapping[str, Any]
    data: tuple[pd.DataFrame, ...]
    whole: ForwardModel | None

    @checked
    def __init__(
        self,
        joint: JointCounts | PreviousCounts,
        prior: float | None = None,
        gait_prior: str = "uniform",
        provenance: Mapping[str, Any] | None = None,
        data: tuple[pd.DataFrame, ...] = (),
        structure: Structure | None = None,
        backoff: float | None = None,
    ) -> None:
        """Make a model of counts as they are; :meth:`fit` and :meth:`from_counts` also check them.

        joint: the sufficient statistics; every table is derived from them and from the prior.
        prior: Dirichlet pseudo-count per cell, >= 0; 0 gives maximum-likelihood tables.
        gait_prior: "uniform" (the paper) or "empirical".
        structure: the edges; by default the paper's, or PREVIOUS_GAIT for counts by the gait before.
        backoff: rows of back-off of counts by the gait before; None: none.
        """
        self._set(tables_of(joint, prior, gait_prior, structure, backoff), provenance or {}, data)

    def _set(
        self, source: TableSource, provenance: Mapping[str, Any], data: tuple[pd.DataFrame, ...] = (),
        whole: ForwardModel | None = None,
    ) -> None:  # fmt: skip
        fields = {"source": source, "provenance": copy.deepcopy(dict(provenance)), "data": data, "whole": whole}
        for name, value in fields.items():  # the caller's provenance may change
            object.__setattr__(self, name, value)

    @classmethod
    @checked
    def over(
        cls, source: TableSource, provenance: Mapping[str, Any] | None = None, data: tuple[pd.DataFrame, ...] = ()
    ) -> ForwardModel:
        """Return the model of a table source."""
        model = cls.__new__(cls)
        model._set(source, provenance or {}, data)
        return model

    # --- learning -----------------------------------------------------------------------------

    @classmethod
    @checked_but("backoff")
    def fit(
        cls,
        frame: pd.DataFrame,
        gaits: Iterable[Gait | str] | GaitRepertoire,
        prior: float | None = None,
        *,
        axes: EffectAxes | str | None = None,
        gait_prior: str = "uniform",
        structure: str | Structure = "naive",
        backoff: float | str | None = "auto",
        residual_of: str | Residuals | None = None,
        effects: Iterable[str] | None = None,
    ) -> ForwardModel:
        """Learn the tables from a babbling table; pgmpy fits them, the counts confirm them.

        frame: columns gait, distance [m], angle and heading [rad clockwise]; path columns optional.
        gaits: a repertoire, or Gait objects or names, in table order. Of names alone, body length and duration are
            those of the robot that the table's record names, or of ``axes``; else they are unknown.
        prior: Dirichlet pseudo-count per cell, >= 0; by default 0, with back-off 0.03.
        axes: bins; default ``EffectAxes.standard(gaits.body_length)``. Distance bins are added up
            to the farthest row. "auto": those of the highest held-out density, see ``models.counting.auto_axes``.
        structure: "naive" (the paper), "tan", "joint", "previous_gait" or "learned", or a Structure. The
            edges of "tan" and "learned" are found in the rows; later updates keep them. For
            "previous_gait" the table must say which gait went before, see :meth:`given`.
        backoff: of "previous_gait", rows > 0 that P(effect | Gait), smoothed by the prior, is worth in each
            P(effect | Gait, PreviousGait), by default 5.0; mean poses lean likewise. None: the prior alone.
        residual_of: "unicycle": the motion that a gait's command asks for is fitted, and the tables count what it
            misses, on bins of their own; ``axes`` are those of :attr:`binned`. The gaits need commands, or the table
            command_0, ...; updates keep the motion. With "previous_gait" it lags behind its commands. None: the poses.
        effects: ["Distance", "Angle", "Heading", "Energy"], in any order, makes the column energy [J] a node that
            depends on what causes the others, in bins of ``axes.energy`` or of the highest held-out density.

        Raises DataError if the table is wrong or, with prior 0, a gait (without back-off: a pair) has no rows;
        InputError for a bad prior or structure or another robot's table; ZeroCountError if one needs a prior.
        """
        check_hunting(structure)
        if effects is None and isinstance(structure, Structure) and structure.has_energy:
            effects = structure.effects
        record = frame.attrs.get(babbling_table.PROVENANCE_KEY) if isinstance(frame, pd.DataFrame) else None
        repertoire, grid = measured(gaits, chosen_axes(axes, frame, gaits), record)
        grid = with_energy(grid, effects, frame, repertoire)
        if residual_of is not None:
            if grid.energy is not None:
                raise InputError("effects: tables of residuals have no Energy; leave it or residual_of out")
            found = residual_tables(frame, repertoire, grid, residual_of, lags=depends_on_previous(structure))
            inner = cls.fit(found.table, found.residuals.gaits, prior, axes=found.residuals.axes, gait_prior=gait_prior,
                            structure=structure, backoff=backoff)  # fmt: skip
            return cls.over(found.source(inner.source), inner.provenance, (frame,))
        backoff = structures.strength_of(backoff, structure)
        empty = cls(counts_for(structure).empty(repertoire, grid), prior, gait_prior, backoff=backoff)
        return empty.update(frame)._fitted(structure)

    @classmethod
    @checked_but("backoff")
    def from_counts(
        cls,
        joint: JointCounts | PreviousCounts,
        prior: float | None = None,
        *,
        gait_prior: str = "uniform",
        structure: str | Structure = "naive",
        backoff: float | str | None = "auto",
        provenance: Mapping[str, Any] | None = None,
    ) -> ForwardModel:
        """Learn the tables from counts of rows that need not be in memory: equal to :meth:`fit` of those rows.

        joint: of the kind the structure is fitted to, see ``models.counting.streaming``; the rest as in :meth:`fit`.
        """
        check_hunting(structure)
        if not isinstance(joint, counts_for(structure)):
            raise InputError(
                "structure 'previous_gait' is fitted to PreviousCounts: count the gait before as well"
                if depends_on_previous(structure)
                else "this structure is fitted to JointCounts; counts by the gait before are for previous_gait"
            )
        backoff = structures.strength_of(backoff, structure)
        return cls(joint, prior, gait_prior, provenance, backoff=backoff)._fitted(structure)

    def _fitted(self, structure: str | Structure) -> ForwardModel:
        """Return this model with ``structure`` and with its tables confirmed by pgmpy's own fit."""
        tables = self.source
        assert isinstance(tables, (CountedTables, ContextTables))
        check_every_gait_seen(tables)
        if isinstance(structure, str):
            structure = structures.find_structure(structure, tables.cells)
        tables = replace(tables, structure=structure.with_energy() if tables.axes.energy is not None else structure)
        # With back-off pgmpy confirms the tables leant on. Huge ones are refused before it would allocate them.
        checked = tables.pooled if isinstance(tables, ContextTables) and tables.backoff is not None else tables
        learned = {**tables.effects.local, **shares(tables)} if checked is tables else dict(checked.effects.local)
        fitted = network.fit_cells(checked.cells, checked.states, checked.prior, checked.structure)
        network.check_equal(fitted, learned)
        if checked.energy is not None:
            causes = checked.structure.parents(ENERGY)
            fitted = network.fit_energy(checked.counts_of(ENERGY), causes, checked.states, checked.prior)
            network.check_equal(fitted, {ENERGY: checked.energy})
        return ForwardModel.over(tables, self.provenance, self.data)

    @classmethod
    @checked_but("backoff")
    def empty(
        cls,
        gaits: Iterable[Gait | str] | GaitRepertoire,
        prior: float | None = None,
        *,
        axes: EffectAxes | None = None,
        gait_prior: str = "uniform",
        structure: str | Structure = "naive",
        backoff: float | str | None = "auto",
    ) -> ForwardModel:
        """Return a model that has counted nothing; with prior 0 its tables raise ZeroCountError.

        structure: as in :meth:`fit`, but for those that are found in rows, of which there are none yet.
        """
        check_hunting(structure)
        repertoire, grid = measured(gaits, axes)
        counts = counts_for(structure).empty(repertoire, grid)
        if isinstance(structure, str):
            if structure in structures.SEARCHED:
                raise InputError(f"structure {structure!r} is found in rows, and there are none yet; use fit")
            structure = structures.find_structure(structure, counts.table)
        return cls(counts, prior, gait_prior, structure=structure, backoff=structures.strength_of(backoff, structure))

    @classmethod
    @checked
    def of_tables(
        cls, gaits: GaitRepertoire, axes: EffectAxes, structure: Structure, tables: Mapping[str, np.ndarray]
    ) -> ForwardModel:
        """Return the model of tables that another program made; see :class:`GivenTables`."""
        return cls.over(GivenTables.of(gaits, axes, structure, tables))

    @checked
    def update(self, rows: pd.DataFrame) -> ForwardModel:
        """Return a new model that has also counted ``rows``; equal to one batch fit of all rows.

        Raises DataError if ``rows`` is not a babbling table of these gaits, InputError for one of another robot, an
        imported network or the part of a model.
        """
        self._check_whole("update")
        record = rows.attrs.get(babbling_table.PROVENANCE_KEY)
        if self.has_counts:
            babbling_table.validate(rows)  # counting checks the gaits
            check_rows(self.gaits, self.provenance, record)
            warn_implausible(rows, self.gaits, self.source.outcome_axes)
        tables = self.source.learn(rows)
        sources = list(self.provenance.get("sources", []))
        if record and record not in sources:
            sources.append(record)
        provenance = {**self.provenance, "sources": sources} if sources else self.provenance
        return ForwardModel.over(tables, provenance, (*self.data, rows))

    @checked
    def with_data(self, frame: pd.DataFrame) -> ForwardModel:
        """Return this model with the rows that it counted, which no model file holds; DataError for others."""
        if not self.has_counts:
            raise DataError("an imported network has no counts to hold rows against; fit a model: ForwardModel.fit")
        model = ForwardModel.__new__(ForwardModel)
        model._set(self.source, self.provenance, (frame,), self.whole)
        model._counted_rows  # noqa: B018  # checks the rows now, where the caller can see which table is wrong
        return model

    # --- in a context ---------------------------------------------------------------------------

    @checked
    def given(self, context: Mapping[str, Gait | str | None]) -> ForwardModel:
        """Return what each gait does in a context: the tables conditioned on it.

        context: {"PreviousGait": the gait just executed}; {}, or None for the gait: nothing is known of it, which
            is the whole model. Learned coordinates, counts and rows are those of the rows in that context.
            Where there are none (the model was smoothed by a prior), poses and coordinates are those of all
            rows; ``counts`` shows the 0.

        The same model unless its structure has the gait before as a cause. Raises InputError for another
        variable, or a gait that is not in the repertoire.
        """
        for variable in context:
            if variable != PREVIOUS:
                raise InputError(f"unknown context {variable!r}: expected {PREVIOUS}")
        return self.after(context.get(PREVIOUS))

    @checked
    def after(self, previous_gait: Gait | str | None) -> ForwardModel:
        """Return what each gait does right after ``previous_gait``: ``given({"PreviousGait": previous_gait})``."""
        name = None if previous_gait is None else self.gaits.names[self.gaits.index(previous_gait)]
        return (self if self.whole is None else self.whole)._part(name)

    def _part(self, previous_gait: str | None) -> ForwardModel:
        """The part after a gait, made once."""
        if previous_gait not in self._parts:
            tables = self.source.given({PREVIOUS: str(previous_gait)})
            part = self
            if tables is not self.source:
                part = ForwardModel.__new__(ForwardModel)
                part._set(tables, self.provenance, self.data, self)
            self._parts[previous_gait] = part
        return self._parts[previous_gait]

    @cached_property
    def _parts(self) -> dict[str | None, ForwardModel]:
        return {None: self}

    @property
    def binned(self) -> ForwardModel:
        """The model with tables of the poses themselves: of a model of residuals, outcomes of it in ordinary bins.

        The same model unless it was fitted with ``residual_of``. Inverse models, networks and exports are made of it.
        """
        if self.source.binned is self.source:
            return self
        return ForwardModel.over(self.source.binned, self.provenance, self.data)

    def __repr__(self) -> str:
        bins = ", ".join(f"{axis.name} {axis.bins}" for axis in self.axes.all)
        after = "".join(f" after {state!r}" for state in self.known.values())
        if not self.has_counts:
            return f"<ForwardModel{after}: imported, {len(self.gaits)} gaits, bins {bins}>"
        kind = "" if self.structure.is_naive else f", structure {self.structure.name}"
        kind += "" if self.backoff is None else f", back-off {self.backoff:g}"
        kind += "" if self.source.residual_of is None else f", residuals of the {self.source.residual_of}"
        rows = f"{len(self.gaits)} gaits, {self.joint.total} rows"
        return f"<ForwardModel{after}: {rows}, bins {bins}, prior {self.prior:g}{kind}>"

    def __eq__(self, other: object) -> bool:
        """Equal counts, prior and gait prior (imported: equal tables), hence equal tables; provenance may differ."""
        return self.source == other.source if isinstance(other, ForwardModel) else NotImplemented

    def __hash__(self) -> int:
        return hash(self.source)

    def __reduce__(self) -> tuple[Any, ...]:
        # Only what defines the model: a worker process must not have to import pgmpy to receive it.
        if self.whole is not None:
            return methodcaller("given", dict(self.known)), (self.whole,)
        return ForwardModel.over, (self.source, self.provenance)

    # --- inside -------------------------------------------------------------------------------

    def _check_whole(self, what: str) -> None:
        """Raise InputError for the part of a model, which does not ``what`` by itself."""
        if self.whole is not None:
            raise InputError(f"this is the part after {self.known[PREVIOUS]!r}; {what} the whole model")
