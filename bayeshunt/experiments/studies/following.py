"""Follow people: how well a hunter of a person's size catches recorded walkers, and keeps them company.

Each walker is followed once for every prey model, from the same start with the same noise: models compare in pairs.
A model that is learned from people is learned from the other scenes. The planner is the same throughout.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.config.loading import load_experiment
from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.checks import check_whole
from bayeshunt.core.errors import DataError, InputError, did_you_mean
from bayeshunt.core.geometry import Polar
from bayeshunt.core.protocols import TargetModel
from bayeshunt.data import tracks as tracks_file
from bayeshunt.data.transitions import transitions
from bayeshunt.episodes.loop import run_hunt
from bayeshunt.episodes.pursuit import Pursuit
from bayeshunt.experiments.protocol import hunt_seed, learn_model
from bayeshunt.experiments.scores import wilson_interval
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.target.following import ConstantVelocity
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.planners.api import Plan, Planner, Situation
from bayeshunt.planners.asking import ask
from bayeshunt.planners.registry import make_planner
from bayeshunt.worlds.recorded.path import RecordedPath, read_path
from bayeshunt.worlds.scene import HUNTER, PREY

__all__ = ["MODELS", "Walker", "follow", "summary", "walkers_of"]

#: Prey models that can be compared: the paper's, empty at the start; the same table (order 0) of other people; the last
#: step goes on; people learned beforehand, given their speed and what constant velocity misses.
MODELS = ("counts", "table", "constant_velocity", "conditioned")
_PRESET, _ARENA = "follow", "open"
_BOOTSTRAPS = 2000
_NEVER = 1e-3  # bodies: nobody is ever caught at this distance


@dataclass(frozen=True)
class Walker:
    """One recorded walker: which, and how a hunter starts. theta: first bearing [rad clockwise]."""

    scene: str
    individual: str
    theta: float
    seed: int
    duration: float


class _Behind:
    """A planner that goes for a point behind the prey instead of the prey."""

    def __init__(self, planner: Planner, distance: float) -> None:
        self._planner, self.name, self._behind = planner, planner.name, Polar(distance, np.pi, 0.0)

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Plan as if the prey were behind itself."""
        return self._planner.plan(replace(situation, prey=situation.prey.compose(self._behind)), rng=rng)


def walkers_of(
    tracks: pd.DataFrame, scenes: Sequence[str], number: int, seed: int, least: float = 8.0,
    thetas: Sequence[float] = (0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0),
) -> list[Walker]:  # fmt: skip
    """Return walkers of some scenes who were seen for ``least`` seconds on end, drawn at random, evenly over scenes.

    Raises InputError for an unknown scene, DataError if nobody was seen that long.
    """
    known = list(dict.fromkeys(tracks["scene"].astype(str)))
    for scene in scenes:
        if scene not in known:
            raise InputError(f"unknown scene {scene!r}{did_you_mean(scene, known)}")
    check_whole(number, "walkers", 1)
    found: list[Walker] = []
    streams = np.random.SeedSequence(seed).spawn(len(scenes))
    for at, (scene, stream) in enumerate(zip(scenes, streams, strict=True)):
        frame = tracks[tracks["scene"].astype(str) == scene]
        spans = frame.groupby(frame["id"].astype(str))["time"].agg(["min", "max"])
        long = [name for name, (a, b) in zip(spans.index, spans.to_numpy(), strict=True) if b - a >= least]
        rng, want = np.random.default_rng(stream), number // len(scenes) + (at < number % len(scenes))
        for name in rng.permutation(np.array(long, dtype=object)):
            if want <= 0:
                break
            way = _way(frame, str(name))
            if way is None or way.duration < least:
                continue
            index = len(found)
            theta = float(thetas[index % len(thetas)])
            found.append(Walker(scene, str(name), theta, hunt_seed(seed, index, 0), way.duration))
            want -= 1
    if not found:
        raise DataError(f"tracks: nobody in {', '.join(scenes)} was seen for {least:g} s on end")
    return found


def _way(frame: pd.DataFrame, name: str) -> RecordedPath | None:
    try:
        return read_path(frame, name)
    except DataError:
        return None


