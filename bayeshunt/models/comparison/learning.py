"""Watching a model learn: what it knew after each row, how well that foretells others, and what to babble next."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core import displays
from bayeshunt.core.bins import EFFECTS, EffectAxes
from bayeshunt.core.checks import check_kind, check_whole
from bayeshunt.core.errors import InputError
from bayeshunt.core.gaits import Gait, GaitRepertoire
from bayeshunt.data import babbling_table
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.comparison.information import expected_bits
from bayeshunt.models.counting.backoff import PRIOR
from bayeshunt.models.counting.measures import measured

__all__ = ["Learning"]


class Learning(displays.Instrument):
    """A babbling table read row by row.

    A notebook shows it as a widget with a slider over the rows (:attr:`widget`; its ``n`` follows the slider),
    :meth:`save` as a page.

    frame, gaits, prior, axes, gait_prior: as in ``ForwardModel.fit``; the structure is the paper's.
    Raises what ``ForwardModel.fit`` raises for a wrong table, prior or repertoire.
    """

    def __init__(
        self,
        frame: pd.DataFrame,
        gaits: Iterable[Gait | str] | GaitRepertoire,
        prior: float | None = None,
        *,
        axes: EffectAxes | None = None,
        gait_prior: str = "uniform",
    ) -> None:
        check_kind(frame, "frame", pd.DataFrame, "a babbling table")
        record = frame.attrs.get(babbling_table.PROVENANCE_KEY)
        self.gaits, self._axes = measured(gaits, axes, record)
        babbling_table.validate(frame, self.gaits.names)
        self.frame, self.prior, self.gait_prior = frame, prior, gait_prior

    def __len__(self) -> int:
        return len(self.frame)

    def model(self, n: int) -> ForwardModel:
        """Return the model after the first ``n`` rows: that of ``ForwardModel.fit(frame[:n], ...)``, bit for bit.

        Raises InputError for n out of range; with prior 0 DataError as long as a gait has no rows.
        """
        return ForwardModel.fit(self._first(n), self.gaits, self.prior, axes=self._axes, gait_prior=self.gait_prior)

    def coverage(self, at: Sequence[int] | None = None) -> pd.DataFrame:
        """Return what was reached after n rows: n, gaits (babbled so far), coordinates (learned), rows_each (mean).

        at: numbers of rows; None: about 20, evenly spread.
        """
        rows = []
        for n in self._steps(at, len(self)):
            model = self._smoothed(self._first(n), None)
            cells = len(model.learned_cells)
            rows.append((n, int((model.joint.marginal("Gait") > 0).sum()), cells, n / cells))
        return pd.DataFrame(rows, columns=["n", "gaits", "coordinates", "rows_each"])

    def widths(self, at: Sequence[int] | None = None, level: float = 0.95) -> pd.DataFrame:
        """Return how unsure the tables were after n rows: n, width (mean of the intervals of cells that hold rows).

        at: numbers of rows; None: about 20, evenly spread.
        """
        rows = []
        for n in self._steps(at, len(self)):
            model = self._smoothed(self._first(n), None)
            spans = []
            for effect in EFFECTS:
                table = model.table(effect, level)
                if table.count is not None and table.low is not None and table.high is not None:
                    spans.append((table.high - table.low).to_numpy()[table.count.to_numpy() > 0])
            rows.append((n, float(np.concatenate(spans).mean())))
        return pd.DataFrame(rows, columns=["n", "width"])

    def cells(self, most: int | None = None) -> tuple[np.ndarray, EffectAxes]:
        """Return the bins that the first ``most`` rows (None: all) fell into, int64 [N, 4]: gait, Distance, Angle,
        Heading; and the axes that hold them."""
        rows = self.frame if most is None else self.frame.iloc[:most]
        model = self._smoothed(rows, None)
        return babbling_table.discretise(rows, self.gaits, model.axes), model.axes

    def log_loss(self, at: Sequence[int] | None = None, *, every: int = 5) -> pd.DataFrame:
        """Return how well the first rows foretell rows held out: n, log_loss [nat per row], less is better.

        Every so many-th row is held out, never learned from. at: numbers of rows to learn from; None: about 20.
        Where the prior is 0, 0.03 a cell stands in: else a bin not seen yet would cost infinitely much.
        """
        check_whole(every, "every", 2)
        held = np.arange(len(self)) % every == every - 1
        if not held.any():
            raise InputError(f"{len(self)} rows are too few to hold every {every}th out")
        rest, out = self.frame[~held], self.frame[held]
        reach = ForwardModel.empty(self.gaits, 1.0, axes=self._axes).update(self.frame).axes
        rows = []
        for n in self._steps(at, len(rest)):
            model = self._smoothed(rest.iloc[:n], reach)
            rows.append((n, -model.log_likelihood(out) / len(out)))
        return pd.DataFrame(rows, columns=["n", "log_loss"])

    def babble_next(self, n: int | None = None) -> pd.Series:
        """Return the bits that one more row of each gait is expected to tell of its tables; most first.

        n: after so many rows; None: all. The effects add up; see :func:`~bayeshunt.models.comparison.information
        .expected_bits`. The pseudo-count is the model's prior, at prior 0 it is 1/K a cell.
        """
        model = self._smoothed(self.frame if n is None else self._first(n), None)
        tables = [model.joint.marginal(effect) for effect in EFFECTS]
        bits = sum(expected_bits(counts, self.prior or 1.0 / len(counts)) for counts in tables)
        found = pd.Series(bits, index=pd.Index(self.gaits.names, name="Gait"), name="bits")
        return found.sort_values(ascending=False, kind="stable")

    def __repr__(self) -> str:
        return f"<Learning: {len(self)} rows of {len(self.gaits)} gaits>"

    def _first(self, n: Any) -> pd.DataFrame:
        check_whole(n, "n", 1)
        if n > len(self):
            raise InputError(f"n is {n}, but there are {len(self)} rows")
        return self.frame.iloc[: int(n)]

    def _smoothed(self, rows: pd.DataFrame, axes: EffectAxes | None) -> ForwardModel:
        return ForwardModel.empty(self.gaits, self.prior or PRIOR, axes=axes or self._axes).update(rows)

    def _steps(self, at: Sequence[int] | None, most: int) -> list[int]:
        steps = sorted({*np.linspace(1, most, 20).astype(int).tolist()}) if at is None else list(at)
        for n in steps:
            check_whole(n, "at", 1)
            if n > most:
                raise InputError(f"at: {n} rows, but there are {most}")
        return steps
