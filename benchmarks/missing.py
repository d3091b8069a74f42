"""What a hunter would have to know to be as soon as its bound: three interventions.

``python -m benchmarks.missing side [--runs 4] [--seed 1000 ...]``: preset oses2010, walled, the bearings at which the
prey sets out head on to a wall. Every gait is tried as the first one, ``intercept_walls`` goes on; beside it the same
in the mirrored world, in which the prey turns to the other side. A hunter that does not know the side gets the mean.

``python -m benchmarks.missing bound [--runs 1] [--seed 1000 ...] [--gaits 4]``: the same, and after the first gait the
best of all sequences, as if all were known from then on: no planner that is not told the side can be sooner.

``python -m benchmarks.missing noise [--runs 16] [--samples 48] [--seed 1000 ...]``: preset slippery, open. Value
iteration over the relative pose, told the motion of both robots, of one, or of none: then the hunter's own is its
forward model's, and the prey is believed to move as the hunter's fastest straight gait does, at 0.9 of its speed, until
it has been seen.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np

from bayeshunt.config.loading import load_experiment
from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.episodes.loop import run_hunt
from bayeshunt.experiments.protocol import hunt_seed, learn_model
from bayeshunt.experiments.studies.references import reference
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.api import Plan, Planner, Situation
from bayeshunt.planners.bounds.relative import Chase, Grid, expected_times, solve
from bayeshunt.planners.interception.homing import CHASE_SHARE
from bayeshunt.planners.interception.intercept import InterceptPlanner
from bayeshunt.planners.interception.lookahead import gait_paths
from bayeshunt.planners.search.rollouts import Outcomes
from benchmarks.sides import bound, side


def believed(model: ForwardModel, reach: float, samples: int) -> Chase:
    """Return the motion of both robots as a hunter believes it to be that has only babbled."""
    paths, drawn = gait_paths(model), Outcomes.draw(model, 2, samples, 1, 0)
    share = np.arange(1, paths.shape[1] + 1) / paths.shape[1]

    def sampled(step: int) -> np.ndarray:
        ends = np.stack([part[0, step].T for part in (drawn.forward, drawn.right, drawn.heading)], axis=-1)  # [G, S, 3]
        off = ends - paths[:, None, -1]
        off[..., 2] = np.pi - np.mod(np.pi - off[..., 2], 2.0 * np.pi)
        return paths[:, None] + share[:, None] * off[:, :, None]  # [G, S, P, 3]

    ran, turned = np.hypot(*paths[:, -1, :2].T), np.abs(paths[:, -1, 2])
    fastest = int(np.where(turned < 0.4, ran, 0.0).argmax())
    prey = sampled(1)[fastest] * [CHASE_SHARE, CHASE_SHARE, 1.0]
    duration = model.gaits.need("duration")
    return Chase(sampled(0), prey, duration, reach, (1.0 - CHASE_SHARE) * float(ran[fastest]) / duration)


class ValueIteration:
    """The gait of least expected time of capture; ``learns``: whether the prey's speed is that seen in the hunt."""

    name = "value_iteration"

    def __init__(self, model: ForwardModel, chase: Chase, learns: bool) -> None:
        body = model.gaits.need("body_length")
        distances = np.concatenate([np.arange(0.918, 7.0, 0.5), np.arange(7.0, 24.5, 1.5)]) * body
        self.chase, self.grid, self.learns = chase, Grid(distances, 24, 24), learns
        self.values, self.hunter = solve(chase, self.grid, tolerance=0.05), InterceptPlanner(model)

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Return the gait of least expected time."""
        chase, hunter = self.chase, self.hunter
        if self.learns and situation.transitions:
            pace = hunter.prey(situation).speed / hunter.prior.prior_speed
            chase = replace(chase, prey=chase.prey * [pace, pace, 1.0])
        times = expected_times(chase, self.grid, self.values, np.array([float(part) for part in situation.prey]))
        return Plan(hunter.gaits[int(times.argmin())])


def noise(seeds: list[int], runs: int, samples: int) -> None:
    """Print how value iteration fares by what it is told."""
    settings = load_experiment("slippery", {"protocol.runs": 1})
    told = reference(settings, samples=samples, angles=24, headings=24).chase
    print("| told | caught | mean time [s] | above the first [s] |\n| --- | --- | --- | --- |")
    first = None
    for what in ("both robots' motion", "the prey's motion", "the hunter's motion", "nothing"):
        ends = []
        for seed in seeds:
            model = learn_model(settings, seed)
            chase = believed(model, told.reach, samples)
            if what.startswith(("both", "the hunter")):
                chase = replace(chase, hunter=told.hunter)
            knows_prey = what.startswith(("both", "the prey"))
            if knows_prey:
                chase = replace(chase, prey=told.prey, closing=told.closing)
            ends += hunted(settings, ValueIteration(model, chase, not knows_prey), seed, runs)
        times = np.array([time for time, _ in ends])
        first = times if first is None else first
        gap = times - first
        print(
            f"| {what} | {sum(caught for _, caught in ends)}/{len(ends)} | {times.mean():.2f} | "
            f"{gap.mean():+.2f} ± {gap.std() / len(gap) ** 0.5:.2f} |", flush=True,
        )  # fmt: skip


def hunted(settings: ExperimentSettings, planner: Planner, seed: int, runs: int) -> list[tuple[float, bool]]:
    """Return (time, caught) of every hunt in the open with one seed."""
    found = []
    for run in range(runs):
        for index, theta in enumerate(settings.protocol.thetas):
            end = run_hunt(settings, planner, "open", theta, hunt_seed(seed, index, run))
            found.append((end.time, bool(end.caught)))
    return found


def main() -> None:
    """Hunt and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("side", "bound", "noise"))
    parser.add_argument("--runs", type=int, help="per bearing and seed; by default 4 (side), 1 (bound) or 16 (noise)")
    parser.add_argument("--seed", type=int, action="append", help="by default 1000 and 1001; bound: 1000")
    parser.add_argument("--samples", type=int, default=48, help="sampled paths of each gait and of the prey (48)")
    parser.add_argument("--gaits", type=int, default=4, help="bound: of the longest sequences that are run (4)")
    given = parser.parse_args()
    seeds = given.seed or ([1000] if given.what == "bound" else [1000, 1001])
    if given.what == "side":
        side(seeds, given.runs or 4)
    elif given.what == "bound":
        bound(seeds, given.runs or 1, given.gaits)
    else:
        noise(seeds, given.runs or 16, given.samples)


if __name__ == "__main__":
    main()