def follow(
    tracks: pd.DataFrame, scenes: Sequence[str] | None = None, walkers: int = 200, *,
    planner: str = "planning", models: Sequence[str] = MODELS, seed: int = 0, band: tuple[float, float] = (0.5, 2.5),
    learn_from: pd.DataFrame | None = None, model: ForwardModel | None = None,
    experiment: str | os.PathLike[str] | ExperimentSettings = _PRESET, progress: Callable[[int], None] | None = None,
) -> pd.DataFrame:  # fmt: skip
    """Follow recorded walkers with each prey model; a row a walker and model.

    tracks: of one or more scenes, in metres. scenes: those whose walkers are followed; None: all. walkers: how many in
    all. models: of :data:`MODELS`; "table" and "conditioned" are fitted to the other scenes, or to ``learn_from``.
    band: distances between the centres [m] that count as company. model: of the hunter's body; None: it babbles first.
    experiment: the hunter and the start; by default preset "follow". progress: called after each hunt with 1.

    Columns: model, scene, id, theta [rad], seed, limit [s] (how long the walker was seen), caught, time [s] (the limit
    if missed), company (share of the walker's time within the band, the hunter going for its middle behind the walker).
    Raises InputError for an unknown scene or model, DataError for tracks that cannot be used.
    """
    for name in models:
        if name not in MODELS:
            raise InputError(f"unknown model {name!r}{did_you_mean(str(name), list(MODELS))}")
    if not (0 <= band[0] < band[1]):
        raise InputError(f"band: expected two distances, the lower first, got {band}")
    tracks_file.validate(tracks)
    settings = load_experiment(experiment)
    chosen = list(dict.fromkeys(tracks["scene"].astype(str))) if scenes is None else list(scenes)
    people = walkers_of(tracks, chosen, walkers, seed, thetas=settings.protocol.thetas)
    body = learn_model(settings, seed) if model is None else model
    hunter = make_planner(planner, body)
    known: dict[str, dict[str, TargetModel | None]] = {}
    records = []
    with tempfile.TemporaryDirectory() as folder:
        for walker in people:
            file = Path(folder) / f"{chosen.index(walker.scene)}.parquet"
            if not file.exists():
                tracks_file.save(tracks[tracks["scene"].astype(str) == walker.scene], file)
            own = _settings(settings, file, walker)
            if walker.scene not in known:
                others = tracks[tracks["scene"].astype(str) != walker.scene] if learn_from is None else learn_from
                known[walker.scene] = _prey_models(models, others, body)
            for name in models:
                records.append(_followed(own, hunter, walker, name, known[walker.scene][name], band))
                if progress is not None:
                    progress(1)
    return pd.DataFrame(records)


def summary(hunts: pd.DataFrame, reference: str = "constant_velocity", seed: int = 0) -> pd.DataFrame:
    """Return a row a model: caught of n with its 95 % Wilson interval, mean time and company with paired differences.

    hunts: as :func:`follow` returns them. Differences are to ``reference``, over the same walkers, with 95 % intervals
    by a bootstrap over walkers: caught_differs (share), time_differs [s], company_differs (share), each _low and _high.
    """
    names = ("caught", "time", "company")
    wide = {name: hunts.pivot_table(index=["scene", "id"], columns="model", values=name) for name in names}
    number = len(wide["caught"])
    drawn = np.random.default_rng(seed).integers(number, size=(_BOOTSTRAPS, number))
    records = []
    for model in dict.fromkeys(hunts["model"]):
        caught = int(wide["caught"][model].sum())
        low, high = wilson_interval(caught, number)
        record: dict[str, Any] = {
            "model": model, "caught": caught, "n": number, "share": caught / number, "share_low": low,
            "share_high": high, "mean_time": wide["time"][model].mean(), "company": wide["company"][model].mean(),
        }  # fmt: skip
        for name in names:
            if reference in wide[name]:
                apart = (wide[name][model] - wide[name][reference]).to_numpy(dtype=float)
                ends = np.percentile(apart[drawn].mean(axis=1), [2.5, 97.5])
                record |= {f"{name}_differs": apart.mean(), f"{name}_low": ends[0], f"{name}_high": ends[1]}
        records.append(record)
    return pd.DataFrame(records)


def _settings(settings: ExperimentSettings, file: Path, walker: Walker) -> ExperimentSettings:
    prey = settings.prey.model_copy(update={"behaviour": f"recorded:{file}#{walker.individual}"})
    protocol = settings.protocol.model_copy(update={"time_limit": walker.duration})
    return settings.model_copy(update={"prey": prey, "protocol": protocol})


def _prey_models(names: Sequence[str], others: pd.DataFrame, body: ForwardModel) -> dict[str, TargetModel | None]:
    """The prey models of these names, the learned ones fitted to other people; None: the hunt makes an empty one."""
    made: dict[str, TargetModel | None] = {"counts": None, "constant_velocity": ConstantVelocity()}
    learned = [name for name in names if name not in made]
    if learned:
        if not len(others):
            raise InputError(f"model {learned[0]!r} is learned from other scenes; give tracks of more than one scene")
        rows = transitions(others, body.gaits.need("duration"))
        for name in learned:
            made[name] = PreyModel.fit(rows) if name == "table" else PreyModel.fit(rows, "speed", "constant_velocity")
    return made


def _followed(
    settings: ExperimentSettings, planner: Planner, walker: Walker, name: str, known: TargetModel | None,
    band: tuple[float, float],
) -> dict[str, Any]:  # fmt: skip
    ended = run_hunt(settings, planner, _ARENA, walker.theta, walker.seed, known)
    return {
        "model": name, "scene": walker.scene, "id": walker.individual, "theta": walker.theta, "seed": walker.seed,
        "limit": walker.duration, "caught": ended.caught, "time": ended.time,
        "company": _company(settings, planner, walker, known, band),
    }  # fmt: skip


def _company(
    settings: ExperimentSettings, planner: Planner, walker: Walker, known: TargetModel | None, band: tuple[float, float]
) -> float:
    """Share of the walker's time within the band."""
    protocol = settings.protocol.model_copy(update={"catch_distance": _NEVER})
    behind = _Behind(planner, 0.5 * (band[0] + band[1]))
    running = Pursuit(
        settings.model_copy(update={"protocol": protocol}), _ARENA, walker.theta, walker.seed, prey_model=known
    )
    near = total = 0
    while not running.done:
        running.step(ask(behind, running.situation, running.rng, running.gaits).gait)
        for moment in running.moments:
            one, other = moment.poses[HUNTER], moment.poses[PREY]
            near += band[0] <= float(np.hypot(one.x - other.x, one.y - other.y)) <= band[1]
            total += 1
    return near / max(total, 1)
