"""The hunt: sense, learn the prey, plan, act, until the catch or the time limit.

The first room that sees both the world and the minds. Everything random comes from one seed,
split into one stream per role, so that two planners meet the same noise and the same prey.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

from bayeshunt.config.loading import load_experiment
from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.checks import check_kind, check_radians, check_whole
from bayeshunt.core.messages import Moment, Run
from bayeshunt.core.protocols import TargetModel
from bayeshunt.core.streams import spawn_streams
from bayeshunt.episodes.episode import Episode
from bayeshunt.episodes.hunter import Hunter
from bayeshunt.episodes.recorder import Step
from bayeshunt.episodes.trial import Trial
from bayeshunt.models.target.registry import make_prey_model
from bayeshunt.perception.registry import make_sensor, make_tracker
from bayeshunt.perception.setting import PerceptionContext
from bayeshunt.planners.api import Future, Planner
from bayeshunt.planners.asking import check_can_plan, check_robot
from bayeshunt.planners.bounds.kinematic_limit import KinematicLimit
from bayeshunt.planners.registry import check_sections, foresight_of
from bayeshunt.worlds.scene import HUNTER, PREY

__all__ = ["Result", "hunt", "run_hunt"]


class Result(NamedTuple):
    """How a hunt ended.

    caught: whether the prey was caught. time: seconds to the catch, the time limit if missed.
    decisions: gaits chosen. transitions: changes of gait. distance: metres travelled by the
    hunter, as the sum of straight lines between decisions.
    """

    caught: bool
    time: float
    decisions: int
    transitions: int
    distance: float


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
    check_robot(planner, settings.robot.gaits, settings.robot.name)
    steps: list[Step] = []
    trail: list[Moment] = []
    running = _Hunt(settings, planner, arena, theta, seed, prey_model, trail)
    hunter = running.hunter
    for moment in running.decide():
        assert hunter.situation is not None  # it has just decided
        assert hunter.plan is not None
        # The prey model goes on learning: the record keeps what was known at this decision.
        situation = replace(hunter.situation, prey_model=hunter.prey_model.copy())
        steps.append(Step.of(len(steps), moment, situation, hunter.plan, hunter.observed))
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
    running = _Hunt(settings, planner, arena, theta, seed, prey_model, None)
    if isinstance(planner, KinematicLimit):
        return running.limit(planner)
    for _ in running.decide():
        pass
    return running.result


class _Hunt:
    """One hunt in progress: a trial in a world, what the hunter perceives of it, and who decides."""

    def __init__(
        self, settings: ExperimentSettings, planner: Planner, arena: str, theta: float, seed: int,
        prey_model: TargetModel | None, trail: list[Moment] | None,
    ) -> None:  # fmt: skip
        _check(settings, arena, theta, seed, prey_model)
        self.settings, self.planner, self.trail = settings, planner, trail
        streams = spawn_streams(seed)
        self.trial = Trial(settings, arena, float(theta), streams)
        gaits, sensing = settings.robot.gaits, settings.sensing
        context = PerceptionContext(
            gaits.duration, gaits.body_length, settings.prey.body.diameter, self.trial.start, HUNTER, PREY
        )
        self.sensor = make_sensor(sensing.sensor, context, sensing.sensor_settings)
        self.hunter = Hunter(
            planner, sensing=make_tracker(sensing.tracker, context, sensing.tracker_settings), gaits=gaits,
            prey_model=make_prey_model(settings.prey.model, _prey_axes(settings)) if prey_model is None else prey_model,
            task=self.trial.task, streams=streams,
        )  # fmt: skip
        self._rng = streams["sensor"]
        self.changes = 0

    @property
    def result(self) -> Result:
        """How the hunt ended (or stands)."""
        trial = self.trial
        return Result(trial.caught, trial.time, self.hunter.steps, self.changes, trial.distance)

    def decide(self) -> Iterator[Moment]:
        """Take every decision; yield the moment of each before it is carried out."""
        trial, hunter, sensor = self.trial, self.hunter, self.sensor
        foresight, world_map, rng = foresight_of(self.planner), trial.world.map, self._rng
        run = Run((trial.moment,))
        while not trial.done:
            before = hunter.plan
            seen = sensor.sense(run, world_map, rng=rng)
            future = Future(*trial.future(foresight)) if foresight else None
            plan = hunter.step(seen.pose, seen, trial.moment.time, future=future)
            self.changes += before is not None and plan.gait != before.gait
            yield trial.moment
            run = trial.step(hunter.gaits[plan.gait])
            if self.trail is not None:
                self.trail.extend(run.moments)

    def limit(self, bound: KinematicLimit) -> Result:
        """Return the result of a bound that is computed from the start of the hunt instead of run."""
        limit, speed = self.settings.protocol.time_limit, self.settings.robot.top_speed
        time = bound.capture_time(Future(*self.trial.future(limit)), speed, self.trial.reach.distance)
        caught = time <= limit
        time = min(time, limit)
        return Result(caught, time, 0, 0, speed * time)


def _prey_axes(settings: ExperimentSettings) -> EffectAxes:
    model = settings.model
    return EffectAxes.standard(
        settings.robot.body.body_length,
        distance_bin=model.distance_bin,
        angle_bins=model.angle_bins,
        heading_bins=model.heading_bins,
    )


def _check(settings: ExperimentSettings, arena: str, theta: float, seed: int, prey_model: TargetModel | None) -> None:
    check_whole(seed, "seed", 0)
    check_radians(theta, "theta")
    settings.check_arena(arena, theta)
    if prey_model is not None:
        check_kind(prey_model, "prey_model", TargetModel, "a PreyModel or None")
