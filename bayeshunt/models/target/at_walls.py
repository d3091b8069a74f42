"""What a prey does where it meets a wall, and whether it turns where there is none: counted, beside what was believed.

A leg is a stretch of the prey's motion. One whose straight continuation ends at a wall tells how the prey meets walls;
one that is clear of them tells whether it turns elsewhere. What is too close to call is not counted.
"""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

from bayeshunt.core.arguments import check_fields
from bayeshunt.core.errors import InputError

__all__ = ["AtWalls"]


@dataclass(frozen=True)
class AtWalls:
    """Counts of a prey's legs at walls and away from them; a value.

    rebound: radians between a wall and the prey that has turned away from it, believed beforehand. clearance: metres
        that its centre keeps from where a body of the hunter's size is stopped, believed beforehand.
    keeps: probability that it keeps its heading at a wall (it is held up, or slides along), believed beforehand.
    prior: how many legs at a wall these three are worth, > 0.
    straight: how many legs without a turn the belief that it turns at walls alone is worth, > 0.
    rebounds, clearances: of the legs seen at a wall after which it had turned away. kept: legs seen at a wall in which
        it kept its heading. elsewhere: legs seen clear of every wall; strays: those of them in which it turned.
    """

    rebound: float
    clearance: float
    keeps: float = 0.2
    prior: float = 1.0
    straight: float = 2.0
    rebounds: tuple[float, ...] = ()
    clearances: tuple[float, ...] = ()
    kept: int = 0
    elsewhere: int = 0
    strays: int = 0

    def __post_init__(self) -> None:
        check_fields(self)
        if not 0.0 <= self.keeps <= 1.0:
            raise InputError(f"at walls: keeps must be a probability, got {self.keeps!r}")
        for name in ("prior", "straight"):
            if not getattr(self, name) > 0:
                raise InputError(f"at walls: {name} must be a number > 0, got {getattr(self, name)!r}")

    @property
    def keeping(self) -> float:
        """Probability that it keeps its heading at a wall: ``(kept + prior keeps) / (legs at a wall + prior)``."""
        return (self.kept + self.prior * self.keeps) / (self.kept + len(self.rebounds) + self.prior)

    @property
    def hazard(self) -> float:
        """Chance that it turns within a leg clear of walls: ``strays / (elsewhere + straight)``."""
        return self.strays / (self.elsewhere + self.straight)

    @property
    def leaving(self) -> float:
        """The angle between a wall and the prey that has turned away [rad]: the mean, the prior among those seen."""
        return (self.prior * self.rebound + sum(self.rebounds)) / (self.prior + len(self.rebounds))

    @property
    def keeping_clear(self) -> float:
        """The clearance at which it turns [m]: the mean, the prior among those seen."""
        return (self.prior * self.clearance + sum(self.clearances)) / (self.prior + len(self.clearances))

    def table(self) -> pd.DataFrame:
        """Return what it does: rows "turns at a wall", "keeps its heading at a wall", "turns elsewhere".

        Columns: probability; before: what was believed before anything was seen; seen, of: the counts; worth: how
        many legs the belief beforehand counts for; rebound [rad] and clearance [m], with rebound_before and
        clearance_before, of the first row.
        """
        met = self.kept + len(self.rebounds)
        rows = {
            "turns at a wall": (1.0 - self.keeping, 1.0 - self.keeps, len(self.rebounds), met, self.prior),
            "keeps its heading at a wall": (self.keeping, self.keeps, self.kept, met, self.prior),
            "turns elsewhere": (self.hazard, 0.0, self.strays, self.elsewhere, self.straight),
        }
        frame = pd.DataFrame.from_dict(rows, orient="index", columns=["probability", "before", "seen", "of", "worth"])
        lengths = {
            "rebound": self.leaving, "rebound_before": self.rebound,
            "clearance": self.keeping_clear, "clearance_before": self.clearance,
        }  # fmt: skip
        for name, value in lengths.items():
            frame[name] = [value, float("nan"), float("nan")]
        return frame.rename_axis("Motion")
