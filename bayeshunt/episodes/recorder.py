"""The recorder: what one decision knew, weighed and chose, as a row of an episode's table."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from bayeshunt.core.geometry import FloatArray, Polar
from bayeshunt.core.messages import Moment, Observation
from bayeshunt.core.statistics import entropy
from bayeshunt.episodes.beliefs import belief_record
from bayeshunt.episodes.considered import considered, first_gaits
from bayeshunt.planners.api import Plan, Situation

__all__ = ["Step"]


class Step(NamedTuple):
    """One decision: where everybody was, what was known, what was chosen and why."""

    values: dict[str, Any]
    plan: Plan
    situation: Situation

    @classmethod
    def of(
        cls, step: int, moment: Moment, situation: Situation, plan: Plan, observed: Polar | None,
        spent: tuple[float, int] = (0.0, 0), observation: Observation | None = None,
    ) -> Step:  # fmt: skip
        """Summarise a decision; ``observed`` is the prey transition learned just before it.

        spent: the hunter's energy [J] and falls so far. observation: what was seen, where that is not all.
        """
        target = plan.target if plan.target is not None else Polar(np.nan, np.nan, np.nan)
        seen = observed if observed is not None else Polar(np.nan, np.nan, np.nan)
        learned: Any = situation.prey_model
        expected = None if learned.is_empty else learned.predict_path(1)
        values = {
            "step": step,
            "time": moment.time,
            **{f"hunter_{k}": v for k, v in moment.poses["hunter"]._asdict().items()},
            **{f"prey_{k}": v for k, v in moment.poses["prey"]._asdict().items()},
            **{f"seen_{k}": float(v) for k, v in situation.prey._asdict().items()},
            **{f"target_{k}": float(v) for k, v in target._asdict().items()},
            "gait": plan.gait,
            "planned_gaits": list(plan.gaits),
            "value": float(plan.value),
            "objective": plan.objective,
            "nodes": plan.nodes,
            "evidence_probability": np.nan if plan.evidence_probability is None else plan.evidence_probability,
            "support": plan.support,
            "posterior": None if plan.posterior is None else np.asarray(plan.posterior).tolist(),
            "posterior_entropy": np.nan if plan.posterior is None else float(entropy(plan.posterior)),
            "prey_known": plan.prey_known,
            "prey_observations": learned.observations,
            **{f"observed_{k}": float(v) for k, v in seen._asdict().items()},
            **{
                f"expected_{k}": float(getattr(expected, k)[1]) if expected is not None else np.nan
                for k in Polar._fields
            },
            **_path("predicted", plan.predicted_prey),
            **_path("planned", _planned_path(plan)),
            **_alternatives(plan),
            **belief_record(situation, observation),
            "prey_table": [list(map(float, row)) for row in learned.cells()],
            **considered(plan),
            "energy": float(spent[0]),
            "falls": int(spent[1]),
        }
        return cls(values, plan, situation)


def _path(name: str, path: Polar[FloatArray] | None) -> dict[str, list[float] | None]:
    """A path seen from the hunter as three columns of lists [T + 1], None where there is none."""
    parts = [None] * 3 if path is None else [np.asarray(part, dtype=float).tolist() for part in path]
    return {f"{name}_{k}": part for k, part in zip(Polar._fields, parts, strict=True)}


def _planned_path(plan: Plan) -> Polar[FloatArray] | None:
    """The hunter 0..T steps ahead on the chosen branch, if the plan's trace tells all its poses."""
    trace = plan.trace
    if not {"chosen", "T", "hunter_forward", "hunter_right", "hunter_heading"} <= set(trace.columns):
        return None
    branch = trace[trace["chosen"]].sort_values("T")
    if branch["T"].tolist() != list(range(len(branch))):
        return None
    parts = (branch[f"hunter_{name}"].to_numpy(dtype=float) for name in ("forward", "right", "heading"))
    return Polar.from_cartesian(*parts)


def _alternatives(plan: Plan) -> dict[str, Any]:
    """The first gaits that a plan considered and the least value found under each, in order of the trace."""
    trace = plan.trace
    column = next((name for name in ("value_m", "value_s", "value") if name in trace), None)
    if plan.posterior is not None or column is None or "gait" not in trace:
        return {"alternative_gaits": None, "alternative_values": None}
    least: dict[str, float] = {}
    for gait, value in zip(first_gaits(trace), trace[column].tolist(), strict=True):
        if gait is not None:
            least[gait] = min(value, least.get(gait, np.inf))
    return {"alternative_gaits": list(least), "alternative_values": list(least.values())}
