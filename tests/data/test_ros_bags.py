"""ROS bags of both generations: odometry and the command before it become a log."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import bayeshunt as bh
from bayeshunt.core.errors import BayesHuntError

pytest.importorskip("rosbags")


def _arc(number: int) -> tuple[float, float, float]:
    """Pose [m, m, rad] after so many tenths of a second at 0.5 m/s and 0.2 rad/s to the left."""
    turn = 0.02 * number
    return 2.5 * math.sin(turn), 2.5 * (1 - math.cos(turn)), turn


def _write(writer, store, stamped: bool, poses: bool) -> None:
    types = store.types
    stamp = types["builtin_interfaces/msg/Time"]
    vector, quaternion, point = (types[f"geometry_msgs/msg/{name}"] for name in ("Vector3", "Quaternion", "Point"))
    header = types["std_msgs/msg/Header"]
    numbered = {"seq": 0} if "seq" in header.__dataclass_fields__ else {}
    twist = types["geometry_msgs/msg/Twist"]
    name = "TwistStamped" if stamped else "Twist"
    told = writer.add_connection("/cmd_vel", f"geometry_msgs/msg/{name}", typestore=store)
    odometry = writer.add_connection("/odom", "nav_msgs/msg/Odometry", typestore=store) if poses else None
    dump = store.serialize_cdr if not numbered else store.serialize_ros1
    for number in range(101):
        now, (x, y, yaw) = number * 100_000_000, _arc(number)
        at = header(stamp=stamp(sec=now // 10**9, nanosec=now % 10**9), frame_id="odom", **numbered)
        asked = twist(linear=vector(x=0.5, y=0.0, z=0.0), angular=vector(x=0.0, y=0.0, z=0.2))
        if number % 5 == 0:
            message = types["geometry_msgs/msg/TwistStamped"](header=at, twist=asked) if stamped else asked
            writer.write(told, now, dump(message, told.msgtype))
        if odometry is None:
            continue
        pose = types["geometry_msgs/msg/Pose"](
            position=point(x=x, y=y, z=0.0),
            orientation=quaternion(x=0.0, y=0.0, z=math.sin(yaw / 2), w=math.cos(yaw / 2)),
        )
        still = np.zeros(36)
        message = types["nav_msgs/msg/Odometry"](
            header=at, child_frame_id="base",
            pose=types["geometry_msgs/msg/PoseWithCovariance"](pose=pose, covariance=still),
            twist=types["geometry_msgs/msg/TwistWithCovariance"](twist=asked, covariance=still),
        )  # fmt: skip
        writer.write(odometry, now + 1, dump(message, odometry.msgtype))


def bag(folder: Path, generation: int, *, stamped: bool = False, poses: bool = True) -> Path:
    """A bag of ten seconds along an arc."""
    from rosbags import rosbag1, rosbag2
    from rosbags.typesys import Stores, get_typestore

    if generation == 1:
        path, store = folder / "drive.bag", get_typestore(Stores.ROS1_NOETIC)
        with rosbag1.Writer(path) as writer:
            _write(writer, store, stamped, poses)
        return path
    path, store = folder / "drive", get_typestore(Stores.ROS2_HUMBLE)
    with rosbag2.Writer(path, version=8) as writer:
        _write(writer, store, stamped, poses)
    return path


@pytest.mark.parametrize(("generation", "stamped"), [(1, False), (2, False), (2, True)])
def test_a_bag_becomes_gaits(tmp_path, generation, stamped) -> None:
    log = bh.read_log(bag(tmp_path, generation, stamped=stamped))
    assert len(log) == 101
    table = bh.gaits_from_log(log, time_step=1.0, gaits="held")
    assert len(table) >= 9
    assert table["gait"].nunique() == 1
    assert table[["command_0", "command_1"]].to_numpy().tolist()[0] == [0.5, 0.2]
    assert table["distance"].to_numpy() == pytest.approx(5 * math.sin(0.1), abs=1e-3)
    assert table["heading"].to_numpy() == pytest.approx(-0.2, abs=1e-6)  # to the left is anticlockwise


def test_what_a_bag_lacks_is_one_line(tmp_path) -> None:
    with pytest.raises(BayesHuntError, match=r"no topic of nav_msgs/msg/Odometry .* the bag holds /cmd_vel") as told:
        bh.read_log(bag(tmp_path, 1, poses=False))
    assert "\n" not in str(told.value)
    (tmp_path / "bad.bag").write_bytes(b"#ROSBAG V2.0\n" + b"\0" * 40)
    with pytest.raises(BayesHuntError, match="cannot be read as a ROS bag") as told:
        bh.read_log(tmp_path / "bad.bag")
    assert "\n" not in str(told.value)
