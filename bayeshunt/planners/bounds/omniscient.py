"""A hunter that knows the prey's future: how good these gaits and this time-step can be."""

from __future__ import annotations

import numpy as np

from bayeshunt.core.errors import InputError
from bayeshunt.planners.api import Plan, Situation
from bayeshunt.planners.info import FUTURE, PlannerInfo, own_foresight
from bayeshunt.planners.requests import check_request
from bayeshunt.planners.sequences.capture import PreyPaths
from bayeshunt.planners.sequences.hunter import SearchSettings, SequenceHunter, capture_plan
from bayeshunt.planners.settings import planner_settings

__all__ = ["Omniscient", "OmniscientSettings"]


@planner_settings("omniscient")
class OmniscientSettings(SearchSettings):
    """Settings of the omniscient hunter: how it searches."""


class Omniscient(SequenceHunter):
    """A yardstick that hunts: the sequence of earliest capture, the prey's true noise-free future known.

    Every sequence of at most ``depth`` gaits with at most ``max_transitions`` changes is followed
    along its mean path, against the future that the evaluation hands in (``Situation.future``); the
    one that captures first is executed for one step, and then the hunter plans again. Where nothing
    captures within the horizon, the sequence of least end time + time to go is (see
    :meth:`~bayeshunt.planners.sequences.capture.CapturePaths.times_to_go`).

    ``rng`` is not used.

    It is a yardstick and no strict bound: it follows mean paths, so where noise decides a hunter that
    knows less may be sooner. A prey that senses the hunter reacts to it, which the future handed in leaves out.
    """

    name = "omniscient"
    Settings = OmniscientSettings
    info = PlannerInfo(ab_initio=False, needs=(FUTURE,), foresight=own_foresight)

    @property
    def foresight(self) -> float:
        """Seconds of the prey's future that a decision needs."""
        return self.paths.depth * self.paths.duration

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Return the sequence of earliest capture."""
        situation = check_request(situation, rng, self.hunter)
        if situation.future is None:
            raise InputError("omniscient needs the prey's future, which only an evaluation hands in")
        paths = self.paths
        ahead, right = situation.future.at(paths.interval * np.arange(paths.depth * paths.points + 1))
        prey = PreyPaths(ahead[None], right[None])
        reach = self.reach(situation)
        times = paths.first_captures(prey, reach, stop_at_first=True)[0]
        captured = bool(np.isfinite(times).any())
        if not captured:
            ends = paths.depth * paths.duration
            times[self.leaves] = ends + paths.times_to_go(self.leaves, prey, reach, paths.turn_price)[0]
        return capture_plan(paths, self.gaits, times, prey, situation, "time of capture [s]", prey_known=True)
