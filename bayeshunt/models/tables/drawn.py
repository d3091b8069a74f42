"""Tables of poses that follow from tables of residuals, for an inverse model.

Outcomes of each gait are drawn, always the same, and put into ordinary bins.
Letters: G gaits, K bins of a variable, D and A bins of Distance and Angle, P part-way poses of a gait.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.core.geometry import FloatArray, Polar
from bayeshunt.models.counting.joint import JointCounts
from bayeshunt.models.counting.previous import PreviousCounts
from bayeshunt.models.tables import sampling
from bayeshunt.models.tables.effects import IndependentEffects, JointEffects
from bayeshunt.models.tables.sources import TableSource
from bayeshunt.models.tables.structures import NAIVE, PREVIOUS, PREVIOUS_GAIT, depends_on_previous

__all__ = ["DrawnTables"]

#: Outcomes drawn of each gait; of each pair of gaits where the gait before matters.
_DRAWS, _PAIR_DRAWS = 1 << 14, 1 << 11
_SEED = 20101  # private, so that the tables of a model are always the same


@dataclass(frozen=True)
class DrawnTables(TableSource):
    """Tables in ordinary bins of outcomes drawn from tables of residuals; naive, or with the gait before as a cause.

    Counts, support and learned coordinates are those of the rows themselves; how sure a column is, is that of a
    Dirichlet with the column as its mean and as many rows as the gait has behind it.

    residual: the tables of residuals. seen: the poses of their rows in ordinary bins. whole: of a part after a gait,
    those of all rows.
    """

    residual: TableSource
    seen: JointCounts | PreviousCounts
    whole: JointCounts | None = None

    def __post_init__(self) -> None:
        for name in ("prior", "gait_prior", "known", "residuals"):
            object.__setattr__(self, name, getattr(self.residual, name))
        before = depends_on_previous(self.residual.structure)
        object.__setattr__(self, "structure", PREVIOUS_GAIT if before else NAIVE)

    @property
    def gaits(self) -> GaitRepertoire:
        """The repertoire, in table order."""
        return self.residual.gaits

    @cached_property
    def _drawn(self) -> tuple[EffectAxes, dict[str, np.ndarray]]:
        """Bins that reach the farthest draw, and P(effect | parents) [K, ...parents] of each."""
        sources = [self.residual]
        if self.structure is PREVIOUS_GAIT:
            sources = [self.residual.given({PREVIOUS: name}) for name in self.gaits.names]
        count = _PAIR_DRAWS if len(sources) > 1 else _DRAWS
        uniforms = np.random.default_rng(_SEED).random((count, sampling.UNIFORMS))
        poses = [[source.draw(gait, uniforms) for gait in range(len(self.gaits))] for source in sources]
        axes, farthest = self.residual.outcome_axes, max(float(pose.distance.max()) for row in poses for pose in row)
        axes = axes.extended(int(axes.distance.index(farthest)) + 1)
        tables = {}
        for axis in axes:
            values = [[getattr(pose, axis.name.lower()) for pose in row] for row in poses]
            shares = [[np.bincount(axis.index(v), minlength=axis.bins) / count for v in row] for row in values]
            table = np.moveaxis(np.array(shares), (0, 1, 2), (2, 1, 0))  # [K, Gait, PreviousGait]
            tables[axis.name] = np.ascontiguousarray(table if len(sources) > 1 else table[:, :, 0])
            tables[axis.name].setflags(write=False)
        return axes, tables

    @cached_property
    def counted(self) -> JointCounts | PreviousCounts:
        """The poses of the rows, in bins that reach the farthest draw."""
        axes, seen = self._drawn[0], self.seen
        if isinstance(seen, PreviousCounts):
            return PreviousCounts(tuple(replace(part, axes=axes) for part in seen.after))
        return replace(seen, axes=axes)

    @property
    def joint(self) -> JointCounts:  # type: ignore[override]
        """The poses of the rows, whatever gait went before them."""
        return self.counted.joint if isinstance(self.counted, PreviousCounts) else self.counted

    @cached_property
    def effects(self) -> IndependentEffects | JointEffects:
        """P(Distance, Angle, Heading | Gait), the gait before summed over."""
        axes, tables = self._drawn
        if self.structure is NAIVE:
            return IndependentEffects.of_tables(tables)
        sizes = (len(self.gaits), *axes.shape)
        return JointEffects.of_tables(PREVIOUS_GAIT, tables, sizes, {PREVIOUS: self.causes[PREVIOUS]})

    @property
    def causes(self) -> dict[str, np.ndarray]:
        """P(cause) [G] of each cause."""
        return self.residual.causes

    @cached_property
    def learned_cells(self) -> np.ndarray:
        """Int64 [M, 2]: the (Distance, Angle) bins that rows fell into and that are possible; sorted."""
        rows, whole = self.seen, self.whole
        if whole is not None and (self.residual.backoff is not None or not rows.total):
            rows = whole
        cells = np.argwhere((rows.joint if isinstance(rows, PreviousCounts) else rows).support > 0)
        possible = self.effects.evidence(self.causes["Gait"], cells[:, 0], cells[:, 1]).sum(axis=1) > 0
        kept: np.ndarray = cells[possible]
        return kept

    @property
    def mean_paths(self) -> np.ndarray | None:
        """Mean path of each gait [G, P + 1, 3], as of the residuals."""
        return self.residual.mean_paths

    def mean_pose(self, gait: int) -> np.ndarray:
        """Return the mean final pose [3], as of the residuals."""
        return self.residual.mean_pose(gait)

    def draw(self, gait: int, uniforms: np.ndarray) -> Polar[FloatArray]:
        """Return poses [...] as the residuals give them, not as the bins do."""
        return self.residual.draw(gait, uniforms)

    def select(self, rows: pd.DataFrame) -> pd.DataFrame:
        """Return those of ``rows`` that such tables count."""
        return self.residual.select(rows)

    def learn(self, rows: pd.DataFrame) -> TableSource:
        """Return the tables of residuals that have also counted ``rows``, drawn anew."""
        return self.residual.learn(rows).binned

    def given(self, context: Mapping[str, str]) -> TableSource:
        """Return the tables after one gait; these, if they do not depend on the gait before."""
        part = self.residual.given(context)
        return self if part is self.residual else part.binned

    def pseudo_counts(self, variable: str) -> np.ndarray | float:
        """What with the rows' own counts makes up the Dirichlet of a column: [K, G]."""
        if variable == "Gait":
            return self.residual.prior
        return self._made_up(self.effects.marginal(variable), self.joint.marginal(variable))

    def local_pseudo(self, effect: str) -> np.ndarray:
        """What with the rows' own counts makes up the Dirichlet of P(effect | parents)."""
        return self._made_up(self.effects.local[effect], self.cells.tabulate((effect, *self.structure.parents(effect))))

    def _made_up(self, table: np.ndarray, counts: np.ndarray) -> np.ndarray:
        strength = counts.sum(axis=0, keepdims=True) + (self.residual.backoff or 1.0)
        return np.asarray(strength * table - counts)

    @property
    def pseudo_words(self) -> str:
        """Which Dirichlet the intervals are of."""
        return f"of outcomes drawn beside the {self.residual.residual_of}, with as many rows as each gait has"

    def __reduce__(self) -> tuple[Any, ...]:
        return DrawnTables, (self.residual, self.seen, self.whole)
