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
from bayeshunt.core.geometry import Polar, in_frame
from bayeshunt.core.messages import Moment
from bayeshunt.core.streams import spawn_streams
from bayeshunt.episodes.episode import Episode, Step
from bayeshunt.episodes.trial import Trial
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.planners.api import Future, Plan, Planner, Situation
from bayeshunt.planners.asking import ask, check_can_plan, check_robot
from bayeshunt.planners.bounds.kinematic_limit import KinematicLimit
from bayeshunt.planners.registry import check_sections, foresight_of


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
    prey_model: PreyModel | None = None,
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
    trial = _Hunt(settings, arena, theta, seed, prey_model, trail)
    for situation, plan, moment, observed in trial.decide(planner):
        # The prey model goes on learning: the record keeps what was known at this decision.
        situation = replace(situation, prey_model=trial.prey_model.copy())
        steps.append(Step.of(len(steps), moment, situation, plan, observed))
    return Episode.assemble(
        steps,
        trail,
        trial.result,
        settings=settings,
        planner=planner.name,
        arena=arena,
        theta=float(theta),
        seed=int(seed),
    )


def run_hunt(
    settings: ExperimentSettings, planner: Planner, arena: str, theta: float, seed: int,
    prey_model: PreyModel | None = None,
) -> Result:  # fmt: skip
    """Run one hunt and return only how it ended: the same hunt as :func:`hunt`, without the record."""
    trial = _Hunt(settings, arena, theta, seed, prey_model, None)
    if isinstance(planner, KinematicLimit):
        return trial.limit(planner)
    for _ in trial.decide(planner):
        pass
    return trial.result


class _Hunt:
    """One hunt in progress."""

    def __init__(
        self, settings: ExperimentSettings, arena: str, theta: float, seed: int,
        prey_model: PreyModel | None, trail: list[Moment] | None,
    ) -> None:  # fmt: skip
        _check(settings, arena, theta, seed, prey_model)
        self.settings = settings
        self.trail = trail
        streams = spawn_streams(seed)
        self.rng = streams["planner"]
        self.prey_model = prey_model.copy() if prey_model is not None else PreyModel(_prey_axes(settings))
        self.trial = Trial(settings, arena, float(theta), streams)
        self.transitions = self.decisions = 0

    @property
    def result(self) -> Result:
        """How the hunt ended (or stands)."""
        trial = self.trial
        return Result(trial.caught, trial.time, self.decisions, self.transitions, trial.distance)

    def decide(self, planner: Planner) -> Iterator[tuple[Situation, Plan, Moment, Polar | None]]:
        """Yield each decision: the situation, the plan, the poses, and the prey transition just observed."""
        trial, robot = self.trial, self.settings.robot
        gaits = robot.gaits
        previous_gait = None
        foresight = foresight_of(planner)
        previous: Moment | None = None
        transitions: tuple[Polar, ...] = ()
        while not trial.done:
            moment = trial.moment
            observed = self._observe(previous, moment)
            if observed is not None:
                transitions = (*transitions, observed)
            hunter = moment.poses["hunter"]
            situation = Situation(
                prey=hunter.relative(moment.poses["prey"]), prey_model=self.prey_model,
                body_length=robot.body.diameter, time=moment.time, step=self.decisions,
                previous_gait=previous_gait, time_step=robot.gait_duration,
                transitions=transitions, pose=in_frame(hunter, trial.start), task=trial.task,
                future=Future(*trial.future(foresight)) if foresight else None,
            )  # fmt: skip
            plan = ask(planner, situation, self.rng, gaits)
            yield situation, plan, moment, observed
            self.decisions += 1
            self.transitions += previous_gait is not None and plan.gait != previous_gait
            previous, previous_gait = moment, plan.gait
            run = trial.step(gaits[plan.gait])
            if self.trail is not None:
                self.trail.extend(run.moments)

    def limit(self, bound: KinematicLimit) -> Result:
        """Return the result of a bound that is computed from the start of the hunt instead of run."""
        limit, speed = self.settings.protocol.time_limit, self.settings.robot.top_speed
        time = bound.capture_time(Future(*self.trial.future(limit)), speed, self.trial.reach.distance)
        caught = time <= limit
        time = min(time, limit)
        return Result(caught, time, 0, 0, speed * time)

    def _observe(self, previous: Moment | None, moment: Moment) -> Polar | None:
        """Learn the prey's last transition, in its own earlier frame."""
        if previous is None:
            return None
        transition = previous.poses["prey"].relative(moment.poses["prey"])
        self.prey_model.observe(transition)
        return transition


def _prey_axes(settings: ExperimentSettings) -> EffectAxes:
    model = settings.model
    return EffectAxes.standard(
        settings.robot.body.diameter,
        distance_bin=model.distance_bin,
        angle_bins=model.angle_bins,
        heading_bins=model.heading_bins,
    )


def _check(settings: ExperimentSettings, arena: str, theta: float, seed: int, prey_model: PreyModel | None) -> None:
    check_whole(seed, "seed", 0)
    check_radians(theta, "theta")
    settings.check_arena(arena, theta)
    if prey_model is not None:
        check_kind(prey_model, "prey_model", PreyModel, "a PreyModel or None")
