"""Tables of what a command's own motion misses.

They count residuals (``models.motion.residuals``) on their own bins; what they are asked of poses, draws and means, has
the command's motion added. The tables of the poses in ordinary bins follow from them: ``models.tables.drawn``.
Letters: G gaits, P part-way poses of a gait.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.geometry import FloatArray, Polar
from bayeshunt.models.counting.joint import JointCounts
from bayeshunt.models.counting.previous import PreviousCounts
from bayeshunt.models.motion.residuals import UNICYCLE, Residuals, added
from bayeshunt.models.tables.counted import ContextTables, CountedTables
from bayeshunt.models.tables.drawn import DrawnTables
from bayeshunt.models.tables.effects import IndependentEffects, JointEffects
from bayeshunt.models.tables.sources import TableSource
from bayeshunt.models.tables.structures import PREVIOUS

__all__ = ["ResidualTables"]

_POINTS = 13  # of a mean path, where the rows have no part-way poses
#: What the tables have of those over the residuals.
_COUNTED = ("joint", "prior", "gait_prior", "structure", "known", "backoff")


@dataclass(frozen=True)
class ResidualTables(TableSource):
    """Counted residuals of the gaits' commands.

    inner: tables over the bins of the residuals. residuals: the motion that is added.
    seen: the same rows' poses in ordinary bins, which :attr:`binned` has. whole: of a part after a gait, those of all.
    """

    inner: CountedTables | ContextTables
    residuals: Residuals = field()  # without it, the None of all table sources would be its default
    seen: JointCounts | PreviousCounts
    whole: JointCounts | None = None

    def __post_init__(self) -> None:
        for name in _COUNTED:
            object.__setattr__(self, name, getattr(self.inner, name))

    @property
    def residual_of(self) -> str:
        """Whose residuals they are."""
        return UNICYCLE

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

    @cached_property
    def mean_paths(self) -> np.ndarray | None:
        """Mean path of each gait [G, P + 1, 3]: the command's arc and the mean residual at each point of it.

        Of rows without part-way poses: as if the residual of the end grew evenly.
        """
        if self._summed:
            paths = self._over_befores([part.mean_paths for part in self._parts])
        else:
            gaps = self.inner.mean_paths
            if gaps is None:
                gaps = np.stack([self._growing(gait) for gait in range(len(self.gaits))])
            paths = np.stack([self._moved(gait, gaps[gait]) for gait in range(len(self.gaits))])
        paths.setflags(write=False)
        return paths

    @property
    def _summed(self) -> bool:
        """Whether the motion lags behind a gait that is not known: it is summed over."""
        return self.residuals.motion.lags and isinstance(self.inner, ContextTables)

    @cached_property
    def _parts(self) -> list[TableSource]:
        """The tables after each gait."""
        return [self.given({PREVIOUS: name}) for name in self.gaits.names]

    def _over_befores(self, poses: list[Any]) -> np.ndarray:
        """Mean poses [..., 3] of those after each gait [G, ..., 3], by P(PreviousGait); the heading's mean is circular.

        A gait may have gone before none: parts lean on all rows, so that each has poses.
        """
        each = np.stack(poses)
        turned = np.stack([*np.moveaxis(each[..., :2], -1, 0), np.cos(each[..., 2]), np.sin(each[..., 2])])
        forward, right, cosine, sine = np.tensordot(self.causes[PREVIOUS], turned, axes=(0, 1))
        return np.stack([forward, right, np.arctan2(sine, cosine)], axis=-1)

    def _growing(self, gait: int) -> np.ndarray:
        """Residuals [P + 1, 3] that grow evenly to the mean one; 0 for a gait without rows."""
        rows = int((self.inner.pooled or self.inner).joint.marginal("Gait")[gait])
        end = self.inner.mean_pose(gait) if rows else np.zeros(3)
        return np.arange(1, _POINTS + 1)[:, None] / _POINTS * end

    def mean_pose(self, gait: int) -> np.ndarray:
        """Return the end of the gait's own arc with its mean residual, [3]."""
        if self._summed:
            return self._over_befores([part.mean_pose(gait) for part in self._parts])
        pose: np.ndarray = self._moved(gait, self.inner.mean_pose(gait)[None])[-1]
        return pose

    def _moved(self, gait: int, gaps: np.ndarray) -> np.ndarray:
        """Poses [P, 3] of residuals [P, 3] at equal parts of a gait."""
        gap: Any = Polar.from_cartesian(*gaps.T)
        pose = added(self.residuals.of_gait(gait, len(gaps)), gap)
        return np.column_stack([pose.forward, pose.right, pose.heading])

    def draw(self, gait: int, uniforms: np.ndarray) -> Polar[FloatArray]:
        """Return poses [...]: residuals drawn from the tables beside the end of the gait's own arc."""
        if self._summed:
            return self._draw_after_any(gait, uniforms)
        return added(self.residuals.of_gait(gait), super().draw(gait, uniforms))

    def _draw_after_any(self, gait: int, uniforms: np.ndarray) -> Polar[FloatArray]:
        """Poses [...] after gaits drawn by P(PreviousGait): the first number draws it, what is left of it goes on."""
        reach = np.concatenate([[0.0], np.cumsum(self.causes[PREVIOUS])])
        before = np.clip(np.searchsorted(reach, uniforms[..., 0], side="right") - 1, 0, len(self.gaits) - 1)
        found = np.empty((3, *before.shape))
        for number in np.unique(before):
            here = before == number
            mine = uniforms[here].copy()
            mine[..., 0] = ((mine[..., 0] - reach[number]) / (reach[number + 1] - reach[number])).clip(0, 1 - 1e-12)
            found[:, here] = self._parts[number].draw(gait, mine)
        return Polar(*found)

    def recast(self, rows: pd.DataFrame) -> pd.DataFrame:
        """Return the rows with their residuals instead of their poses."""
        return self.residuals.of(rows)

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
        return ResidualTables(inner, self.residuals.after(context[PREVIOUS]), part, self.seen.joint)

    def log_likelihood(self, seen: JointCounts | PreviousCounts) -> float:
        """Return the sum over residuals counted of their log-probability; -inf if one is 0."""
        return self.inner.log_likelihood(seen)

    @cached_property
    def binned(self) -> DrawnTables:
        """The tables of the poses in ordinary bins."""
        return DrawnTables(self, self.seen, self.whole)

    def __reduce__(self) -> tuple[Any, ...]:
        return ResidualTables, (self.inner, self.residuals, self.seen, self.whole)
