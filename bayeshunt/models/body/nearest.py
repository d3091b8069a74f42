"""Which learned (Distance, Angle) cell a target uses: its own, else the nearest in metres. Exactly.

The plane is cut into small sectors, finer than the bins by a power of two, in rings that grow with
distance beyond the axis. Which of two centres is nearer is an affine question, so a centre that
beats another at the corners of a convex hull around a sector beats it inside. Most sectors are left
with one candidate and need no arithmetic at all; the others compare the few that remain.
Letters: M learned cells, S sectors in a ring, N targets.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from bayeshunt.core.bins import Axis

#: Rings per distance bin, sectors per angle bin: powers of two, so that subdividing is exact.
RINGS, SECTORS = 4, 16
#: Rings per doubling of the distance beyond the axis.
_OCTAVE = 8
#: Targets may lie this far out [m].
FARTHEST = 1e12
#: Relative closeness of squared distances that counts as a tie, far above rounding.
_TIE = 1e-12

#: What a sector says: (item, used cell is not the target's own), or (None, candidates to compare).
Entry = tuple[Any, Any]


class CellFinder:
    """Finds a target's cell in a few hundred nanoseconds; rings are worked out when first asked.

    cells: int64 [M, 2], bins of the learned cells, sorted; their index is 0 to M - 1.
    items: what :meth:`entry` gives for each cell. Ties (to 1 part in 1e12) go to the lowest index.
    """

    def __init__(self, distance: Axis, angle: Axis, cells: np.ndarray, items: list[Any]) -> None:
        self.distance, self.angle = distance, angle
        self._own = np.full((distance.bins, angle.bins), -1, dtype=np.int64)
        self._own[tuple(cells.T)] = np.arange(len(cells))
        reach, bearing = distance.centres[cells[:, 0]], angle.centres[cells[:, 1]]
        # |p - c|^2 = |p|^2 + (|c|^2 - 2 p.c): the bracket ranks the centres c and is affine in p.
        self._square = reach**2
        self._twice_x, self._twice_y = 2.0 * reach * np.cos(bearing), 2.0 * reach * np.sin(bearing)
        self._radius = float(reach.max())
        self._items = items
        self._first_octave = math.frexp(distance.bins)[1]
        octaves = math.frexp(FARTHEST / distance.width)[1] + 1 - self._first_octave
        rings = distance.bins * RINGS + max(octaves, 1) * _OCTAVE
        #: Entries of each ring by floor(angle bin * SECTORS), or None where not worked out yet.
        self.rows: list[list[Entry] | None] = [None] * rings
        self._slots = np.full(rings, -1, dtype=np.int64)
        self._codes = np.zeros((0, (angle.bins + 1) * SECTORS + 2), dtype=np.int64)
        self._lengths, self._flat = np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
        self._starts = np.zeros(0, dtype=np.int64)

    def far_ring(self, bins: float) -> int:
        """Return the ring of a distance of ``bins`` bin widths, beyond the distance axis."""
        mantissa, octave = math.frexp(bins)
        far = (octave - self._first_octave) * _OCTAVE + int(mantissa * 2 * _OCTAVE) - _OCTAVE
        return self.distance.bins * RINGS + far

    def build(self, ring: int) -> list[Entry]:
        """Work out one ring and return its row of :attr:`rows`."""
        single, keep = self._ring(ring)
        disputed = np.flatnonzero(keep.any(axis=1))
        single[disputed] = -1 - len(self._lengths) - np.arange(len(disputed))
        entries: list[Entry] = [(self._items[c], True) if c >= 0 else (None, None) for c in single.tolist()]
        for sector in disputed.tolist():
            entries[sector] = (None, self._candidates(np.flatnonzero(keep[sector])))
        for sector in np.flatnonzero(self._own_of(ring) >= 0).tolist():
            entries[sector] = (entries[sector][0], False)
        self._remember(ring, single, keep[disputed])
        # One bin more than a turn, because bins start before -pi; index -1 is the last sector.
        row = entries + entries[:SECTORS] + entries[-1:]
        self.rows[ring] = row
        return row

    def settle(self, candidates: list[tuple[float, float, float, Any]], d: float, x: float, y: float) -> Any:
        """Return the item of the candidate nearest to (x, y) [m], ``d`` metres away."""
        slack = _TIE * self._radius * (self._radius + d)
        if len(candidates) == 2:  # nearly always; the rule below, written out
            (square, x2, y2, item), (other, u2, v2, second) = candidates
            return item if square - x * x2 - y * y2 <= other - x * u2 - y * v2 + slack else second
        scores = [square - x * x2 - y * y2 for square, x2, y2, _ in candidates]
        limit = min(scores) + slack
        return next(c[3] for c, score in zip(candidates, scores, strict=True) if score <= limit)

    def find_many(self, d: np.ndarray, a: np.ndarray) -> np.ndarray:
        """Return int64 [N]: the cell that each target uses. d [m] in [0, FARTHEST], a [rad] finite."""
        turned = np.pi - a
        if turned.min(initial=0.0) < 0.0 or turned.max(initial=0.0) >= 2.0 * np.pi:
            turned = np.mod(turned, 2.0 * np.pi)
        wrapped = np.pi - turned
        np.copyto(wrapped, np.pi, where=wrapped <= -np.pi)
        columns = np.floor((wrapped - self.angle.edges[0]) / self.angle.width * SECTORS).astype(np.int64)
        rings = self._rings_of(d / self.distance.width)
        slots = self._slots[rings]
        if slots.min(initial=0) < 0:
            for ring in np.unique(rings[slots < 0]).tolist():
                self.build(ring)
            slots = self._slots[rings]
        found = self._codes.ravel()[slots * self._codes.shape[1] + columns + 1]
        disputed = np.flatnonzero(found < 0)
        if disputed.size:
            d, a = d[disputed], a[disputed]
            found[disputed] = self._settle_many(-1 - found[disputed], d, d * np.cos(a), d * np.sin(a))
        return found

    # --- inside -------------------------------------------------------------------------------

    def _rings_of(self, bins: np.ndarray) -> np.ndarray:
        far = np.flatnonzero(bins >= self.distance.bins)
        if not far.size:
            return (bins * RINGS).astype(np.int64)
        mantissa, octave = np.frexp(bins[far])
        rings = (bins * RINGS).astype(np.int64)
        rings[far] = (octave.astype(np.int64) - self._first_octave) * _OCTAVE - _OCTAVE
        rings[far] += (mantissa * (2 * _OCTAVE)).astype(np.int64) + self.distance.bins * RINGS
        return rings

    def _own_of(self, ring: int) -> np.ndarray:
        """[S] the learned cell that each sector lies in, or -1."""
        if ring >= self.distance.bins * RINGS:
            return np.full(self.angle.bins * SECTORS, -1)
        return np.repeat(self._own[ring // RINGS], SECTORS)

    def _edges(self, ring: int) -> tuple[float, float]:
        """Inner and outer radius [m]."""
        width, near = self.distance.width, self.distance.bins * RINGS
        if ring < near:
            return ring / RINGS * width, (ring + 1) / RINGS * width
        octave, part = divmod(ring - near, _OCTAVE)
        unit = width * 2.0 ** (octave + self._first_octave) / (2 * _OCTAVE)
        return (part + _OCTAVE) * unit, (part + _OCTAVE + 1) * unit

    def _ring(self, ring: int) -> tuple[np.ndarray, np.ndarray]:
        """The only candidate of each sector [S], and which candidates the disputed ones keep [S, M]."""
        single = self._own_of(ring)
        keep = np.zeros((len(single), len(self._square)), dtype=bool)
        todo = np.flatnonzero(single < 0)
        step = max(1, (1 << 18) // len(self._square))
        for start in range(0, len(todo), step):
            sectors = todo[start : start + step]
            x, y = self._hull(ring, sectors)
            scores, slack = self._scores(x, y), self._slack(np.hypot(x, y))[..., None]
            winners = np.argmax(scores <= scores.min(axis=2, keepdims=True) + slack, axis=2)  # [5, s]
            agreed = np.all(winners == winners[0], axis=0)
            single[sectors] = winners[0]
            split = np.flatnonzero(~agreed)
            keep[sectors[split]] = _unbeaten(scores[:, split], winners[:, split], 4.0 * slack[:, split])
        return single, keep

    def _hull(self, ring: int, sectors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """x, y [5, s]: corners of a convex hull: the sector's own, and where the outer tangents meet."""
        inner, outer = self._edges(ring)
        step = self.angle.width / SECTORS
        low = self.angle.edges[0] + sectors * step
        apex = outer / math.cos(step / 2.0)
        radii = np.array([inner, inner, outer, outer, apex])[:, None]
        angles = np.stack([low, low + step, low, low + step, low + step / 2.0])
        return radii * np.cos(angles), radii * np.sin(angles)

    def _scores(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """[..., M] squared distances to the centres, less that to the origin."""
        return self._square - x[..., None] * self._twice_x - y[..., None] * self._twice_y

    def _slack(self, d: np.ndarray) -> np.ndarray:
        return _TIE * self._radius * (self._radius + d)

    def _candidates(self, cells: np.ndarray) -> list[tuple[float, float, float, Any]]:
        parts = (self._square[cells], self._twice_x[cells], self._twice_y[cells])
        return list(zip(*(p.tolist() for p in parts), (self._items[c] for c in cells.tolist()), strict=True))

    def _remember(self, ring: int, single: np.ndarray, keep: np.ndarray) -> None:
        """Add a ring to the arrays that :meth:`find_many` reads."""
        self._slots[ring] = len(self._codes)
        # One column early for index -1, then as the rows of entries.
        row = np.concatenate([single[-1:], single, single[:SECTORS], single[-1:]])
        self._codes = np.concatenate([self._codes, row[None, :]])
        self._lengths = np.concatenate([self._lengths, keep.sum(axis=1)])
        self._flat = np.concatenate([self._flat, np.nonzero(keep)[1]])
        self._starts = np.cumsum(self._lengths) - self._lengths

    def _settle_many(self, rows: np.ndarray, d: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Nearest candidate [N] of each row; worked on as one flat array of (target, candidate) pairs."""
        lengths = self._lengths[rows]
        firsts = np.cumsum(lengths) - lengths
        pairs = np.arange(int(lengths.sum())) + np.repeat(self._starts[rows] - firsts, lengths)
        cells = self._flat[pairs]
        scores = self._square[cells] - np.repeat(x, lengths) * self._twice_x[cells]
        scores -= np.repeat(y, lengths) * self._twice_y[cells]
        limit = np.minimum.reduceat(scores, firsts) + self._slack(d)
        tied = np.where(scores <= np.repeat(limit, lengths), cells, len(self._square))
        return np.minimum.reduceat(tied, firsts)


def _unbeaten(scores: np.ndarray, winners: np.ndarray, slack: np.ndarray) -> np.ndarray:
    """[s, M] True where no corner's winner beats a centre at all corners by more than ``slack``.

    scores: [5, s, M]; winners: [5, s], the nearest centre at each corner.
    """
    keep = np.ones(scores.shape[1:], dtype=bool)
    for winner in winners:
        rival = np.take_along_axis(scores, winner[None, :, None], axis=2)  # [5, s, 1]
        keep &= ~np.all(scores > rival + slack, axis=0)
    return keep
