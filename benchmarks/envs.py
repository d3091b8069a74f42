"""What stepping a hunt costs over running its world: ``python -m benchmarks.envs [--json] [--seed 0] [--rounds 20]``.

The same hunts of preset "paper", the same gaits by chance, five ways: the bare ``World.run`` of their gaits; the trial,
which adds the catch, the clock and the way travelled; the step API (``Pursuit.step``); the step API whose situation is
asked for before every step, which adds perception: sensor, belief, the prey's table; the environment, which adds
observation, reward and info. Every hunt is run all five ways, one right after the other and in another order each time,
and beside them go steps of Gymnasium's LunarLander, each of which is one Box2D step (extra ``bench``). Each part takes
some 10 us when called over and over; after a third of a millisecond of physics it finds the processor's caches cold and
takes several times that. Last what imports cost in fresh processes.

All in processor time: means over the rounds, and their standard errors, of ratios within a round.
"""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from bayeshunt.config.loading import load_experiment
from bayeshunt.core.messages import Reach
from bayeshunt.core.streams import spawn_streams
from bayeshunt.envs import HuntEnv
from bayeshunt.episodes.pursuit import Pursuit
from bayeshunt.episodes.trial import Trial
from bayeshunt.worlds.box2d.world import Box2DWorld
from bayeshunt.worlds.scene import Scene
from benchmarks.command import command, show

ROUNDS, HUNTS, LANDER_STEPS = 20, 12, 150
IMPORTS = ("numpy", "gymnasium", "bayeshunt", "bayeshunt.envs", "bayeshunt.envs.gym")
SETTINGS = load_experiment("paper")


def chosen(seed: int) -> list[tuple[float, int, list[int]]]:
    """Bearing, seed and gaits of every hunt."""
    rng = np.random.default_rng(seed)
    gaits = len(SETTINGS.robot.gaits)
    return [(float(n % 7), seed + n, rng.integers(gaits, size=19).tolist()) for n in range(HUNTS)]


def bare(arena: str, theta: float, seed: int) -> tuple[Callable[[int], bool], Callable[[], int]]:
    """The world alone: what takes a step and says whether that was the end, and what counts physics steps."""
    scene = Scene(SETTINGS.robot, SETTINGS.prey, SETTINGS.arenas[arena], SETTINGS.physics)
    world, robot, limit = Box2DWorld(scene), SETTINGS.robot, SETTINGS.protocol.time_limit
    hunter, prey = SETTINGS.starting_poses(theta)
    world.reset({"hunter": hunter, "prey": prey}, spawn_streams(seed))
    reach = Reach("hunter", "prey", SETTINGS.protocol.catch_distance * robot.body.body_length)

    def step(gait: int) -> bool:
        run = world.run({"hunter": robot.gaits.gaits[gait]}, min(robot.gait_duration, limit - world.time), reach)
        return run.stopped is not None or not world.time < limit - 1e-9

    return step, lambda: round(world.time / SETTINGS.physics.step)


def trial(arena: str, theta: float, seed: int) -> tuple[Callable[[int], bool], Callable[[], int]]:
    """With the catch and the clock."""
    one = Trial(SETTINGS, arena, theta, spawn_streams(seed))
    gaits = SETTINGS.robot.gaits.gaits

    def step(gait: int) -> bool:
        one.step(gaits[gait])
        return one.done

    return step, lambda: round(one.moment.time / SETTINGS.physics.step)


def step_api(arena: str, theta: float, seed: int) -> tuple[Callable[[int], bool], Callable[[], int]]:
    """Whoever steps and asks nothing."""
    one = Pursuit(SETTINGS, arena, theta, seed)

    def step(gait: int) -> bool:
        one.step(gait)
        return one.done

    return step, lambda: round(one.moment.time / SETTINGS.physics.step)


def looking(arena: str, theta: float, seed: int) -> tuple[Callable[[int], bool], Callable[[], int]]:
    """Whoever asks for the situation after every step."""
    one = Pursuit(SETTINGS, arena, theta, seed)
    _ = one.situation

    def step(gait: int) -> bool:
        one.step(gait)
        _ = one.situation
        return one.done

    return step, lambda: round(one.moment.time / SETTINGS.physics.step)


def environment(arena: str, theta: float, seed: int) -> tuple[Callable[[int], bool], Callable[[], int]]:
    """All of it."""
    env = HuntEnv(arena=arena, preset="paper")
    env.reset(options={"theta": theta, "hunt_seed": seed})

    def step(gait: int) -> bool:
        _, _, terminated, truncated, _ = env.step(gait)
        return terminated or truncated

    return step, lambda: round(env.moments[-1].time / SETTINGS.physics.step)


WAYS = {"bare": bare, "trial": trial, "step_api": step_api, "situation": looking, "environment": environment}


