"""Where a forward model's tables come from: counted rows, rows counted by context, or another program's network.

A source knows the gaits, the bins and every table, and what may be asked beyond them: counts, means of the rows,
the tables in a context. :class:`bayeshunt.models.body.forward.ForwardModel` is one class over any source.
Letters: G gaits, K bins of a variable, D and A bins of Distance and Angle, P part-way poses of a gait.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.bins import EFFECTS, ENERGY, EffectAxes
from bayeshunt.core.errors import InputError
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.core.geometry import FloatArray, Polar
from bayeshunt.models.counting.cells import CountedCells
from bayeshunt.models.counting.joint import JointCounts
from bayeshunt.models.counting.previous import PreviousCounts
from bayeshunt.models.motion.residuals import Residuals
from bayeshunt.models.tables import network
from bayeshunt.models.tables.effects import IndependentEffects, JointEffects
from bayeshunt.models.tables.structures import PREVIOUS, Structure, depends_on_previous

__all__ = ["TableSource"]


class TableSource(ABC):
    """The tables of one network, immutable.

    joint: the rows counted, whatever their context; of given tables: gaits and bins, nothing counted.
    prior: Dirichlet pseudo-count per cell. gait_prior: "uniform" or "empirical".
    structure: the edges. known: states of other variables that the tables are conditioned on.
    backoff: rows that P(effect | Gait) is worth in the tables given the gait before; None: no back-off.
    residuals: the motion behind the tables; None: they know of none.
    """

    joint: JointCounts
    prior: float
    gait_prior: str
    structure: Structure
    known: Mapping[str, str]
    backoff: float | None = None
    residuals: Residuals | None = None

    # --- what it is of ------------------------------------------------------------------------

    @property
    def gaits(self) -> GaitRepertoire:
        """The repertoire, in table order."""
        return self.joint.gaits

    @property
    def axes(self) -> EffectAxes:
        """The bins of Distance, Angle and Heading."""
        return self.joint.axes

    @property
    def states(self) -> dict[str, list[str]]:
        """Names of the states of each variable of the network: gait names and bin labels, in table order."""
        before = {PREVIOUS: list(self.gaits.names)} if depends_on_previous(self.structure) else {}
        return {**before, **network.state_names(self.gaits, self.axes)}

    @property
    def residual_of(self) -> str | None:
        """The motion whose residuals the tables count, "unicycle"; None: they count the poses themselves."""
        return None

    @property
    def outcome_axes(self) -> EffectAxes:
        """The bins of the poses themselves."""
        return self.axes

    @property
    def binned(self) -> TableSource:
        """The tables of the poses themselves."""
        return self

    # --- probabilities ------------------------------------------------------------------------

    @property
    @abstractmethod
    def effects(self) -> IndependentEffects | JointEffects:
        """P(Distance, Angle, Heading | Gait), other causes summed over; ZeroCountError if there is none."""

    @property
    @abstractmethod
    def causes(self) -> dict[str, np.ndarray]:
        """P(cause) [G] of each cause of the structure, PreviousGait first."""

    @property
    def energy(self) -> np.ndarray | None:
        """P(Energy | causes) [E, ...causes], in alphabetical order; None where Energy is no node."""
        return None

    def marginal(self, effect: str) -> np.ndarray:
        """Return P(effect | Gait) [K, G], all else summed over."""
        if effect != ENERGY:
            return self.effects.marginal(effect)
        table = self.energy
        assert table is not None
        return table if table.ndim == 2 else np.asarray(table @ self.causes[PREVIOUS])

    def evidence(self, distances: Any, angles: Any, headings: Any = None, energies: Any = None) -> np.ndarray:
        """Return P(Gait, evidence) [..., G] for bin numbers, or arrays of them."""
        found = self.effects.evidence(self.causes["Gait"], distances, angles, headings)
        if energies is None:
            return found
        if not depends_on_previous(self.structure):
            return np.asarray(found * self.marginal(ENERGY)[energies])
        parts = [
            self.given({PREVIOUS: name}).evidence(distances, angles, headings, energies) for name in self.gaits.names
        ]
        return np.asarray(np.tensordot(self.causes[PREVIOUS], np.stack(parts), axes=1))

    def pseudo_counts(self, variable: str) -> np.ndarray | float:
        """Dirichlet pseudo-counts behind P(variable | Gait): one for all cells, or [K, G]."""
        return self.prior

    def local_pseudo(self, effect: str) -> np.ndarray | None:
        """Return the pseudo-counts of the network's own table [K, ...parents]; None: the prior in each cell."""
        return None

    @property
    def pseudo_words(self) -> str:
        """Which pseudo-counts an interval rests on: "pseudo-count 0.5 a cell"."""
        if self.backoff is not None:
            return f"pseudo-counts of the back-off, {self.backoff:g} rows of each gait's own table"
        if self.prior > 0:
            return f"pseudo-count {self.prior:g} a cell, the model's prior"
        return "pseudo-count 1/K a cell (K bins), as the model has no prior"

    # --- counts -------------------------------------------------------------------------------

    @property
    def support(self) -> np.ndarray | None:
        """Int64 [D, A]: rows in each (Distance, Angle) cell; None where nobody knows the counts."""
        return self.joint.support

    @property
    def counted(self) -> JointCounts | PreviousCounts:
        """The sufficient statistics that the tables are made of."""
        return self.joint

    @property
    def cells(self) -> CountedCells:
        """The counts over every variable of the network."""
        return self.counted.table

    def counts_of(self, variable: str) -> np.ndarray:
        """Return the counts [K, ...parents] behind the network's own table of a variable."""
        if variable == ENERGY:
            return self.counted.spent
        return self.cells.tabulate((variable, *self.structure.parents(variable)))

    def count(self, rows: pd.DataFrame) -> JointCounts | PreviousCounts:
        """Return the counts of further rows, of the kind of :attr:`counted`; DataError if they are wrong."""
        return type(self.counted).of(self.recast(rows), self.gaits, self.axes)

    def recast(self, rows: pd.DataFrame) -> pd.DataFrame:
        """Return a babbling table as the tables count it: the poses of its rows, or what a motion misses of them."""
        return rows

    def learn(self, rows: pd.DataFrame) -> TableSource:
        """Return the tables that have also counted ``rows``; InputError for those that cannot."""
        self.count(rows)
        raise InputError("these tables cannot learn from further rows")

    def select(self, rows: pd.DataFrame) -> pd.DataFrame:
        """Return those of ``rows`` that such tables count."""
        return rows

    # --- what the robot does ------------------------------------------------------------------

    @property
    @abstractmethod
    def learned_cells(self) -> np.ndarray:
        """Int64 [M, 2]: the (Distance, Angle) bins that can be reached, as far as is known; sorted."""

    @property
    @abstractmethod
    def mean_paths(self) -> np.ndarray | None:
        """Float64 [G, P + 1, 3]: mean forward [m], right [m] and heading [rad] part-way; None if unknown."""

    @abstractmethod
    def mean_pose(self, gait: int) -> np.ndarray:
        """Return float64 [3]: mean forward [m], right [m], heading [rad] at the end; ZeroCountError if unknown."""

    def draw(self, gait: int, uniforms: np.ndarray) -> Polar[FloatArray]:
        """Return the poses [...] of one gait that ``uniforms`` [..., 6] in [0, 1) choose."""
        return self.effects.draw(self.axes, gait, uniforms)

    def given(self, context: Mapping[str, str]) -> TableSource:
        """Return the tables in a context, {"PreviousGait": name}; these, if it makes no difference to them."""
        return self

    def log_likelihood(self, seen: JointCounts | PreviousCounts) -> float:
        """Return the sum over the rows of ``seen`` of log P(Gait) + log P(effects | causes); -inf if one is 0."""
        seen = seen.joint if isinstance(seen, PreviousCounts) else seen
        if seen.axes.distance.bins > self.axes.distance.bins:
            return -math.inf
        if self.axes.energy is not None and seen.axes.energy is not None and len(seen.spent) > self.axes.energy.bins:
            return -math.inf
        with np.errstate(divide="ignore"):
            logs = np.log(self.causes["Gait"][seen.cells[:, 0]]) + self.effects.log_probability(seen.cells)
            spent = np.log(self.marginal(ENERGY)) if seen.axes.energy is not None and self.energy is not None else None
        total = float(np.sum(seen.counts * logs))
        if spent is None:
            return total
        some = seen.spent > 0
        return total + float(np.sum(seen.spent[some] * spent[: len(seen.spent)][some]))

    @property
    def local(self) -> dict[str, np.ndarray]:
        """The network's own tables: each cause [G], P(effect | parents) [K, ...parents] of each effect."""
        energy = {} if self.energy is None else {ENERGY: self.energy}
        return {**self.causes, **{effect: self.effects.local[effect] for effect in EFFECTS}, **energy}
