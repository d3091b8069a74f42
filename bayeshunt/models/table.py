"""One table of a model with everything behind its numbers: probability, count, credible interval."""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

from bayeshunt import displays


@dataclass(frozen=True, eq=False, repr=False)
class ProbabilityTable:
    """P(variable | Gait) as it is shown: four frames of one shape, rows = bins, columns = gaits.

    variable: "Distance", "Angle", "Heading" or "Gait" (then one column "probability").
    probability: columns sum to 1. count: the rows behind each probability.
    low, high: bounds of each cell's Dirichlet credible interval at ``level``.
    prior: Dirichlet pseudo-count per cell of the probabilities.
    In an imported network nobody knows count, low, high and prior: they are None.
    """

    variable: str
    probability: pd.DataFrame
    count: pd.DataFrame | None
    low: pd.DataFrame | None
    high: pd.DataFrame | None
    level: float
    prior: float | None

    @property
    def name(self) -> str:
        """What the table is: "P(Distance | Gait)"."""
        return "P(Gait)" if self.variable == "Gait" else f"P({self.variable} | Gait)"

    def __repr__(self) -> str:
        bins, columns = self.probability.shape
        rows = "counts unknown" if self.count is None else f"{int(self.count.to_numpy().sum())} rows"
        return f"<{self.name}: {bins} x {columns}, {rows}>"

    def __str__(self) -> str:
        return displays.to_text(self)

    def _repr_html_(self) -> str | None:
        return displays.to_html(self)
