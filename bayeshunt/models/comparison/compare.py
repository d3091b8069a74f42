"""Two models side by side: what each table says otherwise, and whether that is more than chance.

The interval of a difference is made of the two cells' own intervals (l, u) around p (MOVER: G. Zou and A. Donner,
Construction of confidence limits about effect measures, Statistics in Medicine 27, 2008):
``d - sqrt((p2 - l2)^2 + (u1 - p1)^2)`` to ``d + sqrt((u2 - p2)^2 + (p1 - l1)^2)`` with ``d = p2 - p1``.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pandas as pd

from bayeshunt.core import displays
from bayeshunt.core.bins import ENERGY
from bayeshunt.core.checks import check_kind
from bayeshunt.core.errors import InputError
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel
from bayeshunt.models.tables.structures import Edge

__all__ = ["Comparison", "compare"]


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(displays.Displayed):
    """How two models differ.

    difference, low, high: variable -> P of the second less P of the first, rows = bins, columns = gaits, and the ends
        of its interval at ``level`` (NaN where nobody knows: an imported network, a P(Gait) that was set).
    edges_added, edges_removed: (parent, child) of the second model alone, of the first alone.
    models: the two.
    """

    difference: Mapping[str, pd.DataFrame]
    low: Mapping[str, pd.DataFrame]
    high: Mapping[str, pd.DataFrame]
    level: float
    edges_added: tuple[Edge, ...]
    edges_removed: tuple[Edge, ...]
    models: tuple[ForwardModel, ForwardModel]

    @cached_property
    def answers(self) -> pd.DataFrame:
        """A row per (Distance, Angle) cell that either model learned: distance, angle, before, after, changed.

        before, after: each model's most probable gait there, its own nearest learned cell answering where it learned
        none. changed: whether they differ. Of models of structure "previous_gait" the gait before is summed over.
        """
        first, second = (InverseModel(model) for model in self.models)
        cells = np.unique(np.concatenate([model.learned_cells for model in self.models]), axis=0)
        axes = max((model.axes for model in self.models), key=lambda grid: grid.distance.bins)
        distance, angle = axes.distance.centres[cells[:, 0]], axes.angle.centres[cells[:, 1]]
        names = np.array(first.model.gaits.names, dtype=object)
        best = [names[one.posterior_many(distance, angle).argmax(axis=1)] for one in (first, second)]
        frame = pd.DataFrame({"distance": distance, "angle": angle, "before": best[0], "after": best[1]})
        return frame.assign(changed=frame["before"] != frame["after"])

    @property
    def marked(self) -> dict[str, pd.DataFrame]:
        """Variable -> whether each cell's interval excludes 0."""
        return {v: (self.low[v] > 0) | (self.high[v] < 0) for v in self.difference}

    @property
    def cells(self) -> pd.DataFrame:
        """A row per cell whose interval excludes 0, the largest difference first.

        Columns: variable, state, gait, difference, low, high. P(Gait) has its gait as state.
        """
        rows = []
        for variable, marked in self.marked.items():
            for i, j in np.argwhere(marked.to_numpy()):
                at = (marked.index[i], marked.columns[j])
                ends = (t[variable].to_numpy()[i, j].item() for t in (self.difference, self.low, self.high))
                rows.append((variable, *at, *ends))
        frame = pd.DataFrame(rows, columns=["variable", "state", "gait", "difference", "low", "high"])
        order = frame["difference"].abs().sort_values(ascending=False, kind="stable").index
        return frame.loc[order].reset_index(drop=True)

    @property
    def share(self) -> float:
        """Share of all cells whose interval excludes 0."""
        marks = [marked.to_numpy().ravel() for marked in self.marked.values()]
        return float(np.concatenate(marks).mean())

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the comparison as one HTML page, replaced atomically."""
        displays.save(self, path)

    def __repr__(self) -> str:
        total = sum(frame.size for frame in self.difference.values())
        return f"<Comparison: {len(self.cells)} of {total} cells differ by more than chance>"


def compare(a: ForwardModel, b: ForwardModel, level: float = 0.95) -> Comparison:
    """Return how model ``b`` differs from model ``a``: before and after, two structures, two days, two robots.

    The models must have the same gaits and widths of bins; distance bins that only one has count as never reached by
    the other. Where structures give a variable other parents than the gait, those are summed over. Models of residuals
    are compared by the poses that they give, in ordinary bins.

    Raises InputError for other models, gaits or bins, or a level outside (0, 1).
    """
    for name, model in (("a", a), ("b", b)):
        check_kind(model, name, ForwardModel, "a ForwardModel")
    if a.gaits.names != b.gaits.names:
        raise InputError("the models have different gaits, so their tables have no cells in common")
    a, b = a.binned, b.binned
    effects = [e for e in a.structure.effects if e in b.structure.effects]
    shared = [model.axes if ENERGY in effects else replace(model.axes, energy=None) for model in (a, b)]
    whole = shared[0].covering(shared[1])
    if whole != shared[1].covering(shared[0]):
        raise InputError("the models have different bins; fit both with the same axes")
    difference, low, high = {}, {}, {}
    for variable in (*effects, "Gait"):
        labels = list(whole[variable].labels) if variable != "Gait" else list(a.gaits.names)
        p1, l1, u1 = _table(a, variable, labels, level)
        p2, l2, u2 = _table(b, variable, labels, level)
        d = p2 - p1
        difference[variable] = d
        low[variable] = d - np.sqrt((p2 - l2) ** 2 + (u1 - p1) ** 2)
        high[variable] = d + np.sqrt((u2 - p2) ** 2 + (p1 - l1) ** 2)
    added, removed = (
        tuple(e for e in one.structure.edges if e not in other.structure.edges) for one, other in ((b, a), (a, b))
    )
    return Comparison(difference, low, high, level, added, removed, (a, b))


def _table(model: ForwardModel, variable: str, labels: list[str], level: float) -> tuple[pd.DataFrame, ...]:
    """Probability, low and high over all bins; a bin beyond the model's axis was never reached.

    Its probability is 0, as unsure as that of the gait's least probable bin.
    """
    table = model.table(variable, level)
    nobody = table.probability * np.nan
    ends = (nobody if table.low is None else table.low, nobody if table.high is None else table.high)
    frames = []
    for at, frame in enumerate((table.probability, *ends)):
        frame = frame.set_axis(["probability"], axis=1) if variable == "Gait" else frame
        wide = frame.reindex(labels)
        beyond = ~wide.index.isin(frame.index)
        wide.loc[beyond] = frame.min().to_numpy() if at == 2 else 0.0
        frames.append(wide)
    return tuple(frames)
