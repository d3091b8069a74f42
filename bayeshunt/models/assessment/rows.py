"""A babbling table as bin numbers, and its split into folds: what every score of ``assess`` works on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from bayeshunt.core.bins import EFFECTS, EffectAxes
from bayeshunt.core.errors import DataError, InputError
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.data import babbling_table
from bayeshunt.models.counting.cells import MAX_DISTANCE_BINS, CountedCells
from bayeshunt.models.tables.structures import CAUSES, PREVIOUS

__all__ = ["NO_GAIT", "CodedRows", "set_aside"]

#: State of PreviousGait in a row that no gait went before.
NO_GAIT = "(none)"
#: A row this many times as far out as nine tenths of the rows is no outcome of a gait, if it is beyond so many bins.
_GLITCH, _GLITCH_BINS = 10.0, 100
#: Forecasts of more rows x distance bins than this (512 MB) are refused rather than allocated.
_MOST_FORECASTS = 1 << 26


@dataclass(frozen=True, eq=False)
class CodedRows:
    """The rows of a babbling table as state numbers.

    gaits, axes: what the numbers mean; the distance axis reaches the farthest row.
    codes: int64 [N, V], columns ``names``. has_previous: whether the table knows the gait before.
    """

    gaits: GaitRepertoire
    axes: EffectAxes
    codes: np.ndarray
    has_previous: bool

    @classmethod
    def of(cls, frame: pd.DataFrame, gaits: GaitRepertoire, axes: EffectAxes) -> CodedRows:
        """Discretise a babbling table; raises DataError if it is not one, or if a gait before is unknown."""
        babbling_table.validate(frame, gaits.names)
        _check_reach(frame, axes)
        codes = babbling_table.discretise(frame, gaits, axes)
        axes = axes.extended(int(codes[:, 1].max()) + 1)
        has_previous = "previous_gait" in frame.columns and bool(frame["previous_gait"].notna().any())
        if has_previous:
            codes = np.column_stack([_previous(frame["previous_gait"], gaits), codes])
        return cls(gaits, axes, codes, has_previous)

    @property
    def names(self) -> tuple[str, ...]:
        """The variables, in the order of the columns."""
        return (*CAUSES, *EFFECTS) if self.has_previous else ("Gait", *EFFECTS)

    @property
    def states(self) -> dict[str, list[str]]:
        """Names of the states of each variable."""
        labels = {"Gait": list(self.gaits.names), **{axis.name: list(axis.labels) for axis in self.axes}}
        return {PREVIOUS: [*self.gaits.names, NO_GAIT], **labels} if self.has_previous else labels

    @property
    def sizes(self) -> dict[str, int]:
        """Number of states of each variable."""
        return {name: len(states) for name, states in self.states.items()}

    def column(self, name: str) -> np.ndarray:
        """State numbers [N] of one variable."""
        return self.codes[:, self.names.index(name)]

    def count(self, chosen: np.ndarray | slice = slice(None)) -> CountedCells:
        """Count the rows chosen by a mask or slice."""
        sizes = self.sizes
        return CountedCells.of_rows(self.names, [sizes[name] for name in self.names], self.codes[chosen])

    def folds(self, number: int, rng: np.random.Generator) -> np.ndarray:
        """Return the fold [N] of each row, 0 to ``number - 1``: at random, each gait spread evenly.

        Raises InputError unless 2 <= number <= rows; DataError for a single row.
        """
        if len(self.codes) < 2:
            raise DataError("the table has one row; a held-out score needs two: one to learn from, one to predict")
        if isinstance(number, bool) or not isinstance(number, (int, np.integer)) or not 2 <= number <= len(self.codes):
            raise InputError(f"folds: expected a whole number from 2 to {len(self.codes)} (the rows), got {number!r}")
        order = np.lexsort((rng.random(len(self.codes)), self.column("Gait")))
        fold = np.empty(len(order), dtype=np.int64)
        fold[order] = np.arange(len(order)) % number
        return fold


def set_aside(frame: pd.DataFrame, axes: EffectAxes) -> tuple[pd.DataFrame, list[str]]:
    """Return the rows that can be scored, and what to say of those that cannot: single rows absurdly far out.

    One such row makes the distance axis, and every table with it, as long as itself. Fewer than two rows are
    never left.
    """
    distances = frame["distance"].to_numpy(dtype=float)
    usual = float(np.quantile(distances, 0.9, method="lower"))
    far = distances > max(_GLITCH * usual, _GLITCH_BINS * axes.distance.width)
    if not far.any() or (~far).sum() < 2:
        return frame, []
    rows = np.flatnonzero(far).tolist()
    listed = ", ".join(map(str, rows[:5])) + (f" and {len(rows) - 5} more" if len(rows) > 5 else "")
    which, them = ("Row {} is", "it") if len(rows) == 1 else ("Rows {} are", "them")
    said = (
        f"{which.format(listed)} left out: {distances.max():g} m away, where nine tenths of the rows end within "
        f"{usual:.3g} m; correct or drop {them}."
    )
    return frame[~far], [said]


def _check_reach(frame: pd.DataFrame, axes: EffectAxes) -> None:
    """Raise DataError if the farthest row would make the forecasts too large to hold."""
    distances = frame["distance"].to_numpy(dtype=float)
    row = int(distances.argmax())
    bins = distances[row] / axes.distance.width
    if bins >= MAX_DISTANCE_BINS or bins * len(frame) > _MOST_FORECASTS:
        raise DataError(
            f"row {row}: distance is {distances[row]:g} m, {bins:,.0f} distance bins of {axes.distance.width:g} m; "
            "too many to score: give wider bins (axes), or correct the row"
        )


def _previous(names: pd.Series, gaits: GaitRepertoire) -> np.ndarray:
    """State numbers [N] of the gait before; the last state where there was none."""
    known = names.notna().to_numpy()
    strange = known & ~names.isin(gaits.names).to_numpy()
    if strange.any():
        row = int(strange.argmax())
        raise DataError(f"row {row}: previous_gait {names.iloc[row]!r} is not in the repertoire")
    position = {name: index for index, name in enumerate(gaits.names)}
    return np.array([position.get(name, len(gaits)) for name in names], dtype=np.int64)
