"""The camera: what it finds, how it measures, from where it looks; the settings that name one."""

import math

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.config.schema import SensingSettings
from bayeshunt.config.schema.camera import CAMERAS, CameraSettings
from bayeshunt.core.geometry import Pose, in_frame
from bayeshunt.core.messages import Moment, Run
from bayeshunt.perception.sensors.camera import Camera, look_moments
from bayeshunt.perception.setting import PerceptionContext

HERE = Pose(0.0, 0.0, 0.0)
SURE = {"detection": 1.0, "clutter": 0.0, "pixel_noise": 0.0, "bearing_noise_deg": 0.0}


class Plane:
    def __init__(self, hidden=False):
        self.hidden = hidden

    def free(self, x, y):
        return True

    def blocked(self, ray):
        return self.hidden


def camera(start="unknown", origin=HERE, **settings):
    return Camera(
        PerceptionContext(2.0, 0.06, 0.06, origin, camera=CameraSettings(**{**SURE, **settings}), start=start)
    )


def look(sensor, prey, hunter=HERE, map=None, rng=None):
    run = Run((Moment(0.0, {"hunter": hunter, "prey": prey}),))
    seen = sensor.sense(run, map or Plane(), rng=rng or np.random.default_rng(0))
    return seen.frames[-1].detections


def test_a_pinhole_has_the_pixels_that_its_field_of_view_leaves():
    assert CameraSettings(**CAMERAS["camera_narrow"]).focal == pytest.approx(160 / (2 * math.tan(math.radians(30))))
    assert CameraSettings(**CAMERAS["camera_narrow"]).focal == pytest.approx(138.6, abs=0.1)
    assert CameraSettings(**CAMERAS["camera_omni"]).focal == pytest.approx(640 / (2 * math.pi))
    assert CameraSettings(**CAMERAS["camera_k213"]).reach(0.057) == pytest.approx(1.87, abs=0.01)


def test_a_prey_in_view_is_found_where_it_is():
    (found,) = look(camera(fov_deg=60), Pose(0.3, -0.1, 1.0))
    assert found.seen.distance == pytest.approx(math.hypot(0.3, 0.1))
    assert found.seen.angle == pytest.approx(math.atan2(0.1, 0.3))
    assert math.isnan(found.seen.heading)
    width, focal = 0.06, CameraSettings(fov_deg=60).focal
    assert found.sd.distance == 0.0
    noisy = CameraSettings(fov_deg=60).detection_of(0.0, distance=0.6, width=width)
    assert noisy.sd.distance == pytest.approx(0.6**2 * 0.7 / (focal * width))


@pytest.mark.parametrize(
    ("prey", "settings", "map"),
    [
        (Pose(0.2, 0.2, 0.0), {"fov_deg": 60}, None),  # at 45 deg, beside the edge at 30
        (Pose(0.5, 0.0, 0.0), {"range": 0.4}, None),
        (Pose(2.0, 0.0, 0.0), {"fov_deg": 36, "pixels": 64}, None),  # narrower than three pixels
        (Pose(0.3, 0.0, 0.0), {}, Plane(hidden=True)),
    ],
)
def test_a_prey_beside_the_view_too_far_away_or_hidden_is_not_found(prey, settings, map):
    assert look(camera(**settings), prey, map=map) == ()
    assert len(look(camera("shown", **settings), prey, map=map)) == 1  # but it may be shown once


def test_a_heading_is_seen_only_where_the_camera_sees_it():
    (found,) = look(camera(heading_noise_deg=1e-6), Pose(0.3, 0.0, 1.0))
    assert found.seen.heading == pytest.approx(-1.0, abs=1e-4)


def test_false_detections_come_as_often_as_said_and_in_view_only():
    sensor, rng = camera(clutter=0.5, fov_deg=60), np.random.default_rng(3)
    found = [d for _ in range(2000) for d in look(sensor, Pose(-1.0, 0.0, 0.0), rng=rng)]
    assert len(found) / 2000 == pytest.approx(0.5, abs=0.05)
    assert max(abs(d.seen.angle) for d in found) <= math.radians(30)
    assert max(d.seen.distance for d in found) <= 1.2


