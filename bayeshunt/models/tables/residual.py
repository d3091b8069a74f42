"""Tables of what a command's own motion misses, and the tables of the poses themselves that follow from them.

:class:`ResidualTables` count residuals (``models.motion.residuals``) on their own bins; what they are asked of poses,
draws and means, has the command's motion added. :class:`DrawnTables` are the tables of the poses in ordinary bins, for
an inverse model: outcomes of each gait are drawn, always the same, and binned.
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
from bayeshunt.models.motion.residuals import UNICYCLE, Residuals, added
from bayeshunt.models.tables import sampling
from bayeshunt.models.tables.counted import ContextTables, CountedTables
from bayeshunt.models.tables.effects import IndependentEffects, JointEffects
from bayeshunt.models.tables.sources import TableSource
from bayeshunt.models.tables.structures import NAIVE, PREVIOUS, PREVIOUS_GAIT, Structure, depends_on_previous

__all__ = ["DrawnTables", "ResidualTables"]

#: Outcomes drawn of each gait; of each pair of gaits where the gait before matters.
_DRAWS, _PAIR_DRAWS = 1 << 14, 1 << 11
_POINTS = 13  # of a mean path, where the rows have no part-way poses
_SEED = 20101  # private, so that the tables of a model are always the same


@dataclass(frozen=True)
class ResidualTables(TableSource):
    """Counted residuals of the gaits' commands.

    inner: tables over the bins of the residuals. motion: what is added.
    seen: the same rows' poses in ordinary bins, which :attr:`binned` has. whole: of a part after a gait, those of all.
    """

    inner: CountedTables | ContextTables
    motion: Residuals
    seen: JointCounts | PreviousCounts
    whole: JointCounts | None = None

    @property
    def residuals(self) -> Residuals:
        """The motion behind the tables."""
        return self.motion

    @property
    def residual_of(self) -> str:
        """Whose residuals they are."""
        return UNICYCLE

    @property
    def joint(self) -> JointCounts:  # type: ignore[override]
        """The residuals counted, whatever the gait before."""
        return self.inner.joint

    @property
    def prior(self) -> float:  # type: ignore[override]
        """Dirichlet pseudo-count per cell."""
        return self.inner.prior

    @property
    def gait_prior(self) -> str:  # type: ignore[override]
        """ "uniform" or "empirical"."""
        return self.inner.gait_prior

    @property
    def structure(self) -> Structure:  # type: ignore[override]
        """The edges among the residuals."""
        return self.inner.structure

    @property
    def known(self) -> Mapping[str, str]:  # type: ignore[override]
        """States of other variables that the tables are conditioned on."""
        return self.inner.known

    @property
    def backoff(self) -> float | None:  # type: ignore[override]
        """Rows that P(effect | Gait) is worth given the gait before."""
        return self.inner.backoff

    @property
    def outcome_axes(self) -> EffectAxes:
        """The ordinary bins."""
        return self.seen.axes

    @property
    def effects(self) -> IndependentEffects | JointEffects:
        """P(Distance, Angle, Heading of the residual | Gait)."""
        return self.inner.effects

    @property
    def causes(self) -> dict[str, np.ndarray]:
        """P(cause) [G] of each cause."""
        return self.inner.causes

    def pseudo_counts(self, variable: str) -> np.ndarray | float:
        """Dirichlet pseudo-counts behind the tables of residuals."""
        return self.inner.pseudo_counts(variable)

    def local_pseudo(self, effect: str) -> np.ndarray | None:
        """Pseudo-counts of the tables leant on."""
        return self.inner.local_pseudo(effect)

    @property
    def counted(self) -> JointCounts | PreviousCounts:
        """The residuals counted."""
        return self.inner.counted

    @property
    def learned_cells(self) -> np.ndarray:
        """Int64 [M, 2]: bins of the residuals that rows fell into."""
        return self.inner.learned_cells

    @property
    def mean_paths(self) -> np.ndarray | None:
        """Mean path of each gait [G, P + 1, 3]: the command's arc and the mean residual at each point of it.

        Of rows without part-way poses: as if the residual of the end grew evenly.
        """
        gaps = self.inner.mean_paths
        if gaps is None:
            gaps = np.stack([self._growing(gait) for gait in range(len(self.gaits))])
        paths = np.stack([self._moved(gait, gaps[gait]) for gait in range(len(self.gaits))])
        paths.setflags(write=False)
        return paths

    def _growing(self, gait: int) -> np.ndarray:
        """Residuals [P + 1, 3] that grow evenly to the mean one; 0 for a gait without rows."""
        rows = int((self.inner.pooled or self.inner).joint.marginal("Gait")[gait])
        end = self.inner.mean_pose(gait) if rows else np.zeros(3)
        return np.arange(1, _POINTS + 1)[:, None] / _POINTS * end

    def mean_pose(self, gait: int) -> np.ndarray:
        """Return the end of the gait's own arc with its mean residual, [3]."""
        pose: np.ndarray = self._moved(gait, self.inner.mean_pose(gait)[None])[-1]
        return pose

    def _moved(self, gait: int, gaps: np.ndarray) -> np.ndarray:
        """Poses [P, 3] of residuals [P, 3] at equal parts of a gait."""
        gap: Any = Polar.from_cartesian(*gaps.T)
        pose = added(self.motion.of_gait(gait, len(gaps)), gap)
        return np.column_stack([pose.forward, pose.right, pose.heading])

    def draw(self, gait: int, uniforms: np.ndarray) -> Polar[FloatArray]:
        """Return poses [...]: residuals drawn from the tables beside the end of the gait's own arc."""
        return added(self.motion.of_gait(gait), super().draw(gait, uniforms))

    def recast(self, rows: pd.DataFrame) -> pd.DataFrame:
        """Return the rows with their residuals instead of their poses."""
        return self.motion.of(rows)

    def select(self, rows: pd.DataFrame) -> pd.DataFrame:
        """Return those of ``rows`` that such tables count."""
        return self.inner.select(rows)

    def learn(self, rows: pd.DataFrame) -> ResidualTables:
        """Return the tables that have also counted ``rows``, beside the same motion."""
        seen: Any = type(self.seen).of(rows, self.gaits, self.seen.axes)
        return replace(self, inner=self.inner.learn(self.recast(rows)), seen=self.seen.merge(seen))

    def given(self, context: Mapping[str, str]) -> TableSource:
        """Return the tables after one gait; these, if they do not depend on the gait before."""
        inner = self.inner.given(context)
        if inner is self.inner or not isinstance(inner, CountedTables) or not isinstance(self.seen, PreviousCounts):
            return self
        part = self.seen.after[self.gaits.index(context[PREVIOUS])]
        return ResidualTables(inner, self.motion, part, self.seen.joint)

    def log_likelihood(self, seen: JointCounts | PreviousCounts) -> float:
        """Return the sum over residuals counted of their log-probability; -inf if one is 0."""
        return self.inner.log_likelihood(seen)

    @cached_property
    def binned(self) -> DrawnTables:
        """The tables of the poses in ordinary bins."""
        return DrawnTables(self)

    def __reduce__(self) -> tuple[Any, ...]:
        return ResidualTables, (self.inner, self.motion, self.seen, self.whole)


