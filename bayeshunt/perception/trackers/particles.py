"""The particle tracker: thousands of guesses at the prey's pose and motion, weighed by every frame of the camera."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from bayeshunt.core.checks import check_number, check_whole
from bayeshunt.core.errors import InputError
from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import FloatArray, Polar, Pose, wrap
from bayeshunt.core.messages import Detection, Frame, Observation
from bayeshunt.core.protocols import Belief
from bayeshunt.models.target.turns import TurnModel
from bayeshunt.perception.setting import PerceptionContext
from bayeshunt.perception.trackers.cloud import Cloud, systematic
from bayeshunt.perception.trackers.common import BODIES_PER_SECOND, SURE, TOLERANCE
from bayeshunt.perception.trackers.motion import PreyMotion
from bayeshunt.perception.trackers.particle_belief import ParticleBelief
from bayeshunt.perception.trackers.sightings import Eye

__all__ = ["ParticleTracker"]

#: A sighting that the particles explain less than this, against a false one, brings new ones.
_UNEXPLAINED = 0.3
#: New particles: their share of all, and of the weight.
_BORN, _BORN_WEIGHT = 0.25, 0.03
#: Fewer effective particles than this share: the sighting fell where there were hardly any, and more are put there.
_THIN = 0.02
#: What is added to particles that are drawn again, so that no two are the same: metres, radians, share of the speed.
_JITTER_PLACE, _JITTER_TURN, _JITTER_SPEED = 0.0003, 0.008, 0.003
#: This share of them is put much farther off, so many times: where the prey does what no particle foresaw.
_FAR_SHARE, _FAR = 0.04, 8.0
#: A frame shows the prey if that is more probable than not.
_SEEN = 0.5
#: A way below this [m] has no direction.
_STANDING = 0.002


class ParticleTracker:
    """A particle filter: see ``bayeshunt.protocols.Tracker``.

    particles: how many, at least 50. still: probability that a prey stands, believed beforehand; learned then.
    unknown_range: half the width of the square in which a prey is that was not shown at the start [m].

    Between frames the particles move as the prey is known to: at their own speed, turning by chance as often and as
    much as has been seen (before that as the hunter's own gaits do), along walls and away from obstacles that the
    hunter knows of; some stand. Every frame weighs them by what it shows and by what it does not: where the camera
    looked and found nothing, there are fewer, but not behind a known obstacle. A sighting that none of them explains
    brings new ones. The error of the hunter's odometry is on them.
    Reference: Gordon, Salmond and Smith, IEE Proceedings F 140 (1993).
    """

    def __init__(
        self, context: PerceptionContext, particles: int = 2000, still: float = 0.05, unknown_range: float = 0.6
    ) -> None:
        check_whole(particles, "particles", 50)
        self.count = particles
        if not 0.0 <= check_number(still, "still") < 1.0:
            raise InputError(f"still must be a probability below 1, got {still!r}")
        if not check_number(unknown_range, "unknown_range") > 0.0:
            raise InputError(f"unknown_range must be metres > 0, got {unknown_range!r}")
        self.context, self.unknown_range = context, unknown_range
        self.camera = context.own_camera
        self.eye = Eye(self.camera, context.target_width, context.obstacles)
        step = 1.0 if context.time_step is None else context.time_step
        prior = context.motion or TurnModel(prior_speed=BODIES_PER_SECOND * context.target_width * step)
        self.motion = PreyMotion(prior, step, context.walls, context.obstacles, still)

    def start(self, observation: Observation) -> Belief:
        """Return the belief after the first look: about the sighting, or anywhere the camera has not looked."""
        # The protocol gives no generator here; what a start draws is the same in every hunt, and no result hangs on it.
        rng = np.random.default_rng(0)
        frame = observation.frames[-1] if observation.frames else Frame(observation.time, observation.pose)
        if seen := self.context.start == "shown" and bool(frame.detections):
            cloud = self._born(frame.detections[0], frame.pose, self.count, self.motion, rng)
        else:
            cloud, seen = self._weighed(self._anywhere(rng), frame, self.motion, 0.0, rng)
        return ParticleBelief(
            observation.time, observation.pose, cloud, self.motion, self.eye, 0.0 if seen else math.inf,
            sightings=int(seen),
        )  # fmt: skip

    def update(self, belief: Belief, gait: Gait, observation: Observation, *, rng: np.random.Generator) -> Belief:
        """Return the belief after the frames of a step, each of them weighed when and whence it looked."""
        assert isinstance(belief, ParticleBelief)  # of start or update
        motion, cloud, time, own = belief.motion, belief.cloud.begin_step(), belief.time, belief.own
        last, sightings = belief.time - belief.last_seen, belief.sightings
        errors = rng.normal(size=(2, self.count)) if self.camera.distance_error or self.camera.turn_error else None
        frames: list[Frame | None] = list(observation.frames)
        if not observation.frames or observation.frames[-1].time < observation.time:
            frames.append(None)  # the way to the end, without a look
        for frame in frames:
            now, pose = (observation.time, observation.pose) if frame is None else (frame.time, frame.pose)
            cloud = motion.move(cloud, now - time, rng)
            if errors is not None:
                cloud = self._shaken(cloud, own, pose, errors)
            if frame is not None:
                cloud, seen = self._weighed(cloud, frame, motion, now - belief.time, rng)
                last, sightings = (now, sightings + 1) if seen else (last, sightings)
            time, own = now, pose
        return self._concluded(belief, cloud, observation, last, sightings)

    # --- inside -------------------------------------------------------------------------------

    def _anywhere(self, rng: np.random.Generator) -> Cloud:
        """Particles all over the square about the start, those beyond known walls left out."""
        places = rng.uniform(-self.unknown_range, self.unknown_range, (2, 8 * self.count))
        walls = self.context.walls
        if walls is not None and len(walls.normals):
            inside = (np.array(walls.normals) @ places <= np.array(walls.offsets)[:, None]).all(axis=0)
            places = places[:, inside] if inside.any() else places
        x, y = places[:, rng.integers(0, places.shape[1], self.count)]
        theta = rng.uniform(-np.pi, np.pi, self.count)
        return Cloud.at(Pose(x, y, theta), self.motion.speeds(self.count, rng), self.motion.stands(self.count, rng))

    def _born(
        self, detection: Detection, own: Pose, count: int, motion: PreyMotion, rng: np.random.Generator, *,
        elapsed: float = 0.0,
    ) -> Cloud:  # fmt: skip
        """Particles about a sighting, ``elapsed`` [s] into the time-step; they are taken to have come straight."""
        pose = self.eye.places(detection, own, count, rng)
        cloud = Cloud.at(pose, motion.speeds(count, rng), motion.stands(count, rng), sightings=1.0)
        come = np.where(cloud.still, 0.0, cloud.speed * elapsed)
        return replace(cloud, from_x=pose.x - come * np.cos(pose.theta), from_y=pose.y - come * np.sin(pose.theta))

    def _weighed(
        self, cloud: Cloud, frame: Frame, motion: PreyMotion, elapsed: float, rng: np.random.Generator
    ) -> tuple[Cloud, bool]:
        """Return the particles after a frame, ``elapsed`` [s] into the step, and whether it showed the prey."""
        fit = self.eye.fit(frame, cloud.x, cloud.y, cloud.theta)
        weight = cloud.weight * fit.likelihood
        weight = weight / weight.sum()
        shares = fit.explained / fit.likelihood  # P(it is this detection | the prey is there), [Z, N]
        seen = float((shares @ weight).sum()) > _SEEN if len(shares) else False
        odds = fit.explained @ cloud.weight
        cloud = replace(cloud, weight=weight, sightings=cloud.sightings + shares.sum(axis=0))
        thin = cloud.effective < _THIN * self.count
        if cloud.effective < 0.5 * self.count:
            cloud = self._redrawn(cloud, rng)
        for number, detection in enumerate(frame.detections):
            if odds[number] < _UNEXPLAINED:
                cloud = self._put(cloud, detection, frame, motion, elapsed, _BORN_WEIGHT, rng)
            elif thin and seen:
                share = 0.5 * float(odds[number] / odds.sum())
                cloud = self._put(cloud, detection, frame, motion, elapsed, share, rng)
        return cloud, seen

    def _put(
        self, cloud: Cloud, detection: Detection, frame: Frame, motion: PreyMotion, elapsed: float, share: float,
        rng: np.random.Generator,
    ) -> Cloud:  # fmt: skip
        """Replace some particles by new ones about a sighting, which get a share of the weight."""
        count = max(1, int((_BORN if share < _BORN else share) * self.count))
        born = self._born(detection, frame.pose, count, motion, rng, elapsed=elapsed)
        return cloud.put(rng.permutation(self.count)[:count], born, share)

    def _redrawn(self, cloud: Cloud, rng: np.random.Generator) -> Cloud:
        """Particles drawn by their weights, a little apart from each other."""
        cloud = cloud.pick(systematic(cloud.weight, self.count, rng))
        far = np.where(rng.random(self.count) < _FAR_SHARE, _FAR, 1.0)
        off = rng.normal(size=(4, self.count)) * far
        turn = _JITTER_TURN * off[2]  # of its whole way in this step: what it is turned by here, it did not wander
        return replace(
            cloud,
            x=cloud.x + _JITTER_PLACE * off[0],
            y=cloud.y + _JITTER_PLACE * off[1],
            theta=np.asarray(wrap(cloud.theta + turn)),
            from_theta=np.asarray(wrap(cloud.from_theta + turn)),
            speed=np.maximum(cloud.speed * (1.0 + _JITTER_SPEED * off[3]), 0.0),
        )

    def _shaken(self, cloud: Cloud, before: Pose, own: Pose, errors: FloatArray) -> Cloud:
        """The error of the last way on the particles; ``errors``: of each, in standard deviations, all step long."""
        way = self.camera.distance_error * math.hypot(own.x - before.x, own.y - before.y)
        turn = self.camera.turn_error * wrap(own.theta - before.theta)
        return cloud.shaken(own, way * errors[0], turn * errors[1])

    def _concluded(
        self, belief: ParticleBelief, cloud: Cloud, observation: Observation, last: float, sightings: int
    ) -> ParticleBelief:
        """The belief at the end of a step, and what it has learned of the prey's motion, if it was seen in it."""
        passed = observation.time - belief.time
        step = self.context.time_step
        whole = step is None or abs(passed - step) <= TOLERANCE * step
        learned = whole and sightings > belief.sightings
        motion, expected, transitions = belief.motion, None, belief.transitions
        if learned:
            motion = motion.learn(cloud)
            before = Pose(cloud.from_x, cloud.from_y, cloud.from_theta)
            moved = before.relative(Pose(cloud.x, cloud.y, cloud.theta))
            moved = moved._replace(angle=np.where(moved.distance < _STANDING, 0.0, moved.angle))  # means nothing there
            expected = (moved, cloud.weight)
            transitions = (*transitions, *_mean_transition(cloud))
        return ParticleBelief(
            observation.time, observation.pose, cloud, motion, self.eye, observation.time - last, transitions, expected,
            sightings,
        )  # fmt: skip


def _mean_transition(cloud: Cloud) -> tuple[Polar, ...]:
    """The transition between the mean poses of the two ends of a step, if both headings are sure."""
    (before, sure_before), (after, sure) = cloud.heading_before(), cloud.heading()
    if min(sure_before, sure) < SURE:
        return ()
    start = Pose(float(cloud.weight @ cloud.from_x), float(cloud.weight @ cloud.from_y), before)
    return (start.relative(Pose(*cloud.centre(), after)),)
