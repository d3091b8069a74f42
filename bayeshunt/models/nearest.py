"""The nearest of a fixed set of points in the plane, exactly, in a few hundred nanoseconds.

The plane is cut into squares. In each square only those points can be nearest that no other point
beats at all four corners (which of two points is nearer is an affine question, so what holds at
the corners holds inside). Most squares keep one candidate and need no arithmetic; the others
compare the few that are left. Squares come in levels, each reaching twice as far as the last.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

#: Squares per side of a level.
_SIDE = 128
#: Levels reach 2**_LEVELS times as far as the farthest point; beyond, every point is compared.
_LEVELS = 16
#: Relative closeness of squared distances that counts as a tie, far above rounding.
_TIE = 1e-12
_BRUTE_CHUNK = 1 << 20


@dataclass(frozen=True)
class _Level:
    """One level: squares over [-half, half) in both directions, row-major in forward.

    single: int64 [side * side], the only candidate of a square, or -1 - r for row r of the others.
    starts, lengths: int64 [R], where row r's candidates lie in ``flat``; flat: int64, each row ascending.
    """

    half: float
    scale: float  # squares per metre
    single: np.ndarray
    starts: np.ndarray
    lengths: np.ndarray
    flat: np.ndarray
    single_list: list[int]  # the same as ``single``: a Python list answers faster to one index
    rows: dict[int, list[tuple[float, float, float, int]]] = field(default_factory=dict)


class NearestPoint:
    """Index of the nearest of ``M`` points; ties (to 1 part in 1e12) go to the lowest index.

    forward, right: float64 [M], metres. Immutable apart from levels built when first needed.
    """

    def __init__(self, forward: np.ndarray, right: np.ndarray) -> None:
        # |p - c|^2 = |p|^2 + (|c|^2 - 2 p.c): the bracket ranks the points and is affine in p.
        self._square = np.asarray(forward**2 + right**2, dtype=float)
        self._twice = (2.0 * np.asarray(forward, dtype=float), 2.0 * np.asarray(right, dtype=float))
        self._radius = float(np.sqrt(self._square.max())) or 1.0
        self._levels: list[_Level | None] = [None] * (_LEVELS + 1)

    def find(self, forward: float, right: float) -> int:
        """Return the index of the point nearest to (forward, right) [m]."""
        reach = max(abs(forward), abs(right))
        number = math.frexp(reach / self._radius)[1]
        if number > _LEVELS:
            return int(self._compare_all(np.array([forward]), np.array([right]))[0])
        number = max(number, 0)
        level = self._levels[number] or self._level(number)
        half, scale = level.half, level.scale
        code = level.single_list[int((forward + half) * scale) * _SIDE + int((right + half) * scale)]
        if code >= 0:
            return code
        row = level.rows.get(code) or self._row(level, code)
        scores = [square - forward * x - right * y for square, x, y, _ in row]
        limit = min(scores) + self._slack(reach)
        return next(entry[3] for entry, score in zip(row, scores, strict=True) if score <= limit)

    def find_many(self, forward: np.ndarray, right: np.ndarray) -> np.ndarray:
        """Return int64 [N]: :meth:`find` of every point of two float64 arrays [N]."""
        reach = np.maximum(np.abs(forward), np.abs(right))
        numbers = np.maximum(np.frexp(reach / self._radius)[1], 0)
        found = np.empty(len(forward), dtype=np.int64)
        for number in np.flatnonzero(np.bincount(np.minimum(numbers, _LEVELS + 1))):
            here = np.flatnonzero(numbers == number) if number <= _LEVELS else np.flatnonzero(numbers > _LEVELS)
            search = self._find_in_level if number <= _LEVELS else self._compare_all_of
            found[here] = search(int(number), forward[here], right[here])
        return found

    # --- inside -------------------------------------------------------------------------------

    def _slack(self, reach: np.ndarray | float) -> np.ndarray | float:
        return _TIE * self._radius * (self._radius + reach)

    def _scores(self, forward: np.ndarray, right: np.ndarray) -> np.ndarray:
        """[N, M] squared distances less |p|^2."""
        x, y = self._twice
        return self._square - np.multiply.outer(forward, x) - np.multiply.outer(right, y)

    def _winners(self, scores: np.ndarray, reach: np.ndarray) -> np.ndarray:
        limit = scores.min(axis=1) + self._slack(reach)
        return np.argmax(scores <= limit[:, None], axis=1)

    def _compare_all(self, forward: np.ndarray, right: np.ndarray) -> np.ndarray:
        found = np.empty(len(forward), dtype=np.int64)
        step = max(1, _BRUTE_CHUNK // len(self._square))
        for start in range(0, len(forward), step):
            x, y = forward[start : start + step], right[start : start + step]
            reach = np.maximum(np.abs(x), np.abs(y))
            found[start : start + step] = self._winners(self._scores(x, y), reach)
        return found

    def _compare_all_of(self, number: int, forward: np.ndarray, right: np.ndarray) -> np.ndarray:
        return self._compare_all(forward, right)

    def _find_in_level(self, number: int, forward: np.ndarray, right: np.ndarray) -> np.ndarray:
        level = self._levels[number] or self._level(number)
        square = ((forward + level.half) * level.scale).astype(np.int64) * _SIDE
        square += ((right + level.half) * level.scale).astype(np.int64)
        found = level.single[square]
        open_ = np.flatnonzero(found < 0)
        if open_.size:
            found[open_] = self._settle(level, -1 - found[open_], forward[open_], right[open_])
        return found

    def _settle(self, level: _Level, rows: np.ndarray, forward: np.ndarray, right: np.ndarray) -> np.ndarray:
        """Compare the candidates of ``rows`` [N]; one flat array of (point, candidate) pairs."""
        lengths = level.lengths[rows]
        firsts = np.cumsum(lengths) - lengths
        within = np.arange(int(lengths.sum())) - np.repeat(firsts - level.starts[rows], lengths)
        candidates = level.flat[within]
        x, y = self._twice
        scores = self._square[candidates] - np.repeat(forward, lengths) * x[candidates]
        scores -= np.repeat(right, lengths) * y[candidates]
        limit = np.minimum.reduceat(scores, firsts)
        limit += self._slack(np.maximum(np.abs(forward), np.abs(right)))
        tied = np.where(scores <= np.repeat(limit, lengths), candidates, len(self._square))
        return np.minimum.reduceat(tied, firsts)

    def _row(self, level: _Level, code: int) -> list[tuple[float, float, float, int]]:
        start = int(level.starts[-1 - code])
        indices = level.flat[start : start + int(level.lengths[-1 - code])]
        parts = (self._square[indices], self._twice[0][indices], self._twice[1][indices], indices)
        level.rows[code] = list(zip(*(part.tolist() for part in parts), strict=True))
        return level.rows[code]

    def _level(self, number: int) -> _Level:
        # A hair wider than its reach, so that rounding never points past the last square.
        half = self._radius * 2.0**number * (1.0 + 1e-9)
        corners = np.linspace(-half, half, _SIDE + 1)
        winners = self._corner_winners(corners)
        used = self._used_squares(corners, number)
        agreed = np.all(winners == winners[:, :1], axis=1)
        single = winners[:, 0].copy()
        disputed = np.flatnonzero(used & ~agreed)
        single[disputed] = -1 - np.arange(len(disputed))
        lengths, flat = self._candidates(disputed, corners, winners[disputed])
        starts = np.cumsum(lengths) - lengths
        level = _Level(half, _SIDE / (2.0 * half), single, starts, lengths, flat, single.tolist())
        self._levels[number] = level
        return level

    def _corner_winners(self, corners: np.ndarray) -> np.ndarray:
        """[squares, 4] the nearest point at each corner of every square."""
        x, y = (part.ravel() for part in np.meshgrid(corners, corners, indexing="ij"))
        best = self._compare_all(x, y).reshape(_SIDE + 1, _SIDE + 1)
        four = [best[:-1, :-1], best[:-1, 1:], best[1:, :-1], best[1:, 1:]]
        return np.stack([part.ravel() for part in four], axis=1)

    def _used_squares(self, corners: np.ndarray, number: int) -> np.ndarray:
        """Squares that this level is asked about: the level below answers for the middle."""
        if number == 0:
            return np.ones(_SIDE * _SIDE, dtype=bool)
        outer = np.maximum(np.abs(corners[:-1]), np.abs(corners[1:]))
        inner_reach = self._radius * 2.0 ** (number - 1) * (1.0 - 1e-9)
        return np.asarray(np.maximum.outer(outer, outer).ravel() >= inner_reach)

    def _candidates(
        self, squares: np.ndarray, corners: np.ndarray, winners: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Number of candidates of each square [R], and all of them in one array."""
        lengths, flat = np.zeros(len(squares), dtype=np.int64), [np.zeros(0, dtype=np.int64)]
        step = max(1, _BRUTE_CHUNK // (16 * len(self._square)))
        for start in range(0, len(squares), step):
            part = slice(start, start + step)
            i, j = np.divmod(squares[part], _SIDE)
            keep = self._unbeaten(corners[i], corners[i + 1], corners[j], corners[j + 1], winners[part])
            lengths[part] = keep.sum(axis=1)
            flat.append(np.nonzero(keep)[1])
        return lengths, np.concatenate(flat)

    def _unbeaten(
        self,
        low_x: np.ndarray,
        high_x: np.ndarray,
        low_y: np.ndarray,
        high_y: np.ndarray,
        winners: np.ndarray,
    ) -> np.ndarray:
        """[R, M] True where no corner's winner beats the point at all four corners, ties aside."""
        at = [(low_x, low_y), (low_x, high_y), (high_x, low_y), (high_x, high_y)]
        scores = np.stack([self._scores(x, y) for x, y in at])  # [4, R, M]
        reach = np.max([np.maximum(np.abs(x), np.abs(y)) for x, y in at], axis=0)
        slack = 4.0 * np.asarray(self._slack(reach))[:, None]
        keep = np.ones(scores.shape[1:], dtype=bool)
        for corner in range(4):
            rival = np.take_along_axis(scores, winners[None, :, corner, None], axis=2)  # [4, R, 1]
            keep &= ~np.all(scores > rival + slack, axis=0)
        return keep
