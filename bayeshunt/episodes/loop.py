"""The hunt: sense, learn the prey, plan, act, until the catch or the time limit.

Everything random comes from one seed, split into one stream per role, so that two planners meet the same noise and the
same prey.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import replace

from bayeshunt.config.loading import load_experiment
from bayeshunt.config.plausibility import warn_of_other_motion
from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.arguments import checked_but
from bayeshunt.core.errors import unwarned
from bayeshunt.core.messages import Moment
from bayeshunt.core.protocols import TargetModel
from bayeshunt.episodes.episode import Episode
from bayeshunt.episodes.knowledge import known_to
from bayeshunt.episodes.pursuit import Pursuit, Result
from bayeshunt.episodes.recorder import Step
from bayeshunt.planners.api import Future, Plan, Planner, Situation
from bayeshunt.planners.asking import ask, check_can_plan, check_robot
from bayeshunt.planners.bounds.kinematic_limit import KinematicLimit
from bayeshunt.planners.registry import check_sections, foresight_of, info_of, model_of

__all__ = ["Result", "hunt", "run_hunt"]


@checked_but("arena")
def hunt(
    experiment: str | os.PathLike[str] | ExperimentSettings,
    planner: Planner,
    *,
    arena: str = "walled",
    theta: float = 1.0,
    seed: int = 0,
    prey_model: TargetModel | None = None,
) -> Episode:
    """Run one hunt and return all of it.

    experiment: preset name ("oses2010"), TOML path or settings. arena: one of its arenas.
    theta: bearing of the prey at the start, radians clockwise from the hunter's heading, -2 pi to 2 pi.
    seed: of the noise, the prey and the planner; any whole number >= 0.
    prey_model: what is known of the prey beforehand; by default nothing (it is copied, not changed).

    Raises InputError for an unknown arena or a seed or theta that is not a number in range.
    """
    settings = load_experiment(experiment)
    check_sections(settings.planner)
    check_can_plan(planner)
    steps: list[Step] = []
    trail: list[Moment] = []
    running = _begin(settings, planner, arena, theta, seed, prey_model)
    if (model := model_of(planner)) is not None:
        warn_of_other_motion(model.provenance, settings.robot)
    with unwarned():
        for situation, plan in _decide(running, planner):
            # The prey model goes on learning: the record keeps what was known at this decision.
            situation = replace(situation, prey_model=running.prey_model.copy())
            spent = running.trial.energy, running.trial.falls
            steps.append(
                Step.of(len(steps), running.moment, situation, plan, running.observed, spent, running.observation)
            )
            running.step(plan.gait, nodes=plan.nodes)
            trail.extend(running.moments)
    return Episode.assemble(
        steps,
        trail,
        running.result,
        settings=settings,
        planner=planner.name,
        arena=arena,
        theta=float(theta),
        seed=int(seed),
    )


def run_hunt(
    settings: ExperimentSettings, planner: Planner, arena: str, theta: float, seed: int,
    prey_model: TargetModel | None = None,
) -> Result:  # fmt: skip
    """Run one hunt and return only how it ended: the same hunt as :func:`hunt`, without the record."""
    running = _begin(settings, planner, arena, theta, seed, prey_model)
    if isinstance(planner, KinematicLimit):
        return _limit(running, planner)
    with unwarned():
        for _, plan in _decide(running, planner):
            running.step(plan.gait, nodes=plan.nodes)
    return running.result


def _begin(
    settings: ExperimentSettings, planner: Planner, arena: str, theta: float, seed: int, prey_model: TargetModel | None
) -> Pursuit:
    check_can_plan(planner, named=False)  # an evaluation knows it by the name it is registered under
    running = Pursuit(
        settings,
        arena,
        theta,
        seed,
        prey_model=prey_model,
        foresight=foresight_of(planner),
        known=known_to(planner),
        told=not info_of(planner).ab_initio,
    )
    check_robot(planner, running.gaits, settings.robot.name)
    return running


def _decide(running: Pursuit, planner: Planner) -> Iterator[tuple[Situation, Plan]]:
    """Yield every situation and the plan for it, which whoever asks carries out."""
    gaits, rng = running.gaits, running.rng
    while not running.done:
        situation = running.situation
        yield situation, ask(planner, situation, rng, gaits)


def _limit(running: Pursuit, bound: KinematicLimit) -> Result:
    """Return the result of a bound that is computed from the start of the hunt instead of run."""
    trial, settings = running.trial, running.trial.settings
    limit, speed = settings.protocol.time_limit, settings.robot.top_speed
    time = bound.capture_time(Future(*trial.future(limit)), speed, trial.reach.distance)
    caught = time <= limit
    time = min(time, limit)
    return Result(caught, time, 0, 0, speed * time)
