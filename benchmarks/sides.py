"""What it is worth to know to which side a prey turns at a wall: preset oses2010, walled, bearings 0 and 6 rad.

There the prey meets a wall head on, or nearly, within the first time-step, and always turns to the same hand. What a
hunter sees before its first decision is the same in the mirrored world, in which the prey turns to the other side:
whatever it is and however it plans, its first gait is the same in both. Run as ``python -m benchmarks.missing``.
"""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

import numpy as np

from bayeshunt.config.loading import load_experiment
from bayeshunt.episodes.loop import run_hunt
from bayeshunt.experiments.preparation import learn_rooms, prepare_planner
from bayeshunt.experiments.protocol import hunt_seed, learn_model
from bayeshunt.planners.api import Plan, Planner, Situation

__all__ = ["bound", "first_gaits", "side"]

_OTHER = {"left": "right", "right": "left"}
_THETAS = (0.0, 6.0)


class FirstGait:
    """A planner whose first gait is given."""

    def __init__(self, planner: Planner, gait: str) -> None:
        self.name, self.planner, self.gait = planner.name, planner, gait

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Return the given gait, and after it what the planner says."""
        return self.planner.plan(situation, rng=rng) if situation.step else Plan(self.gait)


class AllGaits:
    """A planner all of whose gaits are given."""

    name = "all_gaits"

    def __init__(self, gaits: tuple[str, ...]) -> None:
        self.gaits = gaits

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Return the gait of this step."""
        return Plan(self.gaits[min(situation.step, len(self.gaits) - 1)])


class Earliest(NamedTuple):
    """time: mean of the earliest captures [s]; is_least: whether a hunt had none, and counts when the search ended."""

    time: float
    is_least: bool


def first_gaits(theta: float, seeds: list[int], runs: int) -> dict[str, float]:
    """Return the mean time [s] of ``intercept_walls`` after each first gait."""
    settings = load_experiment("oses2010", {"protocol.thetas": [theta], "protocol.runs": 1})
    times: dict[str, list[float]] = {}
    for seed in seeds:
        model = learn_model(settings, seed)
        rooms = learn_rooms(settings, ["intercept_walls"], ["walled"], seed, model)
        planner = prepare_planner("intercept_walls", model, settings, rooms, "walled")
        for gait in model.gaits.names:
            hunters = FirstGait(planner, gait)
            ends = [run_hunt(settings, hunters, "walled", theta, hunt_seed(seed, 0, run)) for run in range(runs)]
            times.setdefault(gait, []).extend(end.time for end in ends)
    return {gait: float(np.mean(found)) for gait, found in times.items()}


def side(seeds: list[int], runs: int) -> None:
    """Print the time after every first gait on both sides."""
    print("| bearing [rad] | first gait | as the prey turns [s] | to the other side [s] | mean [s] |")
    print("| --- | --- | --- | --- | --- |")
    for theta in _THETAS:
        here, there = first_gaits(theta, seeds, runs), first_gaits(_mirrored(theta), seeds, runs)
        for gait, time in here.items():
            other = there[_mirrored_gait(gait)]
            print(f"| {theta:g} | {gait} | {time:.2f} | {other:.2f} | {0.5 * (time + other):.2f} |")


def earliest(theta: float, seeds: list[int], runs: int, longest: int) -> dict[str, Earliest]:
    """Return the earliest captures that any sequence of up to ``longest`` gaits brings, by its first gait.

    All sequences are run, so that this is what a hunter gets that knows everything from its second decision on, the
    noise of both robots included. Longer ones are tried only after a first gait that no shorter one brought a capture.
    """
    found: dict[str, list[float | None]] = {}
    step = float(load_experiment("oses2010", {}).robot.gait_duration)
    for seed, run in itertools.product(seeds, range(runs)):
        model = None
        for count in range(1, longest + 1):
            limit = {"protocol.thetas": [theta], "protocol.runs": 1, "protocol.time_limit": count * step}
            settings = load_experiment("oses2010", limit)
            model = learn_model(settings, seed) if model is None else model
            for first in model.gaits.names:
                own = found.setdefault(first, [])
                if count == 1:
                    own.append(None)
                if own[-1] is None:
                    rest = itertools.product(model.gaits.names, repeat=count - 1)
                    hunters = (AllGaits((first, *gaits)) for gaits in rest)
                    hunts = (run_hunt(settings, each, "walled", theta, hunt_seed(seed, 0, run)) for each in hunters)
                    own[-1] = min((hunt.time for hunt in hunts if hunt.caught), default=None)
    return {
        gait: Earliest(float(np.mean([longest * step if t is None else t for t in times])), None in times)
        for gait, times in found.items()
    }


def bound(seeds: list[int], runs: int, longest: int) -> None:
    """Print the earliest capture after every first gait on both sides, and what no planner can be sooner than."""
    print("| bearing [rad] | first gait | as the prey turns [s] | to the other side [s] | mean [s] |")
    print("| --- | --- | --- | --- | --- |")
    ends = []
    for theta in _THETAS:
        here, there = (earliest(at, seeds, runs, longest) for at in (theta, _mirrored(theta)))
        means = []
        for gait, one in here.items():
            other = there[_mirrored_gait(gait)]
            mean = Earliest(0.5 * (one.time + other.time), one.is_least or other.is_least)
            means.append(mean)
            print(f"| {theta:g} | {gait} | {_said(one)} | {_said(other)} | {_said(mean)} |", flush=True)
        told = 0.5 * sum(min(part.values()).time for part in (here, there))
        ends.append((theta, min(means), told))
    print()
    for theta, least, told in ends:
        print(f"bearing {theta:g}: {told:.2f} s by one that is told the side, {_said(least)} s by any that is not")
    gaps = sum(least.time - told for _, least, told in ends)
    print(f"not to know the side costs at least {gaps:.2f} s at both, {gaps / 7:.2f} s in the mean of all 7 bearings")


def _said(end: Earliest) -> str:
    return f"{'over ' * end.is_least}{end.time:.2f}"


def _mirrored(theta: float) -> float:
    return (2 * math.pi - theta) % (2 * math.pi)


def _mirrored_gait(gait: str) -> str:
    return " ".join(_OTHER.get(word, word) for word in gait.split())
