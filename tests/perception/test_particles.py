"""The belief of particles: what it makes of what is seen, and of what is not."""

import math
from dataclasses import replace

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.config.schema.camera import CameraSettings
from bayeshunt.core.gaits import Gait
from bayeshunt.core.geometry import Polar, Pose
from bayeshunt.core.messages import Frame, Observation
from bayeshunt.models.target.turns import TurnModel
from bayeshunt.perception.setting import PerceptionContext
from bayeshunt.perception.trackers.motion import PreyMotion
from bayeshunt.perception.trackers.particles import ParticleTracker
from bayeshunt.planners.interception.bouncing import Walls

STEP, SPEED, GAIT = 2.0, 0.05, Gait("ahead", (0.05, 0.05))
HERE = Pose(0.0, 0.0, 0.0)


def tracker(start="shown", walls=None, particles=2000, **camera):
    motion = TurnModel(prior_speed=SPEED * STEP, prior_turns=np.array([1.0, -1.0]))
    settings = CameraSettings(**camera)
    context = PerceptionContext(STEP, 0.06, 0.06, camera=settings, start=start, motion=motion, walls=walls)
    return ParticleTracker(context, particles)


def frame(mind, time, place, own=HERE):
    """A look at a prey at ``place``, or one that finds nothing."""
    if place is None:
        return Frame(time, own)
    seen = own.relative(Pose(*place, 0.0))
    return Frame(time, own, (mind.camera.detection_of(seen.angle, distance=seen.distance, width=0.06),))


def watch(mind, places, own=HERE, rng=None):
    """The belief after a look a second at places [x, y] or None, two to a step; the first is the start."""
    rng = rng or np.random.default_rng(0)
    belief = mind.start(Observation(0.0, own, (frame(mind, 0.0, places[0], own),)))
    for step in range(1, len(places), 2):
        frames = tuple(frame(mind, float(i), places[i], own) for i in (step, step + 1))
        belief = mind.update(belief, GAIT, Observation(float(step + 1), own, frames), rng=rng)
    return belief


def walk(count, x=0.3, y=0.0, ux=0.0, uy=1.0):
    return [(x + SPEED * i * ux, y + SPEED * i * uy) for i in range(count)]


def test_it_keeps_the_rules_of_trackers():
    bh.check_tracker("particles", particles=200)


def test_a_prey_that_is_seen_is_followed_and_its_heading_and_transitions_learned():
    belief = watch(tracker(), walk(7))
    assert math.hypot(belief.mean.x - 0.3, belief.mean.y - 0.3) < 0.01
    assert belief.mean.theta == pytest.approx(math.pi / 2, abs=0.15)
    assert belief.resultant > 0.95
    assert belief.last_seen == 0.0
    assert belief.transitions[-1].distance == pytest.approx(0.1, abs=0.015)
    assert abs(belief.transitions[-1].heading) < 0.15
    assert belief.sightings == 7
    assert belief.motion.hazard < 0.1  # the prior: nothing has turned


def test_a_prey_that_was_shown_without_its_heading_may_go_any_way():
    mind = tracker()
    belief = mind.start(Observation(0.0, HERE, (frame(mind, 0.0, (0.3, 0.1)),)))
    assert belief.resultant < 0.1
    assert belief.mean.theta == pytest.approx(math.atan2(0.1, 0.3), abs=0.05)  # away: the best guess for who needs one


def test_a_sure_belief_draws_what_it_says():
    belief = watch(tracker(), walk(7))
    pose, speed = belief.sample_motion(400, rng=np.random.default_rng(1))
    assert np.hypot(pose.x - belief.mean.x, pose.y - belief.mean.y).mean() < 0.02
    assert np.median(speed) == pytest.approx(SPEED, rel=0.1)


