"""What constant velocity misses, counted over whole futures: by class of the path that was seen.

A path is classed by its mean speed (octaves of the scale), its unsteadiness (mean change of velocity), whether it
gained speed, and how much it bent. Every class counts its futures, and keeps some of the paths themselves: those
with the smallest hash, the same set for any order and split of the rows. A future is drawn from the class of the path,
backed off to coarser classes (Dirichlet, weight 25), scaled by the speed and added to the base motion.
Letters: N paths, T places seen, S steps that follow, F kept.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from bayeshunt.core.geometry import FloatArray
from bayeshunt.models.target.base_motion import BASES

__all__ = ["BACKOFF", "KEPT", "ResidualTable", "path_classes"]

#: Weight [futures] of a coarser class in a finer one.
BACKOFF = 25.0
#: Paths that a class keeps.
KEPT = 64
#: Golden ratio: steps of it on a circle spread evenly, however many there are.
_GOLDEN = (5**0.5 - 1) / 2
#: Fixed point of kept places: this many units in one scale.
_GRID = 512
_UNSTEADY = np.array([0.05, 0.1, 0.2, 0.4, 0.8])
_GAIN = np.array([-0.3, -0.1, 0.1, 0.3])
_BEND = np.array([0.1, 0.3])
#: A path slower than this share of the scale a step counts as one of that speed.
_SLOWEST = 0.05
Key = tuple[int, int, int, int]


def path_classes(seen: FloatArray, scale: float) -> tuple[np.ndarray, FloatArray, np.ndarray]:
    """Return the class [N, 4] of each path, its speed [N] (metres a step) and its side [N] (-1: it bent to the right).

    seen: complex [N, T] places (forward + i left), the last one at 0, facing forward. scale: metres.
    """
    steps = np.diff(seen, axis=1)
    sizes = np.abs(steps)
    mean = sizes.mean(axis=1)
    speed = np.maximum(mean, _SLOWEST * scale)
    change = np.abs(np.diff(steps, axis=1)).mean(axis=1) / speed if steps.shape[1] > 1 else np.zeros(len(seen))
    ends = max(1, steps.shape[1] // 3)
    gain = (sizes[:, -ends:].mean(axis=1) - sizes[:, :ends].mean(axis=1)) / speed
    bend = steps[:, : max(1, steps.shape[1] // 2 + 1)].mean(axis=1).imag / speed
    octave = np.clip(np.floor(np.log2(mean / scale + 1e-9)), -8, 8)
    found = (
        octave,
        np.searchsorted(_UNSTEADY, change),
        np.searchsorted(_GAIN, gain),
        np.searchsorted(_BEND, np.abs(bend)),
    )
    return np.stack(found, axis=1).astype(np.int64), speed, np.where(bend < 0, -1, 1)


class ResidualTable:
    """Counts of futures by class of path, and kept paths; changes in place, by addition only.

    base: name of the base motion. seen: places known. steps: places that follow. scale: metres, the typical step.
    """

    def __init__(self, base: str, seen: int, steps: int, scale: float, backoff: float = BACKOFF) -> None:
        self.backoff = backoff
        self.base, self.seen, self.steps, self.scale = base, seen, steps, scale
        self.counts: dict[Key, int] = {}
        self.kept: dict[Key, dict[tuple[int, ...], int]] = {}  # class -> path on the grid -> how often
        self.wandered = (0, 0)  # summed over paths, in units of the grid: what the last step misses, how far it went
        self._mixed: dict[Key, tuple[np.ndarray, FloatArray]] = {}
        self._pool: tuple[np.ndarray, FloatArray, dict[Key, slice]] | None = None

    def add(self, paths: FloatArray) -> None:
        """Count whole paths, complex [N, T + S], the place T - 1 at 0 and facing forward."""
        if not len(paths):
            return
        on_grid = np.round(paths / self.scale * _GRID)
        gone = on_grid[:, self.seen - 1] - on_grid[:, self.seen - 2]
        missed = np.abs(on_grid[:, -1] - on_grid[:, self.seen - 1] - self.steps * gone)
        self._wander(int(np.rint(missed).sum()), int(np.rint(self.steps * np.abs(gone)).sum()))
        keys, _, side = path_classes(on_grid[:, : self.seen] / _GRID, 1.0)
        on_grid = np.where(side[:, None] < 0, np.conj(on_grid), on_grid)
        rows = np.stack([on_grid.real, on_grid.imag], axis=2).reshape(len(paths), -1).astype(np.int64)
        distinct, times = np.unique(np.hstack([keys, rows]), axis=0, return_counts=True)
        hashes = _hash(distinct[:, 4:])
        order = np.lexsort((hashes, *distinct[:, :4].T[::-1]))
        edges = np.flatnonzero(np.any(np.diff(distinct[order, :4], axis=0), axis=1)) + 1
        for part in np.split(order, edges):
            key: Key = tuple(distinct[part[0], :4].tolist())
            self.counts[key] = self.counts.get(key, 0) + int(times[part].sum())
            new = dict(zip(map(tuple, distinct[part[:KEPT], 4:].tolist()), times[part[:KEPT]].tolist(), strict=True))
            self._keep(key, new)
        self._mixed.clear()
        self._pool = None

    def merge(self, other: ResidualTable) -> None:
        """Count what another table has counted."""
        self._wander(*other.wandered)
        for key, count in other.counts.items():
            self.counts[key] = self.counts.get(key, 0) + count
            self._keep(key, other.kept[key])
        self._mixed.clear()
        self._pool = None

    @property
    def wandering(self) -> float:
        """How far off constant velocity is at the last step, as a share of how far it goes; 0 before any path."""
        missed, gone = self.wandered
        return missed / gone if gone else 0.0

    def _wander(self, missed: int, gone: int) -> None:
        self.wandered = (self.wandered[0] + missed, self.wandered[1] + gone)

    def _keep(self, key: Key, new: dict[tuple[int, ...], int]) -> None:
        """Join kept paths; of more than KEPT those with the smallest hashes stay, however often each was seen."""
        kept = self.kept.setdefault(key, {})
        for row, times in new.items():
            kept[row] = kept.get(row, 0) + times
        if len(kept) > KEPT:
            rows = list(kept)
            order = sorted(zip(_hash(np.array(rows, dtype=np.int64)).tolist(), rows, strict=True))
            self.kept[key] = {row: kept[row] for _, row in order[:KEPT]}

    def draw(self, seen: FloatArray, n: int, steps: int, *, rng: np.random.Generator) -> FloatArray:
        """Return complex [N, n, steps] places that follow ``seen`` [N, T], which ends at 0 and faces forward.

        Draws that follow each other are spread evenly over what a class draws from: fewer of them tell as much.
        """
        keys, speed, side = path_classes(seen / self.scale, 1.0)
        residuals, _, _ = self._residuals()
        picked = np.empty((len(seen), n), dtype=np.int64)
        mirrored = rng.random((len(seen), n)) < 0.5
        uniform = (rng.random((len(seen), 1)) + _GOLDEN * np.arange(n)) % 1.0
        for i, key in enumerate(map(tuple, keys.tolist())):
            rows, reach = self._mixture(key)
            picked[i] = rows[np.searchsorted(reach, uniform[i] * reach[-1], side="right").clip(max=len(rows) - 1)]
        found = residuals[picked, :steps]
        found = np.where(mirrored[..., None] ^ (side[:, None, None] < 0), np.conj(found), found)
        ahead = BASES[self.base](seen, steps)
        return np.asarray(ahead[:, None] + found * (speed * self.scale)[:, None, None])

    def _residuals(self) -> tuple[FloatArray, FloatArray, dict[Key, slice]]:
        """Residuals [F, S] over speed of all kept paths, their weights [F] in their class, and where a class stands."""
        if self._pool is None:
            rows: list[tuple[int, ...]] = []
            weights: list[float] = []
            places: dict[Key, slice] = {}
            for key in sorted(self.kept):
                own = sorted(self.kept[key].items())
                places[key] = slice(len(rows), len(rows) + len(own))
                rows += [row for row, _ in own]
                total = sum(times for _, times in own)
                weights += [times / total for _, times in own]
            flat = np.array(rows, dtype=float).reshape(len(rows), self.seen + self.steps, 2) / _GRID
            paths = flat[..., 0] + 1j * flat[..., 1]
            _, speed, _ = path_classes(paths[:, : self.seen], 1.0)
            missed = paths[:, self.seen :] - BASES[self.base](paths[:, : self.seen], self.steps)
            self._pool = missed / speed[:, None], np.array(weights), places
        return self._pool

    def shares(self, key: Key) -> dict[Key, float]:
        """Return the share of each class's own futures in the table given a class; they sum to 1."""
        share: dict[Key, float] = {}
        left = 1.0
        for level in (4, 3, 2, 1, 0):
            group = {k: count for k, count in self.counts.items() if k[:level] == key[:level]}
            total = sum(group.values())
            if not total:
                continue
            taken = left if level == 0 else left * total / (total + self.backoff)
            for k, count in group.items():
                share[k] = share.get(k, 0.0) + taken * count / total
            left -= taken
        return share

    def _mixture(self, key: Key) -> tuple[np.ndarray, FloatArray]:
        """Kept paths that a class draws from, by how far ahead they end, and their cumulative weights."""
        if key not in self._mixed:
            residuals, weights, places = self._residuals()
            share = self.shares(key)
            rows = np.concatenate([np.arange(len(weights))[places[k]] for k in sorted(share)])
            own = np.concatenate([share[k] * weights[places[k]] for k in sorted(share)])
            order = np.argsort(residuals[rows, -1].real, kind="stable")
            self._mixed[key] = rows[order], np.cumsum(own[order])
        return self._mixed[key]

    def to_dict(self) -> dict[str, Any]:
        """Return plain numbers for JSON: per class its count and the kept paths, each before its number."""
        classes = []
        for key in sorted(self.counts):
            kept = [[*row, self.kept[key][row]] for row in sorted(self.kept[key])]
            classes.append({"class": list(key), "count": self.counts[key], "kept": kept})
        return {"base": self.base, "seen": self.seen, "steps": self.steps, "scale": self.scale, "backoff": self.backoff,
                "grid": _GRID, "wandered": list(self.wandered), "classes": classes}  # fmt: skip

    @classmethod
    def from_dict(cls, record: dict[str, Any]) -> ResidualTable:
        """Rebuild from :meth:`to_dict`; KeyError, TypeError or ValueError if it is none."""
        numbers = (int(record["seen"]), int(record["steps"]), float(record["scale"]), float(record["backoff"]))
        if record["base"] not in BASES or record["grid"] != _GRID or min(numbers) <= 0:
            raise ValueError("residual table")
        table = cls(record["base"], *numbers)
        table._wander(*(int(part) for part in record.get("wandered", (0, 0))))  # files of before do not say
        width = 2 * (table.seen + table.steps) + 1
        for entry in record["classes"]:
            key, rows = tuple(entry["class"]), entry["kept"]
            numbers_in = [*key, entry["count"], *(v for row in rows for v in row)]
            whole = all(isinstance(v, int) and not isinstance(v, bool) for v in numbers_in)
            if not whole or len(key) != 4 or not rows or any(len(row) != width or row[-1] < 1 for row in rows):
                raise ValueError(f"class {list(key)} of the residual table")
            table.counts[key] = entry["count"]
            table.kept[key] = {tuple(row[:-1]): row[-1] for row in rows}
        return table


def _hash(rows: np.ndarray) -> np.ndarray:
    """A 64-bit number [N] of rows of whole numbers [N, K], spread evenly (splitmix64 over FNV)."""
    value = np.full(len(rows), 0xCBF29CE484222325, dtype=np.uint64)
    for column in rows.astype(np.int64).view(np.uint64).T:
        value = (value ^ column) * np.uint64(0x100000001B3)
        value ^= value >> np.uint64(29)
    value = (value ^ (value >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    value = (value ^ (value >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return value ^ (value >> np.uint64(31))
