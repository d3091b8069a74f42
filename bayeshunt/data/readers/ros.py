"""ROS bags (ROS 1, rosbag2, mcap) as one table: odometry and the last command before it. Needs the extra ``ros``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd

from bayeshunt.core.errors import DataError, InputError
from bayeshunt.data.readers.quaternions import yaw_of

__all__ = ["read_bag"]

_POSES = ("nav_msgs/msg/Odometry", "geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/PoseWithCovarianceStamped")
_COMMANDS = ("geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped")


def read_bag(path: Path) -> pd.DataFrame:
    """Return columns time [s], x, y [m], yaw [rad], linear_x, angular_z of every pose; the first topic of each kind.

    Raises InputError without the extra, DataError in one line for a bag that cannot be read or lacks either topic.
    """
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise InputError(f'{path}: ROS bags need rosbags: pip install ".[ros]" in the folder of bayeshunt') from None
    if not path.exists():
        raise DataError(f"{path}: no such file; give a ROS bag")
    try:
        with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
            chosen = [_topic(reader, kinds, path) for kinds in (_POSES, _COMMANDS)]
            return _table(reader, chosen)
    except (DataError, InputError):
        raise
    except Exception as error:  # rosbags, its decompressors and the system each raise their own
        reason = (str(error).splitlines() or [""])[0][:120] or type(error).__name__
        raise DataError(f"{path}: cannot be read as a ROS bag ({reason})") from None


def _topic(reader: Any, kinds: tuple[str, ...], path: Path) -> Any:
    found = sorted(
        (c for c in reader.connections if c.msgtype in kinds), key=lambda c: (kinds.index(c.msgtype), c.topic)
    )
    if not found:
        topics = ", ".join(sorted({f"{c.topic} ({c.msgtype})" for c in reader.connections})) or "nothing"
        raise DataError(f"{path}: no topic of {' or '.join(kinds)}; the bag holds {topics}")
    return found[0]


def _table(reader: Any, chosen: list[Any]) -> pd.DataFrame:
    """A row for every pose after the first command."""
    rows, command = [], None
    for connection, stamp, data in reader.messages(connections=chosen):
        message = reader.deserialize(data, connection.msgtype)
        if connection.msgtype in _COMMANDS:
            twist = getattr(message, "twist", message)
            command = (twist.linear.x, twist.angular.z)
            continue
        pose = message.pose
        pose = getattr(pose, "pose", pose)
        q = pose.orientation
        yaw = float(yaw_of(q.x, q.y, q.z, q.w))
        if command is not None:
            rows.append((stamp * 1e-9, pose.position.x, pose.position.y, yaw, *command))
    table = pd.DataFrame(rows, columns=["time", "x", "y", "yaw", "linear_x", "angular_z"], dtype=float)
    table["time"] -= table["time"].min()
    return table