def seconds(way: Any, arena: str, hunt: tuple[float, int, list[int]]) -> tuple[float, int, int]:
    """Processor seconds of all steps of a hunt, how many gaits, and how many physics steps they were."""
    theta, seed, wanted = hunt
    step, count = way(arena, theta, seed)
    gaits, begun = 0, time.process_time()
    for gait in wanted:
        gaits += 1
        if step(gait):
            break
    return time.process_time() - begun, gaits, count()


class Lander:
    """Gymnasium's LunarLander with actions by chance."""

    def __init__(self, seed: int) -> None:
        import gymnasium

        self._env = gymnasium.make("LunarLander-v3")
        self._env.reset(seed=seed)
        self._rng = np.random.default_rng(seed)

    @classmethod
    def made(cls, seed: int) -> Lander | None:
        """None where it is not installed."""
        import gymnasium

        try:
            return cls(seed)
        except gymnasium.error.DependencyNotInstalled:
            return None

    def seconds(self) -> float:
        """Processor seconds of a few steps; what a new episode takes is not among them."""
        taken = 0.0
        for action in self._rng.integers(4, size=LANDER_STEPS).tolist():
            begun = time.process_time()
            _, _, terminated, truncated, _ = self._env.step(action)
            taken += time.process_time() - begun
            if terminated or truncated:
                self._env.reset()
        return taken


def imported(name: str) -> float:
    """Processor seconds of an import in a fresh process."""
    code = f"import time; begun = time.process_time(); import {name}; print(time.process_time() - begun)"
    return float(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout)


def timed(
    arena: str, hunts: list[Any], lander: Lander | None, rng: np.random.Generator
) -> tuple[dict[str, float], int, int]:
    """One round: processor seconds by way, and of the lander's steps; gaits and physics steps of each way."""
    taken = dict.fromkeys((*WAYS, "lander"), 0.0)
    gaits = steps = 0
    for hunt in hunts:
        for name in rng.permutation(list(taken)).tolist():  # by chance: what ran before leaves its caches
            if name in WAYS:
                spent, executed, physics = seconds(WAYS[name], arena, hunt)
                taken[name] += spent
            elif lander is not None:
                taken[name] += lander.seconds()
        gaits, steps = gaits + executed, steps + physics
    return taken, gaits, steps


def mean(values: Any) -> tuple[float, float]:
    """Mean and its standard error."""
    return float(np.mean(values)), float(np.std(values, ddof=1) / np.sqrt(len(values)))


def measure(seed: int, rounds: int) -> dict[str, Any]:
    """Means over the rounds, with their standard errors."""
    hunts, lander, rng = chosen(seed), Lander.made(seed), np.random.default_rng(seed)
    rows = []
    for arena in SETTINGS.arenas:
        timed(arena, hunts, lander, rng)  # the first round is not counted
        found = [timed(arena, hunts, lander, rng) for _ in range(rounds)]
        _, gaits, steps = found[0]
        times = {name: np.array([taken[name] for taken, _, _ in found]) for name in (*WAYS, "lander")}
        row: dict[str, Any] = {"arena": arena, "gaits": gaits, "physics_steps": steps}
        row |= {f"{name}_us": mean(1e6 * times[name] / gaits)[0] for name in WAYS}
        row |= {f"{name}_over_bare": mean(times[name] / times["bare"] - 1.0) for name in WAYS if name != "bare"}
        if lander is not None:
            each = times["lander"] / (LANDER_STEPS * HUNTS)
            row["lander_us"] = 1e6 * mean(each)[0]
            row |= {f"{name}_times_lander": mean(each * steps / times[name]) for name in WAYS}
        rows.append(row)
    cost = {name: float(np.median([imported(name) for _ in range(5)])) for name in IMPORTS}
    return {"seed": seed, "rounds": rounds, "hunts": HUNTS, "rows": rows, "import_s": cost}


def report(facts: dict[str, Any]) -> str:
    """The figures as text."""
    lines = [f"A gait of a hunt, processor time: {facts['hunts']} hunts, means of {facts['rounds']} rounds"]
    for row in facts["rows"]:
        lines.append(f"  {row['arena']}: {row['gaits']} gaits, {row['physics_steps']} physics steps")
        for name in WAYS:
            over, landers = row.get(f"{name}_over_bare"), row.get(f"{name}_times_lander")
            line = f"    {name.replace('_', ' '):12} {row[f'{name}_us']:4.0f} us"
            line += " " * 18 if over is None else f"   {over[0]:+6.1%} +- {over[1]:.1%}"
            if landers is not None:
                line += f"   {landers[0]:.2f} +- {landers[1]:.2f} times LunarLander's physics steps"
            lines.append(line)
        if "lander_us" in row:
            lines.append(f"    a step of LunarLander {row['lander_us']:.1f} us")
    told = ", ".join(f"{name} {1e3 * cost:.0f} ms" for name, cost in facts["import_s"].items())
    return "\n".join([*lines, f"Imports, processor time: {told}"])


def main() -> None:
    """Run and print."""
    parser = command(__doc__)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    options = parser.parse_args()
    facts = measure(options.seed, options.rounds)
    show(facts, report, options)


if __name__ == "__main__":
    main()
