"""How well is one's own motion foreseen? Held-out errors of the pose after a gait, tables beside simple kinematics."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.arguments import checked
from bayeshunt.core.checks import check_whole
from bayeshunt.core.errors import DataError, InputError, did_you_mean
from bayeshunt.core.gaits import Gait, GaitRepertoire
from bayeshunt.core.geometry import FloatArray, Polar, wrap
from bayeshunt.data import babbling_table
from bayeshunt.data.command_gaits import AUTO, best_number, cluster
from bayeshunt.data.logs import command_columns
from bayeshunt.models.assessment.forward_points import points
from bayeshunt.models.motion.residuals import added, missed
from bayeshunt.models.motion.unicycle import Unicycle

__all__ = ["COMMANDED", "MODELS", "score_forward"]

#: Everything that can be scored; what is scored unless asked otherwise; what needs commands.
MODELS = ("stays", "unicycle", "unicycle_lag", "table", "previous_gait", "residual")
_USUAL = ("stays", "unicycle", "table", "previous_gait", "residual")
COMMANDED = ("unicycle", "unicycle_lag", "residual")
_BOOTSTRAPS = 1000
_BLOCK = 10  # rows that are resampled together
_UNKNOWN = -1


@checked
def score_forward(
    frame: pd.DataFrame,
    gaits: int | str | Iterable[Gait | str] | GaitRepertoire | None = None,
    models: Sequence[str] = _USUAL,
    folds_by: str | None = None,
    folds: int = 5,
    seed: int = 0,
) -> pd.DataFrame:
    """Score the pose after a gait as models foresee it that have not counted it; a row a model.

    frame: a babbling table, in the order of execution; ``command_0``, ... beside for :data:`COMMANDED` models.
    gaits: a number (commands are clustered inside each training fold) or "auto" (it is chosen there, too), names or a
        repertoire, or None: as the table.
    models: "stays"; "unicycle", the command's own motion fitted; "unicycle_lag", the same behind the command before;
        "table", the median pose of each gait; "previous_gait", backed off from (gait, gait before) over (gait, whether
        it changed) to the gait; "residual", such tables of what the lagging unicycle misses (without the gait before
        and the lag, where the table does not know it).
    folds_by: a column whose values are kept together; by default rows are drawn. folds: 2 or more. seed: of the folds.

    Columns: model; position_m, mean distance; heading_deg, mean absolute turn; n; position_low, position_high,
    heading_low, heading_high: 95 %, bootstrap over the values of ``folds_by``; without, over blocks of ten rows,
    because rows that follow each other depend on each other. Raises DataError, InputError in one line.
    """
    babbling_table.validate(frame)
    for value, name, least in ((folds, "folds", 2), (seed, "seed", 0)):
        check_whole(value, name, least)
    models = (models,) if isinstance(models, str) else tuple(models)
    for name in models:
        if name not in MODELS:
            raise InputError(f"unknown model {name!r}{did_you_mean(str(name), list(MODELS))}")
    commands = _commands(frame, gaits, models)
    group, fold = _folds(frame, folds_by, folds, seed)
    outcomes = Polar(*(frame[name].to_numpy(dtype=float) for name in ("distance", "angle", "heading")))
    errors = {name: np.full((len(frame), 2), np.nan) for name in models}
    earlier = _earlier(frame, commands)
    for number in range(int(fold.max()) + 1):
        test, train = fold == number, fold != number
        gait, before = _codes(frame, commands, gaits, train, seed)
        asked = _asked(models, commands, earlier, outcomes, train, test)
        for name, foreseen in _foreseen(models, asked, gait, before, outcomes, train, test).items():
            errors[name][test] = _errors(foreseen, _rows(outcomes, test))
    blocks = group // _BLOCK if folds_by is None else group
    return pd.DataFrame([_record(name, values, blocks, seed) for name, values in errors.items()])


def _commands(frame: pd.DataFrame, gaits: Any, models: Sequence[str]) -> FloatArray | None:
    names = command_columns(frame.columns)
    needed = [name for name in models if name in COMMANDED]
    if not names and (needed or gaits == AUTO or isinstance(gaits, (int, np.integer))):
        what = f"model {needed[0]!r} needs" if needed else "a number of gaits needs"
        raise DataError(f"table: column 'command_0' is missing; {what} the commands (bayeshunt.gaits_from_windows)")
    values = frame[names].to_numpy(dtype=float)
    if not np.isfinite(values).all():
        row = int(np.flatnonzero(~np.isfinite(values).all(axis=1))[0])
        raise DataError(f"table: row {row}: a command is not a finite number")
    return values if names else None


def _folds(frame: pd.DataFrame, folds_by: str | None, folds: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Group [N] and fold [N] of each row; whole groups are in one fold."""
    if folds_by is not None and folds_by not in frame:
        raise DataError(f"table: column {folds_by!r} is missing; the table has {', '.join(map(str, frame.columns))}"
                        f"{did_you_mean(folds_by, frame.columns, listed=False)}")  # fmt: skip
    group = np.arange(len(frame)) if folds_by is None else pd.factorize(frame[folds_by])[0]
    groups = int(group.max()) + 1
    if groups < folds:
        fix = "give fewer" if groups > 1 else f"{folds_by!r} has one value: leave it out, or name another column"
        raise InputError(f"folds: {folds} folds of {groups} groups; {fix}")
    rng = np.random.default_rng(np.random.SeedSequence(seed))
    return group, (rng.permutation(groups) % folds)[group]


