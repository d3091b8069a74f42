"""Tables of counted rows: all together, or by what went before.

In the second kind momentum carries over: the paper's network has a second cause,
``P(PreviousGait) P(Gait) prod_v P(v | Gait, PreviousGait)`` for v in Distance, Angle, Heading. Its tables are those of
one naive Bayes model for each gait before, which :meth:`ContextTables.given` returns.

Before the first decision of a hunt there is no gait before. The data have a single such row a table (the
robot at rest; one a shard of a large table), too few for tables of their own, so that row is not counted,
and PreviousGait is then simply not known: it is summed over,
``P(v.. | Gait) = sum_p P(PreviousGait = p) P(v.. | Gait, p)``, as the network's own inference does. P(PreviousGait) is
set as P(Gait) is: uniform (``gait_prior="uniform"``, the robot chooses), or the share of the rows.
Letters: G gaits, K bins of a variable, P part-way poses of a gait.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Self

import numpy as np
import pandas as pd

from bayeshunt.core import statistics
from bayeshunt.core.bins import EFFECTS, ENERGY
from bayeshunt.core.checks import check_pseudo_count
from bayeshunt.core.errors import DataError, InputError, did_you_mean
from bayeshunt.models.counting.backoff import PRIOR, check_strength, leaning_poses, leaning_table
from bayeshunt.models.counting.cells import conditional
from bayeshunt.models.counting.joint import JointCounts
from bayeshunt.models.counting.previous import PreviousCounts, previous_codes
from bayeshunt.models.counting.tally import SCALE
from bayeshunt.models.tables.effects import IndependentEffects, JointEffects, check_size, compile_effects, local_tables
from bayeshunt.models.tables.sources import TableSource
from bayeshunt.models.tables.structures import NAIVE, PREVIOUS, PREVIOUS_GAIT, Structure, depends_on_previous

__all__ = [
    "GAIT_PRIORS",
    "ContextTables",
    "CountedTables",
    "check_every_gait_seen",
    "check_settings",
    "shares",
    "tables_of",
]

#: How P(Gait) is set: 1/G as in the paper, or the share of each gait in the rows.
GAIT_PRIORS = ("uniform", "empirical")


class _RowTables(TableSource):
    """Tables that can count further rows."""

    def learn(self, rows: pd.DataFrame) -> Self:
        """Return the tables that have also counted ``rows``."""
        more: Any = self.count(rows)
        made = tables_of(self.counted.merge(more), self.prior, self.gait_prior, self.structure, self.backoff)
        assert isinstance(made, type(self))
        return made


@dataclass(frozen=True)
class CountedTables(_RowTables):
    """Tables of rows counted together.

    pooled: of a part of a model, the tables of all its rows. P(Gait) is theirs, because the robot chooses
        whatever went before; so are poses and learned coordinates where the part has no rows.
    backoff: rows that the pooled tables are worth beside the part's own, see ``models.counting.backoff``; poses lean
        on the pooled ones likewise, and learned coordinates are the pooled ones. None: the part stands alone.
    """

    joint: JointCounts
    prior: float = 0.0
    gait_prior: str = "uniform"
    structure: Structure = NAIVE
    known: Mapping[str, str] = field(default_factory=dict, hash=False)
    pooled: CountedTables | None = None
    backoff: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "prior", check_settings(self.prior, self.gait_prior))
        if depends_on_previous(self.structure):
            raise InputError("this structure needs counts by the gait before; fit it: ForwardModel.fit")

    @cached_property
    def effects(self) -> IndependentEffects | JointEffects:
        """P(Distance, Angle, Heading | Gait)."""
        if self.pooled is not None and self.backoff is not None:
            base = self.pooled.effects.local
            local = {e: leaning_table(self.joint.marginal(e), base[e], self.backoff) for e in EFFECTS}
            for table in local.values():
                table.setflags(write=False)
            return IndependentEffects.of_tables(local)
        return compile_effects(self.structure, self.joint, self.prior)

    @cached_property
    def energy(self) -> np.ndarray | None:
        """P(Energy | Gait) [E, G]; None where Energy is no node."""
        if self.axes.energy is None:
            return None
        if self.pooled is not None and self.backoff is not None:
            assert self.pooled.energy is not None
            table = leaning_table(self.joint.spent, self.pooled.energy, self.backoff)
        else:
            table = statistics.normalise(self.joint.spent, self.prior, name=ENERGY)
        table.setflags(write=False)
        return table

    @cached_property
    def causes(self) -> dict[str, np.ndarray]:
        """P(Gait) [G]."""
        if self.pooled is not None:
            return self.pooled.causes
        return {"Gait": _share(self.joint.marginal("Gait"), self.prior, self.gait_prior, "Gait")}

    @property
    def learned_cells(self) -> np.ndarray:
        """Int64 [M, 2]: the (Distance, Angle) bins that rows fell into, sorted; of all rows if these lean on them."""
        if self.pooled is not None and (self.backoff is not None or not self.joint.total):
            return self.pooled.learned_cells
        return np.argwhere(self.joint.support > 0)

    @cached_property
    def mean_paths(self) -> np.ndarray | None:
        """Mean path of each gait [G, P + 1, 3], exact sums of the rows; of a gait without rows here: of all rows."""
        if not (self.joint if self.pooled is None else self.pooled.joint).points:
            return None
        paths = np.stack([self._mean_path(gait) for gait in range(len(self.gaits))])
        paths.setflags(write=False)
        return paths

    def mean_pose(self, gait: int) -> np.ndarray:
        """Return the mean final pose [3] of the rows themselves; of a gait without rows here, of all rows."""
        pose: np.ndarray = self._mean_path(gait)[-1]
        return pose

    def _mean_path(self, gait: int) -> np.ndarray:
        if self.pooled is None:
            return self.joint.mean_poses(gait)
        rows = int(self.joint.marginal("Gait")[gait])
        if rows and self.backoff is None:
            return self.joint.mean_poses(gait)
        if not rows or self.backoff is None:
            return self.pooled.joint.mean_poses(gait)
        base, seen = self.pooled.joint, int(self.pooled.joint.marginal("Gait")[gait])
        return leaning_poses(self.joint.sums[gait], rows, base.sums[gait], seen, self.backoff, SCALE)

    def pseudo_counts(self, variable: str) -> np.ndarray | float:
        """Dirichlet pseudo-counts of each cell: [K, G] where the part leans on the pooled tables."""
        leant = None if variable == "Gait" else self.local_pseudo(variable)
        return self.prior if leant is None else leant

    def local_pseudo(self, effect: str) -> np.ndarray | None:
        """Pseudo-counts of the tables leant on; None where the part stands alone."""
        if self.pooled is None or self.backoff is None:
            return None
        return self.backoff * self.pooled.local[effect]

    def select(self, rows: pd.DataFrame) -> pd.DataFrame:
        """Return the rows of this context; all, if there is none."""
        if PREVIOUS not in self.known:
            return rows
        here = np.flatnonzero(previous_codes(rows, self.gaits) == self.gaits.index(self.known[PREVIOUS]))
        return rows.iloc[here]

    def __reduce__(self) -> tuple[Any, ...]:
        # Without what is derived: a worker process makes it again, faster than it could receive it.
        known, leant = dict(self.known), (self.pooled, self.backoff)
        return CountedTables, (self.joint, self.prior, self.gait_prior, self.structure, known, *leant)


@dataclass(frozen=True)
class ContextTables(_RowTables):
    """Tables of rows counted by the gait before: P(effect | Gait, PreviousGait).

    by_previous: the counts of the rows after each gait; ``joint`` holds the same rows together.
    backoff: rows that P(effect | Gait) is worth in each P(effect | Gait, PreviousGait), instead of the prior; the
        prior then smooths P(effect | Gait). None: no back-off.

    Asked directly, they answer as if the gait before were not known (summed over); :meth:`given` has the
    tables after one that is. Poses and learned coordinates are those of all rows.
    """

    by_previous: PreviousCounts
    prior: float = 0.0
    gait_prior: str = "uniform"
    structure: Structure = PREVIOUS_GAIT
    backoff: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "prior", check_settings(self.prior, self.gait_prior))
        if self.backoff is not None:
            object.__setattr__(self, "backoff", check_strength(self.backoff))
        if self.structure.poses != PREVIOUS_GAIT:
            raise InputError("this structure is fitted to JointCounts; counts by the gait before are for previous_gait")

    @property
    def known(self) -> Mapping[str, str]:  # type: ignore[override]
        """Nothing: the gait before is summed over."""
        return {}

    @property
    def joint(self) -> JointCounts:  # type: ignore[override]
        """All rows, whatever gait went before."""
        return self.by_previous.joint

    @property
    def counted(self) -> PreviousCounts:
        """The counts by the gait before."""
        return self.by_previous

    @cached_property
    def pooled(self) -> CountedTables:
        """The paper's tables of all rows."""
        return CountedTables(self.joint, self.prior, self.gait_prior, _with_energy(NAIVE, self.joint))

    @cached_property
    def effects(self) -> JointEffects:
        """P(Distance, Angle, Heading | Gait), the gait before summed over."""
        local = local_tables(PREVIOUS_GAIT, self.cells, self.prior) if self.backoff is None else self._leaning()
        sizes = (len(self.gaits), *self.axes.shape)
        return JointEffects.of_tables(PREVIOUS_GAIT, local, sizes, {PREVIOUS: self.causes[PREVIOUS]})

    def _leaning(self) -> dict[str, np.ndarray]:
        """P(effect | Gait, PreviousGait) [K, G, G] with back-off to P(effect | Gait)."""
        assert self.backoff is not None
        check_size(PREVIOUS_GAIT, self.cells)
        base = self.pooled.effects.local
        counts = {effect: self.cells.tabulate((effect, "Gait", PREVIOUS)) for effect in EFFECTS}
        return {e: leaning_table(counts[e], base[e][:, :, None], self.backoff) for e in EFFECTS}

    @cached_property
    def energy(self) -> np.ndarray | None:
        """P(Energy | Gait, PreviousGait) [E, G, G]; None where Energy is no node."""
        if self.axes.energy is None:
            return None
        counts = self.by_previous.spent
        if self.backoff is None:
            return conditional(counts, self.prior)
        assert self.pooled.energy is not None
        return leaning_table(counts, self.pooled.energy[:, :, None], self.backoff)

    @cached_property
    def causes(self) -> dict[str, np.ndarray]:
        """P(PreviousGait) [G] and P(Gait) [G]."""
        before = _share(self.by_previous.pairs.sum(axis=1), self.prior, self.gait_prior, PREVIOUS)
        return {PREVIOUS: before, **self.pooled.causes}

    def local_pseudo(self, effect: str) -> np.ndarray | None:
        """Pseudo-counts [K, G, 1] of the tables leant on."""
        return None if self.backoff is None else self.backoff * self.pooled.local[effect][:, :, None]

    @property
    def learned_cells(self) -> np.ndarray:
        """Int64 [M, 2]: the (Distance, Angle) bins that rows fell into, sorted."""
        return self.pooled.learned_cells

    @property
    def mean_paths(self) -> np.ndarray | None:
        """Mean path of each gait [G, P + 1, 3] over all rows."""
        return self.pooled.mean_paths

    def mean_pose(self, gait: int) -> np.ndarray:
        """Return the mean final pose [3] over all rows."""
        return self.pooled.mean_pose(gait)

    def given(self, context: Mapping[str, str]) -> TableSource:
        """Return naive Bayes given ``PreviousGait``: the tables of the rows after that gait."""
        if PREVIOUS not in context:
            return self
        part = self.by_previous.after[self.gaits.index(context[PREVIOUS])]
        structure = _with_energy(NAIVE, self.joint)
        return CountedTables(part, self.prior, self.gait_prior, structure, dict(context), self.pooled, self.backoff)

    def log_likelihood(self, seen: JointCounts | PreviousCounts) -> float:
        """Return the sum over rows of log P(Gait) + log P(effects | Gait, PreviousGait); -inf if one is 0."""
        if isinstance(seen, JointCounts):
            raise InputError("structure 'previous_gait' needs PreviousCounts: these do not know the gait before")
        parts = zip(self.gaits.names, seen.after, strict=True)
        return sum(self.given({PREVIOUS: name}).log_likelihood(part) for name, part in parts if part.total)

    def select(self, rows: pd.DataFrame) -> pd.DataFrame:
        """Return the rows that a gait went before."""
        return rows.iloc[np.flatnonzero(previous_codes(rows, self.gaits) >= 0)]

    def __reduce__(self) -> tuple[Any, ...]:
        return ContextTables, (self.by_previous, self.prior, self.gait_prior, self.structure, self.backoff)


