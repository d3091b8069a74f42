"""What stepping a hunt costs over running its world: ``python -m benchmarks.envs [--json] [--seed 0]``.

The same hunts of preset "paper", the same gaits by chance, in turns four ways: the bare ``World.run`` of their gaits;
the trial, which adds the catch, the clock and the way travelled; the step API (``Pursuit``), which adds perception:
sensor, belief, the prey's table and the situation; the environment, which adds observation, reward and info. Beside
them steps of Gymnasium's LunarLander, each of which is one Box2D step (extra ``bench``), and what imports cost in fresh
processes. All in processor time; medians over the rounds, of ratios within a round. Each part takes some 10 us when
called over and over; after a third of a millisecond of physics it finds the processor's caches cold and takes several
times that.
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

ROUNDS, HUNTS, LANDER_STEPS = 9, 12, 2000
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


def pursuit(arena: str, theta: float, seed: int) -> tuple[Callable[[int], bool], Callable[[], int]]:
    """With perception."""
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


WAYS = {"bare": bare, "trial": trial, "step_api": pursuit, "environment": environment}


def seconds(way: Any, arena: str, hunts: list[tuple[float, int, list[int]]]) -> tuple[float, int, int]:
    """Processor seconds of all steps of all hunts, how many gaits, and how many physics steps they were."""
    taken, gaits, steps = 0.0, 0, 0
    for theta, seed, wanted in hunts:
        step, count = way(arena, theta, seed)
        begun = time.process_time()
        for gait in wanted:
            gaits += 1
            if step(gait):
                break
        taken += time.process_time() - begun
        steps += count()
    return taken, gaits, steps


def lander(seed: int) -> float | None:
    """Processor seconds per step of LunarLander with actions by chance; None without it."""
    import gymnasium

    try:
        env = gymnasium.make("LunarLander-v3")
    except gymnasium.error.DependencyNotInstalled:
        return None
    actions = np.random.default_rng(seed).integers(4, size=LANDER_STEPS).tolist()
    env.reset(seed=seed)
    taken = 0.0
    for action in actions:
        begun = time.process_time()
        _, _, terminated, truncated, _ = env.step(action)
        taken += time.process_time() - begun
        if terminated or truncated:
            env.reset()
    env.close()
    return taken / LANDER_STEPS


def imported(name: str) -> float:
    """Processor seconds of an import in a fresh process."""
    code = f"import time; begun = time.process_time(); import {name}; print(time.process_time() - begun)"
    return float(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout)


def measure(seed: int) -> dict[str, Any]:
    """Medians over the rounds."""
    hunts = chosen(seed)
    rows, landers = [], [lander(seed)]
    for arena in SETTINGS.arenas:
        found: dict[str, list[float]] = {name: [] for name in WAYS}
        for _ in range(ROUNDS):
            for name, way in WAYS.items():
                taken, gaits, steps = seconds(way, arena, hunts)
                found[name].append(1e6 * taken / gaits)
            landers.append(lander(seed))
        times = {name: np.array(one) for name, one in found.items()}
        row: dict[str, Any] = {"arena": arena, "gaits": gaits, "physics_steps": steps}
        row |= {f"{name}_us": float(np.median(one)) for name, one in times.items()}
        row |= {f"{name}_over_bare": float(np.median(one / times["bare"])) - 1.0 for name, one in times.items()}
        told = [one for one in landers[-ROUNDS:] if one is not None]
        row["lander_us"] = 1e6 * float(np.median(told)) if told else None
        for name in ("bare", "environment"):
            own = times[name] * 1e-6 * gaits / steps
            row[f"{name}_times_lander"] = float(np.median(np.array(told) / own)) if told else None
        rows.append(row)
    cost = {name: float(np.median([imported(name) for _ in range(5)])) for name in IMPORTS}
    return {"seed": seed, "rounds": ROUNDS, "hunts": HUNTS, "rows": rows, "import_s": cost}


def report(facts: dict[str, Any]) -> str:
    """The figures as text."""
    lines = [
        f"A gait of a hunt, processor time: {facts['hunts']} hunts, medians of {facts['rounds']} rounds [microseconds]"
    ]
    for row in facts["rows"]:
        parts = [f"bare {row['bare_us']:.0f}"]
        for name in ("trial", "step_api", "environment"):
            parts.append(f"{name.replace('_', ' ')} {row[f'{name}_us']:.0f} ({row[f'{name}_over_bare']:+.1%})")
        lines.append(f"  {row['arena']:8} " + "   ".join(parts))
        if row["lander_us"] is not None:
            each = row["environment_us"] * row["gaits"] / row["physics_steps"]
            lines.append(
                f"  {'':8} a physics step {each:.2f}, of LunarLander {row['lander_us']:.1f}: "
                f"{row['environment_times_lander']:.1f} times its steps (the bare world {row['bare_times_lander']:.1f})"
            )
    told = ", ".join(f"{name} {1e3 * cost:.0f} ms" for name, cost in facts["import_s"].items())
    return "\n".join([*lines, f"Imports, processor time: {told}"])


def main() -> None:
    """Run and print."""
    parser = command(__doc__)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    facts = measure(options.seed)
    show(facts, report, options)


if __name__ == "__main__":
    main()