def _codes(
    frame: pd.DataFrame, commands: FloatArray | None, gaits: Any, train: np.ndarray, seed: int
) -> tuple[np.ndarray, np.ndarray]:
    """Whole numbers [N] of each row's gait and of the gait before it (-1: unknown)."""
    told = frame["previous_gait"].notna().to_numpy() if "previous_gait" in frame else np.zeros(len(frame), dtype=bool)
    if commands is not None and isinstance(gaits, str) and gaits == AUTO:
        moved = Polar(*(frame.loc[train, name].to_numpy(dtype=float) for name in ("distance", "angle", "heading")))
        places = np.column_stack([moved.forward, moved.right, np.asarray(moved.heading)])
        gaits = best_number(commands[train], places, seed=seed)
    if isinstance(gaits, (int, np.integer)) and not isinstance(gaits, bool) and commands is not None:
        centres = cluster(commands[train], int(gaits), seed=seed)
        spread = commands[train].std(axis=0)
        scale = np.where(spread > 0, spread, 1.0)
        gait = (np.abs(commands[:, None] / scale - centres[None] / scale) ** 2).sum(axis=2).argmin(axis=1)
        before = np.where(told, np.concatenate([[_UNKNOWN], gait[:-1]]), _UNKNOWN)
        return gait, before
    names = GaitRepertoire.of(gaits).names if gaits is not None else tuple(pd.unique(frame["gait"].astype(str)))
    babbling_table.validate(frame, names)
    index = pd.Index(names)
    gait = index.get_indexer(pd.Index(frame["gait"].astype(str)))
    if not told.any():
        return gait, np.full(len(frame), _UNKNOWN)
    return gait, np.where(told, index.get_indexer(pd.Index(frame["previous_gait"].astype(str))), _UNKNOWN)


def _earlier(frame: pd.DataFrame, commands: FloatArray | None) -> FloatArray | None:
    """Commands [N, A] before each row, NaN where none is known; None where no row knows of one."""
    if commands is None or "previous_gait" not in frame:
        return None
    names, before = frame["gait"].astype(str).to_numpy(), frame["previous_gait"]
    told = before.notna().to_numpy() & (before.astype(str).to_numpy() == np.concatenate([[""], names[:-1]]))
    if not told.any():
        return None
    return np.where(told[:, None], np.concatenate([commands[:1], commands[:-1]]), np.nan)


