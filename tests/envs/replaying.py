"""Hunts of every planner, run again gait by gait in the environment: the same poses, to the last bit.

The tests take a part of it. As a script it takes all, 50 seeds with wheels and 5 with legs, and counts:
``python tests/envs/replaying.py [--wheels 50] [--legs 5] [--robot NAME ...]`` (some minutes of processor time).
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Iterator
from functools import cache
from typing import Any, NamedTuple

import numpy as np

import bayeshunt as bh
from bayeshunt.envs import HuntEnv
from bayeshunt.experiments.preparation import learn_rooms, prepare_planner

ROWS = 400
#: It has no gaits: it is worked out from where a hunt starts.
NO_HUNTER = "kinematic_limit"


class Case(NamedTuple):
    """A robot and the experiment it hunts in."""

    preset: str
    robot: str
    legs: bool = False


CASES = {
    case.robot: case
    for case in (
        Case("paper", "khepera"),
        Case("paper", "car"),
        Case("oses2010", "khepera_oses2010"),
        Case("legs", "hexapod_mixed", legs=True),
        Case("legs", "hexapod", legs=True),
        Case("legs", "quadruped", legs=True),
        Case("legs", "puppy", legs=True),
    )
}
ARENAS = ("open", "walled")
PLANNERS = tuple(name for name in bh.planner_names() if name != NO_HUNTER)


@cache
def settings(robot: str) -> bh.ExperimentSettings:
    """The experiment of a case."""
    case = CASES[robot]
    return bh.load_experiment(case.preset, {"robot": robot, "model.babbling_steps": ROWS})


@cache
def model(robot: str) -> bh.ForwardModel:
    """What the robot knows of its body."""
    return bh.ForwardModel.fit(bh.babble(robot, ROWS, 0), bh.load_robot(robot).gaits)


@cache
def given(planner: str, robot: str) -> dict[str, Any]:
    """A coarse table for a planner that needs one: exact values are not needed, the same ones are."""
    if planner == "reference":
        return {"table": bh.reference(settings(robot), samples=2, angles=12, headings=12)}
    return {"tables": bh.remember(settings(robot), runs=1, seed=11, model=model(robot))} if "memory" in planner else {}


def prepared(planner: str, robot: str, arena: str) -> Any:
    """A planner, ready to hunt."""
    mine = settings(robot).planner.get(planner, {})
    chosen = settings(robot).model_copy(update={"planner": {planner: {**mine, **given(planner, robot)}}})
    rooms = learn_rooms(
        chosen.model_copy(update={"model": chosen.model.model_copy(update={"exploring_steps": 100})}),
        [planner], [arena], 0, model(robot),
    )  # fmt: skip
    return prepare_planner(planner, model(robot), chosen, rooms, arena)


def replayed(env: HuntEnv, whole: Any, robot: str, theta: float, seed: int) -> None:
    """Execute the gaits of an episode in the environment; AssertionError where anything differs."""
    moments, ended = [], False
    env.reset(options={"theta": theta, "hunt_seed": seed})
    for gait in whole.frame["gait"]:
        assert not ended
        *_, terminated, truncated, info = env.step(settings(robot).robot.gaits.names.index(gait))
        moments.extend((moment.time, *moment.poses["hunter"], *moment.poses["prey"]) for moment in env.moments)
        ended = terminated or truncated
    assert ended
    assert (info["is_success"], info["time"]) == (whole.caught, whole.time)
    np.testing.assert_array_equal(np.array(moments), whole.trail.to_numpy())


def replay(robot: str, arena: str, planner: str, seeds: Iterable[int]) -> Iterator[int]:
    """Hunt and replay with each seed, one after the other; yield the seeds that were alike."""
    env = HuntEnv(arena=arena, robot=robot, preset=CASES[robot].preset)
    hunter = prepared(planner, robot, arena)
    for seed in seeds:
        theta = float(seed % 7)
        whole = bh.hunt(settings(robot), hunter, arena=arena, theta=theta, seed=seed)
        replayed(env, whole, robot, theta, seed)
        yield seed


def main() -> None:
    """Replay all, and say how many hunts were the same."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--wheels", type=int, default=50, help="seeds of a robot on wheels")
    parser.add_argument("--legs", type=int, default=5, help="seeds of a robot with legs")
    parser.add_argument("--robot", action="append", choices=list(CASES))
    options = parser.parse_args()
    total = 0
    for robot in options.robot or CASES:
        for arena in ARENAS:
            count = options.legs if CASES[robot].legs else options.wheels
            same = sum(len(list(replay(robot, arena, planner, range(count)))) for planner in PLANNERS)
            total += same
            print(f"{robot:18} {arena:7} {len(PLANNERS)} planners, {count} seeds: {same} hunts alike", flush=True)
    print(f"{total} hunts, all alike")


if __name__ == "__main__":
    main()
