"""Probability tables from elsewhere: another program's network, or a published one.

They answer, sample and hunt like learned ones; but nobody knows the counts behind them, so the support of
their answers is None, they have no intervals and no rows, and they cannot learn further.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NoReturn

import numpy as np
import pandas as pd

from bayeshunt.core.bins import EFFECTS, ENERGY, EffectAxes
from bayeshunt.core.errors import InputError
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.models.counting.joint import JointCounts
from bayeshunt.models.tables.effects import IndependentEffects, JointEffects
from bayeshunt.models.tables.sources import TableSource
from bayeshunt.models.tables.structures import NAIVE, PREVIOUS, Structure, check_hunting, depends_on_previous

__all__ = ["GivenTables"]


@dataclass(frozen=True, eq=False)
class GivenTables(TableSource):
    """Tables that are given; ``joint`` holds their gaits and bins and counts nothing.

    tables: "Gait" [G], and P(effect | parents) [K, ...parents] of each effect, parents in alphabetical
        order; columns sum to 1. With the gait before as a cause "PreviousGait" [G], too; the structure is
        then PREVIOUS_GAIT.
    """

    joint: JointCounts
    structure: Structure
    tables: Mapping[str, np.ndarray]
    known: Mapping[str, str] = field(default_factory=dict)
    prior: float = 0.0
    gait_prior: str = "uniform"

    def __post_init__(self) -> None:
        check_hunting(self.structure)
        tables = {
            name: np.array(values, dtype=float) for name, values in self.tables.items()
        }  # the caller's may change
        for values in tables.values():
            values.setflags(write=False)
        object.__setattr__(self, "tables", tables)

    @classmethod
    def of(
        cls, gaits: GaitRepertoire, axes: EffectAxes, structure: Structure, tables: Mapping[str, np.ndarray]
    ) -> GivenTables:
        """Return the source of these tables."""
        return cls(JointCounts.empty(gaits, axes), structure, tables)

    @property
    def support(self) -> None:
        """None: nobody knows the counts."""
        return None

    @cached_property
    def effects(self) -> IndependentEffects | JointEffects:
        """P(Distance, Angle, Heading | Gait), the gait before summed over."""
        local = {effect: self.tables[effect] for effect in EFFECTS}
        if self.structure.is_naive:
            return IndependentEffects.of_tables(local)
        shares = {PREVIOUS: self.tables[PREVIOUS]} if depends_on_previous(self.structure) else None
        return JointEffects.of_tables(self.structure, local, (len(self.gaits), *self.axes.shape), shares)

    @property
    def energy(self) -> np.ndarray | None:
        """P(Energy | causes), as given; None where Energy is no node."""
        return self.tables.get(ENERGY)

    @property
    def causes(self) -> dict[str, np.ndarray]:
        """P(cause) [G], as given."""
        return {cause: self.tables[cause] for cause in self.structure.causes}

    @property
    def learned_cells(self) -> np.ndarray:
        """Int64 [M, 2]: bins of Distance and Angle of positive probability, sorted."""
        distance, angle, _ = self.axes.shape
        joint = self.effects.evidence(self.tables["Gait"], *np.ogrid[:distance, :angle])
        return np.argwhere(joint.sum(axis=-1) > 0)

    @property
    def mean_paths(self) -> None:
        """None: tables say nothing of poses part-way."""
        return None

    def mean_pose(self, gait: int) -> np.ndarray:
        """Return the mean final pose [3] over bin centres."""
        bins = [np.arange(size) for size in self.axes.shape]
        ones = np.ones(len(self.gaits))
        places = self.effects.evidence(ones, bins[0][:, None], bins[1][None, :])[..., gait]
        reach, angle = self.axes.distance.centres[:, None], self.axes.angle.centres[None, :]
        forward, right = ((places * reach * part).sum() for part in (np.cos(angle), np.sin(angle)))
        headings, centres = self.effects.marginal("Heading")[:, gait], self.axes.heading.centres
        turn = np.arctan2((headings * np.sin(centres)).sum(), (headings * np.cos(centres)).sum())
        return np.array([forward, right, turn])

    def given(self, context: Mapping[str, str]) -> TableSource:
        """Return the tables after one gait; these, if they do not depend on the gait before."""
        if PREVIOUS not in context or not depends_on_previous(self.structure):
            return self
        before = self.gaits.index(context[PREVIOUS])
        after = {effect: self.tables[effect][:, :, before].copy() for effect in self.structure.effects}
        structure = NAIVE.with_energy() if self.structure.has_energy else NAIVE
        return GivenTables(self.joint, structure, {"Gait": self.tables["Gait"], **after}, dict(context))

    def count(self, rows: pd.DataFrame) -> NoReturn:
        """Raise InputError: probabilities without counts cannot learn from further rows."""
        raise InputError("an imported network has no counts to add rows to; fit a model: ForwardModel.fit")

    def __eq__(self, other: object) -> bool:
        """Equal gaits, bins, edges and tables."""
        if not isinstance(other, GivenTables):
            return NotImplemented
        mine, theirs = ((s.gaits, s.axes, s.structure, dict(s.known)) for s in (self, other))
        return mine == theirs and all(np.array_equal(self.tables[v], other.tables[v]) for v in self.tables)

    def __hash__(self) -> int:
        return hash((self.gaits, self.axes, self.structure))

    def __reduce__(self) -> tuple[Any, ...]:
        return GivenTables, (self.joint, self.structure, dict(self.tables), dict(self.known))
