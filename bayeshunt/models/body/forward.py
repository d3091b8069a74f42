"""The forward model: what each gait does, as probability tables learned from babbling.

Naive Bayes network Gait -> Distance, Angle, Heading (the paper, section "Forward model"): complete
data, known structure, uniform P(Gait), maximum-likelihood tables or a symmetric Dirichlet prior.
Other structures can be chosen (``models.structures``); everything asked of the model stays the same.
Letters: G gaits, K bins of a variable, P part-way poses of a gait.
"""

from __future__ import annotations

import copy
import math
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import pandas as pd

from bayeshunt.core import displays, statistics
from bayeshunt.core.bins import EFFECTS, EffectAxes
from bayeshunt.core.checks import check_generator, check_whole
from bayeshunt.core.errors import DataError, InputError
from bayeshunt.core.gaits import Gait, GaitRepertoire
from bayeshunt.core.geometry import FloatArray, Polar
from bayeshunt.data import babbling_table
from bayeshunt.models.body.opening import OpenTables
from bayeshunt.models.body.rows import CountedRows
from bayeshunt.models.counting.cells import CountedCells
from bayeshunt.models.counting.joint import JointCounts
from bayeshunt.models.tables import network, sampling
from bayeshunt.models.tables.effects import IndependentEffects, JointEffects, compile_effects
from bayeshunt.models.tables.structures import NAIVE, Structure, check_hunting, depends_on_previous, find_structure

if TYPE_CHECKING:
    from bayeshunt.models.counting.previous import PreviousCounts

#: How P(Gait) is set: 1/G as in the paper, or the share of each gait in the rows.
GAIT_PRIORS = ("uniform", "empirical")


