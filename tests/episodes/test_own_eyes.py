"""Detections of one's own eyes in a loop without our world: the same belief and planners."""

import math

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.config.schema import SensingSettings
from bayeshunt.protocols import Frame, Observation

CAMERA = SensingSettings(preset="camera_narrow", camera={"target_width": 0.057})


def world(hunter, prey, model, rng):
    """A loop of somebody's own: the hunter ends where its model expects, the prey walks on."""
    camera, time, poses = CAMERA.camera, 0.0, []
    plan = hunter.step(bh.Pose(1.0, 2.0, 0.5), _look(0.0, bh.Pose(1.0, 2.0, 0.5), prey, camera, rng))
    own = bh.Pose(1.0, 2.0, 0.5)
    for _ in range(12):
        frames = []
        end = own.compose(model.predict(plan.gait))
        for share in (0.5, 1.0):
            time += 0.5 * model.gaits.duration
            prey = prey.compose(bh.Polar(0.048 * 0.5 * model.gaits.duration, 0.0, 0.0))
            pose = end if share == 1.0 else bh.Pose((own.x + end.x) / 2, (own.y + end.y) / 2, own.theta)
            frames += _look(time, pose, prey, camera, rng).frames
        own = end
        plan = hunter.step(own, Observation(time, own, tuple(frames)), time)
        poses.append((hunter.belief, own, prey))
    return poses


def _look(time, own, prey, camera, rng):
    seen = own.relative(prey)
    if abs(seen.angle) > 0.5 * camera.fov and time > 0:
        return Observation(time, own, (Frame(time, own),))
    width = camera.focal * 0.057 / seen.distance + rng.normal(0.0, camera.pixel_noise)
    found = camera.detection_of(seen.angle + rng.normal(0.0, camera.bearing_sd), width_px=width)
    return Observation(time, own, (Frame(time, own, (found,)),))


def test_detections_of_bearing_and_width_go_in_and_the_prey_is_followed(khepera_model):
    hunter = bh.Hunter("search", khepera_model, sensing=CAMERA, seed=3)
    prey = bh.Pose(1.3, 2.1, 1.0)
    poses = world(hunter, prey, khepera_model, np.random.default_rng(3))
    off = []
    for belief, own, true in poses:
        if belief.last_seen == 0.0:
            there = belief.own.relative(belief.mean)  # from the hunter, as in its own frame
            off.append(math.hypot(there.forward - own.relative(true).forward, there.right - own.relative(true).right))
    assert len(off) >= 2
    assert np.median(off) < 0.03
    assert not hunter.prey_model.is_empty
    assert "the prey" in hunter.explain()


def test_a_list_of_detections_is_one_look(khepera_model):
    one, two = (bh.Hunter("search", khepera_model, sensing=CAMERA, seed=3) for _ in range(2))
    here = bh.Pose(1.0, 2.0, 0.5)
    found = CAMERA.camera.detection_of(0.3, width_px=30)
    one.step(here, [found])
    two.step(here, Observation(0.0, here, (Frame(0.0, here, (found,)),)))
    assert one.belief == two.belief
    assert one.belief.last_seen == 0.0
    one.step(here, [])
    assert one.belief.last_seen == pytest.approx(khepera_model.gaits.duration)


def test_a_preset_by_name_will_do(khepera_model):
    hunter = bh.Hunter("search", khepera_model, sensing="camera_narrow")
    plan = hunter.step(bh.Pose(0.0, 0.0, 0.0), None)
    assert plan.gait in khepera_model.gaits.names
    assert hunter.belief.last_seen == math.inf
    assert hunter.situation.camera.fov_deg == 60
    with pytest.raises(bh.InputError, match="camera_narow"):
        bh.Hunter("search", khepera_model, sensing="camera_narow")