def test_it_looks_evenly_over_a_step_and_always_now():
    assert look_moments([0.5, 1.0, 1.5, 2.0], 0.0, 2.0, 2) == [1, 3]
    assert look_moments([0.5, 1.0, 1.2], 0.0, 2.0, 2) == [1, 2]  # a step that was cut short
    assert look_moments([0.0], 0.0, 2.0, 4) == [0]


def test_every_frame_has_its_own_pose():
    sensor = camera(frames=4)
    look(sensor, Pose(0.3, 0.0, 0.0))
    moments = [
        Moment(0.5 * (i + 1), {"hunter": Pose(0.0, 0.0, 0.5 * (i + 1)), "prey": Pose(0.3, 0.0, 0.0)}) for i in range(4)
    ]
    seen = sensor.sense(Run(moments), Plane(), rng=np.random.default_rng(0))
    assert [frame.pose.theta for frame in seen.frames] == [0.5, 1.0, 1.5, 2.0]
    assert [len(frame.detections) for frame in seen.frames] == [1, 1, 0, 0]  # 60 deg to each side


def test_odometry_is_exact_unless_it_is_said_to_err():
    start, there = Pose(0.5, 0.2, 1.0), Pose(0.7, 0.5, 2.0)
    exact, erring = camera(origin=start), camera(origin=start, distance_error=0.1, turn_error=0.1)
    poses = []
    for sensor in (exact, erring):
        look(sensor, there, hunter=start)
        run = Run((Moment(2.0, {"hunter": there, "prey": there}),))
        poses.append(sensor.sense(run, Plane(), rng=np.random.default_rng(1)).pose)
    assert poses[0] == in_frame(there, start)
    assert math.hypot(poses[1].x, poses[1].y) != pytest.approx(math.hypot(poses[0].x, poses[0].y), rel=1e-6)
    assert abs(poses[1].theta - poses[0].theta) < 0.5


def test_the_camera_keeps_the_rules_of_sensors():
    bh.check_sensor("camera")


# --- settings ---------------------------------------------------------------------------------------


def test_a_preset_is_a_camera_and_particles():
    sensing = SensingSettings(preset="camera_narrow")
    assert (sensing.sensor, sensing.tracker, sensing.camera.fov_deg) == ("camera", "particles", 60.0)
    assert SensingSettings(**sensing.model_dump()) == sensing
    assert SensingSettings(sensor="camera").tracker == "particles"
    assert SensingSettings() == SensingSettings(sensor="exact", tracker="exact")


@pytest.mark.parametrize("order", [1, -1])
def test_a_preset_comes_before_what_changes_it_whatever_the_order(order):
    changes = {
        "sensing.preset": "camera_narrow", "sensing.tracker": "exact", "sensing.start": "unknown",
        "sensing.camera.pixels": 200,
    }  # fmt: skip
    sensing = bh.load_experiment("paper", dict(list(changes.items())[::order])).sensing
    assert (sensing.camera.fov_deg, sensing.camera.pixels) == (60.0, 200)
    assert (sensing.tracker, sensing.start) == ("exact", "unknown")


def test_another_preset_replaces_the_camera_before_it():
    narrow = bh.load_experiment("paper", {"sensing.preset": "camera_narrow", "sensing.start": "unknown"})
    wide = bh.load_experiment(narrow, {"sensing.preset": "camera_wide"}).sensing
    assert (wide.camera.fov_deg, wide.camera.pixels, wide.start) == (120.0, 640, "unknown")
    assert narrow.published == {}  # no camera hunts are published


def test_an_unknown_camera_is_named():
    with pytest.raises(bh.ConfigError, match=r"unknown camera 'camera_wid'; did you mean 'camera_wide'"):
        bh.load_experiment("paper", {"sensing.preset": "camera_wid"})
    with pytest.raises(bh.ConfigError, match=r"sensing\.camera\.fov_deg.*361"):
        bh.load_experiment("paper", {"sensing.preset": "camera_wide", "sensing.camera.fov_deg": 361})
