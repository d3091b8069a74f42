"""A hunter that knows the prey's future: how good these gaits and this time-step can be."""

from __future__ import annotations

import numpy as np

from bayeshunt.core.errors import InputError
from bayeshunt.core.geometry import Polar, placed
from bayeshunt.core.messages import Ray
from bayeshunt.core.protocols import Map
from bayeshunt.planners.api import Plan, Situation
from bayeshunt.planners.info import FUTURE, PlannerInfo, own_foresight
from bayeshunt.planners.requests import check_request
from bayeshunt.planners.sequences.capture import PreyPaths
from bayeshunt.planners.sequences.hunter import SearchSettings, SequenceHunter, capture_plan
from bayeshunt.planners.settings import planner_settings

__all__ = ["Omniscient", "OmniscientSettings"]

#: Sequences whose straight line to the prey is looked at among obstacles, the soonest first.
_LOOKED_AT = 400


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

    ``rng`` is not used. Among obstacles it is told of them too: it takes no sequence that runs into one.

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
        stopped = None if situation.map is None else self._stopped(situation)
        times = paths.first_captures(prey, reach, stop_at_first=stopped is None)[0]
        if stopped is not None:
            times[times > stopped] = np.inf
        captured = bool(np.isfinite(times).any())
        if not captured:
            ends = paths.depth * paths.duration
            times[self.leaves] = ends + paths.times_to_go(self.leaves, prey, reach, paths.turn_price)[0]
            if stopped is not None:
                self._go_round(times, stopped, situation, prey)
        return capture_plan(paths, self.gaits, times, prey, situation, "time of capture [s]", prey_known=True)

    def _stopped(self, situation: Situation) -> np.ndarray:
        """Return when every sequence runs into an obstacle [N], seconds from now; inf if it does not."""
        paths, pose = self.paths, situation.pose
        assert pose is not None
        assert isinstance(situation.map, Map)
        hit = ~np.asarray(situation.map.free(*placed(pose, paths.forward, paths.right)))
        hit[0] = False
        begun = (paths.tree.steps - 1) * paths.duration
        stopped = np.where(hit.any(axis=1), begun + (hit.argmax(axis=1) + 1) * paths.interval, np.inf)
        for step in range(2, paths.depth + 1):
            new = slice(paths.layers[step], paths.layers[step + 1])
            stopped[new] = np.minimum(stopped[new], stopped[paths.tree.parents[new]])
        return stopped

    def _go_round(self, times: np.ndarray, stopped: np.ndarray, situation: Situation, prey: PreyPaths) -> None:
        """Leave out sequences that are stopped, and put those whose straight line to the prey is not free last."""
        paths, pose = self.paths, situation.pose
        assert pose is not None
        assert isinstance(situation.map, Map)
        late = 10.0 * paths.depth * paths.duration
        times[self.leaves] += np.where(np.isfinite(stopped[self.leaves]), 2.0 * late, 0.0)
        at = pose.compose(Polar.from_cartesian(float(prey.forward[0, -1]), float(prey.right[0, -1]), 0.0))
        for node in self.leaves[np.argsort(times[self.leaves], kind="stable")][:_LOOKED_AT].tolist():
            end = pose.compose(Polar.from_cartesian(float(paths.end[0, node]), float(paths.end[1, node]), 0.0))
            if not situation.map.blocked(Ray(float(end.x), float(end.y), float(at.x), float(at.y))):
                break
            times[node] += late
