"""How well is a prey foreseen? Held-out scores of models and baselines on recorded tracks, side by side.

A window is ``seen`` places and the ``steps`` that follow. Windows overlap and frames depend on each other, so that
intervals come from a bootstrap over individuals, never over windows; of fewer than four of them over blocks of time.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from bayeshunt.core.arguments import checked
from bayeshunt.core.checks import check_number, check_whole
from bayeshunt.core.errors import DataError, InputError, did_you_mean
from bayeshunt.core.geometry import FloatArray
from bayeshunt.data.steps import Run, median_step, native_step, runs
from bayeshunt.data.transitions import transitions
from bayeshunt.models.assessment.prey_baselines import Autoregression, NoisyVelocity
from bayeshunt.models.assessment.sampled_scores import SCORES, sampled_scores
from bayeshunt.models.target.base_motion import constant_velocity, stands
from bayeshunt.models.target.paths import forward_facing, paths_of
from bayeshunt.models.target.prey import PreyModel

__all__ = ["MODELS", "score_prey"]

#: Name -> given and residual_of of the prey model of that name.
_FITTED: dict[str, tuple[str | None, str | None]] = {
    "table": (None, None),
    "speed": ("speed", None),
    "residual": (None, "constant_velocity"),
    "conditioned": ("speed", "constant_velocity"),
}
#: Everything that can be scored by name, baselines first.
MODELS = ("stands", "constant_velocity", "constant_velocity_noise", "autoregression", *_FITTED)
#: Draws of a forecast: the median of a hundred is itself off by some 0.5 % of the final error.
_SAMPLES = 400
#: Those of them that stand for the distribution.
_SCORED = 100
_FOLDS = 5
_EARLIER = 0.5  # share of the time that is learned from, with split="time"
_BOOTSTRAPS = 1000
#: Fewer individuals than this are no sample; blocks of so many windows are resampled instead.
_FEW, _BLOCK = 4, 5
#: Least width of the kernel density, and area of its uniform part, for tracks in metres.
_FLOOR, _AREA = 0.02, 400.0


class _Windows(NamedTuple):
    places: FloatArray  # complex [N, seen + steps]
    headings: FloatArray  # [N], rad counter-clockwise of the body at present, NaN where unknown
    time: FloatArray  # [N], s, of the first place
    who: np.ndarray  # [N], number of the individual
    scene: np.ndarray  # [N]
    identity: np.ndarray  # [N]


@checked
def score_prey(
    tracks: pd.DataFrame,
    models: Sequence[Any] | Mapping[str, Any] | None = None,
    seen: int = 8,
    steps: int = 12,
    time_step: float | None = None,
    split: str = "individual",
    seed: int = 0,
    *,
    most: int = 1500,
) -> pd.DataFrame:
    """Score forecasts of every individual in ``tracks`` by models that have not seen it; a row a model.

    models: names (:data:`MODELS`), or fitted PreyModels, which are scored as they are; by default every name.
    seen, steps: places known, and places foreseen. time_step: seconds; by default that of the rows.
    split: "individual" (five folds of them), "scene" (each left out once; scores are means over scenes) or "time"
        (the first half of every scene is learned from). most: windows scored of each fold, drawn at random.

    Columns: model; ade, fde, best20_ade, best20_fde, energy, nll, cover50, cover90 (see ``sampled_scores``; lengths in
    the unit of the tracks, nll in nats per square of it); n windows; individuals; ade_low, ade_high, fde_low, fde_high
    (95 %, bootstrap over what ``resampled`` says: individuals or, of fewer than four, blocks of time five windows
    long); differs_low, differs_high: of ade less that of constant velocity.
    Raises DataError for tracks that are none or too short, InputError for an unknown model or split.
    """
    for value, name, least in ((seen, "seen", 3), (steps, "steps", 1), (seed, "seed", 0), (most, "most", 1)):
        check_whole(value, name, least)
    chosen = _chosen(models)
    found = runs(tracks, time_step)
    step = native_step(tracks) if time_step is None else check_number(time_step, "time_step", "seconds")
    windows = _windows(found, seen, steps, step)
    scale = median_step(found)
    rows = transitions(tracks, time_step, seen=seen, steps=steps) if any(_learns(m) for _, m in chosen) else None
    floor, area = _resolution(tracks, scale)
    results: dict[str, list[FloatArray]] = {name: [] for name, _ in chosen}
    tested: list[np.ndarray] = []
    for number, (test, train) in enumerate(_folds(split, tracks, windows, rows, seen, steps, step, seed)):
        streams = np.random.SeedSequence([seed, number]).spawn(1 + len(chosen))
        mine = np.flatnonzero(test)
        mine = np.sort(np.random.default_rng(streams[0]).permutation(mine)[:most])
        if not len(mine):
            continue
        tested.append(mine)
        part = _Windows(*(values[mine] for values in windows))
        learned = None if rows is None else rows[train]
        for (name, model), stream in zip(chosen, streams[1:], strict=True):
            draw = _forecaster(name, model, learned, scale, seen, steps)
            samples = draw(part, np.random.default_rng(stream))
            results[name].append(sampled_scores(samples, part.places[:, seen:], floor=floor, area=area, scored=_SCORED))
    if not tested:
        raise DataError(f"tracks: no individual has {seen + steps} places at {step:g} s on end")
    return _summary(results, tested, windows, split == "scene", seed, (seen + steps) * step)


def _chosen(models: Sequence[Any] | Mapping[str, Any] | None) -> list[tuple[str, Any]]:
    """Name and model of everything to score; InputError for what is neither a name nor a prey model."""
    if isinstance(models, (str, PreyModel)) or (models is not None and not isinstance(models, (Sequence, Mapping))):
        models = [models]
    pairs = list(models.items()) if isinstance(models, Mapping) else [(None, m) for m in models or MODELS]
    chosen: list[tuple[str, Any]] = []
    for label, model in pairs:
        if isinstance(model, str) and model not in MODELS:
            raise InputError(f"unknown model {model!r}{did_you_mean(model, list(MODELS))}")
        if not isinstance(model, (str, PreyModel)):
            raise InputError(f"models: expected names or prey models, got a value of type {type(model).__name__}")
        taken = [name for name, _ in chosen]
        name = label or (model if isinstance(model, str) else "given")
        while name in taken:
            name += "'"
        chosen.append((name, model))
    return chosen


def _learns(model: Any) -> bool:
    return isinstance(model, str) and model not in ("stands", "constant_velocity")


def _windows(found: list[Run], seen: int, steps: int, step: float) -> _Windows:
    """Every window of every run, one from each sample."""
    parts: list[tuple[np.ndarray, ...]] = []
    who: dict[tuple[object, object], int] = {}
    for run in found:
        count = len(run.places) - (seen + steps - 1) * run.stride
        if count <= 0:
            continue
        at = np.arange(count)[:, None] + np.arange(seen + steps) * run.stride
        number = who.setdefault((run.scene, run.individual), len(who))
        parts.append((
            run.places[at], run.headings[at[:, seen - 1]], run.start + np.arange(count) * step / run.stride,
            np.full(count, number), *(np.full(count, name, dtype=object) for name in (run.scene, run.individual)),
        ))  # fmt: skip
    if not parts:
        raise DataError(f"tracks: no individual has {seen + steps} places at {step:g} s on end")
    return _Windows(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def _folds(
    split: str, tracks: pd.DataFrame, windows: _Windows, rows: pd.DataFrame | None, seen: int, steps: int, step: float,
    seed: int,
) -> list[tuple[np.ndarray, np.ndarray]]:  # fmt: skip
    """Which windows are tested and which transitions learned from, in each fold."""
    if rows is None:  # nothing is learned: every window is held out
        return [(np.ones(len(windows.who), dtype=bool), np.zeros(0, dtype=bool))]
    table = rows
    if split == "time":
        ends = tracks.groupby(tracks["scene"] if "scene" in tracks else np.zeros(len(tracks)))["time"].agg(
            ["min", "max"]
        )
        cut = dict(zip(ends.index, ends["min"] + _EARLIER * (ends["max"] - ends["min"]), strict=True))
        limits = np.array([cut[s] if "scene" in tracks else cut[0.0] for s in windows.scene])
        own = np.array([cut[s] if "scene" in tracks else cut[0.0] for s in table["scene"]], dtype=float)
        return [(windows.time >= limits, table["time"].to_numpy() + steps * step < own)]
    if split == "scene":
        names = list(dict.fromkeys(windows.scene))
        if len(names) < 2:
            raise InputError("split 'scene': the tracks hold one scene; give more, or split by individual or time")
        return [(windows.scene == name, (table["scene"] != name).to_numpy()) for name in names]
    if split != "individual":
        raise InputError(f"unknown split {split!r}{did_you_mean(str(split), ['individual', 'scene', 'time'])}")
    first = np.unique(windows.who, return_index=True)[1]
    people = len(first)
    if people < 2:
        raise InputError("split 'individual': only one individual has whole windows; split by time")
    fold_of = np.random.default_rng(np.random.SeedSequence(seed)).permutation(people) % min(_FOLDS, people)
    number = {(windows.scene[i], windows.identity[i]): n for n, i in enumerate(first)}
    mine = np.array([fold_of[number[k]] if k in number else -1 for k in zip(table["scene"], table["id"], strict=True)])
    return [(fold_of[windows.who] == fold, mine != fold) for fold in range(fold_of.max() + 1)]


def _resolution(tracks: pd.DataFrame, scale: float) -> tuple[float, float]:
    """Least width of the kernel density and area of its uniform part: 2 cm and 400 m2, or like that in other units."""
    if "unit" not in tracks or tracks["unit"].isna().all():
        return _FLOOR, _AREA
    extent = np.ptp(tracks["x"].to_numpy(dtype=float)) * np.ptp(tracks["y"].to_numpy(dtype=float))
    return 0.04 * scale, float(max(extent, scale**2))


def _forecaster(
    name: str, model: Any, rows: pd.DataFrame | None, scale: float, seen: int, steps: int
) -> Callable[[_Windows, np.random.Generator], FloatArray]:
    """What draws samples complex [N, K, steps] for windows, learned from ``rows`` where it learns."""
    if model == "stands":
        return lambda w, rng: stands(w.places[:, :seen], steps)[:, None]
    if model == "constant_velocity":
        return lambda w, rng: constant_velocity(w.places[:, :seen], steps)[:, None]
    if isinstance(model, PreyModel):
        return _futures_of(model, seen, steps)
    if rows is None or rows.empty:
        raise DataError(f"model {name!r}: nothing is left to learn from")
    if model in ("constant_velocity_noise", "autoregression"):
        paths = forward_facing(paths_of(rows, seen, steps), seen, scale)[0]
        return _baseline(str(model), paths, seen, steps, scale)
    return _futures_of(PreyModel.fit(rows, *_FITTED[model]), seen, steps)


def _futures_of(fitted: PreyModel, seen: int, steps: int) -> Callable[[_Windows, np.random.Generator], FloatArray]:
    def draw(windows: _Windows, rng: np.random.Generator) -> FloatArray:
        return fitted.futures(windows.places[:, :seen], steps, _SAMPLES, rng=rng, headings=windows.headings)

    return draw


def _baseline(
    name: str, paths: FloatArray, seen: int, steps: int, scale: float
) -> Callable[[_Windows, np.random.Generator], FloatArray]:
    if name == "constant_velocity_noise":
        noisy = NoisyVelocity(paths, seen)
        return lambda w, rng: noisy.draw(w.places[:, :seen], _SAMPLES, steps, rng=rng)
    linear = Autoregression(paths, seen, scale)

    def draw(windows: _Windows, rng: np.random.Generator) -> FloatArray:
        turned, direction = forward_facing(windows.places, seen, scale)
        ahead = linear.predict(turned[:, :seen]) * direction[:, None]
        return np.asarray((windows.places[:, seen - 1 : seen] + ahead)[:, None])

    return draw


def _summary(
    results: dict[str, list[FloatArray]], tested: list[np.ndarray], windows: _Windows, by_scene: bool, seed: int,
    length: float,
) -> pd.DataFrame:  # fmt: skip
    """Means over windows (over scenes first, if they are the folds), with intervals over individuals."""
    who = np.concatenate([windows.who[mine] for mine in tested])
    fold = np.repeat(np.arange(len(tested)), [len(mine) for mine in tested])
    group = fold if by_scene else np.zeros_like(fold)
    few = len(np.unique(who)) < _FEW
    time = np.concatenate([windows.time[mine] for mine in tested])
    block = np.floor(time / (_BLOCK * length)).astype(np.int64)
    units = np.unique(np.stack([who, block], axis=1), axis=0, return_inverse=True)[1].ravel() if few else who
    weights = _bootstrap(units, group, seed)
    reference = None
    records = []
    scores = {name: np.concatenate(parts) for name, parts in results.items()}
    if "constant_velocity" in scores:
        reference = weights @ scores["constant_velocity"][:, 0]
    for name, values in scores.items():
        means = pd.DataFrame(values, columns=list(SCORES)).groupby(group).mean().mean()
        ade, fde = weights @ values[:, 0], weights @ values[:, 1]
        apart = ade - reference if reference is not None else np.full(len(ade), np.nan)
        bounds = [np.percentile(v, q) for v in (ade, fde, apart) for q in (2.5, 97.5)]
        ends = ("ade_low", "ade_high", "fde_low", "fde_high", "differs_low", "differs_high")
        record: dict[str, Any] = {
            "model": name,
            **{str(score): value for score, value in means.items()},
            "n": len(values),
            "individuals": len(np.unique(who)),
            "resampled": "blocks of time" if few else "individuals",
        }
        records.append({**record, **{end: float(bound) for end, bound in zip(ends, bounds, strict=True)}})
    return pd.DataFrame(records)


def _bootstrap(who: np.ndarray, group: np.ndarray, seed: int) -> FloatArray:
    """Weights [B, N] of the windows in each resampling of the individuals; groups weigh alike, rows sum to 1."""
    people, codes = np.unique(who, return_inverse=True)
    rng = np.random.default_rng(np.random.SeedSequence([seed, len(people)]))
    drawn = rng.multinomial(len(people), np.full(len(people), 1 / len(people)), size=_BOOTSTRAPS)
    weights = drawn[:, codes].astype(float)
    groups = np.unique(group)
    for number in groups:
        mine = group == number
        total = weights[:, mine].sum(axis=1, keepdims=True)
        weights[:, mine] /= np.where(total > 0, total, 1.0) * len(groups)
    return weights
