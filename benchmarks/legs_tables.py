"""What the gait before tells of a gait, on rows that no table has seen: by rows, back-off, bins; and two gaits before.

Held-out nats a row, four folds of rows drawn by chance. Letters: N rows, K bins, G gaits.
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

FOLDS = 4
Table = Callable[[Sequence[str], list[list[str]]], str]


def losses(frame: pd.DataFrame, gaits: Sequence[str], axes: EffectAxes, strength: float) -> np.ndarray:
    """Return held-out log-probabilities [3, N]: given the gait; the gait before too; the two gaits before too.

    The second leans on the first, the third on the second, each with ``strength`` rows.
    """
    codes = pd.Index(gaits).get_indexer(frame["gait"])
    rows, count = np.arange(2, len(codes)), len(gaits)
    now, before, earlier = codes[2:], codes[1:-1], codes[:-2]
    fold = np.random.default_rng(0).integers(FOLDS, size=len(rows))
    found = np.zeros((3, len(rows)))
    for axis in axes:
        bins = np.asarray(axis.index(frame[axis.name.lower()].to_numpy(dtype=float)))[rows]
        size = axis.bins if axis.circular else int(bins.max()) + 1
        for k in range(FOLDS):
            seen, test = fold != k, fold == k
            counts = np.zeros((size, count, count, count))
            np.add.at(counts, (bins[seen], now[seen], before[seen], earlier[seen]), 1.0)
            base = conditional(counts.sum(axis=(2, 3)), PRIOR)
            one = leaning_table(counts.sum(axis=3), base[:, :, None], strength)
            two = leaning_table(counts, one[..., None], strength)
            cell = (bins[test], now[test], before[test], earlier[test])
            found[:, test] += np.log([base[cell[:2]], one[cell[:3]], two[cell]])
    return found


def gain(values: np.ndarray) -> str:
    """Return a mean with its 95 % interval."""
    low, high = mean_interval(values)
    return f"{values.mean():+.3f} ±{(high - low) / 2:.3f}"


def report(seed: int, table: Table) -> Iterator[str]:
    """Yield the tables."""
    frames = {name: babble(name, 2000 if name == "puppy" else 10_000, seed=seed) for name in
              ("khepera", "car", "hexapod", "hexapod_mixed", "quadruped", "puppy")}  # fmt: skip
    lines = []
    for name, frame in frames.items():
        robot = load_robot(name)
        axes = EffectAxes.standard(robot.gaits.body_length)
        cells = []
        for number in (500, 2000, 10_000):
            if number <= len(frame):
                naive, one, two = losses(frame[:number], robot.gaits.names, axes, 5.0)
                cells += (
                    [gain(one - naive), gain(two - one)] if number == min(10_000, len(frame)) else [gain(one - naive)]
                )
        lines.append([name, *cells[:2], *(["", cells[2]] if len(cells) == 3 else cells[2:])])
    yield table(["robot", "500 rows", "2,000", "10,000", "two gaits before, beyond one, all rows"], lines)
    yield table(*tuned(frames["hexapod"][:2000]))


def tuned(frame: pd.DataFrame) -> tuple[list[str], list[list[str]]]:
    """Return the hexapod's gain at 2,000 rows by back-off and bins: is either what limits it?"""
    strengths, lines, robot = (2.0, 5.0, 10.0, 20.0, 40.0), [], load_robot("hexapod")
    for width, turns in ((0.1, 36), (0.2, 18), (0.3, 12), (0.05, 72)):
        axes = EffectAxes.standard(robot.gaits.body_length, distance_bin=width, angle_bins=turns, heading_bins=turns)
        made = [losses(frame, robot.gaits.names, axes, s) for s in strengths]
        lines.append([f"{width:g} lengths, {turns}", *(gain(one - naive) for naive, one, _ in made)])
    return ["bins", *(f"back-off {s:g}" for s in strengths)], lines
