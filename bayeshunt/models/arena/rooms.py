"""The room: walls that the hunter was held up by while it babbled in the arena, and the cells in which it was.

Walls are straight and the room is convex: a wall is a half-plane that the hunter's centre cannot
leave, in the frame in which the hunter started. Letters: W walls.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core import displays
from bayeshunt.core.arguments import check_fields, checked
from bayeshunt.core.checks import check_bearings
from bayeshunt.core.errors import DataError
from bayeshunt.data.babbling_table import PROVENANCE_KEY
from bayeshunt.files.endings import check_ending
from bayeshunt.files.records import RecordKind
from bayeshunt.models.arena.contacts import Wall, find_contacts, find_walls
from bayeshunt.models.arena.free_space import FreeSpace
from bayeshunt.models.arena.obstacles import TouchedObstacles
from bayeshunt.models.body.forward import ForwardModel

__all__ = ["PARALLEL", "RoomModel"]

_RECORD = RecordKind("bayeshunt room", "bayeshunt explore")
_COLUMNS = ("step", "gait", "interval", "x", "y", "theta")
#: A step ended this many body lengths, or this share of the longest step if that is less, from where its gait leads:
#: something was in the way.
_BLOCKED, _SHORT = 1.0, 0.3
#: A wall is at least this long, and these many blocked poses lie within this many body lengths of it.
_LENGTH, _SUPPORT, _NEAR = 1.5, 10, 0.1
#: And so many to a body length of it, where no touch can be told: in the open a hexapod's hull has 0.2 to 0.6, a wall
#: of its room 40 (1,500 gaits, seed 1000).
_DENSE = 2.0
#: Directions of walls that differ by less [rad] are one.
PARALLEL = math.radians(10.0)


@dataclass(frozen=True, eq=False, repr=False)
class RoomModel(displays.Displayed):
    """Walls as half-planes ``nx x + ny y <= offset`` of the hunter's centre, in its starting frame.

    normals: unit vectors towards the walls, x ahead and y to the left [W, 2]. offsets: metres [W].
    lengths: metres of wall touched [W]. blocked: poses near the wall in steps that were held up [W].
    space: where the hunter's centre can be, cell by cell: obstacles inside the room are there; None: not known.
    """

    normals: np.ndarray
    offsets: np.ndarray
    lengths: np.ndarray
    blocked: np.ndarray
    provenance: Mapping[str, Any] = field(default_factory=dict)
    space: FreeSpace | None = None

    @classmethod
    def empty(cls) -> RoomModel:
        """Return a room in which no wall has been met."""
        return cls(np.zeros((0, 2)), np.zeros(0), np.zeros(0), np.zeros(0, dtype=int))

    @classmethod
    def of(cls, room: RoomModel | str | os.PathLike[str] | None) -> RoomModel:
        """Return a room as it is, the one of a file, or for None one in which no wall has been met."""
        if room is None:
            return cls.empty()
        return room if isinstance(room, RoomModel) else cls.load(room)

    @classmethod
    @checked
    def fit(cls, track: pd.DataFrame, model: ForwardModel) -> RoomModel:
        """Learn the walls, and the table of free space, from poses while babbling in the arena.

        track: columns step, gait, interval, x, y [m], theta [rad, counter-clockwise], one row per
        part-way pose, ordered, in the starting frame. model: tells where each gait leads in the open.
        A wall is where the hunter was stopped, and shows itself at the first touch: see
        :mod:`~bayeshunt.models.arena.contacts`. A model without part-way poses does not tell a touch, nor can one be
        told in the gaits of a robot that trips, or is stopped by its legs more than by walls; then walls are the long
        edges of the convex hull of all poses at which steps were held up.

        Raises DataError if a column is missing, a number is not finite or the robot hardly moved; InputError
        for a gait that ``model`` does not know.
        """
        missing = [name for name in _COLUMNS if name not in track.columns]
        if missing:
            raise DataError(f"track: column {missing[0]!r} is missing; expected {', '.join(_COLUMNS)}")
        poses = track[["x", "y", "theta"]].to_numpy(dtype=float)
        places = poses[:, :2]
        if not np.isfinite(poses).all() or len(np.unique(places, axis=0)) < 3:
            raise DataError("track: expected at least three places, and finite x, y and theta")
        check_bearings(poses[:, 2], "track: theta")
        body, held = model.gaits.need("body_length"), _held_up(track, model)
        contacts = find_contacts(track, held, model)
        walls: Sequence[Wall] = _merge(_edges(_hull(places)), places[held], body)
        if contacts is not None:
            touched = find_walls(contacts, walls, places, body) if len(contacts.places) else []
            # one that trips is held up in the open as well, but hardly ever along one line
            walls = touched or [wall for wall in walls if wall[4] * body >= _DENSE * wall[3]]
        table = np.array(walls, dtype=float).reshape(-1, 5)
        provenance = dict(track.attrs.get(PROVENANCE_KEY, {}))
        space = FreeSpace.count(places, contacts, body)
        return cls(table[:, :2], table[:, 2], table[:, 3], table[:, 4].astype(int), provenance, space)

    def __post_init__(self) -> None:
        check_fields(self)
        for name in ("normals", "offsets", "lengths", "blocked"):
            array = np.array(getattr(self, name))
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    def walls(self) -> pd.DataFrame:
        """Return one row per wall: direction [deg, clockwise from the start's heading], offset, length [m], blocked."""
        bearing = -np.degrees(np.arctan2(self.normals[:, 1], self.normals[:, 0])) + 0.0
        columns = {"bearing_deg": bearing, "offset_m": self.offsets, "length_m": self.lengths, "blocked": self.blocked}
        return pd.DataFrame(columns).rename_axis("Wall")

    def obstacles(self) -> TouchedObstacles | None:
        """Return what the hunter touched inside the walls, cell by cell; None if it touched nothing there."""
        return TouchedObstacles.of(self.space, self.normals, self.offsets)

    def __repr__(self) -> str:
        return f"<RoomModel: {len(self.offsets)} walls, {self.space!r}>"

    @checked
    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the room as JSON with a checksum, replaced atomically."""
        content: dict[str, Any] = {
            "normals": self.normals.tolist(),
            "offsets": self.offsets.tolist(),
            "lengths": self.lengths.tolist(),
            "blocked": self.blocked.tolist(),
            "provenance": dict(self.provenance),
        }
        if self.space is not None:
            content["space"] = self.space.to_dict()
        check_ending(path, "rooms", ".json")
        _RECORD.save(content, path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> RoomModel:
        """Read a room; ModelFileError in one line if the file is missing, damaged or something else."""
        _, content = _RECORD.load(path)
        try:
            normals = np.array(content["normals"], dtype=float).reshape(-1, 2)
            offsets, lengths, blocked = (np.array(content[k], dtype=float) for k in ("offsets", "lengths", "blocked"))
            if {len(offsets), len(lengths), len(blocked)} != {len(normals)}:
                raise ValueError("every wall needs an offset, a length and a count")
            space = FreeSpace.from_dict(content["space"]) if "space" in content else None
            return cls(normals, offsets, lengths, blocked.astype(int), content["provenance"], space)
        except (ValueError, KeyError, TypeError, IndexError, DataError) as error:
            raise _RECORD.malformed(os.fspath(path), error) from None


def _held_up(track: pd.DataFrame, model: ForwardModel) -> np.ndarray:
    """Return bool [N]: rows of steps that ended a body length or more from where their gait leads."""
    last = track.groupby("step", sort=False).tail(1)
    end = last[["x", "y", "theta"]].to_numpy(dtype=float)
    start = np.vstack([np.zeros(3), end[:-1]])
    codes = [model.gaits.index(name) for name in last["gait"]]
    led = [model.predict(gait) for gait in model.gaits]
    ahead, left = (
        np.array([float(v) for v in part])[codes] for part in ([p.forward for p in led], [-p.right for p in led])
    )
    cos, sin = np.cos(start[:, 2]), np.sin(start[:, 2])
    miss = np.hypot(
        start[:, 0] + cos * ahead - sin * left - end[:, 0], start[:, 1] + sin * ahead + cos * left - end[:, 1]
    )
    longest = max(float(pose.distance) for pose in led)
    held = last["step"].to_numpy()[miss > min(_BLOCKED * model.gaits.need("body_length"), _SHORT * longest)]
    return track["step"].isin(held).to_numpy()


def _hull(points: np.ndarray) -> np.ndarray:
    """Return the corners of the convex hull, counter-clockwise [V, 2] (Andrew's monotone chain)."""
    ordered = np.unique(points, axis=0).tolist()
    half: list[list[list[float]]] = []
    for run in (ordered, ordered[::-1]):
        chain: list[list[float]] = []
        for x, y in run:
            while len(chain) > 1:
                (ax, ay), (bx, by) = chain[-2], chain[-1]
                if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0:
                    break
                chain.pop()
            chain.append([x, y])
        half.append(chain[:-1])
    return np.array(half[0] + half[1])


def _edges(hull: np.ndarray) -> np.ndarray:
    """Return nx, ny, offset, length of every edge, the longest first [V, 4]."""
    along = np.roll(hull, -1, axis=0) - hull
    length = np.hypot(*along.T)
    normal = np.stack([along[:, 1], -along[:, 0]], axis=1) / length[:, None]
    offset = (normal * hull).sum(axis=1)
    return np.column_stack([normal, offset, length])[np.argsort(-length, kind="stable")]


def _merge(edges: np.ndarray, held: np.ndarray, body: float) -> list[tuple[float, ...]]:
    """Return the walls among the edges: of nearly parallel ones, the longest says where the wall is."""
    walls: list[tuple[float, ...]] = []
    free = np.ones(len(edges), dtype=bool)
    for index, (nx, ny, offset, _) in enumerate(edges.tolist()):
        if not free[index]:
            continue
        same = free & (edges[:, 0] * nx + edges[:, 1] * ny > math.cos(PARALLEL))
        free &= ~same
        length = float(edges[same, 3].sum())
        near = int((offset - held @ np.array([nx, ny]) < _NEAR * body).sum())
        if length >= _LENGTH * body and near >= _SUPPORT:
            walls.append((nx, ny, offset, length, float(near)))
    return walls
