"""The hunter that knows where it can be: straight at the prey where the way is free, else the way round."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.geometry import FloatArray, Polar, Pose, placed, wrap
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.planners.api import Plan, Situation
from bayeshunt.planners.detour.ways import WayFinder, Ways
from bayeshunt.planners.info import ROOM, PlannerInfo
from bayeshunt.planners.interception.futures import Futures
from bayeshunt.planners.interception.intercept_walls import InterceptWallsPlanner, RoomSettings
from bayeshunt.planners.interception.lookahead import Outlook, PairPaths
from bayeshunt.planners.requests import check_request
from bayeshunt.planners.settings import Number, planner_settings, setting

__all__ = ["DetourPlanner", "DetourSettings", "detour"]


@planner_settings("detour")
class DetourSettings(RoomSettings):
    """Settings of the interception hunter among walls, and of the way round."""

    free: Number = setting(
        0.5, "P(free) from which a cell is taken to be free when a straight way is looked at", gt=0, lt=1
    )
    known: Number = setting(
        0.85, "share of an interception's part-way points that must lie in free cells for it to be taken", ge=0, le=1
    )
    stuck: Number = setting(1.6, "what running into something costs, in legs", ge=0)


class DetourPlanner(InterceptWallsPlanner):
    """Interception while the straight line to the prey is free on the map, else the way round.

    The map is the table of free space (:class:`~bayeshunt.models.arena.free_space.FreeSpace`) that the hunter counts
    while it babbles alone in the arena, as it learns the walls: an evaluation and ``bayeshunt hunt`` do so first.

    Straight: if the gaits of the interception lead over free cells and through no obstacle, and so does the straight
    line from their end to where the prey then is, it is that interception.

    Round: else every pair of gaits is followed along its part-way points. ``P(not stopped)`` is the least P(free) so
    far. Beyond the pair the hunter takes the geodesic, the shortest way over the table with metres divided by P(free),
    to where the prey will be. The pair of the least expected time is chosen.

    With a map it needs to know where it is: ``situation.pose``. Without one it is the interception hunter.
    ``rng`` is not used. Reference: geodesic distances by Dijkstra's algorithm (E. W. Dijkstra, Numerische Mathematik
    1, 1959).
    """

    name = "detour"
    info = PlannerInfo(prepare=ROOM)
    Settings = DetourSettings  # type: ignore[assignment]  # what its base takes, and more
    settings: DetourSettings

    def __init__(self, model: ForwardModel, settings: DetourSettings | None = None, **given: Any) -> None:
        chosen = DetourSettings(**given) if settings is None else settings
        super().__init__(model, replace(chosen, room=RoomModel.of(chosen.room)))
        self.ways = None if self.room.space is None else WayFinder(self.room.space)
        self.obstacles = self.room.obstacles()

    def futures(self, situation: Situation) -> Futures:
        """Return the prey's paths: among the walls, if it knows any."""
        if situation.pose is None and self.ways is None and not len(self.room.offsets):
            return self.turning(situation)
        return super().futures(situation)

    def plan(self, situation: Situation, *, rng: np.random.Generator) -> Plan:
        """Return the interception where the way is free, else the first gaits of the way round."""
        situation = check_request(situation, rng, self.hunter)
        pairs, futures = self.pairs_from(situation), self.futures(situation)
        straight = self.choose(situation, *self.ahead(situation, futures, rng))
        if self.ways is None or self._is_clear(situation, straight, pairs, futures):
            return straight
        return self._round(situation, pairs, futures)

    def _is_clear(self, situation: Situation, plan: Plan, pairs: PairPaths, futures: Futures) -> bool:
        """Whether an interception is free on the map: its gaits until the catch, and the straight line that is left."""
        assert self.ways is not None
        assert situation.pose is not None  # the futures need it
        space, pose, reach = self.ways.space, situation.pose, self.reach(situation)
        first, second = (self.gaits.index(gait) for gait in plan.gaits)
        parts = pairs.first[:2, first, :, 0], pairs.second[:2, first, second, :, 0]
        path = np.concatenate(parts, axis=-1)  # [2, 2 P]
        prey = futures.likeliest(pairs.times)
        gaps = np.hypot(path[0] - prey.forward[1:], path[1] - prey.right[1:])
        caught = gaps <= reach
        until = int(caught.argmax()) if caught.any() else len(gaps)
        x, y = placed(pose, *path[:, :until])
        if until and (space.at(x, y) >= self.settings.free).mean() < self.settings.known:
            return False
        if self.obstacles is not None and self.obstacles.inside(x, y).any():
            return False  # a thin one is few of the points
        if until < len(gaps):
            return True
        share = np.arange(0.0, 1.0 - reach / gaps[-1], 0.5 * space.cell / gaps[-1])
        line = path[:, -1:] + share * (np.array([[prey.forward[-1]], [prey.right[-1]]]) - path[:, -1:])
        return bool((space.at(*placed(pose, *line)) >= self.settings.free).all())

    def _round(self, situation: Situation, pairs: PairPaths, futures: Futures) -> Plan:
        assert self.ways is not None
        assert situation.pose is not None
        pose = situation.pose
        prey = futures.likeliest(pairs.times[[len(pairs.times) // 2 - 1, -1]])
        goal = pose.compose(Polar(*(float(part[-1]) for part in prey)))
        ways = self.ways.to(float(goal.x), float(goal.y))
        outlook = self._outlook(pairs, futures, pose, ways, self.reach(situation))
        if (charge := self.charge(situation, pairs)) is not None:
            outlook = replace(outlook, times=charge(outlook.pairs()).time[..., 0])
        plan = self.best(
            outlook.times.min(axis=1), outlook.times, self.objective.replace(" [s]", ", the way round [s]"),
            partial(_trace, self.gaits, pairs, outlook), prey, prey_known=bool(situation.transitions),
        )  # fmt: skip
        aim = pose.relative(Pose(*ways.waypoint(pose.x, pose.y), pose.theta))._replace(heading=np.nan)
        return replace(plan, target=aim)

    def _outlook(self, pairs: PairPaths, futures: Futures, pose: Pose, ways: Ways, reach: float) -> _Outlook:
        """Value every pair of gaits: until its end, and then the way that is left."""
        count, points = pairs.first.shape[1:3]
        both = np.broadcast_to(pairs.first[:2, :, None, :, 0], (2, count, count, points))
        path = np.concatenate([both, pairs.second[:2, ..., 0]], axis=-1)  # [2, G, G, 2 P]
        x, y = placed(pose, *path)
        safe = np.minimum.accumulate(ways.space.at(x, y), axis=-1)  # P(not stopped so far)
        forward, right = (part.T for part in futures.at(pairs.times))  # [2 P, K]
        gap = np.hypot(path[0][..., None] - forward, path[1][..., None] - right)
        chance = np.clip((reach + self.spread - gap) / (2.0 * self.spread), 0.0, 1.0)
        captured = np.maximum.accumulate((chance * safe[..., None]) @ futures.weights, axis=-1)  # [G, G, 2 P]
        during = pairs.times[0] * (1.0 - captured).sum(axis=-1)
        # Where it is stopped, if it is: before the first cell that is more blocked than free.
        first = np.where(safe[..., -1] < 0.5, (safe < 0.5).argmax(axis=-1), 2 * points) - 1
        at = np.maximum(first, 0)[..., None]
        stop_x, stop_y = (np.take_along_axis(part, at, axis=-1)[..., 0] for part in (x, y))
        stop_x, stop_y = np.where(first < 0, pose.x, stop_x), np.where(first < 0, pose.y, stop_y)
        heading = pose.theta - pairs.end[2, ..., 0]
        met = self.homing.time(pairs.end, futures, pairs.times[-1]) @ futures.weights  # were nothing in the way
        left = np.maximum(met, self._time(ways, x[..., -1], y[..., -1], heading, reach))
        stopped = self._time(ways, stop_x, stop_y, heading, reach) + self.settings.stuck * self.leg
        end = safe[..., -1]
        times = during + (1.0 - captured[..., -1]) * (end * left + (1.0 - end) * stopped)
        return _Outlook(times, captured, safe)

    def _time(self, ways: Ways, x: FloatArray, y: FloatArray, heading: FloatArray, reach: float) -> FloatArray:
        """Seconds that the way from poses in the starting frame takes, turning towards it included."""
        turn = np.abs(np.asarray(wrap(ways.direction(x, y) - heading)))
        time: FloatArray = np.maximum(ways.length(x, y) - reach, 0.0) / self.homing.top_speed
        return time + self.homing.heading_price * turn


@dataclass(frozen=True, eq=False)
class _Outlook:
    """Of every pair: expected seconds to the capture [G, G]; P(captured), P(not stopped) by each time [G, G, 2 P]."""

    times: FloatArray
    captured: FloatArray
    safe: FloatArray

    def pairs(self) -> Outlook:
        """Return it as that of one future."""
        points = self.captured.shape[-1] // 2
        first, second = self.captured[:, 0, :points, None], self.captured[..., points:, None]
        return Outlook(first, second, self.times[..., None])


def _trace(gaits: tuple[str, ...], pairs: PairPaths, outlook: _Outlook) -> pd.DataFrame:
    """One row per sequence: the root, every first gait with its best second, every pair.

    collision_probability: of being stopped by the end of step T.
    """
    count, points = len(gaits), pairs.first.shape[2]
    times = outlook.times
    best = int(times.min(axis=1).argmin())
    first, second = np.repeat(np.arange(count), count), np.tile(np.arange(count), count)
    ends = [
        np.concatenate([[0.0], one.ravel(), two.ravel()]) for one, two in zip(pairs.first_end, pairs.end, strict=True)
    ]
    captured, safe = (
        np.concatenate([[start], table[:, 0, points - 1], table[..., -1].ravel()])
        for start, table in ((0.0, outlook.captured), (1.0, outlook.safe))
    )
    single = np.arange(count) == best
    return pd.DataFrame(
        {
            "node": np.arange(1 + count + count * count),
            "parent": np.concatenate([[-1], np.zeros(count, dtype=int), 1 + first]),
            "T": np.repeat([0, 1, 2], [1, count, count * count]),
            "gaits": ["", *gaits, *(f"{gaits[i]}, {gaits[j]}" for i, j in zip(first, second, strict=True))],
            "gait": ["", *gaits, *(gaits[j] for j in second)],
            "hunter_forward": ends[0],
            "hunter_right": ends[1],
            "hunter_heading": np.asarray(wrap(ends[2])),
            "value_s": np.concatenate([[times.min()], times.min(axis=1), times.ravel()]),
            "capture_probability": captured,
            "collision_probability": 1.0 - safe,
            "chosen": np.concatenate([[True], single, (first == best) & (second == int(times[best].argmin()))]),
        }
    )


#: The planner by the name that it is registered under.
detour = DetourPlanner
