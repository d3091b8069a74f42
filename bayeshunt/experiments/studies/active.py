"""Active babbling: the gait next is the one whose row is expected to tell most; and whether that learns faster."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.config.loading import load_robot
from bayeshunt.config.schema import RobotSettings
from bayeshunt.core.bins import EFFECTS, EffectAxes
from bayeshunt.core.checks import check_whole
from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import Polar
from bayeshunt.data import babbling_table
from bayeshunt.experiments.studies.babbling import SHARD_ROWS
from bayeshunt.files.atomic import check_target
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.comparison.information import expected_bits
from bayeshunt.models.counting.backoff import PRIOR
from bayeshunt.worlds.babbling import babble

__all__ = ["Informed", "babble_actively", "babble_actively_to_file", "compare_babbling"]

_FARTHEST = 400  # bins of distance that are counted apart; what lies beyond shares the last


class Informed:
    """Chooses the gait whose next row is expected to tell most of its three tables; of equals one by chance.

    axes: the bins in which it counts. gaits: how many there are. rng: breaks ties.
    The pseudo-count is 1/K a cell, K the bins that any gait has reached so far.
    """

    def __init__(self, axes: EffectAxes, gaits: int, *, rng: np.random.Generator) -> None:
        self._axes, self._rng = axes, rng
        self._counts = {name: np.zeros((_size(axes, name), gaits), dtype=np.int64) for name in EFFECTS}
        self.bits = np.zeros(gaits)
        self._rate(np.arange(gaits))

    def __call__(self, before: tuple[int, Polar] | None) -> int:
        """Return the index of the gait to execute; before: the last gait and where it led."""
        if before is not None:
            gait, end = before
            for name, value in zip(EFFECTS, (end.distance, end.angle, end.heading), strict=True):
                table = self._counts[name]
                table[min(int(self._axes[name].index(float(value))), len(table) - 1), gait] += 1
            self._rate(np.array([gait]))
        best = np.flatnonzero(self.bits >= self.bits.max() - 1e-9)
        return int(self._rng.choice(best))

    def _rate(self, gaits: np.ndarray) -> None:
        self.bits[gaits] = sum(expected_bits(t[:, gaits], 1.0 / len(t)) for t in self._counts.values())


def babble_actively(
    robot: str | os.PathLike[str] | RobotSettings, steps: int = 2000, seed: int = 0, **given: Any
) -> pd.DataFrame:
    """Return a babbling table whose gaits are chosen by expected information; arguments as of ``bayeshunt.babble``."""
    robot = load_robot(robot)
    rng = np.random.default_rng(np.random.SeedSequence([seed, 1]))
    chooser = Informed(EffectAxes.standard(robot.body.body_length), len(robot.gaits), rng=rng)
    return babble(robot, steps, seed, choose=chooser, **given)


def babble_actively_to_file(
    robot: str | os.PathLike[str] | RobotSettings,
    steps: int,
    seed: int,
    path: str | os.PathLike[str],
    *,
    progress: Callable[[int], None] | None = None,
) -> list[str]:
    """Write such a table as Parquet; return the gaits executed, sorted. Raises InputError beyond 100,000 steps."""
    check_whole(steps, "steps", 1)
    if steps > SHARD_ROWS:
        raise InputError(f"active babbling is one stream of at most {SHARD_ROWS:,} steps, got {steps:,}")
    check_target(path)
    frame = babble_actively(robot, steps, seed, progress=progress)
    babbling_table.save(frame, path)
    return sorted(frame["gait"].unique())


def compare_babbling(
    robot: str | RobotSettings,
    at: Sequence[int] = (50, 100, 200, 500),
    *,
    seeds: Sequence[int] = range(10),
    held_out: int = 2000,
    progress: Callable[[int], None] | None = None,
) -> pd.DataFrame:
    """Return how well tables learned by random and by active babbling foretell rows that neither saw.

    Columns: seed, n, random, active [nat per row, less is better], smoothed by 0.03 a cell. held_out: rows of random
    babbling of another seed, the same for all.
    """
    settings = load_robot(robot)
    for n in at:
        check_whole(n, "at", 1)
    test = babble(settings, held_out, 999_983)
    whole = ForwardModel.empty(settings.gaits, PRIOR).update(test)
    rows = []
    for seed in seeds:
        tables = {"random": babble(settings, max(at), seed), "active": babble_actively(settings, max(at), seed)}
        reach = [ForwardModel.empty(settings.gaits, PRIOR).update(t).axes.distance.bins for t in tables.values()]
        axes = whole.axes.extended(max([whole.axes.distance.bins, *reach]))
        for n in at:
            losses = {
                how: -ForwardModel.empty(settings.gaits, PRIOR, axes=axes).update(table[:n]).log_likelihood(test)
                / held_out
                for how, table in tables.items()
            }
            rows.append({"seed": seed, "n": n, **losses})
        if progress is not None:
            progress(1)
    return pd.DataFrame(rows)


def _size(axes: EffectAxes, name: str) -> int:
    return _FARTHEST if name == "Distance" else axes[name].bins
