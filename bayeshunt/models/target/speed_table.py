"""Transitions given the prey's own speed: counts by class of the step before, backed off to like speeds.

Who hardly moves, in the slowest class, is counted by for how many steps he has: a pause of a walker that goes on as he
went, or a rest whose end tells no direction.

Letters: C classes, N[c] counts of class c, s the smoothed counts of its neighbours, w the back-off weight. The table
of a class is the Dirichlet mean ``(N[c] + w m) / (n_c + w)`` under the mean
``m = (s + w p) / (n_s + w)`` of the classes beside it (each less by a Gaussian of one class), itself backed off to
the table p of all classes.
All of these are mixtures of the classes' own shares, so that a mixing matrix [C, C] and the counts are enough.

The prey that is foreseen has a manner of its own, which its few steps just seen show: they count beside the table,
which weighs as ten of them (:class:`OwnSteps`).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.geometry import FloatArray, wrap
from bayeshunt.models.counting.cells import MAX_DISTANCE_BINS

__all__ = ["BACKOFF", "CLASSES", "OWN", "UNIT", "OwnSteps", "SpeedTable", "cell_codes"]

#: Classes of speed; the last is open.
CLASSES = 40
#: Distance bins of one class.
_BINS = 3
#: Steps on end in the slowest class from which it is another one: 1 (class 0), 2, 3, 4 or 5, 6 or more.
_STOOD = np.array([2, 3, 4, 6])
_KINDS = CLASSES + len(_STOOD)
#: Where a class stands beside the others, in classes of speed: those of the slowest are half a class apart.
_PLACES = np.concatenate([np.arange(CLASSES), -0.5 * np.arange(1, len(_STOOD) + 1)])
#: Weight [transitions] of the like speeds in a class.
BACKOFF = 25.0
#: Weight [transitions] of the table beside the prey's own steps; between 5 and 20 it hardly matters.
OWN = 10.0
#: How much an own step of a class tells of another. Of a rest that lasts, all steps before the last were rests, which
#: tells nothing of its end: those of the slowest count for rests as long.
_NEAR = np.exp(-0.5 * (_PLACES[:, None] - _PLACES) ** 2)
_NEAR[_PLACES <= 0] = _NEAR[:, _PLACES <= 0] = 0.0
np.fill_diagonal(_NEAR, 1.0)
#: Counts are whole numbers of 2**-16, so that weighted transitions add up exactly in any order.
UNIT = 1 << 16


def cell_codes(axes: EffectAxes, distance: Any, angle: Any, heading: Any) -> np.ndarray:
    """Return one int64 number [N] for each (Distance, Angle, Heading) cell; the order is the tables'."""
    far = np.minimum(axes.distance.index(np.asarray(distance, dtype=float)), MAX_DISTANCE_BINS - 1)
    turned = axes.angle.index(np.asarray(angle, dtype=float)) * axes.heading.bins
    return np.asarray(
        far * (axes.angle.bins * axes.heading.bins) + turned + axes.heading.index(np.asarray(heading, dtype=float))
    )


