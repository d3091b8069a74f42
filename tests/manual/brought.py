"""What a reader brings: a log of a robot, recorded walkers, a learner. Made up, small, of the shape of real ones."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from blocks import ROOT


def bring(folder: Path) -> None:
    """Lay the project's data and the reader's own files into a folder."""
    shutil.copytree(ROOT / "data", folder / "data")
    log().to_csv(folder / "log.csv", index=False)
    (folder / "recordings").mkdir()
    for number, name in enumerate(("zara01.txt", "zara02.txt", "hotel.txt")):
        (folder / "recordings" / name).write_text(walkers(number), encoding="utf-8")


def bring_more(folder: Path, bayeshunt: Callable[..., tuple[str, str]]) -> None:
    """Lay out what the examples of the commands take for granted: tracks, a model of prey, recorded hunts."""
    shutil.copy(folder / "recordings" / "zara01.txt", folder / "zara.txt")
    pd.read_csv(folder / "zara.txt", sep=" ", names=["frame", "id", "x", "y"]).assign(
        time=lambda table: table.pop("frame") / 25
    ).to_csv(folder / "mine.csv", index=False)
    for out, files in (("tracks", ["zara.txt"]), ("other", ["recordings/zara02.txt"]),
                       ("all", ["recordings/zara01.txt", "recordings/hotel.txt"])):  # fmt: skip
        bayeshunt("ingest", "tracks", *files, "--rate", "2.5", "--unit", "m", "--out", f"{out}.parquet")
    bayeshunt("prey", "fit", "tracks.parquet", "--time-step", "0.8", "--out", "prey.json")
    for name, planner in (("hunt", "planning"), ("planning", "planning"), ("reactive", "reactive")):
        bayeshunt("hunt", "--planner", planner, "--arena", "walled", "--theta", "1", "--out", f"{name}.parquet")


def log(held: int = 40, steps: int = 60, seed: int = 0) -> pd.DataFrame:
    """A robot of two wheels 0.3 m apart: ``held`` random commands of ``steps`` tenths of a second, odometry, 8 runs."""
    rng = np.random.default_rng(seed)
    commands = np.repeat(rng.uniform(-0.2, 0.5, (held, 2)), steps, axis=0)
    wheels = commands * rng.normal([0.95, 1.0], 0.02, commands.shape)
    turn = (wheels[:, 1] - wheels[:, 0]) / 0.3 * 0.1
    yaw = np.cumsum(turn)
    ahead = wheels.mean(axis=1) * 0.1
    places = np.cumsum(ahead[:, None] * np.column_stack([np.cos(yaw), np.sin(yaw)]), axis=0)
    number = np.arange(len(yaw))
    return pd.DataFrame({
        "time": number * 0.1 + number // (len(yaw) // 8) * 60.0, "x": places[:, 0], "y": places[:, 1],
        "yaw": np.arctan2(np.sin(yaw), np.cos(yaw)), "left": commands[:, 0], "right": commands[:, 1],
    })  # fmt: skip


def walkers(seed: int, people: int = 30, frames: int = 40) -> str:
    """Rows of frame, id, x, y at 2.5 frames a second: people who go their way, turning a little."""
    rng = np.random.default_rng(seed)
    rows = []
    for person in range(people):
        way = rng.uniform(-np.pi, np.pi) + np.cumsum(rng.normal(0.0, 0.08, frames))
        steps = rng.uniform(0.3, 0.6) * np.column_stack([np.cos(way), np.sin(way)])
        places = rng.uniform(0.0, 10.0, 2) + np.cumsum(steps, axis=0)
        rows += [(10 * (frame + 3 * person), person, x, y) for frame, (x, y) in enumerate(places)]
    return "".join(f"{frame} {person} {x:.3f} {y:.3f}\n" for frame, person, x, y in sorted(rows))


#: Stands in for learners of stable-baselines3, where that is not installed: it steps environments and learns nothing.
_LEARNER = """
from pathlib import Path


class DQN:
    def __init__(self, policy, env):
        self.env = env

    def learn(self, steps):
        self.env.reset(seed=0)
        for _ in range(steps):
            *_, terminated, truncated, _ = self.env.step(self.env.action_space.sample())
            if terminated or truncated:
                self.env.reset()

    def predict(self, seen, deterministic=False):
        assert seen.shape == (28,)
        return 4, None

    def save(self, path):
        Path(path).write_bytes(b"")

    @classmethod
    def load(cls, path):
        assert Path(path).exists()
        return cls("MlpPolicy", None)


PPO = DQN
"""


def stand_in(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Put a stand-in in the place of stable-baselines3, where it is missing, for worker processes too."""
    if find_spec("stable_baselines3") is None:
        (folder / "stand_in").mkdir()
        (folder / "stand_in" / "stable_baselines3.py").write_text(_LEARNER, encoding="utf-8")
        monkeypatch.syspath_prepend(str(folder / "stand_in"))
        monkeypatch.delitem(sys.modules, "stable_baselines3", raising=False)
