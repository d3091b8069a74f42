"""An episode: everything one hunt did, as a table, with its settings; saved as one Parquet file."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pandas as pd

from bayeshunt.core import displays
from bayeshunt.core.errors import DataError
from bayeshunt.core.geometry import FloatArray, Polar
from bayeshunt.core.statistics import entropy
from bayeshunt.files import parquet
from bayeshunt.files.atomic import check_source
from bayeshunt.files.endings import check_ending

if TYPE_CHECKING:
    from bayeshunt.config.schema import ExperimentSettings
    from bayeshunt.planners.api import Plan, Situation

_KIND = "episode"
_MAKER = "bayeshunt hunt"
_TRAIL = ("time", "hunter_x", "hunter_y", "hunter_theta", "prey_x", "prey_y", "prey_theta")


class Step(NamedTuple):
    """One decision: where everybody was, what was known, what was chosen and why."""

    values: dict[str, Any]
    plan: Plan
    situation: Situation

    @classmethod
    def of(cls, step: int, moment: Any, situation: Situation, plan: Plan, observed: Polar | None) -> Step:
        """Summarise a decision; ``observed`` is the prey transition learned just before it."""
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
            "prey_table": [list(map(float, row)) for row in learned.cells()],
        }
        return cls(values, plan, situation)


def _typed(frame: pd.DataFrame) -> pd.DataFrame:
    """The table with the support as integers that may be missing; an episode without a decision has no columns."""
    if "support" not in frame:
        return frame
    support = frame["support"].astype("Int64")
    return frame.assign(support=support.mask(support < 0))  # earlier files say -1


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
    for gait, value in zip(_first_gaits(trace), trace[column].tolist(), strict=True):
        if gait is not None:
            least[gait] = min(value, least.get(gait, np.inf))
    return {"alternative_gaits": list(least), "alternative_values": list(least.values())}


def _first_gaits(trace: pd.DataFrame) -> list[str | None]:
    """First gait of the sequence in each row of a plan's trace; None for the empty sequence."""
    gaits = trace["gait"].tolist()
    if {"node", "parent", "T"} <= set(trace.columns):
        first: dict[int, str | None] = {}
        for node, parent, steps, gait in zip(trace["node"], trace["parent"], trace["T"], gaits, strict=True):
            first[node] = None if steps == 0 else gait if steps == 1 else first[parent]
        return list(first.values())
    if "gaits" in trace:  # sequences written run by run: "straight x3, wide left x1"
        return [re.split(r" x\d+(?:, |$)", text, maxsplit=1)[0] or None for text in trace["gaits"]]
    return gaits


@dataclass(frozen=True, eq=False, repr=False)
class Episode:
    """One hunt.

    caught: whether the prey was caught. time: seconds to the catch (the time limit if missed).
    frame: one row per decision; units metres, seconds, radians. World poses
        (``hunter_*``, ``prey_*``) are counter-clockwise, what the hunter sees (``seen_*``,
        ``target_*``) clockwise; ``observed_*`` is the prey transition learned before the decision,
        ``expected_*`` the prey model's mean transition after it; ``support`` (Int64) is missing where
        it was not asked or, in a network that was imported, is unknown.
        Lists: ``predicted_*`` and ``planned_*`` are the prey and the hunter 0..T steps ahead as the
        hunter sees them (a heading is NaN where only the place is predicted);
        ``alternative_values`` the least value under each of ``alternative_gaits``;
        ``prey_table`` the prey's [distance, angle, heading, count] per cell seen.
    trail: both robots' world poses every control interval.
    provenance: settings, planner, arena, theta, seed: what makes the hunt again.
    plans: the plans themselves, step by step; empty for an episode read from a file.
    """

    caught: bool
    time: float
    frame: pd.DataFrame
    trail: pd.DataFrame
    provenance: dict[str, Any]
    plans: tuple[Plan, ...] = ()
    situations: tuple[Situation, ...] = ()

    @classmethod
    def assemble(
        cls, steps: list[Step], trail: list[Any], result: Any, *, settings: ExperimentSettings, **origin: Any
    ) -> Episode:
        """Build an episode from its steps, its recorded moments and its result."""
        frame = _typed(pd.DataFrame([step.values for step in steps]))
        path = pd.DataFrame(
            [(m.time, *m.poses["hunter"], *m.poses["prey"]) for m in trail],
            columns=list(_TRAIL),
        )
        provenance = {
            "kind": _KIND,
            "caught": bool(result.caught),
            "time": float(result.time),
            **origin,
            "settings": settings.model_dump(mode="json"),
        }
        plans, situations = tuple(s.plan for s in steps), tuple(s.situation for s in steps)
        return cls(bool(result.caught), float(result.time), frame, path, provenance, plans, situations)

    def __repr__(self) -> str:
        ending = f"caught after {self.time:.2f} s" if self.caught else f"not caught in {self.time:g} s"
        return f"<Episode: {ending}, {len(self.frame)} decisions>"

    def __str__(self) -> str:
        return displays.to_text(self)

    def _repr_html_(self) -> str | None:
        return displays.to_html(self)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the table, the trail and the provenance as one Parquet file with checksums, replaced atomically."""
        import pyarrow as pa

        record = {**self.provenance, "trail": {c: self.trail[c].tolist() for c in self.trail}}
        table = pa.Table.from_pandas(self.frame, preserve_index=False).replace_schema_metadata(None)
        check_ending(path, "episodes", ".parquet")
        parquet.write(table, record, path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Episode:
        """Read an episode; DataError in one line if the file is missing, damaged or something else.

        Files of versions that wrote no checksums are read as they are.
        """
        check_source(path, _MAKER, DataError)
        mend = f"give a file made by: {_MAKER} --out"
        table, record = parquet.read(path, what="an episode", mend=mend)
        try:
            if record is None or record["kind"] != _KIND:
                raise KeyError("kind")
            trail = pd.DataFrame(record.pop("trail"), columns=list(_TRAIL))
            return cls(record["caught"], record["time"], _typed(table.to_pandas()), trail, record)
        except (ValueError, KeyError, TypeError):  # they speak of Python
            raise DataError(f"{os.fspath(path)}: not an episode, or damaged; {mend}") from None
