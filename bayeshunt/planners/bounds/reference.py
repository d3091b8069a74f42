"""The reference hunter: the best that these gaits and this time-step allow against a straight prey."""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.errors import InputError, ModelFileError
from bayeshunt.core.geometry import Polar, Pose, placed
from bayeshunt.core.protocols import Map
from bayeshunt.files.atomic import check_source, replace_atomically
from bayeshunt.files.endings import check_ending
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.api import Plan, Shown, Situation
from bayeshunt.planners.bounds.relative import Chase, Grid, expected_times
from bayeshunt.planners.info import PlannerInfo
from bayeshunt.planners.interception.lookahead import gait_paths
from bayeshunt.planners.requests import check_request
from bayeshunt.planners.settings import File, planner_settings, setting

__all__ = ["FORMAT", "Reference", "ReferenceSettings", "ReferenceTable"]

FORMAT = 1
_MAKER = "bayeshunt reference"
#: Seconds that a gait counts for more that runs into an obstacle.
_STOPPED = 1e6
_ARRAYS = ("values", "distances", "hunter", "prey")


@dataclass(frozen=True, eq=False)
class ReferenceTable:
    """The solved grid: the least expected time to capture for every relative pose.

    values: seconds, float32 [R, A, H]. grid: the states. chase: the sampled motion it rests on.
    gaits: names, in the order of ``chase.hunter``. facts: what it was computed from (settings, seed, digest).
    """

    values: np.ndarray
    grid: Grid
    chase: Chase
    gaits: tuple[str, ...]
    facts: Mapping[str, Any] = field(default_factory=dict)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the table as an .npz file of plain arrays with a checksum, replaced atomically."""
        arrays = {
            "values": self.values,
            "distances": self.grid.distances,
            "hunter": self.chase.hunter,
            "prey": self.chase.prey,
        }
        head = {
            "format": FORMAT,
            "gaits": list(self.gaits),
            "duration": self.chase.duration,
            "reach": self.chase.reach,
            "closing": self.chase.closing,
            "facts": dict(self.facts),
        }
        text = json.dumps(head, sort_keys=True)
        check_ending(path, "such tables", ".npz")
        with replace_atomically(path) as temporary, temporary.open("wb") as out:
            np.savez(out, head=np.array(text), checksum=np.array(_checksum(text, arrays)), **arrays)  # type: ignore[arg-type]

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> ReferenceTable:
        """Read a table; ModelFileError in one line if the file is missing, damaged or something else."""
        name = check_source(path, _MAKER, ModelFileError)
        try:
            with np.load(path, allow_pickle=False) as stored:
                text, checksum = str(stored["head"]), str(stored["checksum"])
                arrays = {key: stored[key] for key in _ARRAYS}
            head = json.loads(text)
            version = head["format"]
        except Exception:  # numpy and zipfile raise many kinds for a damaged file, and advise programmers
            raise ModelFileError(f"{name}: not a reference table, or damaged; give a file made by: {_MAKER}") from None
        if version != FORMAT:
            raise ModelFileError(f"{name}: format {version}, but this version reads {FORMAT}; make it again")
        if checksum != _checksum(text, arrays):
            raise ModelFileError(f"{name}: the checksum does not match, the file is damaged; make it again")
        for array in arrays.values():
            array.setflags(write=False)
        try:
            return cls._from_record(head, arrays)
        except (KeyError, TypeError, ValueError):
            raise ModelFileError(f"{name}: malformed content; give a file made by: {_MAKER}") from None

    @classmethod
    def _from_record(cls, head: dict[str, Any], arrays: dict[str, np.ndarray]) -> ReferenceTable:
        values, distances, hunter, prey = (arrays[key] for key in _ARRAYS)
        motion = (float(head[key]) for key in ("duration", "reach", "closing"))
        gaits, facts = tuple(map(str, head["gaits"])), dict(head["facts"])
        shapes = values.ndim == 3, len(distances) == len(values), hunter.shape == (len(gaits), *prey.shape)
        if not all(shapes) or prey.shape[2:] != (3,):
            raise ValueError("the arrays do not fit together")
        return cls(values, Grid(distances, *values.shape[1:]), Chase(hunter, prey, *motion), gaits, facts)


@planner_settings("reference")
class ReferenceSettings:
    """Settings of the reference hunter."""

    table: File[ReferenceTable | str | os.PathLike[str] | None] = setting(
        None,
        "a ReferenceTable or the path of one (bayeshunt reference --out FILE)",
    )


class Reference(Shown):
    """A yardstick: the gait of least expected time to capture, were the prey to go straight on.

    Its table is computed beforehand from babbling and from the prey's true speed and noise, so its row is not
    learned within the run. Against a prey that turns at walls it is no bound. Among obstacles it
    is told of them, and takes no gait that runs into one; it does not look for a way round. ``rng`` is not used.
    """

    name = "reference"
    info = PlannerInfo(ab_initio=False, needs=("table",), maker="bayeshunt reference")

    Settings = ReferenceSettings

    def __init__(self, model: ForwardModel, settings: ReferenceSettings | None = None, **given: Any) -> None:
        self.settings = ReferenceSettings(**given) if settings is None else settings
        table = self.settings.table
        self.info.check_given(self.name, {"table": table})
        self.table = table if isinstance(table, ReferenceTable) else ReferenceTable.load(table)  # type: ignore[arg-type]
        self.hunter = model.gaits
        self.gaits = tuple(model.gaits.names)
        self.paths = gait_paths(model)
        if self.table.gaits != self.gaits:
            raise InputError(
                f"reference: the table's gaits ({', '.join(self.table.gaits)}) are not the model's; make it again"
            )
        if abs(self.table.chase.duration - model.gaits.need("duration")) > 1e-9:
            raise InputError(
                f"reference: the table is for a time-step of {self.table.chase.duration} s, "
                f"the model's is {model.gaits.duration} s; make it again"
            )

    def _check_task(self, situation: Situation) -> None:
        reach, asked = self.table.chase.reach, situation.task.catch_distance
        if asked is not None and not math.isclose(reach, asked, rel_tol=1e-6):
            raise InputError(
                f"reference: the table is for a catch at {reach:g} m, this hunt's is at {asked:g} m; make it again"
            )

    def _stopped(self, ground: object, pose: Pose) -> np.ndarray:
        """Return which gaits run into something, bool [G]."""
        assert isinstance(ground, Map)
        forward, right, _ = np.moveaxis(self.paths, -1, 0)  # [G, P]
        free = ground.free(*placed(pose, forward, right))
        stopped: np.ndarray = np.logical_not(np.asarray(free)).any(axis=1)
        return stopped

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Return the gait of least expected time to capture."""
        situation = check_request(situation, rng, self.hunter)
        self._check_task(situation)
        table, state = self.table, np.array([float(part) for part in situation.prey])
        times = expected_times(table.chase, table.grid, table.values, state)
        if situation.map is not None and situation.pose is not None:
            times = times + np.where(self._stopped(situation.map, situation.pose), _STOPPED, 0.0)
        best = int(np.argmin(times))
        return Plan(
            gait=self.gaits[best],
            gaits=(self.gaits[best],),
            value=float(times[best]),
            objective="expected time to capture [s]",
            nodes=len(times),
            make_trace=partial(_trace, self.gaits, times, best),
            target=Polar(*map(float, situation.prey)),
        )


def _trace(gaits: tuple[str, ...], times: np.ndarray, best: int) -> pd.DataFrame:
    """One row per gait: the expected time to capture if it is executed now."""
    nodes = np.arange(len(gaits))
    return pd.DataFrame({"node": nodes, "gait": list(gaits), "value": times, "chosen": nodes == best})


def _checksum(text: str, arrays: Mapping[str, np.ndarray]) -> str:
    digest = hashlib.sha256(text.encode())
    for key in _ARRAYS:
        array = np.ascontiguousarray(arrays[key])
        digest.update(f"{key} {array.dtype.str} {array.shape}".encode())
        digest.update(array.tobytes())
    return digest.hexdigest()
