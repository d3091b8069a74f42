"""Where the robot was stopped, and by what: each touch shows the way that its wall faces.

Nothing rubs, so a wall takes from a motion just the part that is towards it: what the gait would have added in an
interval less what the robot moved is normal to the wall. In a corner it is normal to neither of the two. Letters: N
rows of a track, C contacts, G gaits, P intervals.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bayeshunt.core.geometry import FloatArray
from bayeshunt.models.body.forward import ForwardModel

__all__ = ["Contacts", "Wall", "expected_motion", "find_contacts", "find_walls"]

#: An interval that fell short by so many times what is usual was stopped; noise alone hardly reaches it.
_STOPPED = 8.0
#: Intervals in which a gait is still under the spell of the one before.
_SETTLING = 2
#: A robot that still made this share of its way slid along a wall; one that made less may be in a corner.
_SLID = 0.1
#: Contacts of one wall: at first sight their directions differ by less [rad] and their line by less [body lengths].
_TURN, _NEAR = math.radians(5.0), 0.1
#: Of all of them, once the wall is known; and so many show a wall.
_FACING, _ALONG, _LEAST = math.radians(10.0), 0.5, 3
#: A touch as near as this to two walls [body lengths] is of a corner.
_CORNER = 0.25
#: Contacts that are compared with each other; of more, every so many-th.
_MOST = 800

#: nx, ny, offset [m], length [m], contacts.
Wall = tuple[float, ...]
Mask = NDArray[np.bool_]


class Contacts(NamedTuple):
    """Touches: where the robot's centre was [C, 2], metres, the unit vector towards what it touched [C, 2], and slid.

    slid: whether it went on along what it touched, bool [C].
    """

    places: FloatArray
    towards: FloatArray
    slid: Mask

    def where(self, kept: Mask) -> Contacts:
        """Return some of them."""
        return Contacts(self.places[kept], self.towards[kept], self.slid[kept])

    def near(self, wall: Wall, distance: float) -> Mask:
        """Return which were within ``distance`` [m] of a wall's line: bool [C]."""
        found: Mask = np.abs(self.places @ np.array(wall[:2]) - wall[2]) < distance
        return found

    def of(self, wall: Wall, body: float) -> Mask:
        """Return which are of this wall: near it, and facing as it does: bool [C]."""
        found: Mask = self.near(wall, _ALONG * body) & (self.towards @ np.array(wall[:2]) > math.cos(_FACING))
        return found

    def unexplained(self, walls: Sequence[Wall], body: float) -> Contacts:
        """Return those that are neither of one of the walls nor of a corner of two."""
        if not walls:
            return self
        single = np.any([self.of(wall, body) for wall in walls], axis=0)
        corner = np.sum([self.near(wall, _CORNER * body) for wall in walls], axis=0) > 1
        return self.where(~single & ~corner)


def find_walls(contacts: Contacts, edges: Sequence[Wall], places: FloatArray, body: float) -> list[Wall]:
    """Return the walls that contacts show.

    edges: long edges of the hull of all places [N, 2]: walls, or lines that join two of them. An edge is a wall if
    touches along it face as it does. A wall of which only a corner was touched is taken to be at right angles to the
    one that it meets there, until it shows itself.
    """
    sliding = contacts.where(contacts.slid)
    walls = [edge for edge in edges if _confirmed(edge, contacts, body)]
    walls += _apart(_clusters(sliding.unexplained(walls, body), places, body), walls)
    return walls + _apart(_corners(contacts, walls, places, body), walls)


def _confirmed(edge: Wall, contacts: Contacts, body: float) -> bool:
    """Whether touches along an edge face as it does."""
    normal, off = np.array(edge[:2]), 0.2 * _FACING
    towards = contacts.towards[contacts.near(edge, _NEAR * body) & contacts.of(edge, body)]
    mean = towards.sum(axis=0)
    return len(towards) >= _LEAST and bool(mean @ normal > math.cos(off) * np.hypot(*mean))


def _apart(walls: Sequence[Wall], known: Sequence[Wall]) -> list[Wall]:
    """The walls that face otherwise than all known ones."""
    return [w for w in walls if all(w[0] * k[0] + w[1] * k[1] < math.cos(_FACING) for k in known)]


