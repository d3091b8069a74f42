"""Hunts on legs, each made once: kept as a line for each row and seed, so that a run goes on where it stopped."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.config.loading import load_experiment
from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.bins import EffectAxes
from bayeshunt.experiments.run.runner import evaluate
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.worlds.babbling import babble

__all__ = ["BEARINGS", "Hunts", "Row", "learned"]

BEARINGS = 7
#: What is kept of every hunt, and how it is written.
_KEPT = {"caught": "{:d}", "time": "{:.3f}", "energy": "{:.2f}", "transitions": "{:d}", "falls": "{:d}"}
_KEYS = ["planner", "arena", "given", "seed"]


@dataclass(frozen=True)
class Row:
    """A planner of preset ``legs``. given: settings of the experiment that are changed."""

    planner: str
    structure: str = "previous_gait"
    given: dict[str, Any] = field(default_factory=dict)
    arena: str = "open"

    @property
    def label(self) -> str:
        """The planner and what was changed."""
        changed = [f"{key.removeprefix('planner.planning.')} {value}" for key, value in self.given.items()]
        where = [] if self.arena == "open" else [self.arena]
        return ", ".join([self.planner, self.structure, *changed, *where])

    @property
    def settings(self) -> dict[str, Any]:
        """What is changed of the preset, but for the number of hunts."""
        return {"model.structure": self.structure, **self.given}


@lru_cache(maxsize=3)
def _babbled(settings: str, seed: int) -> pd.DataFrame:
    made = ExperimentSettings.model_validate_json(settings)
    return babble(made.robot, made.model.babbling_steps, seed, physics=made.physics, world=made.world)


@lru_cache(maxsize=8)
def learned(given: str, seed: int) -> ForwardModel:
    """Return the model that an experiment with the settings ``given`` (JSON) learns; the structures share a table."""
    settings = load_experiment("legs", json.loads(given))
    model, robot = settings.model, settings.robot
    plain = settings.model_copy(update={"model": model.model_copy(update={"structure": "naive"})})
    frame = _babbled(plain.model_dump_json(), seed)
    axes = EffectAxes.standard(
        robot.body.body_length, distance_bin=model.distance_bin, angle_bins=model.angle_bins,
        heading_bins=model.heading_bins,
    )  # fmt: skip
    backoff = None if model.structure == "naive" else model.backoff
    return ForwardModel.fit(
        frame, robot.gaits, prior=model.prior, axes=axes, structure=model.structure, backoff=backoff
    )


class Hunts:
    """Hunts of rows over all seeds. out: the CSV file that keeps them; None: none does."""

    def __init__(self, seeds: Sequence[int], out: Path | None) -> None:
        self.seeds, self.out = tuple(seeds), out
        self._kept: dict[tuple[str, ...], pd.DataFrame] = dict(_read(out))

    def of(self, row: Row, runs: int) -> pd.DataFrame:
        """Return a row's hunts, ``runs`` of each bearing and seed, indexed by seed, bearing and run."""
        return pd.concat({seed: self._seed(row, runs, seed) for seed in self.seeds}, names=["seed"])

    def _seed(self, row: Row, runs: int, seed: int) -> pd.DataFrame:
        key = (row.planner, row.arena, json.dumps(row.settings, sort_keys=True), str(seed))
        kept = self._kept.get(key)
        if kept is None or len(kept) < runs * BEARINGS:
            started = time.process_time()
            kept = self._kept[key] = _made(row, runs, seed)
            self._write()
            spent = time.process_time() - started
            print(f"{row.label}, seed {seed}: {len(kept)} hunts, {spent:.0f} s", file=sys.stderr, flush=True)
        return kept[kept.index.get_level_values("run") < runs]

    def _write(self) -> None:
        if self.out is None:
            return
        lines = [
            dict(zip(_KEYS, key, strict=True)) | {
                name: " ".join(form.format(value) for value in hunts[name]) for name, form in _KEPT.items()
            }
            for key, hunts in sorted(self._kept.items())
        ]  # fmt: skip
        self.out.parent.mkdir(parents=True, exist_ok=True)
        part = self.out.with_suffix(".part")
        pd.DataFrame(lines).to_csv(part, index=False)
        part.replace(self.out)


def _made(row: Row, runs: int, seed: int) -> pd.DataFrame:
    given = {**row.settings, "protocol.runs": runs}
    about_the_body = {k: v for k, v in row.settings.items() if k.startswith(("model.", "robot"))}
    model = learned(json.dumps(about_the_body, sort_keys=True), seed)
    settings = load_experiment("legs", given)
    frame = evaluate(settings, seed=seed, jobs=1, planners=[row.planner], arenas=[row.arena], model=model)
    bearings = frame["theta"].rank(method="dense").astype(int) - 1
    return _indexed(frame[list(_KEPT)], bearings.to_numpy(), frame["run"].to_numpy())


def _indexed(frame: pd.DataFrame, bearings: np.ndarray, runs: np.ndarray) -> pd.DataFrame:
    return frame.set_axis(pd.MultiIndex.from_arrays([bearings, runs], names=["bearing", "run"]))


def _read(path: Path | None) -> Iterator[tuple[tuple[str, ...], pd.DataFrame]]:
    """Yield what is kept: the hunts of a line in order of bearing, then run."""
    if path is None or not path.is_file():
        return
    for line in pd.read_csv(path, dtype=str).to_dict("records"):
        columns = {name: [float(word) for word in line[name].split()] for name in _KEPT}
        frame = pd.DataFrame(columns).astype({"caught": bool, "transitions": int, "falls": int})
        runs = len(frame) // BEARINGS
        yield (
            tuple(line[key] for key in _KEYS),
            _indexed(frame, np.repeat(np.arange(BEARINGS), runs), np.tile(np.arange(runs), BEARINGS)),
        )
