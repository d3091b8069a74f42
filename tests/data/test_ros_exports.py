"""Logs as ROS writes them to text: quaternions, epochs in nanoseconds, dotted names, commands in their own file."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.core.errors import DataError, InputError

EPOCH = 1_700_000_000_000_000_000  # ns
ATTITUDE = [f"field.pose.pose.orientation.{axis}" for axis in "xyzw"]


def arcs() -> tuple[np.ndarray, np.ndarray]:
    """Poses [N, 3] and commands [N, 2], 20 a second: ahead at 0.3 m/s for 2 s, then arcs at 1 rad/s, and so on."""
    told = np.repeat(np.tile([[0.3, 0.0], [0.3, 1.0]], (10, 1)), 40, axis=0)
    yaw = np.concatenate([[0.0], np.cumsum(told[:, 1] * 0.05)[:-1]])
    steps = told[:, 0] * 0.05 * np.sinc(told[:, 1] * 0.025 / np.pi) * np.exp(1j * (yaw + told[:, 1] * 0.025))
    place = np.concatenate([[0.0], np.cumsum(steps)[:-1]])
    return np.column_stack([place.real, place.imag, yaw]), told


def exported(folder: Path) -> tuple[Path, Path]:
    """Odometry whose commands began to be written two seconds before it, each when it changes."""
    poses, told = arcs()
    stamps = EPOCH + np.arange(len(poses)) * 50_000_000
    half = poses[40:, 2] / 2
    quaternion = dict(zip(ATTITUDE, (0 * half, 0 * half, np.sin(half), np.cos(half)), strict=True))
    place = {f"field.pose.pose.position.{axis}": poses[40:, i] for i, axis in enumerate("xy")}
    measured = {"field.twist.twist.linear.x": told[40:, 0] * 0.9, "field.twist.twist.angular.z": told[40:, 1] * 0.9}
    pd.DataFrame({"%time": stamps[40:], **place, **quaternion, **measured}).to_csv(folder / "odom.csv", index=False)
    changes = np.arange(0, len(told), 40)
    command = {"field.linear.x": told[changes, 0], "field.linear.y": 0.0, "field.angular.z": told[changes, 1]}
    pd.DataFrame({"%time": stamps[changes], **command}).to_csv(folder / "cmd_vel.csv", index=False)
    return folder / "odom.csv", folder / "cmd_vel.csv"


def test_odometry_and_commands_of_two_files_by_the_shell(bayeshunt, tmp_path) -> None:
    exported(tmp_path)
    told = ("odom.csv", "--commands", "cmd_vel.csv", "--time-step", "1", "--gaits", "held")
    out, _ = bayeshunt("ingest", "log", *told, "--json", "--out", "table.parquet")
    facts = json.loads(out)
    assert facts["gaits"] == 2
    assert "time in ns (an epoch, as its size says)" in facts["notes"]
    table = bh.load_dataset(tmp_path / "table.parquet")
    for (speed, turn), rows in table.groupby(["command_0", "command_1"]):
        assert len(rows) >= 17
        assert rows["heading"].to_numpy() == pytest.approx(-turn, abs=1e-6)
        assert rows["distance"].to_numpy() == pytest.approx(speed * np.sinc(turn / 2 / np.pi), abs=1e-6)
    _, said = bayeshunt("ingest", "log", "odom.csv", "odom.csv", *told[1:], "--out", "no.parquet", status=2)
    assert "--commands cmd_vel.csv: goes with one log" in said


def test_what_was_measured_is_no_command(tmp_path) -> None:
    odometry, commands = exported(tmp_path)
    with pytest.raises(DataError, match=r"no columns of the command .* --commands FILE") as caught:
        bh.read_log(odometry)
    assert "yaw (of" not in str(caught.value)
    poses, told = (pd.read_csv(path) for path in (odometry, commands))
    told = told.rename(columns=lambda name: name.replace("field", "cmd_vel"))
    both = pd.merge_asof(poses, told, on="%time")
    both.to_csv(tmp_path / "both.csv", index=False)
    columns = bh.read_log(tmp_path / "both.csv").attrs["bayeshunt"]["source"]["columns"]
    assert columns["command"] == ("cmd_vel.linear.x", "cmd_vel.angular.z")


def test_two_epochs_keep_the_time_between_them(tmp_path) -> None:
    """The commands began two seconds before the poses: not with them."""
    log = bh.read_log(*exported(tmp_path))
    poses, told = arcs()
    np.testing.assert_array_equal(log[["command_0", "command_1"]], told[40:])
    assert log["yaw"].to_numpy() == pytest.approx(poses[40:, 2], abs=1e-9)


def test_a_part_of_a_quaternion_is_no_heading_and_no_quaternion_is_left_out(tmp_path) -> None:
    poses, told = arcs()
    half = poses[:, 2] / 2
    log = pd.DataFrame({"t_s": np.arange(len(poses)) * 0.05, "x": poses[:, 0], "y": poses[:, 1], "orientation_x": 0.0,
                        "orientation_y": 0.0, "orientation_z": np.sin(half), "orientation_w": np.cos(half),
                        "cmd_left": told[:, 0], "cmd_right": told[:, 1]})  # fmt: skip
    log.loc[7, "orientation_w"] = 0.0
    log.to_csv(tmp_path / "log.csv", index=False)
    read = bh.read_log(tmp_path / "log.csv")
    assert len(read) == len(log) - 1
    assert read.attrs["bayeshunt"]["dropped"] == {"no pose": 1}
    assert read["yaw"].iloc[-1] == pytest.approx(poses[-1, 2], abs=1e-9)


def test_small_numbers_are_not_taken_for_an_epoch(tmp_path) -> None:
    poses, told = arcs()
    log = pd.DataFrame({"time": np.arange(len(poses)) * 50.0, "x": poses[:, 0], "y": poses[:, 1], "yaw": poses[:, 2],
                        "cmd_left": told[:, 0], "cmd_right": told[:, 1]})  # fmt: skip
    log.to_csv(tmp_path / "log.csv", index=False)
    with pytest.raises(InputError, match=r"steps by 50; say its unit: time_unit= \(--time-unit s\|ms\|us\|ns\)"):
        bh.read_log(tmp_path / "log.csv")