def _corners(contacts: Contacts, walls: Sequence[Wall], places: FloatArray, body: float) -> list[Wall]:
    """Walls at right angles to known ones, from touches in the corners that they make with them."""
    left, found = contacts.unexplained(walls, body), []
    for wall in walls:
        normal = np.array(wall[:2])
        here = left.where(left.near(wall, _NEAR * body))
        across = here.towards - (here.towards @ normal)[:, None] * normal
        size = np.hypot(*across.T)
        aside = Contacts(here.places, across / np.maximum(size, 1e-9)[:, None], here.slid).where(
            size > math.sin(_FACING)
        )
        found += _clusters(aside, places, body)
    return found


def expected_motion(track: pd.DataFrame, model: ForwardModel) -> tuple[FloatArray, FloatArray]:
    """Return where the robot was before each row and what its gait would have added in it, metres: [N, 2] each.

    NaN where the model knows no part-way poses, or others than the track's.
    """
    poses = track[["x", "y", "theta"]].to_numpy(dtype=float)
    before = np.vstack([np.zeros(3), poses[:-1]])
    interval = track["interval"].to_numpy(dtype=int) - 1
    paths = model.mean_paths
    if paths is None or not np.array_equal(np.unique(interval), np.arange(paths.shape[1])):
        return before[:, :2], np.full((len(poses), 2), np.nan)
    path = np.concatenate([np.zeros((len(paths), 1, 3)), paths], axis=1)  # [G, P + 1, 3] forward, right, heading
    codes = np.array([model.gaits.index(name) for name in track["gait"]])
    start, end = path[codes, interval], path[codes, interval + 1]
    forward, right = (end - start)[:, :2].T
    turn = before[:, 2] + start[:, 2]  # the path's frame turned to where the robot faces, counter-clockwise
    cos, sin = np.cos(turn), np.sin(turn)
    return before[:, :2], np.stack([cos * forward + sin * right, sin * forward - cos * right], axis=1)


def find_contacts(track: pd.DataFrame, held: Mask, model: ForwardModel) -> Contacts | None:
    """Return the touches; None if the model does not know part-way poses. held: rows of steps that were held up [N]."""
    before, expected = expected_motion(track, model)
    if np.isnan(expected).all():
        return None
    places = track[["x", "y"]].to_numpy(dtype=float)
    short = expected - (places - before)
    size, moved = np.hypot(*short.T), np.hypot(*(places - before).T)
    settled = track["interval"].to_numpy() > _SETTLING
    usual = size[settled & ~held]
    stopped = settled & (size > _STOPPED * (np.median(usual) if len(usual) else 0.0))  # NaN is not above
    slid = moved > _SLID * np.hypot(*expected.T)
    return Contacts(places[stopped], short[stopped] / size[stopped, None], slid[stopped])


def _clusters(contacts: Contacts, places: FloatArray, body: float) -> list[Wall]:
    """Walls from contacts that face alike along one line, those of most contacts first.

    places: everywhere that the robot was [N, 2]; it was never beyond a wall.
    """
    walls: list[Wall] = []
    left = contacts.where(np.arange(len(contacts.places)) % max(1, math.ceil(len(contacts.places) / _MOST)) == 0)
    while len(left.places) >= _LEAST:
        lines = (left.places * left.towards).sum(axis=1)
        aside = np.abs(left.towards @ left.places.T - lines[:, None])  # [C, C]: of a touch's line, of a place
        same = (aside < _NEAR * body) & (left.towards @ left.towards.T > math.cos(_TURN))
        best = same[same.sum(axis=1).argmax()]
        if best.sum() < _LEAST:
            break
        best |= left.of(_line(left.where(best), body), body)
        wall = _line(left.where(best), body)
        if (places @ np.array(wall[:2])).max() < wall[2] + _NEAR * body:
            walls.append(wall)
        left = left.where(~best)
    return walls


def _line(contacts: Contacts, body: float) -> Wall:
    """The wall through contacts: facing as they do on average, or, where they lie apart, as their line does."""
    mean = contacts.towards.mean(axis=0)
    mean /= np.hypot(*mean)
    along = contacts.places @ np.array([-mean[1], mean[0]])
    if np.ptp(along) > 2.0 * body:
        tilt = math.atan(np.polyfit(along, contacts.places @ mean, 1)[0])
        cos, sin = math.cos(tilt), math.sin(tilt)
        mean = np.array([cos * mean[0] + sin * mean[1], cos * mean[1] - sin * mean[0]])
    offset = float(np.median(contacts.places @ mean))
    return float(mean[0]), float(mean[1]), offset, float(np.ptp(along)), float(len(along))
