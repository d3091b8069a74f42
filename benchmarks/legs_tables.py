"""What the gait before tells of a gait, on rows that no table has seen: by rows, back-off, bins; and two gaits before.

Held-out nats a row. Letters: N rows, K bins, G gaits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np
import pandas as pd

from bayeshunt.config.loading import load_robot
from bayeshunt.core.bins import EffectAxes
from bayeshunt.experiments.scores import mean_interval
from bayeshunt.models.counting.backoff import PRIOR, leaning_table
from bayeshunt.models.counting.cells import conditional
from bayeshunt.worlds.babbling import babble

__all__ = ["fresh", "gain", "losses", "report"]

FOLDS = 5  # as an assessment has
#: How many tables are babbled, of seeds from 0; of them, how many long ones; rows that are only predicted.
TABLES = {"hexapod": (8, 3), "hexapod_mixed": (8, 3), "quadruped": (8, 3), "puppy": (4, 0), "khepera": (4, 0),
          "khepera_oses2010": (4, 0), "car": (4, 0), "follower": (4, 0)}  # fmt: skip
FURTHER = 1000
#: Rows of back-off from one gait before to two, chosen on seed 1000.
TWO = 100.0
Table = Callable[[Sequence[str], list[list[str]]], str]


def losses(frame: pd.DataFrame, gaits: Sequence[str], axes: EffectAxes, strength: float) -> np.ndarray:
    """Return log-probabilities [3, N - 2] of rows held out in folds: given the gait; the one before; the two before.

    The second leans on the first by ``strength`` rows, the third on the second by :data:`TWO`.
    """
    fold = np.random.default_rng(0).integers(FOLDS, size=len(frame) - 2)
    found = np.zeros((3, len(fold)))
    for k in range(FOLDS):
        found[:, fold == k] = _predicted(frame, gaits, axes, strength, fold != k)
    return found


def fresh(frame: pd.DataFrame, learned: int, gaits: Sequence[str], axes: EffectAxes, strength: float) -> np.ndarray:
    """Return the same of the rows after the first ``learned``, which the tables have counted."""
    return _predicted(frame, gaits, axes, strength, np.arange(2, len(frame)) < learned)


def _predicted(
    frame: pd.DataFrame, gaits: Sequence[str], axes: EffectAxes, strength: float, seen: np.ndarray
) -> np.ndarray:
    codes, count = pd.Index(gaits).get_indexer(frame["gait"]), len(gaits)
    now, before, earlier = codes[2:], codes[1:-1], codes[:-2]
    found, test = np.zeros((3, int((~seen).sum()))), ~seen
    for axis in axes:
        bins = np.asarray(axis.index(frame[axis.name.lower()].to_numpy(dtype=float)))[2:]
        size = axis.bins if axis.circular else int(bins.max()) + 1
        counts = np.zeros((size, count, count, count))
        np.add.at(counts, (bins[seen], now[seen], before[seen], earlier[seen]), 1.0)
        base = conditional(counts.sum(axis=(2, 3)), PRIOR)
        one = leaning_table(counts.sum(axis=3), base[:, :, None], strength)
        two = leaning_table(counts, one[..., None], TWO)
        cell = (bins[test], now[test], before[test], earlier[test])
        found += np.log([base[cell[:2]], one[cell[:3]], two[cell]])
    return found


def gain(values: Sequence[float] | np.ndarray) -> str:
    """Return a mean with its 95 % interval."""
    low, high = mean_interval(np.asarray(values))
    return f"{np.mean(values):+.3f} ±{(high - low) / 2:.3f}"


def over(tables: Sequence[float]) -> str:
    """Return the mean of what several tables gain, its 95 % interval, and the least."""
    return f"{gain(tables)}, least {min(tables):+.3f}, {len(tables)} tables" if tables else ""


def report(table: Table) -> Iterator[str]:
    """Yield the tables."""
    lines = []
    for name, (many, long) in TABLES.items():
        robot, found = load_robot(name), {key: [] for key in ("500", "2000", "folds", "10000", "two")}
        axes = EffectAxes.standard(robot.gaits.body_length)
        for seed in range(many):
            rows = 10_000 if seed < long else 2000
            frame = babble(name, rows + FURTHER, seed)
            for number in (500, 2000, 10_000):
                if number <= rows:
                    some = frame[: number + FURTHER]
                    naive, one, two = fresh(some, number, robot.gaits.names, axes, 5.0).mean(axis=1)
                    found[str(number)].append(one - naive)
            if long and seed < long:
                found["two"].append(two - one)
            naive, one, _ = losses(frame[:2000], robot.gaits.names, axes, 5.0).mean(axis=1)
            found["folds"].append(one - naive)
        lines.append([name, *(over(found[key]) for key in ("500", "2000", "10000", "folds", "two"))])
    heads = ["learned from: 500 rows", "2,000", "10,000", f"2,000 in {FOLDS} folds", "two gaits before, beyond one"]
    yield table(["robot", *heads], lines)
    yield table(*tuned())


def tuned() -> tuple[list[str], list[list[str]]]:
    """Return the hexapod's gain at 2,000 rows by back-off and bins, seeds 1000 to 1003: is either what limits it?"""
    strengths, lines, robot = (2.0, 5.0, 10.0, 20.0, 40.0), [], load_robot("hexapod")
    frames = [babble("hexapod", 2000 + FURTHER, seed) for seed in range(1000, 1004)]
    for width, turns in ((0.1, 36), (0.2, 18), (0.3, 12), (0.05, 72)):
        axes = EffectAxes.standard(robot.gaits.body_length, distance_bin=width, angle_bins=turns, heading_bins=turns)
        cells = []
        for strength in strengths:
            made = [fresh(frame, 2000, robot.gaits.names, axes, strength).mean(axis=1) for frame in frames]
            cells.append(gain([one - naive for naive, one, _ in made]))
        lines.append([f"{width:g} lengths, {turns}", *cells])
    return ["hexapod, 2,000 rows: bins", *(f"back-off {s:g}" for s in strengths)], lines