def test_where_the_camera_looked_and_found_nothing_there_is_less():
    mind = tracker("unknown", fov_deg=120)
    belief = watch(mind, [None] * 3)
    x, y = belief.cloud.x, belief.cloud.y
    ahead = (np.abs(np.arctan2(y, x)) < math.radians(50)) & (x > 0)
    assert belief.cloud.weight[ahead].sum() < 0.05  # a quarter of the square before anything was looked at
    assert belief.last_seen == math.inf
    assert belief.in_view() < 0.1
    assert belief.transitions == ()


def test_a_lost_prey_spreads_and_is_found_again_anywhere():
    mind, rng = tracker(fov_deg=120), np.random.default_rng(2)
    seen = watch(mind, walk(5))
    lost = seen
    for step in range(3):
        frames = (Frame(5.0 + 2 * step, HERE), Frame(6.0 + 2 * step, HERE))
        lost = mind.update(lost, GAIT, Observation(6.0 + 2 * step, HERE, frames), rng=rng)
    assert lost.last_seen == pytest.approx(6.0)
    assert lost.spread > 2 * seen.spread
    where = (0.5, -0.4)  # where hardly a particle is
    for time in (12.0, 14.0):
        frames = (frame(mind, time - 1, where), frame(mind, time, where))
        lost = mind.update(lost, GAIT, Observation(time, HERE, frames), rng=rng)
    assert math.hypot(lost.mean.x - where[0], lost.mean.y - where[1]) < 0.05


def test_one_false_detection_does_not_carry_the_belief_away():
    mind = tracker()
    places = walk(7)
    belief = watch(mind, places[:5])
    false = mind.camera.detection_of(-0.9, distance=0.9, width=0.06)
    frames = (
        frame(mind, 5.0, places[5]),
        frame(mind, 6.0, places[6])._replace(detections=(false, *frame(mind, 6.0, places[6]).detections)),
    )
    belief = mind.update(belief, GAIT, Observation(6.0, HERE, frames), rng=np.random.default_rng(0))
    assert math.hypot(belief.mean.x - places[6][0], belief.mean.y - places[6][1]) < 0.04


def test_a_prey_that_stands_is_learned_to_stand_and_stays_where_it_is_when_hidden():
    mind, rng = tracker(), np.random.default_rng(4)
    belief = watch(mind, [(0.3, 0.0)] * 9)
    assert belief.motion.still_share > 0.5
    assert belief.cloud.weight @ belief.cloud.still > 0.9
    away = Pose(0.0, 0.0, math.pi)  # the hunter looks elsewhere
    for step in range(3):
        time = 10.0 + 2 * step
        belief = mind.update(belief, GAIT, Observation(time, away, (Frame(time, away),)), rng=rng)
    assert math.hypot(belief.mean.x - 0.3, belief.mean.y) < 0.05


def test_a_prey_that_turns_out_slower_is_believed_to_wander_less():
    motion = PreyMotion(TurnModel(prior_speed=0.2, prior_drift=0.1), time_step=1.0)
    slower = replace(motion, steps=3.0, speed_sum=3 * 0.1)
    assert motion.drift == pytest.approx(0.1)
    assert slower.speed == pytest.approx(0.125)
    assert slower.drift == pytest.approx(0.1 * 0.125 / 0.2)


def test_particles_stay_within_known_walls():
    walls = Walls(((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)), (0.5,) * 4, 0.5)
    mind, rng = tracker(walls=walls), np.random.default_rng(5)
    belief = watch(mind, walk(3, x=0.4, ux=1.0, uy=0.0))
    away = Pose(0.0, 0.0, math.pi)
    for step in range(4):
        time = 4.0 + 2 * step
        belief = mind.update(belief, GAIT, Observation(time, away, (Frame(time, away),)), rng=rng)
    outside = (np.abs(belief.cloud.x) > 0.51) | (np.abs(belief.cloud.y) > 0.51)
    assert belief.cloud.weight[outside].sum() < 0.02
    assert belief.motion.turns < 0.2  # a bounce is no turn by chance


