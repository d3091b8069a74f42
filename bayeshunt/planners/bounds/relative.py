"""Expected time to capture for every relative pose: value iteration over a grid.

State: the prey's pose as the hunter sees it (distance, angle, heading). The prey goes straight, with
its own actuator noise; the hunter executes one gait per time-step. With S sampled paths of every
gait and of the prey, the least expected time to capture V is the fixed point of

    V(s) = min_g 1/S sum_i [ t_i if path i captures at t_i < D, else D + V(s_i') ]

Letters: G gaits, S samples, P points per time-step, N states, D time-step [s].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

__all__ = ["Chase", "Grid", "expected_times", "solve"]

_CHUNK = 8192  # states composed at a time: bounds the memory


class Grid(NamedTuple):
    """The states: every combination of a distance, an angle and a heading.

    distances: metres, increasing [R]; beyond the last, the time grows linearly. angles, headings:
    numbers of equal intervals of the full turn, the first value is 0.
    """

    distances: np.ndarray
    angles: int
    headings: int

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of distances, angles and headings."""
        return len(self.distances), self.angles, self.headings

    def states(self) -> np.ndarray:
        """Return distance [m], angle and heading [rad clockwise] of every state, [N, 3]."""
        turn = 2 * np.pi
        parts = np.meshgrid(
            self.distances,
            np.arange(self.angles) * (turn / self.angles),
            np.arange(self.headings) * (turn / self.headings),
            indexing="ij",
        )
        return np.stack([part.ravel() for part in parts], axis=1)

    def corners(self, distance: np.ndarray, angle: np.ndarray, heading: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the 8 states around each pose and their trilinear weights: int32 and float32 [..., 8]."""
        rows = self.distances
        low = np.clip(np.searchsorted(rows, distance, side="right") - 1, 0, len(rows) - 2)
        share = np.clip((distance - rows[low]) / (rows[low + 1] - rows[low]), 0.0, 1.0)
        (a, a_share), (h, h_share) = _around(angle, self.angles), _around(heading, self.headings)
        states, weights = [], []
        for i, u in ((low, 1 - share), (low + 1, share)):
            for j, v in ((a, 1 - a_share), ((a + 1) % self.angles, a_share)):
                for k, w in ((h, 1 - h_share), ((h + 1) % self.headings, h_share)):
                    states.append((i * self.angles + j) * self.headings + k)
                    weights.append(u * v * w)
        return np.stack(states, axis=-1).astype(np.int32), np.stack(weights, axis=-1).astype(np.float32)


@dataclass(frozen=True, eq=False)
class Chase:
    """Sampled motion of both robots over one time-step, and the rule of the catch.

    hunter: sampled paths of every gait, [G, S, P, 3]; prey: of the prey, [S, P, 3]; each in its own
    frame before the step: forward [m], right [m], heading [rad clockwise].
    duration: seconds per step. reach: metres between the centres that count as a catch.
    closing: metres per second at which a far prey comes nearer at best (time beyond the grid).
    """

    hunter: np.ndarray
    prey: np.ndarray
    duration: float
    reach: float
    closing: float

    def outcomes(self, states: np.ndarray, gait: int) -> tuple[np.ndarray, tuple[np.ndarray, ...]]:
        """Return capture times [n, S] (inf: none within the step) and the next relative poses (3 arrays [n, S]).

        states: distance, angle, heading [n, 3].
        """
        distance, angle, heading = states.T[:, :, None, None]
        mine, its = self.hunter[gait], self.prey
        cos, sin = np.cos(heading), np.sin(heading)
        x = distance * np.cos(angle) + cos * its[..., 0] - sin * its[..., 1]  # [n, S, P]
        y = distance * np.sin(angle) + sin * its[..., 0] + cos * its[..., 1]
        dx, dy = x - mine[..., 0], y - mine[..., 1]
        gap = dx * dx + dy * dy <= self.reach * self.reach
        point = np.argmax(gap, axis=2)
        points = gap.shape[2]
        captured = np.where(gap.any(axis=2), (point + 0.5) * (self.duration / points), np.inf)
        dx, dy, turned = dx[..., -1], dy[..., -1], mine[:, -1, 2]
        after = (
            np.hypot(dx, dy),
            np.arctan2(dy, dx) - turned,
            heading[..., 0] + its[:, -1, 2] - turned,
        )
        return captured, after

    def beyond(self, distance: np.ndarray, grid: Grid) -> np.ndarray:
        """Return the seconds that a distance beyond the grid adds, at the closing speed."""
        found: np.ndarray = np.maximum(distance - grid.distances[-1], 0.0) / self.closing
        return found


def solve(
    chase: Chase,
    grid: Grid,
    *,
    tolerance: float = 0.02,
    sweeps: int = 300,
    progress: Callable[[int], None] | None = None,
) -> np.ndarray:
    """Return V, the least expected time to capture [s], float32 of the grid's shape.

    Sweeps until no value changes by more than ``tolerance`` [s], at most ``sweeps`` times: against a
    prey that gets away the values would grow for ever, and then mean the least expected time out of
    ``sweeps`` time-steps. progress: called with 1 after every gait that has been tabulated and then
    after every sweep.
    """
    tables = []
    for gait in range(len(chase.hunter)):
        tables.append(_tabulate(chase, grid, gait))
        if progress is not None:
            progress(1)
    values = np.zeros(int(np.prod(grid.shape)), dtype=np.float32)
    for _ in range(sweeps):
        better = np.min([fixed + moves @ values for fixed, moves in tables], axis=0)
        change = float(np.abs(better - values).max())
        values = better
        if progress is not None:
            progress(1)
        if change < tolerance:
            break
    return values.reshape(grid.shape)


def _tabulate(chase: Chase, grid: Grid, gait: int) -> tuple[np.ndarray, Any]:
    """Return the expected time within the step [N] and the matrix [N, N] of the next states' weights."""
    from scipy.sparse import csr_array, vstack

    states = grid.states()
    fixed, moves = np.empty(len(states), dtype=np.float32), []
    for start in range(0, len(states), _CHUNK):
        part = states[start : start + _CHUNK]
        captured, after = chase.outcomes(part, gait)
        missed = ~np.isfinite(captured)
        within = np.where(missed, chase.duration + chase.beyond(after[0], grid), captured)
        fixed[start : start + len(part)] = within.mean(axis=1)
        cells, weights = grid.corners(*after)
        weights = weights * (missed / missed.shape[1])[..., None].astype(np.float32)
        columns, entries = cells.reshape(len(part), -1), weights.reshape(len(part), -1)
        keep = entries > 0
        pointers = np.concatenate([[0], np.cumsum(keep.sum(axis=1))])
        moves.append(csr_array((entries[keep], columns[keep], pointers), shape=(len(part), len(states))))
    matrix = vstack(moves, format="csr")
    matrix.sum_duplicates()
    return fixed, matrix


def expected_times(chase: Chase, grid: Grid, values: np.ndarray, state: np.ndarray) -> np.ndarray:
    """Return the expected time to capture of each gait from one relative pose [3], [G] seconds."""
    flat = values.ravel()
    times = np.empty(len(chase.hunter))
    for gait in range(len(times)):
        captured, after = chase.outcomes(state[None], gait)
        cells, weights = grid.corners(*after)
        onward = chase.duration + chase.beyond(after[0], grid) + (flat[cells] * weights).sum(axis=-1)
        times[gait] = np.where(np.isfinite(captured), captured, onward).mean()
    return times


def _around(angle: np.ndarray, intervals: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the grid line at or below an angle and how far beyond it the angle lies, in intervals."""
    place = np.mod(angle, 2 * np.pi) * (intervals / (2 * np.pi))
    line = np.floor(place)
    return line.astype(np.int64) % intervals, place - line
