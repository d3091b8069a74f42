"""What was counted after each gait: the sufficient statistics of a network with the gait before as a second cause.

Letters: G gaits, K counted cells.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, reduce
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.bins import EFFECTS, EffectAxes
from bayeshunt.core.errors import DataError, InputError
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.models.counting.cells import CountedCells
from bayeshunt.models.counting.joint import JointCounts
from bayeshunt.models.tables.structures import PREVIOUS, Structure, depends_on_previous

__all__ = ["COLUMN", "PreviousCounts", "counts_for", "previous_codes"]

#: The column of a babbling table that says which gait went before.
COLUMN = "previous_gait"


@dataclass(frozen=True)
class PreviousCounts:
    """The counts of the rows that followed each gait: exact, in any order and split, as JointCounts are.

    after: one JointCounts for each gait of the repertoire, in its order: the rows executed right after it.

    A row that no gait went before (the first of a table, and of each shard of a large one: the robot
    was at rest) says nothing about any gait before it, and is not counted.
    """

    after: tuple[JointCounts, ...]

    def __post_init__(self) -> None:
        axes = reduce(lambda axes, part: axes.covering(part.axes), self.after, self.after[0].axes)
        parts = (part if part.axes == axes else replace(part, axes=axes) for part in self.after)
        object.__setattr__(self, "after", tuple(parts))

    @classmethod
    def empty(cls, gaits: GaitRepertoire, axes: EffectAxes) -> PreviousCounts:
        """Nothing counted yet."""
        return cls((JointCounts.empty(gaits, axes),) * len(gaits))

    @classmethod
    def of(cls, frame: pd.DataFrame, gaits: GaitRepertoire, axes: EffectAxes) -> PreviousCounts:
        """Count a validated babbling table that says which gait went before each row.

        Raises DataError without the column, for a gait before that is not in the repertoire, or as JointCounts does.
        """
        before = previous_codes(frame, gaits)
        chosen = (frame[before == gait] for gait in range(len(gaits)))
        return cls(tuple(JointCounts.of(f, gaits, axes) if len(f) else JointCounts.empty(gaits, axes) for f in chosen))

    def merge(self, other: PreviousCounts) -> PreviousCounts:
        """Return the counts of both; errors as of ``JointCounts.merge``."""
        if self.gaits.names != other.gaits.names:
            raise InputError("cannot join counts of different gaits")
        return PreviousCounts(tuple(one.merge(two) for one, two in zip(self.after, other.after, strict=True)))

    @property
    def gaits(self) -> GaitRepertoire:
        """The repertoire."""
        return self.after[0].gaits

    @property
    def axes(self) -> EffectAxes:
        """The effect axes."""
        return self.after[0].axes

    @property
    def total(self) -> int:
        """Number of rows counted."""
        return sum(part.total for part in self.after)

    @cached_property
    def joint(self) -> JointCounts:
        """The same rows, whatever gait went before them."""
        return reduce(JointCounts.merge, self.after)

    @cached_property
    def table(self) -> CountedCells:
        """The cells over (PreviousGait, Gait, Distance, Angle, Heading)."""
        cells = [np.insert(part.cells, 0, before, axis=1) for before, part in enumerate(self.after)]
        sizes = (len(self.gaits), len(self.gaits), *self.axes.shape)
        counts = np.concatenate([part.counts for part in self.after])
        return CountedCells((PREVIOUS, "Gait", *EFFECTS), sizes, np.concatenate(cells), counts)

    @property
    def spent(self) -> np.ndarray:
        """Int64 [E, G, G]: rows in each bin of Energy by gait and by the gait before."""
        return np.stack([part.spent for part in self.after], axis=2)

    @property
    def pairs(self) -> np.ndarray:
        """Int64 [G, G]: rows of each gait (column) after each gait before (row)."""
        return np.stack([part.marginal("Gait") for part in self.after])

    def __reduce__(self) -> tuple[Any, ...]:
        return PreviousCounts, (self.after,)


def counts_for(structure: str | Structure) -> type[JointCounts] | type[PreviousCounts]:
    """Return the kind of counts that a structure is fitted to."""
    return PreviousCounts if depends_on_previous(structure) else JointCounts


def previous_codes(
    frame: pd.DataFrame, gaits: GaitRepertoire, *, source: str = "table", first_row: int = 0
) -> np.ndarray:
    """Return the index [N] of the gait before each row; -1 where there was none.

    source: what messages call the table. first_row: what they call its first row.
    Raises DataError without the column ``previous_gait``, or for a name that is not in the repertoire.
    """
    if COLUMN not in frame.columns:
        raise DataError(
            f"{source}: column {COLUMN!r} is missing, and structure 'previous_gait' needs it; "
            "choose another structure, or babble again"
        )
    names = frame[COLUMN]
    codes = pd.Index(gaits.names, dtype=object).get_indexer(pd.Index(names, dtype=object))
    strange = (codes < 0) & names.notna().to_numpy()
    if strange.any():
        row = int(strange.argmax())
        raise DataError(
            f"{source}: row {first_row + row}: {COLUMN} {names.iloc[row]!r} is not in the repertoire; "
            f"expected one of {', '.join(gaits.names)}"
        )
    return codes