@dataclass(frozen=True, eq=False, repr=False)
class ForwardModel(OpenTables):
    """P(Gait), P(Distance | Gait), P(Angle | Gait), P(Heading | Gait), and the counts behind them.

    joint: the sufficient statistics; every table is derived from it and from the prior.
    prior: Dirichlet pseudo-count per cell, >= 0; 0 gives maximum-likelihood tables.
    gait_prior: "uniform" (the paper) or "empirical".
    provenance: where the rows came from: ``{"sources": [record of each babbling table]}``.
    data: the babbling tables counted, kept by reference for :meth:`rows`; a loaded model has none.
    structure: the edges among Gait, Distance, Angle and Heading; the paper's by default.
    """

    joint: JointCounts
    prior: float = 0.0
    gait_prior: str = "uniform"
    provenance: Mapping[str, Any] = field(default_factory=dict)
    data: tuple[pd.DataFrame, ...] = field(default=(), repr=False)
    structure: Structure = NAIVE
    counter: ClassVar[type[JointCounts] | type[PreviousCounts]] = JointCounts  # what it is fitted to
    has_counts: ClassVar[bool] = True  # False for an imported network: its tables have no known counts

    def __post_init__(self) -> None:
        prior = self.prior
        if isinstance(prior, bool) or not isinstance(prior, (int, float, np.number)):
            raise InputError(f"prior is {prior!r}; expected a pseudo-count >= 0")
        if not (math.isfinite(prior) and prior >= 0):
            raise InputError(f"prior is {prior}; expected a finite pseudo-count >= 0")
        object.__setattr__(self, "prior", float(prior))
        object.__setattr__(self, "provenance", copy.deepcopy(dict(self.provenance)))  # the caller's may change
        if self.gait_prior not in GAIT_PRIORS:
            raise InputError(f"gait_prior is {self.gait_prior!r}; expected one of {', '.join(GAIT_PRIORS)}")
        self._check_structure()

    # --- learning -----------------------------------------------------------------------------

    @classmethod
    def fit(
        cls,
        frame: pd.DataFrame,
        gaits: Iterable[Gait | str] | GaitRepertoire,
        prior: float = 0.0,
        *,
        axes: EffectAxes | None = None,
        gait_prior: str = "uniform",
        structure: str | Structure = "naive",
    ) -> ForwardModel:
        """Learn the tables from a babbling table; pgmpy fits them, the counts confirm them.

        frame: columns gait, distance [m], angle and heading [rad clockwise]; path columns optional.
        gaits: a repertoire, or Gait objects or names, in table order.
        prior: Dirichlet pseudo-count per cell, >= 0.
        axes: bins; default ``EffectAxes.standard(gaits.body_length)``. Distance bins are added up
            to the farthest row.
        structure: "naive" (the paper), "tan", "joint", "previous_gait" or "learned", or a Structure. The
            edges of "tan" and "learned" are found in the rows; later updates keep them. For
            "previous_gait" see ``models.previous``: the table must say which gait went before.

        Raises DataError if the table is wrong or, with prior 0, if a gait ("previous_gait": a pair of
        gaits) has no rows; InputError for a bad prior or structure; ZeroCountError if the structure
        needs a prior.
        """
        kind = _kind(structure)
        model = kind.empty(gaits, prior, axes=axes, gait_prior=gait_prior).update(frame)
        return model._fitted(structure)

    @classmethod
    def from_counts(
        cls,
        joint: JointCounts | PreviousCounts,
        prior: float = 0.0,
        *,
        gait_prior: str = "uniform",
        structure: str | Structure = "naive",
        provenance: Mapping[str, Any] | None = None,
    ) -> ForwardModel:
        """Learn the tables from counts of rows that need not be in memory: equal to :meth:`fit` of those rows.

        joint: the sufficient statistics, of the kind that the structure is fitted to
            (``models.previous_counts.counts_for``), see ``models.streaming``; the rest as in :meth:`fit`.
        """
        return _kind(structure)._of_counts(joint, prior, gait_prior, provenance or {})._fitted(structure)

    @classmethod
    def _of_counts(
        cls, counts: JointCounts | PreviousCounts, prior: float, gait_prior: str, provenance: Mapping[str, Any]
    ) -> ForwardModel:
        if not isinstance(counts, JointCounts):
            raise InputError("this structure is fitted to JointCounts; counts by the gait before are for previous_gait")
        return cls(counts, prior, gait_prior, provenance)

    def _fitted(self, structure: str | Structure) -> ForwardModel:
        """Return this model with ``structure`` and with its tables confirmed by pgmpy's own fit."""
        self._check_every_gait_seen()
        if isinstance(structure, str):
            structure = find_structure(structure, self.counted_cells)
        model = replace(self, structure=structure)
        learned = {**model._effects.local, **model._shares}  # refuses huge tables before pgmpy would allocate them
        fitted = network.fit_cells(model.counted_cells, model.states, model.prior, structure)
        network.check_equal(fitted, learned)
        return model

    @classmethod
    def empty(
        cls,
        gaits: Iterable[Gait | str] | GaitRepertoire,
        prior: float = 0.0,
        *,
        axes: EffectAxes | None = None,
        gait_prior: str = "uniform",
    ) -> ForwardModel:
        """Return a model that has counted nothing; with prior 0 its tables raise ZeroCountError."""
        repertoire = GaitRepertoire.of(gaits)
        grid = axes if axes is not None else EffectAxes.standard(repertoire.body_length)
        return cls._of_counts(cls.counter.empty(repertoire, grid), prior, gait_prior, {})

    def update(self, rows: pd.DataFrame) -> ForwardModel:
        """Return a new model that has also counted ``rows``; equal to one batch fit of all rows.

        Raises DataError if ``rows`` is not a babbling table of these gaits.
        """
        babbling_table.validate(rows)  # counting checks the gaits
        counted = self._counted_with(rows)
        sources = list(self.provenance.get("sources", []))
        record = rows.attrs.get(babbling_table.PROVENANCE_KEY)
        if record and record not in sources:
            sources.append(record)
        provenance = {**self.provenance, "sources": sources} if sources else self.provenance
        return replace(self, **counted, provenance=provenance, data=(*self.data, rows))

    def with_data(self, frame: pd.DataFrame) -> ForwardModel:
        """Return this model with the rows that it counted, which no model file holds; DataError for others."""
        model = replace(self, data=(frame,))
        model._counted_rows  # noqa: B018  # checks the rows now, where the caller can see which table is wrong
        return model

    # --- tables -------------------------------------------------------------------------------

    def probabilities(self, variable: str) -> np.ndarray:
        """Return a read-only CPT: [K, G] P(variable | Gait), columns sum to 1; [G] for "Gait".

        In other structures than the paper's, other parents are summed over; see :attr:`local_tables`.

        Raises ZeroCountError if a gait has neither rows nor prior, InputError for another variable.
        """
        self._check_variable(variable)
        return self._tables[variable]

    @property
    def local_tables(self) -> dict[str, np.ndarray]:
        """The network's own tables: "Gait" [G] and P(effect | parents) [K, ...parents] of each effect.

        Parents are in alphabetical order (``structure.parents``). In the paper's structure these are
        the tables of :meth:`probabilities`. Otherwise, with prior 0, a column whose parents were
        never seen together is 0 throughout: it cannot be reached.
        """
        return {"Gait": self._tables["Gait"], **self._effects.local}

    @property
    def states(self) -> dict[str, list[str]]:
        """Names of the states of each variable of the network, in table order: gait names and bin labels."""
        return network.state_names(self.gaits, self.axes)

    @cached_property
    def network(self) -> Any:
        """The model as a pgmpy DiscreteBayesianNetwork; its states are :attr:`states`."""
        return network.build(self.local_tables, self.states, self.structure)

    @cached_property
    def mean_paths(self) -> np.ndarray | None:  # [G, P + 1, 3]: forward m, right m, heading rad
        """Mean pose of each gait after each of its P + 1 equal intervals; None without path columns.

        The last is the mean final pose; heading is clockwise. Exact sums of the rows, not of bins.
        """
        if not self.joint.points:
            return None
        paths = np.stack([self.joint.mean_poses(gait) for gait in range(len(self.gaits))])
        paths.setflags(write=False)
        return paths

    @property
    def learned_cells(self) -> np.ndarray:
        """Int64 [M, 2]: the (Distance, Angle) bins that babbled rows fell into, sorted."""
        return np.argwhere(self.joint.support > 0)

    # --- what will happen ---------------------------------------------------------------------

    def after(self, previous_gait: Gait | str | None) -> ForwardModel:
        """Return what each gait does right after ``previous_gait``; None: nothing is known of the gait before.

        The same model unless its structure is "previous_gait", see ``models.previous``.
        Raises InputError for a gait that is not in the repertoire.
        """
        if previous_gait is not None:
            self.gaits.index(previous_gait)
        return self

    def predict(self, gait: Gait | str) -> Polar:
        """Return the expected pose after one step of ``gait``, in the robot's present frame.

        The mean of forward, right [m] and the circular mean heading over the babbled rows
        themselves (exact fixed-point sums), not over bin centres. Raises ZeroCountError if the
        gait was never babbled: a prior says nothing about a pose.
        """
        index = self.gaits.index(gait)
        forward, right, heading = map(float, self.joint.mean_poses(index)[-1])
        return Polar.from_cartesian(forward, right, heading)

    def sample(self, gait: Gait | str, n: int, *, rng: np.random.Generator) -> Polar[FloatArray]:
        """Return ``n`` outcomes of ``gait`` drawn from the network: Polar of arrays [n].

        In the paper's structure distance, angle and heading are drawn from their own CPT columns,
        independently; in any structure they are uniform within each bin.
        """
        index = self.gaits.index(gait)
        check_whole(n, "n", 0)
        check_generator(rng)
        return self._effects.draw(self.axes, index, rng.random((int(n), sampling.UNIFORMS)))

    def outcomes(self, uniforms: np.ndarray) -> Polar[FloatArray]:
        """Return the outcome of **every** gait for the same random numbers: Polar of arrays [G, ...].

        uniforms: [..., 6] in [0, 1): the first three choose the bins of Distance, Angle and Heading
        by inverse CDF, the last three the place inside them. One array shared by all gaits gives
        common random numbers. A bin of probability 0 is never chosen.
        """
        draws = sampling.check_uniforms(uniforms)
        poses = [self._effects.draw(self.axes, gait, draws) for gait in range(len(self.gaits))]
        return Polar(*(np.stack(parts) for parts in zip(*poses, strict=True)))

    def log_likelihood(self, rows: pd.DataFrame | JointCounts) -> float:
        """Return sum over rows of log P(Gait) + log P(Distance, Angle, Heading | Gait), natural log.

        rows: a babbling table, or the counts of one.
        -inf if the model gives some row probability 0 (with prior 0: a bin that the gait was never
        seen in; always: beyond the distance axis).
        """
        if not isinstance(rows, JointCounts):
            babbling_table.validate(rows, self.gaits.names)
            rows = JointCounts.of(rows, self.gaits, self.axes)
        seen = rows
        if seen.axes.distance.bins > self.axes.distance.bins:
            return -math.inf
        with np.errstate(divide="ignore"):
            logs = np.log(self._tables["Gait"][seen.cells[:, 0]]) + self._effects.log_probability(seen.cells)
        return float(np.sum(seen.counts * logs))

    def evidence(self, distance_bins: Any, angle_bins: Any, heading_bins: Any = None) -> np.ndarray:
        """Return P(Gait, evidence) [..., G] for bin numbers, or arrays of them, of Distance, Angle and Heading."""
        return self._effects.evidence(self._tables["Gait"], distance_bins, angle_bins, heading_bins)

    # --- storing ------------------------------------------------------------------------------

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the model as JSON (counts, prior, axes, gaits, provenance); see ``models.store``."""
        from bayeshunt.models.formats import model_file

        model_file.save(self, path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> ForwardModel:
        """Read a model written by :meth:`save`; raises ModelFileError in one clear line."""
        from bayeshunt.models.formats import model_file

        return model_file.load(path)

    def to_csv(self, folder: str | os.PathLike[str]) -> list[Path]:
        """Write every table as CSV, a row per cell with count and interval; see ``models.interchange``."""
        from bayeshunt.models.formats import interchange

        return interchange.write_csv(self, folder)

    def to_xmlbif(self, path: str | os.PathLike[str]) -> None:
        """Export as XMLBIF for other programs, with a map of state labels beside it."""
        from bayeshunt.models.formats import xmlbif

        xmlbif.write(self, path)

    def __repr__(self) -> str:
        bins = ", ".join(f"{axis.name} {axis.bins}" for axis in self.axes)
        kind = "" if self.structure.is_naive else f", structure {self.structure.name}"
        rows = f"{len(self.gaits)} gaits, {self.joint.total} rows"
        return f"<ForwardModel: {rows}, bins {bins}, prior {self.prior:g}{kind}>"

    def __str__(self) -> str:
        return displays.to_text(self)

    def _repr_html_(self) -> str | None:
        return displays.to_html(self)

    def __eq__(self, other: object) -> bool:
        """Equal counts, prior and gait prior, hence equal tables; provenance may differ."""
        if not isinstance(other, ForwardModel):
            return NotImplemented
        mine, theirs = ((m.prior, m.gait_prior, m.structure) for m in (self, other))
        return mine == theirs and self.joint == other.joint

    def __hash__(self) -> int:
        return hash((self.joint, self.prior, self.gait_prior, self.structure))

    def __reduce__(self) -> tuple[Any, ...]:
        # Only what defines the model: a worker process must not have to import pgmpy to receive it.
        return ForwardModel, (self.joint, self.prior, self.gait_prior, self.provenance, (), self.structure)

    # --- inside -------------------------------------------------------------------------------

    @cached_property
    def _tables(self) -> dict[str, np.ndarray]:
        derived = {effect: self._effects.marginal(effect) for effect in EFFECTS}
        count = len(self.gaits)
        uniform = np.full(count, 1.0 / count)
        derived["Gait"] = uniform if self.gait_prior == "uniform" else self._shares["Gait"]
        for table in derived.values():
            table.setflags(write=False)
        return derived

    @property
    def _shares(self) -> dict[str, np.ndarray]:
        """P(Gait) [G] as the rows have it."""
        return {"Gait": statistics.normalise(self.joint.marginal("Gait")[:, None], self.prior, name="Gait")[:, 0]}

    @property
    def counted_cells(self) -> CountedCells:
        """The counts over every variable of the network."""
        return self.joint.table

    def _counted_with(self, rows: pd.DataFrame) -> dict[str, Any]:
        """The fields that hold counts, once ``rows`` are counted too."""
        return {"joint": self.joint.merge(JointCounts.of(rows, self.gaits, self.axes))}

    def _check_structure(self) -> None:
        if depends_on_previous(self.structure):
            raise InputError("this structure needs counts by the gait before; fit it: ForwardModel.fit")

    def _check_every_gait_seen(self) -> None:
        unseen = np.flatnonzero(self.joint.marginal("Gait") == 0)
        if self.prior == 0 and unseen.size:
            name = self.gaits.names[int(unseen[0])]
            raise DataError(f"gait {name!r} has no rows; babble it, or fit with a prior > 0")

    @cached_property
    def _counted_rows(self) -> CountedRows:
        return CountedRows(self, self.data)

    @cached_property
    def _effects(self) -> IndependentEffects | JointEffects:
        return compile_effects(self.structure, self.joint, self.prior)


def _kind(structure: str | Structure) -> type[ForwardModel]:
    """The class that holds models of a structure; InputError if there is none."""
    check_hunting(structure)
    if not depends_on_previous(structure):
        return ForwardModel
    from bayeshunt.models.body.previous import PreviousGaitModel

    return PreviousGaitModel
