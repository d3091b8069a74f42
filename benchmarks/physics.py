"""What one physics step of a hunt costs: ``python -m benchmarks.physics [--json] [--seed 0]``.

Whole hunts of 60 s of the preset "paper", the planner left out (gaits by chance) and nobody caught, so
that every hunt has all its steps. In the same run, alternating with them, so that the ratios can be compared:

* bare ``b2World.Step``: the same two bodies in the same arena, their recorded velocities written
  before each control interval outside the time taken, so that contacts and motion are the same;
* one step of Gymnasium's LunarLander, which is one Box2D step too (extra ``bench``).
"""

from __future__ import annotations

import time
from typing import Any, NamedTuple

import Box2D
import numpy as np

from bayeshunt.config.loading import load_experiment
from bayeshunt.core.messages import Reach
from bayeshunt.core.streams import spawn_streams
from bayeshunt.worlds.box2d.world import Box2DWorld, build_walls, new_world
from bayeshunt.worlds.scene import Scene
from benchmarks.command import command, show

ROUNDS, HUNTS, LANDER_STEPS = 7, 6, 3000


class Motion(NamedTuple):
    """Recorded motion of one hunt: pose and velocity of both bodies [Box2D units] at each control interval."""

    poses: np.ndarray  # [M, 2, 3]: x, y, angle
    velocities: np.ndarray  # [M, 2, 3]: x, y, angular


#: Nobody is ever near enough to be caught.
NEVER = Reach("hunter", "prey", 1e-6)


def make_world(settings: Any, arena: str, seed: int) -> Box2DWorld:
    """A fresh world with both robots in it."""
    hunter, prey = settings.starting_poses(float(seed % 7))
    world = Box2DWorld(Scene(settings.robot, settings.prey, settings.arenas[arena], settings.physics))
    world.reset({"hunter": hunter, "prey": prey}, spawn_streams(seed))
    return world


def chosen_gaits(settings: Any, seed: int) -> list[Any]:
    """Gaits by chance for a whole hunt."""
    count = int(np.ceil(settings.protocol.time_limit / settings.robot.gait_duration))
    picked = np.random.default_rng(seed).integers(len(settings.robot.gaits), size=count)
    gaits = settings.robot.gaits
    return [gaits[int(gait)] for gait in picked]


def time_hunt(settings: Any, arena: str, seed: int) -> float:
    """Processor seconds per physics step of one hunt."""
    world, chosen = make_world(settings, arena, seed), chosen_gaits(settings, seed)
    start = time.process_time()
    for gait in chosen:
        world.run({"hunter": gait}, settings.robot.gait_duration, NEVER)
    return (time.process_time() - start) / round(world.time / settings.physics.step)


def record(settings: Any, arena: str, seed: int) -> Motion:
    """The motion of the same hunt."""
    world, poses, velocities = make_world(settings, arena, seed), [], []
    drives = tuple(world.bodies.values())
    interval = settings.physics.control_interval
    for gait in chosen_gaits(settings, seed):
        for _ in range(round(settings.robot.gait_duration / interval)):
            before = [(*d.body.position, d.body.angle) for d in drives]
            world.run({"hunter": gait}, interval, NEVER)
            poses.append(before)
            velocities.append([(*d.body.linearVelocity, d.body.angularVelocity) for d in drives])
    return Motion(np.array(poses), np.array(velocities))


