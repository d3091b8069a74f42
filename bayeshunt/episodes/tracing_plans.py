"""A decision that weighed sequences of gaits opened: its branch, what else there was, and the rows behind its gaits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from bayeshunt.core import displays
from bayeshunt.core.bins import EFFECTS
from bayeshunt.core.errors import InputError
from bayeshunt.episodes.considered import first_gaits
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.api import Plan

__all__ = ["PlanTrace", "trace_plan"]


@dataclass(frozen=True, eq=False, repr=False)
class PlanTrace(displays.Displayed):
    """A plan opened.

    plan: what is traced. model: whose tables it rests on; None: not given.
    branch: a row per node of the chosen sequence, as ``plan.trace`` has it.
    alternatives: a row per first gait: nodes considered under it, the least and the greatest value.
    """

    plan: Plan
    model: ForwardModel | None
    branch: pd.DataFrame
    alternatives: pd.DataFrame

    @property
    def gait(self) -> str:
        """The gait decided for."""
        return self.plan.gait

    @property
    def formula(self) -> str:
        """What the value is, with its numbers, and what it is of the means where the trace has them."""
        said = f"{self.plan.objective}: {self.plan.value:.6g}, the least of {self.plan.nodes} alternatives"
        if self.means is None:
            return said
        hunter, prey, gap = self.means
        return (
            f"{said}; after {self.steps} gaits the mean hunter is at ({hunter[0]:.4g}, {hunter[1]:.4g}) m and the prey "
            f"expected at ({prey[0]:.4g}, {prey[1]:.4g}) m, {gap:.4g} m apart"
        )

    @property
    def steps(self) -> int:
        """Gaits of the chosen sequence."""
        return int(self.branch.iloc[-1]["T"]) if "T" in self.branch else len(self.plan.gaits)

    @property
    def means(self) -> tuple[tuple[float, float], tuple[float, float], float] | None:
        """Where hunter and prey are expected at the end, forward and right of the hunter now, and their gap [m].

        None where the trace has no such places.
        """
        last = self.branch.iloc[-1]
        names = ("hunter_forward", "hunter_right", "prey_distance", "prey_angle")
        if not {*names} <= set(self.branch.columns):
            return None
        ahead, right, far, angle = (float(last[name]) for name in names)
        prey = (float(far * np.cos(angle)), float(far * np.sin(angle)))
        return (ahead, right), prey, float(np.hypot(ahead - prey[0], right - prey[1]))

    @property
    def cells(self) -> pd.DataFrame:
        """A row per gait of the sequence and effect: variable, likeliest state, gait, given, probability, count,
        rows.

        ``rows`` are all those of the gait, from whose tables its outcomes are drawn. Raises InputError without a model.
        """
        model, rows = self._needed(), []
        for gait in dict.fromkeys(self.plan.gaits):
            at = model.gaits.index(gait)
            for variable in EFFECTS:
                shares = model.cpt(variable).iloc[:, at]
                best = int(np.argmax(shares.to_numpy()))
                counts = model.counts(variable).to_numpy()[:, at] if model.has_counts else None
                known = (pd.NA, pd.NA) if counts is None else (int(counts[best]), int(counts.sum()))
                rows.append((variable, shares.index[best], gait, f"Gait = {gait}", float(shares.iloc[best]), *known))
        frame = pd.DataFrame(rows, columns=["variable", "state", "gait", "given", "probability", "count", "rows"])
        return frame.astype({"count": "Int64", "rows": "Int64"})

    def rows(self, gait: str | None = None) -> pd.DataFrame:
        """Return the babbled rows of a gait of the sequence (None: the first), from which its outcomes are drawn.

        Raises InputError without a model, DataError if the model holds no rows.
        """
        return self._needed().rows("Gait", self.gait if gait is None else gait)

    def _needed(self) -> ForwardModel:
        if self.model is None:
            raise InputError("a plan does not carry its tables; give them: bh.trace(plan, model=model)")
        return self.model

    def __repr__(self) -> str:
        return f"<Trace: {self.formula}>"


def trace_plan(plan: Plan, model: ForwardModel | None) -> PlanTrace:
    """Open a plan that weighed alternatives."""
    trace = plan.trace
    value = next(name for name in ("value_m", "value_s", "value") if name in trace)
    branch = trace[trace["chosen"]] if "chosen" in trace else trace[trace["gait"] == plan.gait]
    if "T" in branch:
        branch = branch.sort_values("T", kind="stable")
    firsts = pd.Series(first_gaits(trace), index=trace.index, name="gait")
    grouped = trace[value].groupby(firsts, sort=False)
    alternatives = pd.DataFrame({"nodes": grouped.size(), "least": grouped.min(), "greatest": grouped.max()})
    return PlanTrace(plan, model, branch.reset_index(drop=True), alternatives)