def tables_of(
    counts: JointCounts | PreviousCounts,
    prior: float | None = None,
    gait_prior: str = "uniform",
    structure: Structure | None = None,
    backoff: float | None = None,
) -> CountedTables | ContextTables:
    """Return the tables of counted rows; the structure is by default the simplest of their kind.

    prior: by default 0; with back-off 0.03, so that nothing within the axes is impossible.

    Raises InputError for a structure of the other kind, a bad prior or gait prior.
    """
    if prior is None:
        prior = 0.0 if backoff is None else PRIOR
    if backoff is not None:
        check_strength(backoff)
    if structure is None:
        structure = PREVIOUS_GAIT if isinstance(counts, PreviousCounts) else NAIVE
    structure = _with_energy(structure, counts)
    if isinstance(counts, PreviousCounts):
        return ContextTables(counts, prior, gait_prior, structure, backoff)
    if backoff is not None:
        raise InputError("backoff is for structure 'previous_gait': other tables have no context to lean on")
    return CountedTables(counts, prior, gait_prior, structure)


def _with_energy(structure: Structure, counts: JointCounts | PreviousCounts) -> Structure:
    """A structure with Energy as a node, or without it, as the counts have it."""
    return structure.poses if counts.axes.energy is None else structure.with_energy()


def check_every_gait_seen(tables: CountedTables | ContextTables) -> None:
    """Raise DataError if prior 0 leaves a gait, or a gait after another, without any row to go by."""
    if tables.prior > 0:
        return
    names, unseen = tables.gaits.names, np.flatnonzero(tables.joint.marginal("Gait") == 0)
    if unseen.size:
        seen = f"{len(names) - unseen.size} of {len(names)} gaits"
        raise DataError(
            f"gait {names[int(unseen[0])]!r} has no rows; babble it, or fit with a prior > 0 (there are {seen})"
        )
    if not isinstance(tables, ContextTables) or tables.backoff is not None:
        return
    if len(pairs := np.argwhere(tables.by_previous.pairs == 0)):
        before, gait = (names[i] for i in pairs[0])
        raise DataError(
            f"structure 'previous_gait': gait {gait!r} was never babbled right after {before!r} ({len(pairs)} of "
            f"{len(names) ** 2} pairs are missing); babble more, or fit with a prior > 0"
        )


def shares(tables: CountedTables | ContextTables) -> dict[str, np.ndarray]:
    """Return P(cause) [G] of each cause as the rows have it."""
    rows = {"Gait": tables.joint.marginal("Gait")}
    if isinstance(tables, ContextTables):
        rows = {PREVIOUS: tables.by_previous.pairs.sum(axis=1), **rows}
    return {cause: _share(counts, tables.prior, "empirical", cause) for cause, counts in rows.items()}


def check_settings(prior: Any, gait_prior: Any) -> float:
    """Return the prior as a float; raises InputError for a prior or gait prior out of range."""
    if gait_prior not in GAIT_PRIORS:
        raise InputError(f"gait_prior is {gait_prior!r}{did_you_mean(gait_prior, GAIT_PRIORS)}")
    return check_pseudo_count(prior, "prior")


def _share(counts: np.ndarray, prior: float, how: str, name: str) -> np.ndarray:
    """P(cause) [G]: uniform, or the share of ``counts``; read-only."""
    if how == "uniform":
        share = np.full(len(counts), 1.0 / len(counts))
    else:
        share = statistics.normalise(counts[:, None], prior, name=name)[:, 0]
    share.setflags(write=False)
    return share
