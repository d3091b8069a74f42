"""Where a hunt starts: the hunter's pose in the arena, and that nobody starts in a wall."""

import math

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.core.errors import ConfigError
from bayeshunt.core.geometry import Pose, in_frame

TURNED = {"protocol.hunter_x": 0.1, "protocol.hunter_y": -0.05, "protocol.hunter_theta": math.pi / 2}


def test_the_hunter_starts_in_the_centre_along_x_unless_told_otherwise():
    for name in ("paper", "oses2010"):
        hunter, prey = bh.load_experiment(name).starting_poses(1.0)
        assert hunter == (0.0, 0.0, 0.0)
        assert prey == pytest.approx((5 * 0.057 * math.cos(1.0), -5 * 0.057 * math.sin(1.0), 0.0))


def test_a_start_pose_turns_counter_clockwise_and_the_bearing_clockwise():
    hunter, prey = bh.load_experiment("paper", TURNED).starting_poses(math.pi / 2)
    assert hunter == (0.1, -0.05, math.pi / 2)
    # facing along y, a quarter turn clockwise is along x
    assert prey == pytest.approx((0.1 + 0.285, -0.05, math.pi / 2))


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"protocol.hunter_x": 0.58}, "the hunter would start in a wall"),
        ({"protocol.hunter_y": -0.58}, "the hunter would start in a wall"),
        ({"protocol.hunter_x": 0.3}, r"the prey would start in a wall \(theta 0\); make them at least 1\.227 m"),
        ({"arenas.walled.height": 0.6}, r"the prey would start in a wall \(theta 5\)"),
        ({"protocol.hunter_theta": 90.0}, "rad"),
        ({"protocol.hunter_x": math.nan}, "hunter_x"),
    ],
)
def test_nobody_starts_in_a_wall(change, says):
    with pytest.raises(ConfigError, match=says) as caught:
        bh.load_experiment("paper", change).check_arena("walled")
    assert "\n" not in str(caught.value)
    if "theta" not in next(iter(change)) and math.isfinite(next(iter(change.values()))):
        bh.load_experiment("paper", change).check_arena("open")


def test_a_start_is_checked_at_the_bearing_of_the_hunt(khepera_model):
    settings = bh.load_experiment("paper", {"protocol.hunter_x": 0.3, "protocol.thetas": [3.0]})
    planner = bh.make_planner("reactive", khepera_model)
    assert bh.hunt(settings, planner, theta=3.0, seed=0).frame["hunter_x"][0] == pytest.approx(0.3)
    with pytest.raises(ConfigError, match=r"prey would start in a wall \(theta 0\.1\)"):
        bh.hunt(settings, planner, theta=0.1, seed=0)


def test_a_planner_knows_odometry_and_not_the_arena(khepera_model):
    """In the open the start makes no difference to what a hunter sees: everything is relative, odometry too."""
    planner = bh.make_planner("intercept", khepera_model)
    settings = (bh.load_experiment("paper", change) for change in ({}, TURNED))
    centre, moved = (bh.hunt(one, planner, arena="open", theta=0.0, seed=1) for one in settings)
    assert moved.situations[0].pose == (0.0, 0.0, 0.0)
    assert list(centre.frame["gait"][:3]) == list(moved.frame["gait"][:3])
    one, other = centre.situations[2].pose, moved.situations[2].pose
    assert np.hypot(one.x - other.x, one.y - other.y) < 1e-4  # Box2D is float32
    assert moved.frame["hunter_x"][0] == pytest.approx(0.1)


def test_a_room_is_learned_in_the_frame_of_the_start(khepera_model):
    """The walls of a room stand where the hunter's odometry meets them."""
    settings = bh.load_experiment("paper", {"protocol.hunter_x": 0.2})
    offsets = bh.learn_room(settings, steps=300, seed=1, model=khepera_model).walls()["offset_m"].to_numpy()
    # the centre may come within a radius of a wall: 0.6 - 0.0285, seen from 0.2 m off the centre
    assert np.sort(offsets) == pytest.approx([0.3715, 0.5715, 0.5715, 0.7715], abs=0.005)


def test_a_frame_at_the_origin_moves_no_bit():
    pose = Pose(0.1, 0.7, 4.0)
    assert in_frame(pose, Pose(0.0, 0.0, 0.0)) is pose
    assert in_frame(Pose(1.0, 3.0, 1.0), Pose(1.0, 1.0, math.pi / 2)) == pytest.approx((2.0, 0.0, 1.0 - math.pi / 2))
