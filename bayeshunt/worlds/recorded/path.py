"""One individual's recorded way: where it is at any time, placed so that it starts where a hunt starts it."""

from __future__ import annotations

import cmath
import os
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
import pandas as pd

from bayeshunt.core.errors import InputError, did_you_mean, shown
from bayeshunt.core.geometry import FloatArray, Pose
from bayeshunt.data import tracks
from bayeshunt.data.steps import Run, median_step, native_step, runs
from bayeshunt.data.transitions import STANDING_SHARE, facing
from bayeshunt.worlds.prey.names import RECORDED, is_recorded

__all__ = ["RecordedPath", "path_of", "read_path"]

_FEW = 8
_HOW = 'expected "recorded:tracks.parquet#id", a table of bayeshunt ingest tracks and one of its individuals'


@dataclass(frozen=True, eq=False)
class RecordedPath:
    """Where it is, and where it faces.

    times: seconds from its start [N], from 0. places: complex [N], x + i y [m]. headings: [N], rad counter-clockwise,
    not wrapped.
    """

    times: FloatArray
    places: FloatArray
    headings: FloatArray

    @classmethod
    def of(cls, run: Run, interval: float) -> RecordedPath:
        """Return the way of an unbroken run, a place every ``interval`` [s].

        Where it faces is where it goes, unless the file has the body's heading. It starts to face where it first goes
        to; a step shorter than a tenth of its typical one does not turn it.
        """
        least = STANDING_SHARE * median_step([run])
        direction = facing(run.places, run.headings, run.stride, least)
        going = np.abs(np.diff(run.places)) > max(least, 1e-12)
        if not np.isfinite(run.headings[0]) and going.any():
            first = int(np.argmax(going))
            step = run.places[first + 1] - run.places[first]
            direction[: first + 1] = step / abs(step)
        times: FloatArray = np.arange(len(run.places), dtype=np.float64) * float(interval)
        return cls(times, run.places, np.unwrap(np.angle(direction)))

    @property
    def duration(self) -> float:
        """Seconds from its first to its last place."""
        return float(self.times[-1])

    def at(self, time: float) -> Pose:
        """Return its pose [m, rad] in the frame of its start; before and after its time it stands."""
        gone = np.interp(time, self.times, self.places.real) + 1j * np.interp(time, self.times, self.places.imag)
        turn = float(self.headings[0])
        place = complex(gone - self.places[0]) * cmath.exp(-1j * turn)
        return Pose(place.real, place.imag, float(np.interp(time, self.times, self.headings)) - turn)


def path_of(behaviour: str) -> RecordedPath:
    """Return the way of a recorded prey by the name of its behaviour; InputError or DataError in one line."""
    file, mark, individual = behaviour.removeprefix(RECORDED).rpartition("#")
    if not is_recorded(behaviour) or not (mark and file and individual):
        raise InputError(f"prey.behaviour: {shown(behaviour)}: {_HOW}")
    path = Path(file)
    return _read(os.fspath(path), individual, path.stat().st_mtime_ns if path.exists() else 0)


def read_path(frame: pd.DataFrame, individual: str, source: str = "tracks") -> RecordedPath:
    """Return the longest unbroken way of an individual of a table of tracks.

    individual: its id; "17@zara01.txt" where several scenes have an individual of that id.

    Raises InputError for one that it does not have, for lengths that are not metres, or without any way.
    """
    individual, _, scene = individual.partition("@")
    names = frame["id"].astype(str)
    if scene or ("scene" in frame and frame.loc[names == individual, "scene"].nunique() > 1):
        frame = _of_scene(frame, individual, scene, source)
        names = frame["id"].astype(str)
    if not (names == individual).any():
        known = list(dict.fromkeys(names))
        if len(known) <= _FEW:
            raise InputError(f"{source}: no individual {individual!r}{did_you_mean(individual, known)}")
        listed = ", ".join(known[:_FEW])
        raise InputError(f"{source}: no individual {individual!r}; it has {listed} and {len(known) - _FEW} more")
    mine = frame[names == individual]
    if "unit" in mine and mine["unit"].notna().any():
        raise InputError(
            f"{source}: lengths are in {mine['unit'].dropna().iloc[0]}, and a hunt needs metres; read the tracks again "
            "with --scale"
        )
    found = [run for run in runs(mine) if len(run.places) > 1] if len(mine) > 1 else []
    if not found:
        raise InputError(f"{source}: individual {individual!r} has no two places on end")
    return RecordedPath.of(max(found, key=lambda run: len(run.places)), native_step(mine))


def _of_scene(frame: pd.DataFrame, individual: str, scene: str, source: str) -> pd.DataFrame:
    """The rows of one scene."""
    scenes = sorted(set(frame["scene"].astype(str)))
    if not scene:
        raise InputError(f"{source}: {len(scenes)} scenes, several with an individual {individual!r}; say which: "
                         f"#{individual}@{scenes[0]}")  # fmt: skip
    if scene not in scenes:
        raise InputError(f"{source}: no scene {scene!r}{did_you_mean(scene, scenes)}")
    return frame[frame["scene"].astype(str) == scene]


@lru_cache(maxsize=512)
def _read(file: str, individual: str, changed: int) -> RecordedPath:
    """The way in a file that was last ``changed`` then."""
    return read_path(_table(file, changed), individual, file)


@lru_cache(maxsize=4)
def _table(file: str, changed: int) -> pd.DataFrame:
    return tracks.load(file)
