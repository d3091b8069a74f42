"""What environments are made from: an experiment of plain arguments, where an episode starts, what steps are worth."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from bayeshunt.config.loading import DEFAULT_PRESET, load_experiment
from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.checks import check_kind, check_radians, check_whole
from bayeshunt.core.errors import InputError, did_you_mean
from bayeshunt.episodes.pursuit import Pursuit

__all__ = ["FPS", "GAMMA", "REWARDS", "Rewards", "experiment_of", "report", "start_of"]

REWARDS = ("time", "shaped")
#: Discount in the potential of the shaped reward.
GAMMA = 0.99
#: Frames per second of a film in real time at the presets' control interval of 64 ms.
FPS = 15.625
#: Hunts' seeds fit the arrays of int64 that vector environments make of infos.
_SEEDS = 2**62


def experiment_of(
    preset: str | None, robot: str | None, sensing: str | Mapping[str, Any] | None, overrides: Mapping[str, Any] | None
) -> ExperimentSettings:
    """Return the experiment that an environment's arguments name; they are plain, so that a spec can be JSON.

    sensing: the name of a sensor, or values of the group ``sensing`` by key. overrides: values by dotted key, over all
    the others. Raises ConfigError in one line for what is unknown, InputError for what is none of these.
    """
    if overrides is not None:
        check_kind(overrides, "overrides", Mapping, 'settings by dotted key, {"prey.speed": 0.04}')
    changes: dict[str, Any] = {} if robot is None else {"robot": robot}
    if isinstance(sensing, str):
        changes["sensing.sensor"] = sensing
    elif sensing is not None:
        check_kind(sensing, "sensing", Mapping, "the name of a sensor, or values by key")
        changes.update({f"sensing.{key}": value for key, value in sensing.items()})
    return load_experiment(DEFAULT_PRESET if preset is None else preset, {**changes, **(overrides or {})})


def start_of(
    settings: ExperimentSettings, theta: float | None, options: Mapping[str, Any] | None, rng: np.random.Generator
) -> tuple[float, int]:
    """Return bearing and seed of an episode: as ``options`` say, else drawn from ``rng``, the seed first.

    theta: the bearing where the options give none; None: one of the protocol's. Other options are left alone.
    Raises InputError for a bearing or a seed that is none.
    """
    given = options or {}
    seed = int(rng.integers(_SEEDS)) if given.get("hunt_seed") is None else given["hunt_seed"]
    bearings = settings.protocol.thetas
    drawn = float(bearings[int(rng.integers(len(bearings)))])
    wanted = given.get("theta")
    bearing = wanted if wanted is not None else drawn if theta is None else theta
    check_whole(seed, "options: hunt_seed", 0)
    check_radians(bearing, "theta")
    return float(bearing), int(seed)


class Rewards:
    """What a step is worth to the hunter.

    "time": minus the seconds it took, in units of the time limit; a return is then minus the time of the hunt, a miss
    is -1. "shaped": to that is added how much nearer in metres the prey is, gamma phi' - phi with phi = -distance, 0
    at the catch, which leaves the best policy what it is.
    """

    def __init__(self, kind: str, limit: float) -> None:
        if kind not in REWARDS:
            raise InputError(f"reward: unknown reward {kind!r}{did_you_mean(kind, REWARDS)}")
        self._shaped, self._limit = kind == "shaped", limit
        self._time = self._potential = 0.0

    def start(self, pursuit: Pursuit) -> None:
        """Begin an episode."""
        self._time = 0.0
        if self._shaped:
            self._potential = _potential(pursuit)

    def step(self, pursuit: Pursuit) -> float:
        """Return what the step that has just been taken is worth."""
        time = pursuit.time
        reward = (self._time - time) / self._limit
        if self._shaped:
            potential = _potential(pursuit)
            reward += GAMMA * potential - self._potential
            self._potential = potential
        self._time = time
        return float(reward)


def report(pursuit: Pursuit, theta: float, seed: int) -> dict[str, Any]:
    """Return an info, plain numbers: the same keys at every step, and what names the episode."""
    return {
        "time": float(pursuit.time), "distance": _distance(pursuit), "is_success": bool(pursuit.caught),
        "gaits": pursuit.decisions, "theta": theta, "hunt_seed": seed,
    }  # fmt: skip


def _distance(pursuit: Pursuit) -> float:
    """Metres between the two robots' centres."""
    poses = pursuit.moment.poses
    hunter, prey = poses["hunter"], poses["prey"]
    return math.hypot(prey.x - hunter.x, prey.y - hunter.y)


def _potential(pursuit: Pursuit) -> float:
    return 0.0 if pursuit.caught else -_distance(pursuit)
