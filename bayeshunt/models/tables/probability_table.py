"""One table of a model with everything behind its numbers: probability, count, credible interval."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import pandas as pd

from bayeshunt.core import displays

__all__ = ["ProbabilityTable"]


@dataclass(frozen=True, eq=False, repr=False)
class ProbabilityTable(displays.Displayed):
    """P(variable | Gait) as it is shown: four frames of one shape, rows = bins, columns = gaits.

    variable: "Distance", "Angle", "Heading" or "Gait" (then one column "probability"); in a model of residuals
        "Distance residual" and so on.
    probability: columns sum to 1. count: the rows behind each probability.
    low, high: bounds of each cell's Dirichlet credible interval at ``level``; None for a P(Gait) that is set to
        uniform, which nobody estimated.
    prior: Dirichlet pseudo-count per cell of the probabilities.
    known: states of other variables that the table is conditioned on, {"PreviousGait": name}.
    summed_over: other parents of the variable in the model's structure, which the table leaves out.
    model: the forward model whose table it is, which opens its cells; None: nobody knows.
    In an imported network nobody knows count, low, high and prior: they are None.
    """

    variable: str
    probability: pd.DataFrame
    count: pd.DataFrame | None
    low: pd.DataFrame | None
    high: pd.DataFrame | None
    level: float
    prior: float | None
    known: Mapping[str, str] = field(default_factory=dict)
    summed_over: tuple[str, ...] = ()
    model: Any = None

    @property
    def name(self) -> str:
        """What the table is: "P(Distance | Gait)", "P(Distance | Gait, PreviousGait = straight)"."""
        given = ["Gait", *(f"{variable} = {state}" for variable, state in self.known.items())]
        return "P(Gait)" if self.variable == "Gait" else f"P({self.variable} | {', '.join(given)})"

    @property
    def title(self) -> str:
        """Its name, and what is summed over: "P(Angle | Gait), summed over Heading"."""
        return f"{self.name}, summed over {' and '.join(self.summed_over)}" if self.summed_over else self.name

    def __repr__(self) -> str:
        bins, columns = self.probability.shape
        rows = "counts unknown" if self.count is None else f"{int(self.count.to_numpy().sum())} rows"
        return f"<{self.title}: {bins} x {columns}, {rows}>"
