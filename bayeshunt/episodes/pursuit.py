"""One hunt, a gait at a time: whoever calls decides. It says what the hunter knows and executes what it is told.

The hunts of this package, its environments and loops of one's own all step this one thing.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import NamedTuple

from bayeshunt.config.loading import load_experiment
from bayeshunt.config.schema import ExperimentSettings
from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.checks import check_kind, check_number, check_radians, check_whole
from bayeshunt.core.errors import InputError
from bayeshunt.core.gaits import Gait, GaitRepertoire
from bayeshunt.core.geometry import Polar
from bayeshunt.core.messages import Moment, Observation, Run
from bayeshunt.core.protocols import TargetModel
from bayeshunt.core.streams import spawn_streams
from bayeshunt.episodes.knowledge import NOTHING, Knowledge
from bayeshunt.episodes.perceiver import Perceiver
from bayeshunt.episodes.trial import Trial
from bayeshunt.models.target.registry import make_prey_model
from bayeshunt.perception.registry import make_sensor, make_tracker
from bayeshunt.perception.setting import PerceptionContext
from bayeshunt.planners.api import Future, Situation
from bayeshunt.worlds.maps import ForBody
from bayeshunt.worlds.scene import HUNTER, PREY

__all__ = ["Pursuit", "Result"]


class Result(NamedTuple):
    """How a hunt ended.

    caught: whether the prey was caught. time: seconds to the catch, the time limit if missed.
    decisions: gaits chosen. transitions: changes of gait. distance: metres travelled by the
    hunter, as the sum of straight lines between decisions. energy: joules that it spent, 0 if its body
    does not know. falls: how often it fell.
    """

    caught: bool
    time: float
    decisions: int
    transitions: int
    distance: float
    energy: float = 0.0
    falls: int = 0


class Pursuit:
    """One hunt in progress: ``while not pursuit.done: pursuit.step(choose(pursuit.situation))``.

    experiment: preset name, TOML path or settings. arena: one of its arenas. theta: bearing of the prey at the start
    [rad, clockwise], -2 pi to 2 pi. seed: of the noise, the prey and the planner; any whole number >= 0. With the same
    four, the same gaits give what :func:`bayeshunt.hunt` gives, to the last bit.
    prey_model: what is known of the prey beforehand (it is copied). foresight: seconds of the prey's true future that
    a situation holds; 0: none. known: what the tracker may know of the prey and of walls from the first look on.

    told: whether a situation holds the true map, where obstacles stand; for yardsticks.

    What the hunter perceives is worked out when somebody asks, of all steps since then and in their order: whoever only
    steps pays for physics alone, and the situation is the same.

    gaits: the hunter's repertoire. rng: what a planner draws from. moments: what the last step did, one at the end of
    each control interval. prey_model, observed: see :class:`~bayeshunt.episodes.perceiver.Perceiver`.

    Raises InputError for an unknown arena or a seed or theta that is not a number in range.
    """

    def __init__(
        self, experiment: str | os.PathLike[str] | ExperimentSettings, arena: str = "walled", theta: float = 1.0,
        seed: int = 0, *, prey_model: TargetModel | None = None, foresight: float = 0.0,
        known: Knowledge = NOTHING, told: bool = False,
    ) -> None:  # fmt: skip
        settings = load_experiment(experiment)
        _check(settings, arena, theta, seed, prey_model)
        self.gaits: GaitRepertoire = settings.robot.gaits
        streams = spawn_streams(seed)
        self.trial = Trial(settings, arena, float(theta), streams)
        check_number(foresight, "foresight", "seconds")
        self.rng, self._sensor_rng, self._foresight = streams["planner"], streams["sensor"], foresight
        sensing = settings.sensing
        context = PerceptionContext(
            self.gaits.duration, self.gaits.body_length, settings.prey.body.diameter, self.trial.start, HUNTER, PREY,
            sensing.camera, sensing.start, known.motion, known.walls, known.obstacles,
        )  # fmt: skip
        self._sensor = make_sensor(sensing.sensor, context, sensing.sensor_settings)
        self._at_end = getattr(self._sensor, "at_end", False)
        tracker = make_tracker(sensing.tracker, context, sensing.tracker_settings)
        model = (
            make_prey_model(settings.prey.model, _prey_axes(settings, self.gaits))
            if prey_model is None
            else prey_model.copy()
        )
        among, radius = settings.arenas[arena].obstacles, 0.5 * settings.robot.body.diameter
        self._perceiver = Perceiver(
            self.gaits, tracker, model, self.trial.task, rng=streams["belief"], camera=sensing.seen_by,
            map=ForBody(self.trial.world.map, self.trial.start, radius) if told and among else None,
        )  # fmt: skip
        self._run = Run((self.trial.moment,))
        self._unseen: list[tuple[Run, str]] = []  # what was not looked at yet, and the gait that followed
        self._situation: Situation | None = None
        self._previous: str | None = None
        #: Gaits executed so far.
        self.decisions = 0
        self._changes = 0

    @property
    def situation(self) -> Situation:
        """What the hunter knows now; of the time after the end too."""
        if self._situation is None:
            future = Future(*self.trial.future(self._foresight)) if self._foresight else None
            self._situation = self._perceived().consider(self._sensed(self._run), future)
        return self._situation

    def _kept(self, run: Run) -> Run:
        """What the sensor needs of a run."""
        return Run((self.trial.moment,)) if self._at_end else run

    def _sensed(self, run: Run) -> Observation:
        return self._sensor.sense(run, self.trial.world.map, rng=self._sensor_rng)

    def _perceived(self) -> Perceiver:
        """Return the perceiver, which has looked at all that was there before the last gait."""
        for run, gait in self._unseen:
            self._perceiver.consider(self._sensed(run))
            self._perceiver.execute(gait)
        self._unseen.clear()
        return self._perceiver

    def step(self, gait: str | int | Gait, prey: Gait | None = None, *, nodes: int = 0) -> None:
        """Execute a gait for one time-step, until the catch, or for what is left of the hunt.

        gait: by its name, its place in the repertoire, or itself. prey: the wheel speeds [m/s] that the prey holds
        meanwhile; None: it steers itself. nodes: how many the planner weighed; where ``protocol.thinking`` prices
        them, the gait before is held for so much of the time-step. Raises InputError for what is no gait of the robot,
        or after the end.
        """
        chosen = self.gaits.gaits[self.gaits.number(gait)]
        if self.trial.done:
            raise InputError(f"the hunt is over: {'caught' if self.caught else 'time is up'}; start another one")
        before, self._previous = self._previous, chosen.name
        self._changes += before is not None and chosen.name != before
        self.decisions += 1
        if self._situation is None:
            self._unseen.append((self._kept(self._run), chosen.name))
        else:
            self._perceiver.execute(chosen.name)
            self._situation = None
        thought = self._thought(nodes) if nodes else 0.0
        held = self.gaits[before] if thought and before is not None else None
        self._run = self.trial.step(chosen, prey, thought=thought, held=held)

    def _thought(self, nodes: int) -> float:
        """Seconds that weighing ``nodes`` takes."""
        protocol = self.trial.settings.protocol
        return 0.0 if protocol.thinking == "free" else nodes * protocol.seconds_per_node

    @property
    def done(self) -> bool:
        """Whether the prey is caught or time is up."""
        return self.trial.done

    @property
    def caught(self) -> bool:
        """Whether the prey is caught."""
        return self.trial.caught

    @property
    def time(self) -> float:
        """Seconds since the start; at the end those to the catch, the time limit if there was none."""
        return self.trial.time if self.trial.done else self.trial.moment.time

    @property
    def moment(self) -> Moment:
        """Where both robots are in the world: poses "hunter" and "prey" [m, rad]."""
        return self.trial.moment

    @property
    def moments(self) -> Sequence[Moment]:
        """What the last step did."""
        return self._run.moments

    @property
    def observation(self) -> Observation | None:
        """What the sensor has seen of the last step."""
        return self._perceived().observation

    @property
    def observed(self) -> Polar | None:
        """The prey transition that the present situation has learned, if any."""
        return self._perceived().observed

    @property
    def prey_model(self) -> TargetModel:
        """What has been learned of the prey; it goes on learning."""
        return self._perceived().prey_model

    @property
    def result(self) -> Result:
        """How the hunt ended (or stands)."""
        trial, taken = self.trial, (self.decisions, self._changes)
        return Result(trial.caught, trial.time, *taken, trial.distance, trial.energy, trial.falls)


def _prey_axes(settings: ExperimentSettings, gaits: GaitRepertoire) -> EffectAxes:
    model = settings.model
    return EffectAxes.standard(
        gaits.need("body_length"),
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