def _asked(
    models: Sequence[str],
    commands: FloatArray | None,
    earlier: FloatArray | None,
    outcomes: Polar[FloatArray],
    train: np.ndarray,
    test: np.ndarray,
) -> dict[str, tuple[Polar[FloatArray], Polar[FloatArray]]]:
    """Poses of the test rows, and of those learned from, that the motions fitted to the latter ask for."""
    found: dict[str, tuple[Polar[FloatArray], Polar[FloatArray]]] = {}
    for name in set(COMMANDED) & set(models):
        before = None if name == "unicycle" else earlier
        if commands is None or (name == "unicycle_lag" and before is None):
            continue
        rows = [(commands[part], None if before is None else before[part]) for part in (train, test)]
        motion = Unicycle.fit(rows[0][0], _rows(outcomes, train), rows[0][1])
        found[name] = motion.predict(*rows[1]), motion.predict(*rows[0])
    return found


def _foreseen(
    models: Sequence[str],
    motions: dict[str, tuple[Polar[FloatArray], Polar[FloatArray]]],
    gait: np.ndarray,
    before: np.ndarray,
    outcomes: Polar[FloatArray],
    train: np.ndarray,
    test: np.ndarray,
) -> dict[str, Polar[FloatArray]]:
    """The pose of each test row as each model foresees it."""
    changed = np.where(before == _UNKNOWN, 2, (before != gait).astype(np.int64))
    pair = gait * (int(max(gait.max(), before.max())) + 2) + before + 1
    levels = [gait, gait * 3 + changed, pair]
    known = bool((before != _UNKNOWN).any())
    learned = _rows(outcomes, train)
    found: dict[str, Polar[FloatArray]] = {}
    if "stays" in models:
        found["stays"] = Polar(*(np.zeros(int(test.sum())) for _ in range(3)))
    if "table" in models:
        found["table"] = points([gait[train]], [gait[test]], learned)
    if "previous_gait" in models:
        if not known and models == ("previous_gait",):
            raise DataError("table: no row knows the gait before (column 'previous_gait')")
        if known:
            found["previous_gait"] = points([k[train] for k in levels], [k[test] for k in levels], learned)
    for name, (asked, there) in motions.items():
        found[name] = asked
        if name == "residual":
            used = levels if known else levels[:1]
            extra = points([level[train] for level in used], [level[test] for level in used], missed(there, learned))
            found[name] = added(asked, extra)
    return {name: found[name] for name in models if name in found}


def _rows(outcomes: Polar[FloatArray], chosen: np.ndarray) -> Polar[FloatArray]:
    return Polar(*(np.asarray(part)[chosen] for part in outcomes))


def _errors(foreseen: Polar[FloatArray], came: Polar[FloatArray]) -> FloatArray:
    """Distance [m] and absolute turn [deg] between poses: [N, 2]."""
    apart = np.hypot(foreseen.forward - came.forward, foreseen.right - came.right)
    return np.column_stack([apart, np.degrees(np.abs(wrap(foreseen.heading - came.heading)))])


def _record(name: str, values: FloatArray, group: np.ndarray, seed: int) -> dict[str, Any]:
    """Means and their intervals over resampled groups."""
    known = np.isfinite(values[:, 0])
    if not known.any():
        return {"model": name, "position_m": np.nan, "heading_deg": np.nan, "n": 0}
    codes = np.unique(group[known], return_inverse=True)[1]
    groups = int(codes.max()) + 1
    sums = np.stack([np.bincount(codes, weights=values[known, i], minlength=groups) for i in range(2)])
    sizes = np.bincount(codes, minlength=groups)
    rng = np.random.default_rng(np.random.SeedSequence([seed, groups]))
    drawn = rng.multinomial(groups, np.full(groups, 1 / groups), size=_BOOTSTRAPS)
    means = (drawn @ sums.T) / (drawn @ sizes)[:, None]
    (low, wide), (high, far) = np.percentile(means, 2.5, axis=0), np.percentile(means, 97.5, axis=0)
    position, heading = values[known].mean(axis=0)
    return {
        "model": name, "position_m": float(position), "heading_deg": float(heading), "n": int(known.sum()),
        "position_low": float(low), "position_high": float(high),
        "heading_low": float(wide), "heading_high": float(far),
    }  # fmt: skip
