"""How particles move: straight on, now and then a turn, along the walls that the hunter knows, or not at all."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from bayeshunt.core.geometry import FloatArray, wrap
from bayeshunt.models.target.turns import TurnModel
from bayeshunt.perception.setting import KnownObstacles, KnownWalls
from bayeshunt.perception.trackers.cloud import Cloud

__all__ = ["PreyMotion"]

#: Into how many bins of angle turns are counted.
_TURN_BINS = 36
#: How far a prey leaves a wall off its usual angle, and how far its heading is off when it meets one [rad].
_REBOUND_SPREAD, _MEETING_SPREAD = 0.15, 0.15
#: How far off its corner it is then, in seconds of its way: it turns in an arc, a particle on the spot. Chosen, as the
#: first above and the change of speed below, for regions that hold the prey as often as they say (seed 1100).
_CORNER_SPREAD = 0.15
#: A prey that stands may begin to move, and one that moves may stop, once in so many time-steps.
_MODE_STEPS = 50.0
#: How many time-steps the first guess at the share of standing still is worth.
_STILL_STEPS = 4.0
#: Share by which a speed differs from the one expected, and by which it changes in a time-step.
_SPEED_SPREAD, _SPEED_CHANGE = 0.12, 0.005
#: Bounces within one move of a particle: two, in a corner.
_BOUNCES = 2


@dataclass(frozen=True, eq=False)
class PreyMotion:
    """What is believed of the prey's motion; a value: :meth:`learn` returns a new one.

    prior: turns and speed as the hunter knows them beforehand, per time-step. time_step: seconds.
    walls, obstacles: known ones; None: none. still: share of prey that stand, believed beforehand.
    steps, turns: expected numbers of time-steps seen and of those with a turn, by chance and not at a wall.
    turn_counts: of the turns by their angle [36]. still_steps: expected number of time-steps in which it stood.
    speed_sum: metres per second, over the time-steps in which it moved. drift_sum, drift_steps: squared heading changes
    [rad^2] of the time-steps in which it went straight on, and how many those were.
    """

    prior: TurnModel
    time_step: float
    walls: KnownWalls | None = None
    obstacles: KnownObstacles | None = None
    still: float = 0.05
    steps: float = 0.0
    turns: float = 0.0
    turn_counts: tuple[float, ...] = (0.0,) * _TURN_BINS
    still_steps: float = 0.0
    speed_sum: float = 0.0
    drift_sum: float = 0.0
    drift_steps: float = 0.0

    @property
    def hazard(self) -> float:
        """Chance of a turn per time-step: ``(turns + prior_hazard prior_steps) / (steps + prior_steps)``."""
        prior = self.prior
        moved = self.steps - self.still_steps
        return (self.turns + prior.prior_hazard * prior.prior_steps) / (max(moved, 0.0) + prior.prior_steps)

    @property
    def still_share(self) -> float:
        """Share of prey that stand: a Dirichlet mean."""
        return (self.still_steps + self.still * _STILL_STEPS) / (self.steps + _STILL_STEPS)

    @property
    def speed(self) -> float:
        """Expected metres per second of a prey that moves."""
        prior = self.prior.prior_speed / self.time_step
        moved = max(self.steps - self.still_steps, 0.0)
        return (self.speed_sum + prior) / (moved + 1.0)

    @property
    def drift(self) -> float:
        """Radians by which the heading wanders per time-step without a turn (standard deviation).

        Beforehand in proportion to its speed: what makes it wander is noise of its way, and a slower prey has less.
        """
        prior = self.prior
        before = prior.prior_drift * self.speed * self.time_step / prior.prior_speed
        total = self.drift_sum + prior.prior_steps * before**2
        return float((total / (self.drift_steps + prior.prior_steps)) ** 0.5)

    @cached_property
    def turn_table(self) -> tuple[FloatArray, FloatArray]:
        """Heading changes [rad, clockwise] and P(change | a turn): own turns as a guess, and those seen."""
        own = self.prior.prior_turns
        share = self.prior.turn_weight / max(len(own), 1)
        centres = (np.arange(_TURN_BINS) + 0.5) * (2.0 * np.pi / _TURN_BINS) - np.pi
        weights = np.concatenate([np.full(len(own), share), self.turn_counts])
        turns = np.concatenate([own, centres])
        kept = weights > 0.0
        if not kept.any():
            return np.zeros(0), np.zeros(0)
        return turns[kept], weights[kept] / weights[kept].sum()

    def speeds(self, count: int, rng: np.random.Generator) -> FloatArray:
        """Return ``count`` speeds [m/s] that a prey may have."""
        return self.speed * np.clip(rng.normal(1.0, _SPEED_SPREAD, count), 0.2, 1.5)

    def stands(self, count: int, rng: np.random.Generator) -> np.ndarray:
        """Return for ``count`` prey whether each stands."""
        return rng.random(count) < self.still_share

    def move(self, cloud: Cloud, duration: float, rng: np.random.Generator) -> Cloud:
        """Return where the particles are after ``duration`` [s]."""
        if duration <= 0.0:
            return cloud
        count, share = len(cloud), duration / self.time_step
        moving = ~cloud.still
        theta = cloud.theta + np.where(moving, rng.normal(0.0, self.drift * share**0.5, count), 0.0)
        turned = cloud.turned
        turns, chances = self.turn_table
        turning = moving & (rng.random(count) < 1.0 - (1.0 - min(self.hazard, 1.0)) ** share)
        if len(turns) and turning.any():
            drawn = turns[np.minimum(np.searchsorted(np.cumsum(chances), rng.random(count)), len(turns) - 1)]
            theta = np.where(turning, theta - drawn, theta)
            turned = np.where(turning, drawn, turned)
        run = np.where(moving, cloud.speed * duration, 0.0)
        x, y, theta = self._go(cloud.x, cloud.y, theta, run, rng)
        x, y, theta = self._turned_away(cloud, x, y, theta, rng)
        changes = rng.random(count) < share / _MODE_STEPS
        still = np.where(changes, self.stands(count, rng), cloud.still)
        speed = cloud.speed * (1.0 + _SPEED_CHANGE * share**0.5 * rng.normal(size=count))
        return replace(cloud, x=x, y=y, theta=np.asarray(wrap(theta)), speed=speed, still=still, turned=turned)

    def learn(self, cloud: Cloud) -> PreyMotion:
        """Return what is believed after a time-step in which the prey was seen: expected counts over the particles."""
        weight = cloud.weight
        stood = float(weight @ cloud.still)
        bins = np.floor((np.asarray(wrap(cloud.turned)) + np.pi) / (2.0 * np.pi / _TURN_BINS)).astype(int) % _TURN_BINS
        happened = (cloud.turned != 0.0) & ~cloud.still
        counted = np.bincount(bins[happened], weights=weight[happened], minlength=_TURN_BINS)
        change = np.asarray(wrap(cloud.theta - cloud.from_theta))
        straight = weight * (~cloud.still & (cloud.turned == 0.0) & (np.abs(change) < self.prior.threshold))
        return replace(
            self,
            steps=self.steps + 1.0,
            turns=self.turns + float(weight @ happened),
            turn_counts=tuple((np.array(self.turn_counts) + counted).tolist()),
            still_steps=self.still_steps + stood,
            drift_sum=self.drift_sum + float(straight @ np.square(change)),
            drift_steps=self.drift_steps + float(straight.sum()),
            speed_sum=self.speed_sum + float(weight @ np.where(cloud.still, 0.0, cloud.speed)),
        )

    def _go(
        self, x: FloatArray, y: FloatArray, theta: FloatArray, run: FloatArray, rng: np.random.Generator
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Straight ways of ``run`` [m], turned along every wall that they meet."""
        if self.walls is None or not len(self.walls.normals):
            return x + run * np.cos(theta), y + run * np.sin(theta), theta
        normals, offsets = self._half_planes
        for _ in range(_BOUNCES):
            ux, uy = np.cos(theta), np.sin(theta)
            towards = normals[:, :1] * ux + normals[:, 1:] * uy  # [W, N]
            room = offsets - normals[:, :1] * x - normals[:, 1:] * y
            with np.errstate(divide="ignore", invalid="ignore"):
                gaps = np.where(towards > 1e-9, np.maximum(room, 0.0) / towards, np.inf)
            wall = gaps.argmin(axis=0)
            gap = np.take_along_axis(gaps, wall[None], axis=0)[0]
            way = np.minimum(run, gap)
            x, y, run = x + way * ux, y + way * uy, run - way
            hit = np.flatnonzero(run > 0.0)
            if not len(hit):
                break
            x, y, theta = x.copy(), y.copy(), theta.copy()
            theta[hit] = self._leave(normals[wall[hit]], theta[hit], rng)
            x[hit] += rng.normal(0.0, _CORNER_SPREAD * self.speed, len(hit))
            y[hit] += rng.normal(0.0, _CORNER_SPREAD * self.speed, len(hit))
        return x + run * np.cos(theta), y + run * np.sin(theta), theta

    def _turned_away(
        self, cloud: Cloud, x: FloatArray, y: FloatArray, theta: FloatArray, rng: np.random.Generator
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Those that would be in an obstacle stay before it, and turn away to either side."""
        if self.obstacles is None:
            return x, y, theta
        met = np.flatnonzero(self.obstacles.met(cloud.x, cloud.y, x, y))
        x, y, theta = x.copy(), y.copy(), theta.copy()
        x[met], y[met] = cloud.x[met], cloud.y[met]
        theta[met] += rng.choice((-1.0, 1.0), len(met)) * rng.uniform(0.5 * np.pi, np.pi, len(met))
        return x, y, theta

    @cached_property
    def _half_planes(self) -> tuple[FloatArray, FloatArray]:
        """Normals [W, 2] and offsets [m, W, 1] of the known walls."""
        assert self.walls is not None
        return np.array(self.walls.normals), np.array(self.walls.offsets)[:, None]

    def _leave(self, normals: FloatArray, theta: FloatArray, rng: np.random.Generator) -> FloatArray:
        """Headings with which prey leave their walls: along them, on the side that they come in on."""
        assert self.walls is not None
        facing = np.arctan2(normals[:, 1], normals[:, 0])
        slant = np.asarray(wrap(theta - facing)) + rng.normal(0.0, _MEETING_SPREAD, len(theta))
        rebound = self.walls.rebound + rng.normal(0.0, _REBOUND_SPREAD, len(theta))
        return facing + np.where(slant >= 0.0, 1.0, -1.0) * (0.5 * np.pi + rebound)
