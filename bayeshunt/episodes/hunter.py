"""The hunter's mind, one decision at a time: for the hunts of this package and for a loop of one's own.

A planner and what a hunter knows between two decisions. The world is outside: whoever owns it says where the hunter is
and what it sees, and executes the gait of the plan.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from bayeshunt.config.plausibility import warn_of_mixed_motion
from bayeshunt.config.schema.camera import CAMERAS
from bayeshunt.config.schema.sensing import SensingSettings
from bayeshunt.core.arguments import checked
from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.checks import check_whole
from bayeshunt.core.errors import InputError, shown
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.core.geometry import Pose
from bayeshunt.core.messages import Detection, Observation
from bayeshunt.core.protocols import TargetModel, Tracker
from bayeshunt.core.streams import spawn_streams
from bayeshunt.core.task import Task
from bayeshunt.episodes.knowledge import known_to
from bayeshunt.episodes.perceiver import Perceiver
from bayeshunt.models.target.registry import COUNTS, is_prey_model, make_prey_model
from bayeshunt.perception.registry import make_tracker
from bayeshunt.perception.setting import PerceptionContext
from bayeshunt.planners.api import Future, Plan, Planner
from bayeshunt.planners.asking import ask, check_can_plan, check_robot

if TYPE_CHECKING:
    from bayeshunt.models.body.forward import ForwardModel

__all__ = ["Hunter"]

#: Trackers that go with a camera.
_OF_CAMERAS = ("particles", "kalman")
_MAKE = 'bayeshunt.make_planner("intercept", model)'


class Hunter(Perceiver):
    """Chooses gaits in a loop of one's own: ``plan = hunter.step(own_pose, seen)``, execute ``plan.gait``, again.

    planner: one of ``make_planner``, one of your own, or a name: then ``model`` is needed.
    model: the hunter's forward model; it says the gaits, how long one is held, and the body's length. A planner of
        ``make_planner`` knows it already.
    sensing: what turns sightings into a belief: the name of a camera ("camera_narrow": particles, and a planner that
        knows what it sees), of a tracker, ``SensingSettings`` or a tracker of your own;
        None: the exact one, which believes what it is told.
    seed: of all that the planner and the tracker draw.
    prey_model: what is known of the prey beforehand (it is copied); None: nothing. task: what counts as a catch, a
        ``bayeshunt.Task``; None: 1.02 bodies. gaits: the repertoire, if neither planner nor model says it. streams:
        generators by role instead of the seed's.

    belief, prey_model, situation, plan, time [s] and steps are there to look at; ``observed`` is the prey transition
    that the last step has learned, or None; ``skipped`` counts the steps whose transition was not learned.

    Raises InputError, naming the argument, for what cannot be used.
    """

    @checked
    def __init__(
        self, planner: Planner | str, model: ForwardModel | None = None, sensing: Any = None, seed: int = 0, *,
        prey_model: TargetModel | None = None, task: Task | None = None, gaits: GaitRepertoire | None = None,
        streams: Mapping[str, np.random.Generator] | None = None,
    ) -> None:  # fmt: skip
        check_whole(seed, "seed", 0)
        self.planner = _planner(planner, model)
        repertoire = _gaits(self.planner, model, gaits)
        streams = spawn_streams(seed) if streams is None else streams
        super().__init__(
            repertoire, _tracker(sensing, repertoire, self.planner), _prey_model(prey_model, model, repertoire),
            Task() if task is None else task, rng=streams["belief"],
            camera=None if isinstance(sensing, Tracker) else _settings(sensing).seen_by,
        )  # fmt: skip
        self._rng = streams["planner"]
        self.plan: Plan | None = None

    def step(
        self, own_pose: Pose, seen: Pose | Observation | list[Detection] | None, time: float | None = None, *,
        future: Future | None = None,
    ) -> Plan:  # fmt: skip
        """Return the plan for now; its gait is taken to be executed until the next call.

        own_pose: the hunter's pose [m, rad] in any fixed counter-clockwise frame, the same in every call.
        seen: the prey's pose in that frame, whose heading may be NaN; a list of detections of one look now
        (``hunter.camera.detection_of(bearing, width_px=...)``); an Observation, of several looks; None: not seen.
        time: seconds; by default one gait's duration after the call before. A transition of the prey over another
        time (by more than a tenth) is not learned, and :meth:`explain` says so.
        future: the prey's true future, for a planner that is a bound and needs it.

        Raises InputError for a pose that is not of finite numbers, a time that does not go on, or a faulty planner.
        """
        situation = self.perceive(own_pose, seen, time, future=future)
        self.plan = ask(self.planner, situation, self._rng, self.gaits)
        self.execute(self.plan.gait)
        return self.plan

    def explain(self) -> str:
        """Return in a few lines what the last step saw, what it learned of the prey, and why it chose its gait."""
        if self.plan is None or self.belief is None:
            return "nothing yet: call step(own_pose, seen)"
        lines = [f"step {self.steps}, {self.time:g} s: {self._sighting()}", self._learning()]
        if self.skipped:
            lines.append(f"{self.skipped} of {self.steps - 1} transitions were not learned")
        lines.append(
            f"{_name(self.planner)} chose {self.plan.gait!r}: {self.plan.objective} {self.plan.value:.4g}, "
            f"{self.plan.nodes} considered"
        )
        return "\n".join(lines)

    # --- inside -------------------------------------------------------------------------------

    def _sighting(self) -> str:
        assert self.belief is not None
        if self.belief.last_seen == 0.0:
            return "the prey is seen"
        if math.isinf(self.belief.last_seen):
            return "the prey was never seen; where it is taken to be is a guess"
        return f"the prey was last seen {self.belief.last_seen:.3g} s ago"

    def _learning(self) -> str:
        if self.observed is not None:
            return f"its transition was learned, the {_ordinal(self.prey_model.observations)}"
        if self.steps == 1:
            return "no transition yet: this is the first step"
        step = self.gaits.duration
        if step is not None and not math.isclose(self._passed, step, rel_tol=0.1):
            return f"its transition was not learned: {self._passed:.4g} s have passed, a gait lasts {step:.4g} s"
        return "its transition was not learned: it was not seen, with a heading, at both ends"


def _planner(planner: Planner | str, model: ForwardModel | None) -> Planner:
    if isinstance(planner, str):
        if model is None:
            raise InputError(f"model: a planner given by name, {planner!r}, needs the hunter's forward model")
        from bayeshunt.planners.registry import make_planner  # brings every planner, and pandas

        return make_planner(planner, model)
    check_can_plan(planner, named=False)  # an evaluation knows it by the name it is registered under
    return planner


def _gaits(planner: Planner, model: ForwardModel | None, gaits: GaitRepertoire | None) -> GaitRepertoire:
    """The hunter's repertoire: as given, the model's, or the one that the planner was made for."""
    if model is not None and not isinstance(getattr(model, "gaits", None), GaitRepertoire):
        raise InputError(f"model: expected a ForwardModel, got {shown(model)}")
    own = getattr(planner, "hunter", None)
    own = own if isinstance(own, GaitRepertoire) else None
    given = gaits if gaits is not None else None if model is None else model.gaits
    if given is None:
        if own is None:
            raise InputError(
                f"model: planner {_name(planner)!r} does not say which gaits the robot has; give model= too"
            )
        return own
    check_robot(planner, given, "the hunter")
    if model is not None:
        _warn_of_another_model(planner, model)
    return given


def _warn_of_another_model(planner: Planner, model: ForwardModel) -> None:
    """Warn if the planner was made with a model of another robot of the same gaits, which moves otherwise."""
    from bayeshunt.planners.registry import model_of

    its = model_of(planner)
    if its is not None and its is not model:
        warn_of_mixed_motion(its.provenance, model.provenance, "planner")


def _prey_model(known: TargetModel | None, model: ForwardModel | None, gaits: GaitRepertoire) -> TargetModel:
    if known is None:
        return make_prey_model(COUNTS, EffectAxes.standard(gaits.body_length) if model is None else model.axes)
    if not is_prey_model(known):
        raise InputError(f"prey_model: expected a PreyModel or None, got {shown(known)}")
    return known.copy()


def _tracker(sensing: Any, gaits: GaitRepertoire, planner: Planner) -> Tracker:
    if isinstance(sensing, Tracker):
        return sensing
    settings = _settings(sensing)
    known = known_to(planner)
    context = PerceptionContext(
        time_step=gaits.duration, body_length=gaits.body_length, camera=settings.camera, start=settings.start,
        motion=known.motion, walls=known.walls, obstacles=known.obstacles,
    )  # fmt: skip
    return make_tracker(settings.tracker, context, settings.tracker_settings)


def _settings(sensing: Any) -> SensingSettings:
    """Settings by the name of a camera or of a tracker; those of a camera see by its defaults."""
    if isinstance(sensing, str):
        if sensing in CAMERAS:
            return SensingSettings(preset=sensing)
        return SensingSettings(sensor="camera" if sensing in _OF_CAMERAS else "exact", tracker=sensing)
    settings = SensingSettings() if sensing is None else sensing
    if not isinstance(settings, SensingSettings):
        raise InputError(
            f"sensing: expected the name of a camera or a tracker, SensingSettings or a Tracker, got {shown(sensing)}"
        )
    return settings


def _name(planner: Planner) -> str:
    return str(getattr(planner, "name", type(planner).__name__))


def _ordinal(number: int) -> str:
    return {1: "first", 2: "second", 3: "third"}.get(number, f"{number}th")
