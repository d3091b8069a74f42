"""Gaits out of commands: clusters of them, the distinct ones that were held, or names that a column gives.

How many clusters can be left to the rows ("auto"): as many as foresee the poses best that they have not counted.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from bayeshunt.core.checks import check_whole
from bayeshunt.core.errors import DataError, InputError
from bayeshunt.core.gaits import Gait

__all__ = ["AUTO", "HELD", "NamedGaits", "best_number", "cluster", "gaits_of_commands", "is_column", "nearest"]

#: What ``gaits`` may say instead of a number or a column.
AUTO, HELD = "auto", "held"
#: Numbers of gaits that are tried; each needs so many rows on average.
_NUMBERS, _ROWS_EACH = (2, 3, 4, 6, 9, 12, 16, 25, 40, 64, 100), 5
_FOLDS = 5
_SHRINK = 0.5  # rows that the mean of all is worth in a gait's own
#: More distinct commands than this are no gaits that were held.
_MOST_HELD = 500
_STARTS = 8  # of the search for clusters; the best is kept


class NamedGaits(NamedTuple):
    """labels: the name of each row's gait [N]. gaits: the repertoire's, sorted by command. fewer: why not more."""

    labels: np.ndarray
    gaits: tuple[Gait, ...]
    fewer: str | None = None


def gaits_of_commands(
    commands: np.ndarray, gaits: int | str, column: pd.Series | None, *, seed: int, source: str = "log",
    moved: np.ndarray | None = None,
) -> NamedGaits:  # fmt: skip
    """Return the gait of each row and the repertoire.

    commands: [N, A]. moved: where each led, [N, 3]: x, y and yaw, for "auto". gaits: a number of clusters, "auto"
    (that number which foresees held-out rows best), or "held" (each distinct command), or the name of ``column``, which
    holds names already. Fewer distinct commands than clusters give as many gaits as there are commands.
    """
    check_whole(seed, "seed", 0)
    if column is not None:
        names = column.astype(str).to_numpy(dtype=object)
        if column.isna().any():
            row = int(np.flatnonzero(column.isna().to_numpy())[0])
            raise DataError(f"{source}: row {row}: column {gaits!r} is empty; expected the name of a gait")
        codes, distinct = pd.factorize(names, sort=True)
        centres = np.stack([commands[codes == i].mean(axis=0) for i in range(len(distinct))])
        return NamedGaits(names, tuple(Gait(str(n), tuple(c.tolist())) for n, c in zip(distinct, centres, strict=True)))
    if gaits == HELD:
        distinct, codes = np.unique(np.round(commands, 9), axis=0, return_inverse=True)
        if len(distinct) > min(_MOST_HELD, max(len(commands) // 2, 1)):
            raise InputError(f"{source}: {len(distinct)} different commands in {len(commands)} windows: they are not "
                             "held; give a number of gaits instead")  # fmt: skip
        return _named(codes.ravel(), distinct)
    if gaits == AUTO and moved is not None:
        gaits = best_number(commands, moved, seed=seed)
    if isinstance(gaits, str):
        raise InputError(f"{source}: gaits: expected a number, 'auto', 'held' or the name of a column, got {gaits!r}")
    check_whole(gaits, "gaits", 1)
    centres = cluster(commands, gaits, seed=seed)
    named = _named(nearest(commands, centres), centres)
    return named._replace(fewer=_why_fewer(commands, gaits, len(named.gaits)))


def _why_fewer(commands: np.ndarray, asked: int, made: int) -> str | None:
    """Why there are fewer gaits than asked for; None where there are as many."""
    if made == asked:
        return None
    distinct = len(np.unique(commands, axis=0))
    alike = f"holds only {distinct} different commands" if distinct <= made else "holds many commands that are alike"
    return f"{made} gaits, not the {asked} asked for: the log {alike}"


def is_column(gaits: Any) -> bool:
    """Return whether ``gaits`` is the name of a column."""
    return isinstance(gaits, str) and gaits not in (AUTO, HELD)


def best_number(commands: np.ndarray, moved: np.ndarray, *, seed: int) -> int:
    """Return the number of clusters of commands [N, A] whose mean poses foresee held-out rows best.

    moved: x, y [m] and yaw [rad] that came, [N, 3]. The loss of a row is its distance in typical steps plus the chord
    of its heading. Folds keep equal commands together, or are blocks of rows where few commands recur often.
    """
    distinct, codes = np.unique(commands, axis=0, return_inverse=True)
    rows = len(commands)
    if len(distinct) > rows / _ROWS_EACH:
        fold = (np.random.default_rng(np.random.SeedSequence(seed)).permutation(len(distinct)) % _FOLDS)[codes.ravel()]
    else:
        fold = np.arange(rows) * _FOLDS // rows
    most = min(len(distinct), max(rows // _ROWS_EACH, 1))
    numbers = sorted({number for number in _NUMBERS if number < most} | {min(most, _NUMBERS[-1])})
    scale = float(np.median(np.hypot(moved[:, 0], moved[:, 1]))) or 1.0
    came = np.column_stack([moved[:, :2] / scale, np.cos(moved[:, 2]), np.sin(moved[:, 2])])
    losses = [_loss(nearest(commands, cluster(commands, n, seed=seed)), came, fold) for n in numbers]
    return numbers[int(np.argmin(losses))]


def _loss(codes: np.ndarray, came: np.ndarray, fold: np.ndarray) -> float:
    """Mean held-out error of the mean poses [N, 4] of each code [N]."""
    total, width = 0.0, int(codes.max()) + 1
    for number in np.unique(fold):
        test, train = fold == number, fold != number
        if not train.any():
            continue
        sums = np.stack([np.bincount(codes[train], came[train, i], minlength=width) for i in range(4)], axis=1)
        counts = np.bincount(codes[train], minlength=width)[:, None]
        means = (sums + _SHRINK * came[train].mean(axis=0)) / (counts + _SHRINK)
        facing = means[:, 2:] / np.maximum(np.hypot(*means[:, 2:].T), 1e-12)[:, None]
        foreseen = np.column_stack([means[:, :2], facing])[codes[test]]
        gap = came[test] - foreseen
        total += float((np.hypot(gap[:, 0], gap[:, 1]) + np.hypot(gap[:, 2], gap[:, 3])).sum())
    return total / len(codes)


def cluster(commands: np.ndarray, number: int, *, seed: int) -> np.ndarray:
    """Return at most ``number`` centres [G, A] of commands [N, A], by k-means, sorted; each has rows.

    Every actuator counts by its own spread. The best of eight starts (k-means++, Arthur and Vassilvitskii 2007).
    """
    from scipy.cluster.vq import kmeans2

    distinct = np.unique(commands, axis=0)
    if len(distinct) <= number:
        return distinct
    spread = commands.std(axis=0)
    scaled = commands / np.where(spread > 0, spread, 1.0)
    best: tuple[float, np.ndarray] | None = None
    for stream in np.random.SeedSequence(seed).spawn(_STARTS):
        centres, codes = kmeans2(scaled, number, minit="++", rng=np.random.default_rng(stream), missing="warn")
        loss = float(np.abs(scaled - centres[codes]).sum())
        if len(np.unique(codes)) == number and (best is None or loss < best[0]):
            best = loss, np.stack([commands[codes == i].mean(axis=0) for i in range(number)])
    if best is None:  # many commands are alike: fewer clusters do
        return cluster(commands, number - 1, seed=seed)
    return best[1][np.lexsort(best[1].T[::-1])]


def nearest(commands: np.ndarray, centres: np.ndarray) -> np.ndarray:
    """Return the index [N] of the centre nearest to each command, every actuator by its own spread."""
    spread = commands.std(axis=0)
    scale = np.where(spread > 0, spread, 1.0)
    gaps = np.abs(commands[:, None] / scale - centres[None] / scale) ** 2
    return np.asarray(gaps.sum(axis=2).argmin(axis=1))


def _named(codes: np.ndarray, centres: np.ndarray) -> NamedGaits:
    """Gaits called by their command: "+2.11/-7.5"."""
    used = np.unique(codes)
    names = _names([centres[i].tolist() for i in used])
    by_code = dict(zip(used.tolist(), names, strict=True))
    labels = np.array([by_code[code] for code in codes.tolist()], dtype=object)
    return NamedGaits(labels, tuple(Gait(n, tuple(centres[i].tolist())) for n, i in zip(names, used, strict=True)))


def _names(centres: Sequence[Sequence[float]]) -> list[str]:
    for digits in range(2, 17):
        names = ["/".join(_number(value, digits) for value in centre) for centre in centres]
        if len(set(names)) == len(names):
            return names
    return [f"gait_{i:03d}" for i in range(len(centres))]


def _number(value: float, digits: int) -> str:
    """A signed number without an exponent wherever one can read it: "+112", "-0.00002"; at least ``digits`` digits."""
    value = value if abs(value) > 1e-9 else 0.0
    text = f"{value:+.{digits}g}"
    if "e" not in text or abs(value) > 1e15:
        return text
    whole = len(f"{abs(value):.0f}")
    return np.format_float_positional(value, max(digits, whole), unique=False, fractional=False, trim="-", sign=True)