def time_bare(settings: Any, arena: str, motion: Motion) -> float:
    """Processor seconds per bare ``b2World.Step`` of the same motion."""
    world, unit, physics = new_world(), settings.robot.body.diameter, settings.physics
    if settings.arenas[arena].walled:
        build_walls(world, settings.arenas[arena].width / unit, settings.arenas[arena].height / unit)
    fixture = Box2D.b2FixtureDef(shape=Box2D.b2CircleShape(radius=0.5), density=1.0, friction=0.0, restitution=0.0)
    bodies = [world.CreateDynamicBody(fixtures=fixture, allowSleep=False) for _ in range(2)]
    step, arguments = world.Step, (physics.step, physics.velocity_iterations, physics.position_iterations)
    clock, taken, count = time.process_time, 0.0, physics.control_steps
    for body, pose in zip(bodies, motion.poses[0].tolist(), strict=True):
        body.transform = (tuple(pose[:2]), pose[2])
    for velocities in motion.velocities.tolist():
        for body, (vx, vy, turn) in zip(bodies, velocities, strict=True):
            body.linearVelocity, body.angularVelocity = (vx, vy), turn
        start = clock()
        for _ in range(count):
            step(*arguments)
        taken += clock() - start
    return taken / (len(motion.velocities) * count) - clock_cost() / count


def clock_cost() -> float:
    """Seconds that reading the clock twice adds to an interval."""
    clock, costs = time.process_time, []
    for _ in range(1000):
        start = clock()
        costs.append(clock() - start)
    return float(np.median(costs))


def time_lander(seed: int) -> float | None:
    """Processor seconds per step of Gymnasium's LunarLander with actions by chance; None without Gymnasium."""
    try:
        import gymnasium
    except ImportError:
        return None
    environment = gymnasium.make("LunarLander-v3").unwrapped
    actions = np.random.default_rng(seed).integers(4, size=LANDER_STEPS).tolist()
    environment.reset(seed=seed)
    taken = 0.0
    for action in actions:
        start = time.process_time()
        ended = environment.step(action)[2]
        taken += time.process_time() - start
        if ended:
            environment.reset()
    environment.close()
    return taken / LANDER_STEPS


def measure(seed: int) -> dict[str, Any]:
    """Least time per step over the rounds, in microseconds, and the ratios; hunts and peers alternate."""
    settings = load_experiment("paper")
    arenas = list(settings.arenas)
    motions = {(a, s): record(settings, a, s) for a in arenas for s in range(seed, seed + HUNTS)}
    hunts: dict[str, list[float]] = {a: [] for a in arenas}
    bare: dict[str, list[float]] = {a: [] for a in arenas}
    lander = []
    for _ in range(ROUNDS):
        for arena in arenas:
            hunts[arena].append(np.mean([time_hunt(settings, arena, s) for s in range(seed, seed + HUNTS)]))
            bare[arena].append(
                np.mean([time_bare(settings, arena, motions[arena, s]) for s in range(seed, seed + HUNTS)])
            )
        lander.append(time_lander(seed))
    rows = []
    for arena in arenas:
        ours, least = 1e6 * min(hunts[arena]), 1e6 * min(bare[arena])
        row = {"arena": arena, "hunt_us": ours, "bare_us": least, "times_bare": ours / least}
        peer = None if lander[0] is None else 1e6 * min(lander)
        rows.append({**row, "lander_us": peer, "times_lander": None if peer is None else ours / peer})
    return {"seed": seed, "rounds": ROUNDS, "hunts": HUNTS, "rows": rows}


def report(facts: dict[str, Any]) -> str:
    """The figures as text."""
    lines = ["One physics step of a hunt, planner left out [microseconds of processor time, least of the rounds]"]
    for row in facts["rows"]:
        lander = "LunarLander not installed (extra bench)" if row["lander_us"] is None else (
            f"LunarLander {row['lander_us']:.1f} (ours is {row['times_lander']:.2f} of it)"
        )  # fmt: skip
        lines.append(
            f"  {row['arena']:8} {row['hunt_us']:6.2f}   bare b2World.Step {row['bare_us']:5.2f}   "
            f"ratio {row['times_bare']:.2f}   {lander}"
        )
    return "\n".join(lines)


def main() -> None:
    """Run and print."""
    parser = command(__doc__)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    facts = measure(options.seed)
    show(facts, report, options)


if __name__ == "__main__":
    main()
