"""Gaits out of commands: clusters of them, the distinct ones that were held, or names that a column gives."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd

from bayeshunt.core.checks import check_whole
from bayeshunt.core.errors import DataError, InputError
from bayeshunt.core.gaits import Gait

__all__ = ["NamedGaits", "cluster", "gaits_of_commands"]

#: More distinct commands than this are no gaits that were held.
_MOST_HELD = 500
_STARTS = 8  # of the search for clusters; the best is kept


class NamedGaits(NamedTuple):
    """labels: the name of each row's gait [N]. gaits: the repertoire's gaits, sorted by command."""

    labels: np.ndarray
    gaits: tuple[Gait, ...]


def gaits_of_commands(
    commands: np.ndarray, gaits: int | str, column: pd.Series | None, *, seed: int, source: str = "log"
) -> NamedGaits:
    """Return the gait of each row and the repertoire.

    commands: [N, A]. gaits: a number of clusters, or "held" (each distinct command), or the name of ``column``, which
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
    if gaits == "held":
        distinct, codes = np.unique(np.round(commands, 9), axis=0, return_inverse=True)
        if len(distinct) > min(_MOST_HELD, max(len(commands) // 2, 1)):
            raise InputError(f"{source}: {len(distinct)} different commands in {len(commands)} windows: they are not "
                             "held; give a number of gaits instead")  # fmt: skip
        return _named(codes.ravel(), distinct)
    if isinstance(gaits, str):
        raise InputError(f"{source}: gaits: expected a number, 'held' or the name of a column, got {gaits!r}")
    check_whole(gaits, "gaits", 1)
    centres = cluster(commands, gaits, seed=seed)
    return _named(nearest(commands, centres), centres)


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
        names = ["/".join(f"{value + 0.0:+.{digits}g}" for value in centre) for centre in centres]
        if len(set(names)) == len(names):
            return names
    return [f"gait_{i:03d}" for i in range(len(centres))]