def test_errors_of_odometry_make_it_less_sure():
    spreads = []
    for error in (0.0, 0.1):
        mind, rng = tracker(turn_error=error, distance_error=error), np.random.default_rng(6)
        belief = watch(mind, walk(3))
        turned = Pose(0.0, 0.0, 2.5)
        belief = mind.update(belief, GAIT, Observation(4.0, turned, (Frame(4.0, turned),)), rng=rng)
        spreads.append(belief.spread)
    assert spreads[1] > 1.5 * spreads[0]


def test_the_table_is_what_the_particles_say():
    belief = watch(tracker(), walk(7, x=0.34))
    table = belief.table()
    assert table["probability"].sum() == pytest.approx(1.0)
    assert table["probability"].idxmax() == ("400 to 500 mm", "-45 to -15 deg")  # at (0.34, 0.3): 453 mm, 41 deg left
    cell = table.loc[table["probability"].idxmax()]
    assert 4.0 < cell["sightings"] <= 7.0
    assert cell["still"] < 0.05
    assert (table["sightings"] <= 7.0 + 1e-9).all()


def test_a_sighting_of_the_bearing_alone_counts():
    mind = tracker("unknown")
    detection = mind.camera.detection_of(0.5)
    assert math.isnan(detection.seen.distance)
    belief = mind.start(Observation(0.0, HERE, (Frame(0.0, HERE, (detection,)),)))
    seen = belief.seen()
    assert float(belief.cloud.weight @ (np.abs(seen.angle - 0.5) < 0.1)) > 0.9


@pytest.mark.parametrize(
    ("settings", "message"),
    [({"particles": 3}, "particles"), ({"still": 1.0}, "a probability"), ({"unknown_range": 0}, "metres > 0")],
)
def test_wrong_settings_are_named(settings, message):
    with pytest.raises(bh.InputError, match=message):
        ParticleTracker(PerceptionContext(), **settings)


# --- expected counts ---------------------------------------------------------------------------------


def test_expected_counts_sum_to_one_in_any_order_and_are_read_again(tmp_path):
    rng = np.random.default_rng(7)
    steps = [
        (Polar(rng.uniform(0.1, 0.2, 300), rng.normal(0, 0.3, 300), rng.normal(0, 0.5, 300)), rng.random(300))
        for _ in range(5)
    ]
    forwards, backwards = bh.PreyModel(), bh.PreyModel()
    for transitions, weights in steps:
        forwards.expect(transitions, weights)
    for transitions, weights in steps[::-1]:
        backwards.expect(transitions, weights)
    assert forwards == backwards
    assert forwards.observations == 5
    assert forwards.counts["count"].sum() == 5.0
    assert forwards.predict(3) == backwards.predict(3)
    forwards.save(tmp_path / "prey.json")
    assert bh.PreyModel.load(tmp_path / "prey.json") == forwards
    drawn = forwards.sample_paths(1, 20_000, rng=np.random.default_rng(0))
    assert drawn.forward[:, 1].mean() == pytest.approx(float(forwards.predict(1).forward), abs=0.002)


def test_a_sure_expectation_is_an_observation():
    sure, seen = bh.PreyModel(), bh.PreyModel()
    sure.expect(Polar(np.full(3, 0.16), np.zeros(3), np.full(3, 0.1)), np.array([0.2, 0.3, 0.5]))
    seen.observe(Polar(0.16, 0.0, 0.1))
    assert sure == seen
    assert sure.counts["count"].tolist() == [1]


@pytest.mark.parametrize("weights", [[0.0, 0.0], [1.0, math.nan], [1.0, -1.0]])
def test_expectations_that_are_none_are_refused(weights):
    with pytest.raises(bh.InputError, match="expected transitions"):
        bh.PreyModel().expect(Polar(np.full(2, 0.1), np.zeros(2), np.zeros(2)), np.array(weights))
