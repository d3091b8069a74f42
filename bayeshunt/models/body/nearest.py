"""Which learned (Distance, Angle) cell is nearest to a target in metres; exactly, for tables of any size.

Seen from the robot, the learned cells of one angle bin lie on a ray. Of a ray the nearest cell is one of the two on
either side of the target's foot on it, so a few cells of each ray are all that can answer. The plane is cut into
buckets, and what can answer somewhere in a bucket is worked out when its points are asked again: the foot of
a bucket on a ray lies between those of its corners, and a cell beaten by another at every corner of a convex hull is
beaten inside, because which of two centres is nearer is an affine question. Nearly all buckets keep one or two cells.
Letters: M learned cells, A rays (angle bins), B buckets, P pairs of a bucket and a cell, N targets.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from bayeshunt.core.bins import Axis
from bayeshunt.core.geometry import wrap

__all__ = ["FARTHEST", "CellFinder"]

#: Targets may lie this far out [m].
FARTHEST = 1e12
#: Buckets per distance bin and per angle bin (powers of two, so that cutting is exact), fewer in a wide table.
_RINGS, _SECTORS = 4, 16
#: Most sectors that are finer than the angle bins, and most buckets within the distance axis.
_MOST_SECTORS, _MOST_BUCKETS = 1 << 10, 1 << 22
#: Rings per doubling of the distance beyond the axis.
_OCTAVE = 8
#: Relative closeness of squared distances that counts as a tie, far above rounding.
_TIE = 1e-12
#: Buckets worked out at a time.
_CHUNK = 512


class _Candidate(NamedTuple):
    """A cell that may be nearest: |c|^2, 2 c_x, 2 c_y and its index."""

    square: float
    twice_x: float
    twice_y: float
    cell: int


class CellFinder:
    """Finds the learned cell nearest to a target. Ties (to 1 part in 1e12) go to the lowest index.

    distance, angle: the axes. cells: int64 [M, 2], bins of the learned cells, sorted; their index is 0 to M - 1.
    """

    def __init__(self, distance: Axis, angle: Axis, cells: np.ndarray) -> None:
        self._distance, self._angle = distance, angle
        reach, bearing = distance.centres[cells[:, 0]], angle.centres[cells[:, 1]]
        # |p - c|^2 = |p|^2 + (|c|^2 - 2 p.c): the bracket ranks the centres c and is affine in p.
        self._square = reach**2
        self._twice_x, self._twice_y = 2.0 * reach * np.cos(bearing), 2.0 * reach * np.sin(bearing)
        self._radius = float(reach.max())
        # The rays: cells by angle bin, then distance bin; each is found by the number a * bins + d.
        self._by_ray = np.lexsort((cells[:, 0], cells[:, 1]))
        self._numbers = cells[self._by_ray, 1] * distance.bins + cells[self._by_ray, 0]
        self._rays = np.arange(angle.bins + 1) * distance.bins
        self._ray_starts = np.searchsorted(self._numbers, self._rays)
        self._cut()
        # 0: not worked out yet; c + 1: only cell c; -1 - k: the k-th list of several.
        self._codes = np.zeros(self._ring_count * self._sectors, dtype=np.int64)
        self._lists: list[np.ndarray] = []
        self._entries: dict[int, int | list[_Candidate]] = {}
        self._asked: set[int] = set()  # buckets that one single target has lain in
        self._own = np.zeros(distance.bins * angle.bins, dtype=np.int32)  # index + 1 of the cell in these bins
        self._own[cells[:, 0] * angle.bins + cells[:, 1]] = np.arange(1, len(cells) + 1)

    def _cut(self) -> None:
        """Choose the buckets: ``_fineness`` rings per distance bin, then ``_OCTAVE`` a doubling; sectors of a turn."""
        bins = self._distance.bins
        self._per_angle = _SECTORS
        while self._per_angle > 1 and self._per_angle * self._angle.bins > _MOST_SECTORS:
            self._per_angle //= 2
        self._sectors = self._per_angle * self._angle.bins
        self._fineness = float(_RINGS)
        while self._fineness * bins * self._sectors > _MOST_BUCKETS and self._fineness * bins > 1:
            self._fineness /= 2
        self._near_rings = math.ceil(bins * self._fineness)
        self._first_octave = math.frexp(bins)[1]
        octaves = math.frexp(FARTHEST / self._distance.width)[1] + 1 - self._first_octave
        self._ring_count = self._near_rings + max(octaves, 1) * _OCTAVE

    def nearest(self, d: float, a: float, d_bins: float, a_bins: float) -> int:
        """Return the index of the cell nearest to a target.

        d [m] in [0, FARTHEST], a [rad]; d_bins, a_bins: the same in bin widths from the axes' first edges.
        """
        if d_bins < self._distance.bins:
            ring = int(d_bins * self._fineness)
        else:
            mantissa, octave = math.frexp(d_bins)
            ring = self._near_rings + (octave - self._first_octave - 1) * _OCTAVE + int(mantissa * 2 * _OCTAVE)
        # bins start before -pi, so the last half one is the first
        key = ring * self._sectors + math.floor(a_bins * self._per_angle) % self._sectors
        found = self._entries.get(key)
        if found is None:
            if key not in self._asked:  # to work out a bucket costs more than to look at every cell once
                self._asked.add(key)
                return self._of_all(d, a)
            found = self._entry(key)
        if isinstance(found, int):
            return found
        x, y = d * math.cos(a), d * math.sin(a)
        slack = _TIE * self._radius * (self._radius + d)
        if len(found) == 2:  # nearly always; the rule below, written out
            (square, x2, y2, cell), (other, u2, v2, second) = found
            return cell if square - x * x2 - y * y2 <= other - x * u2 - y * v2 + slack else second
        scores = [square - x * x2 - y * y2 for square, x2, y2, _ in found]
        limit = min(scores) + slack
        return next(c.cell for c, score in zip(found, scores, strict=True) if score <= limit)

    def _of_all(self, d: float, a: float) -> int:
        """Return what :meth:`nearest` does by comparing all cells."""
        scores = self._square - d * math.cos(a) * self._twice_x - d * math.sin(a) * self._twice_y
        return int(np.argmax(scores <= scores.min() + _TIE * self._radius * (self._radius + d)))

    def find_many(self, d: np.ndarray, a: np.ndarray) -> np.ndarray:
        """Return int64 [N]: the cell that each target uses, its own or else the nearest. d [m], a [rad] finite."""
        d_bins = d / self._distance.width
        a_bins = (wrap(a) - self._angle.edges[0]) / self._angle.width
        found = self._owners(d_bins, a_bins)
        todo = np.flatnonzero(found < 0)
        if todo.size:
            found[todo] = self._nearest_many(d[todo], a[todo], d_bins[todo], a_bins[todo])
        return found

    # --- inside -------------------------------------------------------------------------------

    def _owners(self, d_bins: np.ndarray, a_bins: np.ndarray) -> np.ndarray:
        """[N] the learned cell that each target lies in, or -1."""
        column = np.floor(a_bins).astype(np.int64)
        column = np.where(column >= self._angle.bins, column - self._angle.bins, column)
        within = d_bins < self._distance.bins
        number = np.where(within, d_bins, 0.0).astype(np.int64) * self._angle.bins + column
        return np.where(within, self._own[number], 0).astype(np.int64) - 1

    def _nearest_many(self, d: np.ndarray, a: np.ndarray, d_bins: np.ndarray, a_bins: np.ndarray) -> np.ndarray:
        sectors = np.floor(a_bins * self._per_angle).astype(np.int64)
        sectors = np.where(sectors >= self._sectors, sectors - self._sectors, sectors)
        keys = self._rings_of(d_bins) * self._sectors + sectors
        found = self._codes[keys]
        unknown = np.flatnonzero(found == 0)
        if unknown.size:
            self._work_out(np.unique(keys[unknown]))
            found = self._codes[keys]
        disputed = np.flatnonzero(found < 0)
        if disputed.size:
            d, a = d[disputed], a[disputed]
            found[disputed] = 1 + self._settle_many(-1 - found[disputed], d, d * np.cos(a), d * np.sin(a))
        places: np.ndarray = found - 1
        return places

    def _rings_of(self, bins: np.ndarray) -> np.ndarray:
        rings = (np.minimum(bins, self._distance.bins) * self._fineness).astype(np.int64)
        far = np.flatnonzero(bins >= self._distance.bins)
        if far.size:
            mantissa, octave = np.frexp(bins[far])
            steps = (octave.astype(np.int64) - self._first_octave - 1) * _OCTAVE
            rings[far] = self._near_rings + steps + (mantissa * (2 * _OCTAVE)).astype(np.int64)
        found: np.ndarray = rings
        return found

    def _entry(self, key: int) -> int | list[_Candidate]:
        """What a bucket says: its only cell, or the cells to compare. Remembered."""
        if self._codes[key] == 0:
            self._work_out(np.array([key]))
        code = int(self._codes[key])
        entry: int | list[_Candidate] = code - 1
        if code < 0:
            cells = self._lists[-1 - code]
            parts = (self._square[cells], self._twice_x[cells], self._twice_y[cells], cells)
            entry = [_Candidate(*values) for values in zip(*(part.tolist() for part in parts), strict=True)]
        self._entries[key] = entry
        return entry

    def _work_out(self, keys: np.ndarray) -> None:
        """Fill in the codes of buckets [B]."""
        for start in range(0, len(keys), _CHUNK):
            part = keys[start : start + _CHUNK]
            buckets, cells = self._contenders(part)
            firsts = np.searchsorted(buckets, np.arange(len(part)))
            lengths = np.diff(np.append(firsts, len(cells)))
            single = lengths == 1
            self._codes[part[single]] = cells[firsts[single]] + 1
            for i in np.flatnonzero(~single).tolist():
                self._lists.append(cells[firsts[i] : firsts[i] + lengths[i]].copy())
                self._codes[part[i]] = -len(self._lists)

    def _contenders(self, keys: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pairs (place in ``keys``, cell) [P], sorted: the cells that may be nearest somewhere in each bucket."""
        x, y, outer = self._hull(keys)
        slack = _TIE * self._radius * (self._radius + outer)  # [B], the most inside
        buckets, cells = self._beside(x, y, slack)
        firsts = np.searchsorted(buckets, np.arange(len(keys)))
        scores = self._square[cells] - x[:, buckets] * self._twice_x[cells] - y[:, buckets] * self._twice_y[cells]
        least = np.minimum.reduceat(scores, firsts, axis=1)[:, buckets]  # [5, P]
        places = np.where(scores == least, np.arange(len(cells)), len(cells))
        winners = np.minimum.reduceat(places, firsts, axis=1)  # [5, B], the nearest at each corner
        keep = np.ones(len(cells), dtype=bool)
        for winner in winners:  # one that is worse than another at all corners is worse inside
            rival = scores[:, winner] + 4.0 * slack
            keep &= ~np.all(scores > rival[:, buckets], axis=0)
        order = np.lexsort((cells[keep], buckets[keep]))
        return buckets[keep][order], cells[keep][order]

    def _beside(self, x: np.ndarray, y: np.ndarray, slack: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pairs (bucket, cell) [P], by bucket: on every ray, the cells from below to above all feet of the bucket.

        x, y [5, B]: corners of the bucket's hull. The next cell out is farther by at least a bin width times its
        distance from the foot, so ``slack`` widens the feet by ``slack`` / width to hold all ties.
        """
        width, bins = self._distance.width, self._distance.bins
        centres = self._angle.centres
        feet = x[:, :, None] * np.cos(centres) + y[:, :, None] * np.sin(centres)  # [5, B, A]
        pad = slack[:, None] / width
        low = np.clip(np.floor((feet.min(axis=0) - pad) / width - 0.5), 0, bins - 1).astype(np.int64)
        high = np.clip(np.ceil((feet.max(axis=0) + pad) / width - 0.5), 0, bins - 1).astype(np.int64)
        starts = np.searchsorted(self._numbers, self._rays[:-1] + low, side="right") - 1
        ends = np.searchsorted(self._numbers, self._rays[:-1] + high, side="left") + 1
        starts = np.maximum(starts, self._ray_starts[:-1])
        lengths = np.maximum(np.minimum(ends, self._ray_starts[1:]) - starts, 0)
        flat = lengths.ravel()
        offsets = np.repeat(starts.ravel() - (np.cumsum(flat) - flat), flat)
        cells = self._by_ray[np.arange(len(offsets)) + offsets]
        return np.repeat(np.arange(len(lengths)), lengths.sum(axis=1)), cells

    def _hull(self, keys: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """x, y [5, B] of convex hulls: a bucket's corners, and where its outer tangents meet; and how far that is."""
        rings, sectors = np.divmod(keys, self._sectors)
        far = rings >= self._near_rings
        octave, part = np.divmod(np.where(far, rings - self._near_rings, 0), _OCTAVE)
        unit = 2.0 ** (octave + self._first_octave) / (2 * _OCTAVE)
        inner = self._distance.width * np.where(far, (part + _OCTAVE) * unit, rings / self._fineness)
        outer = self._distance.width * np.where(far, (part + _OCTAVE + 1) * unit, (rings + 1) / self._fineness)
        step = self._angle.width / self._per_angle
        apex = outer / math.cos(step / 2.0)
        low = self._angle.edges[0] + sectors * step
        radii = np.stack([inner, inner, outer, outer, apex])
        angles = np.stack([low, low + step, low, low + step, low + step / 2.0])
        return radii * np.cos(angles), radii * np.sin(angles), apex

    def _settle_many(self, lists: np.ndarray, d: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Nearest candidate [N] of each list; worked on as one flat array of (target, candidate) pairs."""
        used, inverse = np.unique(lists, return_inverse=True)
        kept = [self._lists[k] for k in used.tolist()]
        sizes = np.array([len(cells) for cells in kept])
        begins = np.cumsum(sizes) - sizes
        lengths = sizes[inverse]
        firsts = np.cumsum(lengths) - lengths
        pairs = np.arange(int(lengths.sum())) + np.repeat(begins[inverse] - firsts, lengths)
        cells = np.concatenate(kept)[pairs]
        scores = self._square[cells] - np.repeat(x, lengths) * self._twice_x[cells]
        scores -= np.repeat(y, lengths) * self._twice_y[cells]
        limit = np.minimum.reduceat(scores, firsts) + _TIE * self._radius * (self._radius + d)
        tied = np.where(scores <= np.repeat(limit, lengths), cells, len(self._square))
        nearest: np.ndarray = np.minimum.reduceat(tied, firsts)
        return nearest