@dataclass(frozen=True)
class DrawnTables(TableSource):
    """Tables in ordinary bins of outcomes drawn from tables of residuals; naive, or with the gait before as a cause.

    Counts, support and learned coordinates are those of the rows themselves; how sure a column is, is that of a
    Dirichlet with the column as its mean and as many rows as the gait has behind it.
    """

    residual: ResidualTables

    @property
    def gaits(self) -> GaitRepertoire:
        """The repertoire, in table order."""
        return self.residual.gaits

    @property
    def prior(self) -> float:  # type: ignore[override]
        """Dirichlet pseudo-count per cell of the tables of residuals."""
        return self.residual.prior

    @property
    def gait_prior(self) -> str:  # type: ignore[override]
        """ "uniform" or "empirical"."""
        return self.residual.gait_prior

    @property
    def known(self) -> Mapping[str, str]:  # type: ignore[override]
        """States of other variables that the tables are conditioned on."""
        return self.residual.known

    @property
    def structure(self) -> Structure:  # type: ignore[override]
        """The paper's edges, and those of the gait before where the residuals have them."""
        return PREVIOUS_GAIT if depends_on_previous(self.residual.structure) else NAIVE

    @property
    def residuals(self) -> Residuals:
        """The motion behind the tables."""
        return self.residual.residuals

    @cached_property
    def _drawn(self) -> tuple[EffectAxes, dict[str, np.ndarray]]:
        """Bins that reach the farthest draw, and P(effect | parents) [K, ...parents] of each."""
        sources = [self.residual]
        if self.structure is PREVIOUS_GAIT:
            sources = [self.residual.given({PREVIOUS: name}) for name in self.gaits.names]  # type: ignore[misc]
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
        axes, seen = self._drawn[0], self.residual.seen
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
        rows, whole = self.residual.seen, self.residual.whole
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

    def learn(self, rows: pd.DataFrame) -> DrawnTables:
        """Return the tables of residuals that have also counted ``rows``, drawn anew."""
        return DrawnTables(self.residual.learn(rows))

    def given(self, context: Mapping[str, str]) -> TableSource:
        """Return the tables after one gait; these, if they do not depend on the gait before."""
        part = self.residual.given(context)
        return self if part is self.residual or not isinstance(part, ResidualTables) else DrawnTables(part)

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
        return DrawnTables, (self.residual,)