class SpeedTable:
    """Counts of transitions by class of the own speed; changes in place, by addition only.

    axes: bins. A class is three distance bins of the step before wide; the slowest is split by how long it has lasted.
    """

    def __init__(self, axes: EffectAxes, backoff: float = BACKOFF) -> None:
        self.axes, self.backoff = axes, backoff
        self.counts: dict[tuple[int, int], int] = {}  # (class, cell code) -> weight in units of 2**-16
        self._drawn: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray] | None = None

    def classes(self, before: Any, stood: Any) -> np.ndarray:
        """Return the class [N] of steps of ``before`` [m] that were the last of ``stood`` slowest ones on end [N]."""
        far = np.minimum(np.asarray(before, dtype=float) / (_BINS * self.axes.distance.width), CLASSES - 1)
        split = np.searchsorted(_STOOD, stood, side="right")
        return np.where((far < 1) & (split > 0), CLASSES - 1 + split, far.astype(np.int64))

    def stood(self, steps: FloatArray) -> np.ndarray:
        """Return how many of the last steps on end [N], of steps [N, T] (metres), are of the slowest class."""
        slow = steps[:, ::-1] < _BINS * self.axes.distance.width  # False where nothing is known
        return np.asarray(np.cumprod(slow, axis=1, dtype=np.int64).sum(axis=1))

    def add(self, kinds: np.ndarray, codes: np.ndarray, weight: int = UNIT) -> None:
        """Count transitions into cells ``codes`` [N] after steps of the classes ``kinds`` [N]."""
        both = np.stack([kinds, codes], axis=1)
        pairs, times = np.unique(both, axis=0, return_counts=True)
        for (kind, code), count in zip(pairs.tolist(), times.tolist(), strict=True):
            self.counts[kind, code] = self.counts.get((kind, code), 0) + count * weight
        self._drawn = None

    def merge(self, other: SpeedTable) -> None:
        """Count what another table of the same bins has counted."""
        for pair, count in other.counts.items():
            self.counts[pair] = self.counts.get(pair, 0) + count
        self._drawn = None

    def to_dict(self) -> dict[str, Any]:
        """Return plain numbers for JSON: [class, cell code, weight in 2**-16] rows in order."""
        return {"backoff": self.backoff, "counts": [[*pair, self.counts[pair]] for pair in sorted(self.counts)]}

    @classmethod
    def from_dict(cls, record: dict[str, Any], axes: EffectAxes) -> SpeedTable:
        """Rebuild from :meth:`to_dict`; KeyError, TypeError or ValueError if it is none."""
        table = cls(axes, float(record["backoff"]))
        top = MAX_DISTANCE_BINS * axes.angle.bins * axes.heading.bins
        for kind, code, weight in record["counts"]:
            whole = all(isinstance(v, int) and not isinstance(v, bool) for v in (kind, code, weight))
            if not (whole and 0 <= kind < _KINDS and 0 <= code < top and weight > 0):
                raise ValueError(f"count row {[kind, code, weight]}")
            table.counts[kind, code] = weight
        return table

    def mixing(self) -> FloatArray:
        """Return A [C, C]: the share of each class's own table in the table given a class; rows sum to 1."""
        totals = np.zeros(_KINDS)
        for (kind, _), count in self.counts.items():
            totals[kind] += count
        totals /= UNIT
        everyone = np.broadcast_to(totals / totals.sum(), (_KINDS, _KINDS))
        near = np.exp(-0.5 * (_PLACES[:, None] - _PLACES) ** 2) * totals
        near = (near + self.backoff * everyone) / (near.sum(axis=1, keepdims=True) + self.backoff)
        return np.asarray((np.diag(totals) + self.backoff * near) / (totals[:, None] + self.backoff))

    def probabilities(self, mine: np.ndarray, codes: np.ndarray) -> FloatArray:
        """Return P(cell | class) [N] of cells ``codes`` after classes ``mine``; 0 where no class has seen the cell."""
        mix, kinds, cells, ends = self._ready()
        counts = np.diff(ends, prepend=0)
        totals = np.bincount(kinds, weights=counts, minlength=_KINDS)
        order = np.lexsort((kinds, cells))
        by_cell, share = cells[order], (counts / totals[kinds])[order]
        first, last = np.searchsorted(by_cell, codes), np.searchsorted(by_cell, codes, side="right")
        found = np.zeros(len(codes))
        for i, (a, b) in enumerate(zip(first.tolist(), last.tolist(), strict=True)):
            found[i] = share[a:b] @ mix[mine[i], kinds[order[a:b]]]
        return found

    def draw(self, mine: np.ndarray, *, rng: np.random.Generator) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return one transition after each class of ``mine`` [N]: distance [m], angle and heading [rad], in its bin."""
        mix, kinds, cells, ends = self._ready()
        uniform = rng.random((4, len(mine)))
        source = _sources(np.cumsum(mix, axis=1), mine, uniform[0])
        bounds = np.concatenate([[0], ends[np.searchsorted(kinds, np.arange(_KINDS), side="right") - 1]])
        bounds[1:][np.searchsorted(kinds, np.arange(_KINDS), side="right") == 0] = 0
        low, high = bounds[source], bounds[source + 1]
        at = low + np.floor(uniform[1] * (high - low)).astype(np.int64)
        code = cells[np.searchsorted(ends, at, side="right")]
        turns = self.axes.heading.bins
        axes, far, rest = self.axes, code // (self.axes.angle.bins * turns), code % (self.axes.angle.bins * turns)
        distance = (far + uniform[2]) * axes.distance.width
        wiggle = uniform[3] - 0.5
        angle = axes.angle.centres[rest // turns] + wiggle * axes.angle.width
        heading = axes.heading.centres[rest % turns] + wiggle * axes.heading.width  # they mostly turn together
        return distance, np.asarray(wrap(angle)), np.asarray(wrap(heading))

    def _ready(self) -> tuple[FloatArray, np.ndarray, np.ndarray, np.ndarray]:
        """Mixing matrix; class [M], cell [M] and cumulative count [M] of every pair seen, sorted."""
        if self._drawn is None:
            pairs = sorted(self.counts)
            ends = np.cumsum(np.array([self.counts[pair] for pair in pairs], dtype=np.int64))
            both = np.array(pairs, dtype=np.int64).reshape(-1, 2)
            self._drawn = self.mixing(), both[:, 0], both[:, 1], ends
        return self._drawn


def _sources(reach: FloatArray, mine: np.ndarray, uniform: FloatArray) -> np.ndarray:
    """Return from which class each draw [N] of classes ``mine`` is taken, class by class; reach [C, C]: cumulative."""
    at, found = uniform * reach[mine, -1], np.empty(len(mine), dtype=np.int64)
    order = np.argsort(mine.astype(np.int8), kind="stable")
    edges = np.searchsorted(mine[order], np.arange(_KINDS + 1))
    for kind in range(_KINDS):
        rows = order[edges[kind] : edges[kind + 1]]
        found[rows] = np.searchsorted(reach[kind], at[rows])
    return found


class OwnSteps:
    """The transitions that paths themselves show, as counts beside a table: the prey's own speed, pauses and turns.

    Letters: N paths, T places seen, M draws.
    """

    def __init__(self, paths: FloatArray, table: SpeedTable, least: float) -> None:
        """paths: complex [N, T] places (forward + i left). least: metres, a step no longer than this has no direction.

        A transition counts where its path had a direction before it, and in classes beside its own less, as a Gaussian
        of one class.
        """
        steps = np.diff(paths, axis=1)
        sizes = np.abs(steps)
        count = max(steps.shape[1] - 1, 0)
        kinds = np.zeros((len(paths), count), dtype=np.int64)
        before = np.full(len(paths), np.nan + 0j)  # direction
        turns = np.zeros((len(paths), count), dtype=complex)
        for i in range(count):
            step, size = steps[:, i], sizes[:, i]
            before = np.where(size > least, step / np.where(size > least, size, 1.0), before)
            kinds[:, i] = table.classes(size, table.stood(sizes[:, : i + 1]))
            turns[:, i] = steps[:, i + 1] * np.conj(before)
        known = np.isfinite(turns)
        self._distance = sizes[:, 1:]
        self._angle = np.where(known, -np.angle(np.where(known, turns, 1.0)), 0.0)
        self._heading = np.where(self._distance > least, self._angle, 0.0)  # one that stands keeps its own
        self._reach = np.cumsum(_NEAR[:, kinds].transpose(1, 0, 2) * known[:, None], axis=2)  # [N, C, T - 2]

    def instead(
        self, which: np.ndarray, kinds: np.ndarray, drawn: tuple[FloatArray, FloatArray, FloatArray],
        *, rng: np.random.Generator,
    ) -> tuple[FloatArray, FloatArray, FloatArray]:  # fmt: skip
        """Return draws of the table [M] with some of them exchanged for the path's own, after steps of ``kinds`` [M].

        which: number of the path of each draw [M]. drawn: distance [m], angle and heading [rad].
        """
        if not self._distance.shape[1]:
            return drawn
        reach = self._reach[which, kinds]
        at = rng.random(len(which)) * (reach[:, -1] + OWN)
        mine = at < reach[:, -1]
        own = which[mine], (at[mine, None] >= reach[mine]).sum(axis=1)
        for values, table_values in zip((self._distance, self._angle, self._heading), drawn, strict=True):
            table_values[mine] = values[own]
        return drawn
