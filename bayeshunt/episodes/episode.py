"""An episode: everything one hunt did, as a table, with its settings; saved as one Parquet file."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import pandas as pd

from bayeshunt.core import displays
from bayeshunt.core.arguments import check_fields, checked
from bayeshunt.core.errors import DataError
from bayeshunt.episodes.answers import with_answers
from bayeshunt.episodes.recorder import Step
from bayeshunt.files import parquet
from bayeshunt.files.atomic import check_source
from bayeshunt.files.endings import check_ending

if TYPE_CHECKING:
    from bayeshunt.config.schema import ExperimentSettings
    from bayeshunt.planners.api import Plan, Situation

__all__ = ["Episode"]

_KIND = "episode"
_MAKER = "bayeshunt hunt"
_TRAIL = ("time", "hunter_x", "hunter_y", "hunter_theta", "prey_x", "prey_y", "prey_theta")


def _typed(frame: pd.DataFrame) -> pd.DataFrame:
    """The table with the support as integers that may be missing; an episode without a decision has no columns."""
    if "support" not in frame:
        return frame
    support = frame["support"].astype("Int64")
    return frame.assign(support=support.mask(support < 0))  # earlier files say -1


@dataclass(frozen=True, eq=False, repr=False)
class Episode(displays.Displayed):
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
        ``considered_*`` every node of ``plan.trace``: gait, parent, value, forward, right, heading, chosen;
        ``answer_*`` (in an episode read from a file) what its posterior rests on, see ``episodes.answers.AnswerCells``;
        ``prey_table`` the prey's [distance, angle, heading, count] per cell seen. Of a body that measures what it
        spends also ``energy`` [J] and ``falls``, up to the decision.
    trail: both robots' world poses every control interval.
    provenance: settings, planner, arena, theta, seed: what makes the hunt again; of a body that measures what it
        spends also its ``energy`` [J], ``falls`` and ``changes`` of gait in all.
    plans: the plans themselves, step by step; empty for an episode read from a file.
    """

    caught: bool
    time: float
    frame: pd.DataFrame
    trail: pd.DataFrame
    provenance: dict[str, Any]
    plans: tuple[Plan, ...] = ()
    situations: tuple[Situation, ...] = ()

    def __post_init__(self) -> None:
        check_fields(self)

    @classmethod
    def assemble(
        cls, steps: list[Step], trail: list[Any], result: Any, *, settings: ExperimentSettings, **origin: Any
    ) -> Episode:
        """Build an episode from its steps, its recorded moments and its result."""
        frame = _typed(pd.DataFrame([step.values for step in steps]))
        spent: dict[str, Any] = {}
        if result.energy:
            spent = {"energy": float(result.energy), "falls": result.falls, "changes": result.transitions}
        else:  # what does not measure what it spends does not know when it falls either
            frame = frame.drop(columns=["energy", "falls"], errors="ignore")
        path = pd.DataFrame(
            [(m.time, *m.poses["hunter"], *m.poses["prey"]) for m in trail],
            columns=list(_TRAIL),
        )
        provenance = {
            "kind": _KIND,
            "caught": bool(result.caught),
            "time": float(result.time),
            **spent,
            **origin,
            "settings": settings.model_dump(mode="json"),
        }
        plans, situations = tuple(s.plan for s in steps), tuple(s.situation for s in steps)
        return cls(bool(result.caught), float(result.time), frame, path, provenance, plans, situations)

    def __repr__(self) -> str:
        ending = f"caught after {self.time:.2f} s" if self.caught else f"not caught in {self.time:g} s"
        return f"<Episode: {ending}, {len(self.frame)} decisions>"

    @property
    def spent(self) -> str:
        """What the hunter spent, for people: energy, changes of gait and falls; "" if its body does not measure it."""
        if "energy" not in self.provenance:
            return ""
        energy, changes, falls = (self.provenance[name] for name in ("energy", "changes", "falls"))
        turned, fell = "change" if changes == 1 else "changes", "fall" if falls == 1 else "falls"
        return f"{energy:.1f} J, {changes} {turned} of gait, {falls} {fell}"

    @checked
    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the table, the trail and the provenance as one Parquet file with checksums, replaced atomically."""
        import pyarrow as pa

        record = {**self.provenance, "trail": {c: self.trail[c].tolist() for c in self.trail}}
        table = pa.Table.from_pandas(
            with_answers(self.frame, self.plans), preserve_index=False
        ).replace_schema_metadata(None)
        check_ending(path, "episodes", ".parquet")
        parquet.write(table, record, path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Episode:
        """Read an episode; DataError in one line if the file is missing, damaged or something else.

        Files of versions that wrote no checksums are read as they are.
        """
        check_source(path, _MAKER, DataError)
        fix = f"give a file made by: {_MAKER} --out"
        table, record = parquet.read(path, what="an episode", fix=fix)
        try:
            if record is None or record["kind"] != _KIND:
                raise KeyError("kind")
            trail = pd.DataFrame(record.pop("trail"), columns=list(_TRAIL))
            return cls(record["caught"], record["time"], _typed(table.to_pandas()), trail, record)
        except (ValueError, KeyError, TypeError):  # they speak of Python
            raise DataError(f"{os.fspath(path)}: not an episode, or damaged; {fix}") from None
