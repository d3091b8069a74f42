"""What a prey does given where the hunter is: its transitions counted by the hunter's place in the prey's own frame.

A context is a band of distance and a sector of bearing, as the prey has the hunter. Each leans on the whole sector,
that on all places, and those on what is believed beforehand: that a prey does what takes it away from the hunter.
Letters: C contexts, J motions, L of them believed possible beforehand, N transitions seen.
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
import pandas as pd

from bayeshunt.core import statistics
from bayeshunt.core.arguments import check_fields
from bayeshunt.core.checks import check_polar
from bayeshunt.core.errors import InputError, ModelFileError
from bayeshunt.core.geometry import FloatArray, Polar
from bayeshunt.files.records import RecordKind

__all__ = ["BANDS", "REACTION_FILES", "SECTORS", "Reactions"]

#: Where bands of distance end [body lengths]; the last is open.
BANDS = (2.5, 5.0)
#: Equal sectors of bearing, the first centred straight ahead of the prey.
SECTORS = 8
#: Transitions whose turn falls into the same of so many equal parts, and whose distance into the same body length,
#: are one motion.
_TURNS = 18
REACTION_FILES = RecordKind("prey reactions", "Reactions.save in Python")


@dataclass(frozen=True, eq=False)
class Reactions:
    """Counts of a prey's transitions by the hunter's place; a value: :meth:`learn` returns a new one.

    believed: motions that are possible beforehand, Polar of arrays [L], each in the prey's own earlier frame.
    body: metres, the unit of bands. evasion: how much likelier beforehand a motion is that takes the prey a body length
        farther from where the hunter was, as a logarithm; 0: all are alike.
    backoff: transitions that a coarser table is worth in a finer one, > 0.
    transitions: those seen, oldest first. approaches: the hunter's place when each began, as the prey had it.

    ``P(j | place) = (n_j there + w P(j | sector)) / (n there + w)``, the same for the sector over all places, and for
    those over the belief. Raises InputError for values out of range.
    """

    believed: Polar[FloatArray]
    body: float
    evasion: float = 1.0
    backoff: float = 1.0
    transitions: tuple[Polar, ...] = ()
    approaches: tuple[Polar, ...] = ()

    def __post_init__(self) -> None:
        check_fields(self)
        for name in ("body", "backoff"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise InputError(f"reactions: {name} must be a number > 0, got {getattr(self, name)!r}")
        if not 0.0 <= self.evasion < math.inf:
            raise InputError(f"reactions: evasion must be a number >= 0, got {self.evasion!r}")
        if len(self.transitions) != len(self.approaches):
            raise InputError(
                f"reactions: expected as many approaches as transitions, got {len(self.approaches)} and "
                f"{len(self.transitions)}"
            )

    def learn(self, transitions: Sequence[Polar], approaches: Sequence[Polar]) -> Reactions:
        """Return a table that has also seen these; where fewer places than transitions are known, none is learned."""
        if len(approaches) < len(transitions):
            return self
        for name, poses in (("transitions", transitions), ("approaches", approaches)):
            for pose in poses:
                check_polar(pose, name)
        seen, where = self.transitions + tuple(transitions), self.approaches + tuple(approaches)
        return replace(self, transitions=seen, approaches=where)

    @cached_property
    def _made(self) -> tuple[Polar[FloatArray], FloatArray]:
        """The motions [J], those believed first, and which transition made which: 0 or 1 [N, J]."""
        distance, angle, heading = np.array(self.transitions, dtype=float).reshape(-1, 3).T
        turn = np.round(heading * (_TURNS / (2 * np.pi))).astype(int) % _TURNS
        kinds, kind = np.unique([turn, np.round(distance / self.body).astype(int)], axis=1, return_inverse=True)
        seen = (kind.reshape(-1, 1) == np.arange(kinds.shape[1])).astype(float)
        place = (distance * np.exp(1j * angle)) @ seen / seen.sum(axis=0)
        turned = np.angle(np.exp(1j * heading) @ seen)
        far, bearing, facing = (
            np.concatenate(parts) for parts in zip(self.believed, (np.abs(place), np.angle(place), turned), strict=True)
        )
        return Polar(far, bearing, facing), np.pad(seen, ((0, 0), (len(self.believed.distance), 0)))

    @property
    def motions(self) -> Polar[FloatArray]:
        """What the prey may do in a time-step: Polar of arrays [J], those believed beforehand first."""
        return self._made[0]

    @cached_property
    def everywhere(self) -> FloatArray:
        """P(motion) wherever the hunter is [J]; the belief beforehand counts all of its motions alike."""
        count, alike = len(self.believed.distance), self._made[1].sum(axis=0)
        alike[:count] += self.backoff / count
        shares: FloatArray = alike / alike.sum()
        return shares

    def chances(self, distance: FloatArray, angle: FloatArray) -> FloatArray:
        """Return P(motion | the hunter's place) [C, J]; distance [m], angle [rad clockwise] of it to the prey [C]."""
        return self._backed_off(distance, angle, np.ones((len(distance), len(self.transitions)), dtype=bool))

    def foretold(self) -> FloatArray:
        """Return what :meth:`chances` said of each transition before it and all later ones were seen [N, J]."""
        distance, angle, _ = np.array(self.approaches, dtype=float).reshape(-1, 3).T
        return self._backed_off(distance, angle, np.tri(len(distance), k=-1, dtype=bool))

    def _backed_off(self, distance: FloatArray, angle: FloatArray, told: np.ndarray) -> FloatArray:
        """P(motion | place) [C, J] where each context knows of some of the transitions only: told, bool [C, N]."""
        made, chance = self._made[1], self.beforehand(distance, angle)
        there, towards = self._places(distance, angle), self._places(*self._seen_from())
        sector = told & (there[1][:, None] == towards[1])
        for counted in (told, sector, sector & (there[0][:, None] == towards[0])):
            chance = (counted @ made + self.backoff * chance) / (counted.sum(axis=1) + self.backoff)[:, None]
        return chance

    def beforehand(self, distance: FloatArray, angle: FloatArray) -> FloatArray:
        """Return what is believed before anything is seen [C, J]; 0 for a motion that only seeing it tells of."""
        count = len(self.believed.distance)
        hunter = distance * np.exp(1j * angle)
        ends = self.believed.distance * np.exp(1j * self.believed.angle)
        gained = self.evasion / self.body * np.abs(ends - hunter[:, None])
        liking = np.exp(gained - gained.max(axis=1, keepdims=True))
        missing = len(self.motions.distance) - count
        return np.pad(liking / liking.sum(axis=1, keepdims=True), ((0, 0), (0, missing)))

    def _seen_from(self) -> tuple[FloatArray, FloatArray]:
        distance, angle, _ = np.array(self.approaches, dtype=float).reshape(-1, 3).T
        return distance, angle

    def _places(self, distance: FloatArray, angle: FloatArray) -> tuple[np.ndarray, np.ndarray]:
        """Numbers of band and sector [C]."""
        sector = np.round(angle * (SECTORS / (2 * np.pi))).astype(int) % SECTORS
        return np.searchsorted(np.multiply(BANDS, self.body), distance, side="right"), sector

    def table(self, distance: float, angle: float, level: float = 0.95) -> pd.DataFrame:
        """Return P(motion | the hunter at ``distance`` [m], ``angle`` [rad clockwise] of the prey), a row a motion.

        Columns: moved [m], turned [rad clockwise]; probability; low, high: its Dirichlet interval; count, with the
        hunter there; sector, in that direction; everywhere: how often it was seen; before: what was believed.
        """
        one = np.array([distance], dtype=float), np.array([angle], dtype=float)
        made = self._made[1]
        (band,), (sector,) = self._places(*one)
        bands, sectors = self._places(*self._seen_from())
        there = ((bands == band) & (sectors == sector)) @ made
        chance = self.chances(*one)[0]
        coarser = (chance * (there.sum() + self.backoff) - there)[:, None]
        low, high = statistics.credible_interval(there[:, None], np.maximum(coarser, 0.0), level=level)
        low, high = np.minimum(low[:, 0], chance), np.maximum(high[:, 0], chance)  # the mean of a rare one lies beyond
        columns = {
            "moved": self.motions.distance, "turned": self.motions.heading, "probability": chance, "low": low,
            "high": high, "count": there.astype(int), "sector": ((sectors == sector) @ made).astype(int),
            "everywhere": made.sum(axis=0).astype(int), "before": self.beforehand(*one)[0],
        }  # fmt: skip
        return pd.DataFrame(columns).rename_axis("Motion")

    def rows(self, distance: float, angle: float) -> str:
        """Return in words what :meth:`table` rests on."""
        found = self.table(distance, angle)
        there, towards, all_ = (int(found[name].sum()) for name in ("count", "sector", "everywhere"))
        return (
            f"of these {there} transition{'' if there == 1 else 's'} with the hunter there; the rest from {towards} "
            f"with it in that direction, {all_} in all, and what was believed of a prey that evades"
        )

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the counts as checksummed JSON; the file is replaced atomically."""
        content = {
            "believed": np.transpose(self.believed).tolist(), "body": self.body, "evasion": self.evasion,
            "backoff": self.backoff, "transitions": [list(map(float, t)) for t in self.transitions],
            "approaches": [list(map(float, a)) for a in self.approaches],
        }  # fmt: skip
        REACTION_FILES.save(content, path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read what :meth:`save` wrote; raises ModelFileError in one clear line."""
        _, content = REACTION_FILES.load(path)
        try:
            seen, where = (
                tuple(Polar(*map(float, pose)) for pose in content[n]) for n in ("transitions", "approaches")
            )
            believed = Polar(*np.array(content["believed"], dtype=float).reshape(-1, 3).T)
            return cls(believed, content["body"], content["evasion"], content["backoff"], seen, where)
        except (KeyError, TypeError, ValueError, InputError) as error:
            raise ModelFileError(f"{os.fspath(path)}: malformed content ({str(error).splitlines()[0]})") from None
