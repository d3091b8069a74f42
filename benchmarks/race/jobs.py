"""What runs in the race, one job a line of its table; a job that has been done is read back."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bayeshunt.config.loading import load_experiment
from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.episodes.loop import run_hunt
from bayeshunt.experiments.preparation import learn_rooms, prepare_planner
from bayeshunt.experiments.protocol import hunt_seed, learn_model
from bayeshunt.experiments.scores import wilson_interval
from bayeshunt.planners.policy import policy_planner
from benchmarks.race.learners import Network, learn

__all__ = ["JOBS", "WORLDS", "Job", "Row", "run"]

#: Settings that nobody is trained for; those that learn by babbling babble anew.
WORLDS: dict[str, dict[str, Any]] = {
    "paper": {},
    "prey senses the hunter": {"prey.senses_hunter": True},
    "prey's speed 0.9 of the hunter's": {"prey.speed": 0.9 * 0.0576},
    "room 2.0 x 1.0 m": {"arenas.walled.width": 2.0, "arenas.walled.height": 1.0},
}
#: Experiments that the compiled hunt does not know: learned in the environment itself.
ELSEWHERE: dict[str, tuple[str, dict[str, Any]]] = {
    "legs": ("legs", {}),
    "camera of 60°": ("paper", {"sensing.preset": "camera_narrow"}),
}
#: Gaits that planners babble; the longest that anybody learns from.
BABBLED = (20, 50, 100, 200, 500, 1000, 2000)
LONGEST = {"open": 600_000, "walled": 1_000_000}
_BOTH = ("open", "walled")
_OURS = ("planning", "intercept", "intercept_walls")


@dataclass(frozen=True)
class Job:
    """A hunter in an arena. gaits: babbled by a planner, executed by a learner. seed: of what it learns.

    reward, tuned: of a learner. world: where it hunts. runs: per bearing, all of evaluation seed 0.
    """

    hunter: str
    arena: str
    gaits: int
    seed: int = 0
    reward: str = ""
    tuned: bool = False
    world: str = "paper"
    runs: int = 30

    @property
    def learns(self) -> bool:
        """Whether it learns by trial."""
        return self.hunter not in _OURS

    @property
    def name(self) -> str:
        """One for each job, good for a file."""
        kind = "-".join(["tuned" if self.tuned else "defaults", self.reward]) if self.learns else "babbled"
        where = "".join(c if c.isalnum() else "_" for c in self.world)
        return f"{self.hunter}-{kind}-{self.arena}-{self.gaits}-{self.seed}-{where}-{self.runs}"

    @property
    def network(self) -> str:
        """What its network is kept as: that of the same training wherever it then hunts."""
        trained = self.world if self.world in ELSEWHERE else "paper"
        return Job(self.hunter, self.arena, self.gaits, self.seed, self.reward, self.tuned, trained, 0).name + ".npz"


def _tuned(kind: str, sizes: Sequence[int], seeds: Sequence[int], arenas: Sequence[str] = _BOTH) -> list[Job]:
    """Shaped, with the best settings; from 300,000 gaits on with more hunts, as there is little left to tell apart."""
    return [
        Job(kind, arena, n, seed, "shaped", True, runs=100 if n >= 300_000 else 30)
        for n in sizes for seed in seeds for arena in arenas
    ]  # fmt: skip


def _defaults(reward: str) -> list[Job]:
    """As the library comes."""
    return [Job(kind, arena, 100_000, 0, reward) for kind in ("DQN", "PPO") for arena in _BOTH]


def _changed() -> list[Job]:
    """Worlds that nobody was trained in."""
    found = []
    for world in list(WORLDS)[1:]:
        for arena in _BOTH if "room" not in world else ("walled",):
            found += [Job(name, arena, 2000, 0, world=world) for name in _OURS[1:]]
            found.append(Job("PPO", arena, 300_000, 0, "shaped", True, world))
    return found


def _elsewhere() -> list[Job]:
    """On legs and with a camera, where a network learns in the environment itself."""
    found = []
    for world in ELSEWHERE:
        found += [Job(name, "walled", 2000, 0, world=world, runs=15) for name in _OURS[:2]]
        found.append(Job("DQN", "walled", 10_000, 0, "shaped", True, world, runs=15))
    return found


def _jobs() -> list[Job]:
    """All, the ones that say most first."""
    cheap = (1000, 3000, 10_000, 30_000, 100_000)
    return [
        *(Job(name, arena, n, 0) for name in _OURS for arena in _BOTH for n in BABBLED),
        *_tuned("PPO", cheap, (0,)), *_tuned("DQN", cheap[:3], (0,)), *_tuned("PPO", (300_000,), (0,)),
        *_defaults("shaped"), *_changed(), *(Job("PPO", arena, 100_000, 0, "time", True) for arena in _BOTH),
        *_defaults("time"), *_tuned("PPO", cheap[4:], (1, 2)),
        *_tuned("DQN", cheap[3:4], (0,)), *(Job(name, arena, 2000, 0, runs=100) for name in _OURS for arena in _BOTH),
        *_elsewhere(), *_tuned("DQN", cheap[:3], (1, 2)), *_tuned("PPO", cheap[:4], (1, 2)),
        *_tuned("PPO", (LONGEST["walled"],), (0,), ("walled",)), *_tuned("PPO", (LONGEST["open"],), (0,), ("open",)),
        *(Job(name, arena, n, seed) for name in _OURS[1:] for seed in (1, 2) for arena in _BOTH for n in BABBLED),
        *_tuned("DQN", (100_000,), (0,), ("walled",)),
    ]  # fmt: skip


JOBS = tuple(_jobs())


@dataclass(frozen=True)
class Row:
    """How a job came out. gaits: executed until then, explored ones included. hours: of the robot's time.

    low, high: 95 % Wilson interval. mean_s: a miss counts the time limit; se_s: its standard error. cpu_s: of learning.
    """

    hunter: str
    reward: str
    tuned: bool
    arena: str
    world: str
    seed: int
    gaits: int
    hours: float
    hunts: int
    caught: int
    low: float
    high: float
    mean_s: float
    se_s: float
    cpu_s: float


def run(job: Job, work: Path, progress: Callable[[int], None] | None = None) -> tuple[Row, list[float]]:
    """Return the row of a job and the time of every hunt: as kept in ``work``, else done now and kept there."""
    path = work / f"{job.name}.json"
    if not path.exists():
        row, times = _run(job, work, progress)
        path.parent.mkdir(parents=True, exist_ok=True)
        part = path.with_suffix(".part")
        part.write_text(json.dumps({"row": asdict(row), "times": times}))
        part.replace(path)
    kept = json.loads(path.read_text())
    return Row(**kept["row"]), kept["times"]


def _run(job: Job, work: Path, progress: Callable[[int], None] | None) -> tuple[Row, list[float]]:
    settings = _settings(job)
    begun = time.process_time()
    if job.learns:
        network, gaits, cpu = _trained(job, work, progress)
        planner: Any = policy_planner(network.predict, robot=settings.robot.gaits, name=job.hunter)
    else:
        model = learn_model(settings, job.seed)
        rooms = learn_rooms(settings, [job.hunter], [job.arena], job.seed, model)
        planner = prepare_planner(job.hunter, model, settings, rooms, job.arena)
        gaits, cpu = job.gaits * (2 if rooms else 1), time.process_time() - begun
    ends = [
        run_hunt(settings, planner, job.arena, theta, hunt_seed(0, index, run))
        for index, theta in enumerate(settings.protocol.thetas)
        for run in range(job.runs)
    ]
    times, caught = [end.time for end in ends], sum(end.caught for end in ends)
    low, high = wilson_interval(caught, len(ends))
    return Row(
        job.hunter, job.reward, job.tuned, job.arena, job.world, job.seed, gaits,
        round(gaits * settings.robot.gait_duration / 3600, 4), len(ends), caught, round(low, 4), round(high, 4),
        round(float(np.mean(times)), 3), round(float(np.std(times) / len(times) ** 0.5), 3), round(cpu, 2),
    ), [round(one, 3) for one in times]  # fmt: skip


def _settings(job: Job) -> ExperimentSettings:
    """Those that it hunts with; a planner babbles ``gaits`` gaits, and explores as many where it explores."""
    preset, changes = ELSEWHERE.get(job.world, ("paper", WORLDS.get(job.world, {})))
    learned = {} if job.learns else {"model.babbling_steps": job.gaits, "model.exploring_steps": job.gaits}
    return load_experiment(preset, {**changes, **learned})


def _trained(job: Job, work: Path, progress: Callable[[int], None] | None) -> tuple[Network, int, float]:
    """Return a job's network, the gaits it took and processor seconds; from ``work`` if it has been trained."""
    path = work / "networks" / job.network
    note = path.with_suffix(".json")
    if not note.exists():
        env = _environment(job) if job.world in ELSEWHERE else None
        network, gaits, cpu = learn(
            job.hunter, job.arena, job.gaits, job.seed, reward=job.reward, tuned=job.tuned, progress=progress, env=env
        )
        network.save(path)
        note.write_text(json.dumps([gaits, cpu]))
    gaits, cpu = json.loads(note.read_text())
    return Network.load(path), gaits, cpu


def _environment(job: Job) -> Any:
    """The environment of an experiment that the compiled hunt does not know, as many at once as the settings say."""
    import gymnasium
    from stable_baselines3.common.env_util import make_vec_env

    from benchmarks.race.learners import SETTINGS

    preset, changes = ELSEWHERE[job.world]
    return make_vec_env(
        lambda: gymnasium.make(
            "bayeshunt.envs:Hunt-v0", preset=preset, arena=job.arena, overrides=changes, reward=job.reward
        ),
        n_envs=SETTINGS[job.hunter]["envs"] if job.tuned else 1,
        seed=job.seed,
    )
