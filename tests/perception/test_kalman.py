"""The Kalman baseline: what it follows, and what it takes for false."""

import math

import numpy as np
import pytest
from test_particles import GAIT, HERE, STEP, frame, walk

import bayeshunt as bh
from bayeshunt.config.schema.camera import CameraSettings
from bayeshunt.core.messages import Observation
from bayeshunt.perception.setting import PerceptionContext
from bayeshunt.perception.trackers.kalman import KalmanTracker


def watch(mind, places):
    rng = np.random.default_rng(0)
    belief = mind.start(Observation(0.0, HERE, (frame(mind, 0.0, places[0]),)))
    for step in range(1, len(places), 2):
        frames = tuple(frame(mind, float(i), places[i]) for i in (step, step + 1))
        belief = mind.update(belief, GAIT, Observation(float(step + 1), HERE, frames), rng=rng)
    return belief


@pytest.fixture
def mind():
    return KalmanTracker(PerceptionContext(STEP, 0.06, 0.06, camera=CameraSettings()))


def test_it_keeps_the_rules_of_trackers():
    bh.check_tracker("kalman")


def test_it_follows_and_foretells(mind):
    belief = watch(mind, walk(9))
    assert belief.mean.y == pytest.approx(0.4, abs=0.02)
    assert belief.mean.theta == pytest.approx(math.pi / 2, abs=0.2)
    assert belief.transitions[-1].distance == pytest.approx(0.1, abs=0.02)
    unseen = mind.update(belief, GAIT, Observation(10.0, HERE, ()), rng=np.random.default_rng(0))
    assert unseen.mean.y == pytest.approx(0.5, abs=0.03)
    assert unseen.last_seen == pytest.approx(2.0)
    assert unseen.covariance[0, 0] > belief.covariance[0, 0]


def test_what_is_far_off_is_false_until_it_comes_three_times(mind):
    places = walk(9)
    once = watch(mind, [*places[:7], (0.3, -0.6), places[8]])
    assert once.mean.y == pytest.approx(0.4, abs=0.03)
    often = watch(mind, [*places[:7], *[(0.3, -0.6)] * 4])
    assert often.mean.y == pytest.approx(-0.6, abs=0.03)
