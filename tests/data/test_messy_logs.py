# ruff: noqa: E501
"""Twenty ways in which a log may be a mess: each becomes the same babbling table, and a model in one command."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.core.errors import DataError, InputError

STEP = 0.05  # s from row to row
HELD = 41  # rows of one command: two windows of a second and a row
WINDOWS = 60


def drive() -> pd.DataFrame:
    """A robot with four commands, each held two seconds, exact arcs, logged 20 times a second."""
    commands = [(0.1, 0.1), (0.2, 0.1), (0.1, 0.2), (-0.1, 0.1)]
    order = np.random.default_rng(5).permutation(np.repeat(np.arange(4), WINDOWS // 4)).tolist()
    rows, x, y, yaw = [], 0.0, 0.0, 0.0
    for number, which in enumerate(order):
        left, right = commands[which]
        speed, turn = (left + right) / 2, (right - left) * 5
        for i in range(HELD):
            rows.append(((number * HELD + i) * STEP, x, y, yaw, left, right))
            half = turn * STEP / 2
            x += speed * STEP * np.sinc(half / np.pi) * math.cos(yaw + half)
            y += speed * STEP * np.sinc(half / np.pi) * math.sin(yaw + half)
            yaw += turn * STEP
    return pd.DataFrame(rows, columns=["time", "x", "y", "yaw", "cmd_left", "cmd_right"])


def degrees(log: pd.DataFrame) -> pd.DataFrame:
    return log.assign(yaw=np.degrees(log["yaw"]) % 360)


def put(log: pd.DataFrame, row: int, column: str, value: object) -> pd.DataFrame:
    log = log.astype({column: object})
    log.loc[row, column] = value
    return log


def named(log: pd.DataFrame, **names: str) -> pd.DataFrame:
    return log.rename(columns=names)


def text(frame: pd.DataFrame, **settings: object) -> str:
    return frame.to_csv(index=False, **settings)


#: Name -> (the file's text, options, rows that may be lost).
MESSES: dict[str, tuple[Callable[[pd.DataFrame], str], tuple[str, ...], int]] = {
    "clean": (text, (), 0),
    "other names": (lambda d: text(named(d, time="Timestamp", x="Pos X", y="Pos Y", yaw="Theta", cmd_left="vL", cmd_right="vR")), ("--command", "vL,vR"), 0),
    "names with units": (lambda d: text(named(d, time="Time [s]", x="x [m]", y="y [m]", yaw="yaw [rad]")), (), 0),
    "milliseconds by name": (lambda d: text(named(d.assign(time=d.time * 1000), time="t_ms")), (), 0),
    "milliseconds by option": (lambda d: text(d.assign(time=d.time * 1000)), ("--time-unit", "ms"), 0),
    "microseconds of the epoch": (lambda d: text(named(d.assign(time=1.7e15 + (d.time * 1e6).round()), time="stamp_us"), float_format="%.9f"), (), 0),
    "times of day": (lambda d: text(d.assign(time=(pd.Timestamp("2024-05-01 09:59:00") + pd.to_timedelta(d.time, unit="s")).dt.strftime("%H:%M:%S.%f"))), (), 0),
    "dates": (lambda d: text(d.assign(time=(pd.Timestamp("2024-05-01 09:59:00") + pd.to_timedelta(d.time, unit="s")).dt.strftime("%Y-%m-%dT%H:%M:%S.%fZ"))), (), 0),
    "degrees and a wrap by name": (lambda d: text(named(degrees(d), yaw="heading_deg")), (), 0),
    "degrees and a wrap by option": (lambda d: text(degrees(d)), ("--angle", "deg"), 0),
    "radians that wrap": (lambda d: text(d.assign(yaw=np.angle(np.exp(1j * d.yaw)))), (), 0),
    "millimetres by name": (lambda d: text(named(d.assign(x=d.x * 1000, y=d.y * 1000), x="x_mm", y="y_mm")), (), 0),
    "centimetres by option": (lambda d: text(d.assign(x=d.x * 100, y=d.y * 100)), ("--unit", "cm"), 0),
    "semicolons and decimal commas": (lambda d: text(d, sep=";", decimal=","), (), 0),
    "tabs, a mark and comments": (lambda d: "\ufeff# robot 7\n" + text(d, sep="\t"), (), 0),
    "holes": (lambda d: text(put(put(d, 45, "x", np.nan), 999, "yaw", "--")), (), 0),
    "a word among numbers": (lambda d: text(put(d, 77, "y", "ERROR")), (), 0),
    "rows twice": (lambda d: text(pd.concat([d.iloc[:100], d.iloc[98:100], d.iloc[100:]])), (), 0),
    "rows that go back": (lambda d: text(pd.concat([d.iloc[:300], d.iloc[250:253], d.iloc[300:]])), (), 0),
    "a clock that starts again": (lambda d: text(d.assign(time=np.where(np.arange(len(d)) < HELD * 30, d.time, d.time - d.time[HELD * 30]))), (), 0),
    "a gap": (lambda d: text(d.drop(index=range(HELD * 10 + 5, HELD * 12 + 5))), (), 5),
    "columns that nobody asked for": (lambda d: text(d.assign(battery=12.1, mode="auto", gyro_x=0.0)), (), 0),
}  # fmt: skip


@pytest.mark.parametrize("mess", MESSES)
def test_a_mess_becomes_the_same_table_and_a_model(mess: str, bayeshunt, tmp_path) -> None:
    written, options, lost = MESSES[mess]
    (tmp_path / "log.csv").write_text(written(drive()), encoding="utf-8")
    arguments = ("log.csv", "--time-step", "1", "--gaits", "held", "--body-length", "0.1", *options)
    out, _ = bayeshunt("ingest", "log", *arguments, "--json", "--out", "table.parquet")
    facts = json.loads(out)
    assert facts["gaits"] == 4
    assert 2 * WINDOWS - lost <= facts["rows"] <= 2 * WINDOWS
    table = bh.load_dataset(tmp_path / "table.parquet")
    for (left, right), rows in table.groupby(["command_0", "command_1"]):
        speed, turn = (left + right) / 2, (right - left) * 5
        assert rows["heading"].to_numpy() == pytest.approx(-turn, abs=1e-3)
        assert rows["distance"].to_numpy() == pytest.approx(abs(speed * np.sinc(turn / 2 / np.pi)), abs=2e-4)
    out, _ = bayeshunt("fit", *arguments, "--json", "--out", "model.json")
    assert json.loads(out)["rows"] == facts["rows"]


def test_the_gait_before_is_known_only_within_an_unbroken_run(tmp_path) -> None:
    log = drive().drop(index=range(HELD * 10, HELD * 12))
    log.to_csv(tmp_path / "log.csv", index=False)
    read = bh.read_log(tmp_path / "log.csv")
    assert read["run"].nunique() == 2
    table = bh.gaits_from_log(read, time_step=1.0, gaits="held")
    first = table.groupby("run").head(1)
    assert first["previous_gait"].isna().all()
    assert table.drop(first.index)["previous_gait"].notna().all()
    within = table[table["run"] == 0]
    assert within["previous_gait"].iloc[1:].tolist() == within["gait"].iloc[:-1].tolist()


def test_two_files_with_two_clocks(tmp_path) -> None:
    log = drive()
    log[["time", "x", "y", "yaw"]].to_csv(tmp_path / "poses.csv", index=False)
    changes = log.iloc[::HELD]
    changes.assign(time=changes.time + 1000)[["time", "cmd_left", "cmd_right"]].to_csv(
        tmp_path / "told.csv", index=False
    )
    with pytest.raises(DataError, match="offset="):
        bh.read_log(tmp_path / "poses.csv", tmp_path / "told.csv")
    read = bh.read_log(tmp_path / "poses.csv", tmp_path / "told.csv", offset=-1000)
    assert len(bh.gaits_from_log(read, time_step=1.0, gaits="held")) == 2 * WINDOWS


@pytest.mark.parametrize(
    ("change", "arguments", "problem"),
    [
        (lambda d: d.drop(columns="yaw"), {}, "no column 'yaw'"),
        (lambda d: d.drop(columns="cmd_left"), {"command": ("left", "right")}, "column 'left' is missing"),
        (lambda d: d.drop(columns="time"), {}, "no column of time"),
        (lambda d: d.assign(time=d.time * 1000), {}, "time_unit="),
        (degrees, {}, "degrees or radians"),
        (lambda d: d, {"unit": "miles"}, "unknown unit"),
        (lambda d: d, {"angle": "grad"}, "unknown unit"),
        (lambda d: d, {"angle": "degrees"}, "unknown unit of angles 'degrees'; did you mean 'deg'"),
        (lambda d: d, {"unit": "Meters"}, "did you mean 'm'"),
        (lambda d: d, {"time_unit": "milliseconds"}, "did you mean 'ms'"),
        (lambda d: named(d, x="east", y="north", yaw="nose", cmd_left="a", cmd_right="b"), {},
         r"no column 'x', 'y', 'yaw' of the pose nor columns of the command .* pose=.*X,Y,YAW\) and command="),
        (lambda d: d.assign(x=np.nan), {}, "no row has"),
    ],
)  # fmt: skip
def test_what_cannot_be_known_is_asked_for(change, arguments, problem: str, tmp_path) -> None:
    change(drive()).to_csv(tmp_path / "log.csv", index=False)
    with pytest.raises((DataError, InputError), match=problem) as caught:
        bh.read_log(tmp_path / "log.csv", **arguments)
    assert "\n" not in str(caught.value)


def test_a_clockwise_heading_is_warned_of(tmp_path) -> None:
    log = drive()
    log.assign(yaw=-log.yaw).to_csv(tmp_path / "log.csv", index=False)
    assert "warning" in " ".join(bh.read_log(tmp_path / "log.csv").attrs["bayeshunt"]["notes"])
    log.to_csv(tmp_path / "log.csv", index=False)
    assert "warning" not in " ".join(bh.read_log(tmp_path / "log.csv").attrs["bayeshunt"]["notes"])


def test_gaps_and_fewer_gaits_than_asked_are_said(tmp_path) -> None:
    log = drive()
    log.loc[len(log) // 2 :, "time"] += 20
    log.to_csv(tmp_path / "log.csv", index=False)
    read = bh.read_log(tmp_path / "log.csv")
    notes = bh.gaits_from_log(read, time_step=1.0, gaits=9).attrs["bayeshunt"]["notes"]
    assert "2 unbroken runs, the longest gap 20 s: no window bridges one" in notes
    assert "4 gaits, not the 9 asked for: the log holds only 4 different commands" in notes
    drive().to_csv(tmp_path / "whole.csv", index=False)
    whole = bh.gaits_from_log(bh.read_log(tmp_path / "whole.csv"), time_step=1.0, gaits=4).attrs["bayeshunt"]["notes"]
    assert not any("gap" in note or "asked for" in note for note in whole)


def test_windows_keep_their_rows_and_index() -> None:
    frame = pd.DataFrame({"cmd_left": [1.0, 1, 2, 2], "cmd_right": 1.0, "x": [0.1, 0.2, 0.3, 0.4], "y": [0, 0.1, 0, 0],
                          "yaw": [0, 0.5, 0, 0], "day": 3}, index=[7, 5, 9, 2])  # fmt: skip
    table = bh.gaits_from_windows(frame, time_step=2.0, gaits=25)
    assert table.index.tolist() == [7, 5, 9, 2]
    assert table["gait"].nunique() == 2
    assert table["angle"].iloc[1] < 0 < frame["y"].iloc[1]  # to the left is anticlockwise
    assert table["heading"].tolist() == pytest.approx([0, -0.5, 0, 0])
    assert table["day"].tolist() == [3] * 4
    assert table[["command_0", "command_1"]].to_numpy().tolist() == frame[["cmd_left", "cmd_right"]].to_numpy().tolist()
    assert table["previous_gait"].isna().tolist() == [True, False, False, False]
    bad = frame.assign(x=[0.1, np.nan, 0.3, 0.4])
    with pytest.raises(DataError, match="row 1: x"):
        bh.gaits_from_windows(bad, time_step=2.0)
    kept = bh.gaits_from_windows(bad, time_step=2.0, drop=True)
    assert kept.index.tolist() == [7, 9, 2]
    assert kept["previous_gait"].isna().tolist() == [True, True, False]  # the row between is gone
    for wrong, problem in (
        ({"command": ("a",)}, "column 'a'"),
        ({"time_step": None}, "time_step"),
        ({"gaits": "some"}, "'some'"),
    ):
        with pytest.raises((DataError, InputError), match=problem):
            bh.gaits_from_windows(frame, **{"time_step": 2.0, **wrong})


def test_a_text_table_keeps_its_gaits_as_they_are_written(tmp_path, bayeshunt) -> None:
    rows = "gait,distance,angle,heading\n01,0.3,0,0\n1,0.2,-1,0\n1.0,0.1,1,0\n"
    for text in (rows, rows.replace(",", ";"), rows.replace(",", "\t")):
        (tmp_path / "t.csv").write_text(text)
        bayeshunt("fit", "t.csv", "--out", "m.json")
        assert bh.ForwardModel.load(tmp_path / "m.json").gaits.names == ("01", "1", "1.0")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("gait,distance,angle,heading\na,0.1,0,0\nb,abc,0,0\n", "row 1: distance is 'abc'; expected a finite number"),
        ("a,0.1,0,0\nb,0.1,0,0\n", r"column '0' stands twice; names must be unique \(is the header missing\?\)"),
    ],
)
def test_a_wrong_text_table_is_one_line(text, says, tmp_path, bayeshunt) -> None:
    (tmp_path / "t.csv").write_text(text)
    _, err = bayeshunt("fit", "t.csv", "--out", "m.json", status=2)
    assert re.search(rf"t\.csv: {says}", err)
    assert not (tmp_path / "m.json").exists()


def test_a_table_of_another_program_is_fitted_without_a_robot(bayeshunt, tmp_path) -> None:
    table = pd.DataFrame(
        {"gait": ["go", "turn"] * 10, "distance": [0.3, 0.01] * 10, "angle": 0.0, "heading": [0, 1.5] * 10}
    )
    table.to_csv(tmp_path / "t.csv", index=False)
    table.to_parquet(tmp_path / "t.parquet")
    for name in ("t.csv", "t.parquet"):
        bayeshunt("fit", name, "--out", "m.json")
        out, _ = bayeshunt("query", "m.json", "--distance", "0.3", "--angle", "0", "--json")
        assert json.loads(out)["best"] == "go"


@pytest.mark.parametrize("jitter", [0.0, 0.002])
@pytest.mark.parametrize("rows", [10, 9])
def test_a_hold_of_one_time_step_lasts_up_to_the_next_command(jitter: float, rows: int) -> None:
    rng = np.random.default_rng(3)
    wheels = [(left, right) for left in (0.1, 0.2) for right in (0.1, 0.15, 0.2, 0.25)]
    told = np.repeat(np.array(wheels * 22), rows, axis=0)
    time = np.arange(len(told)) / 10
    time += rng.uniform(-jitter, jitter, len(time))
    x = np.concatenate([[0.0], np.cumsum(told[:-1].mean(axis=1) * np.diff(time))])
    log = pd.DataFrame({"time": time, "x": x, "y": 0.0, "yaw": 0.0, "command_0": told[:, 0], "command_1": told[:, 1],
                        "run": 0})  # fmt: skip
    table = bh.gaits_from_log(log, time_step=1.0, gaits="held")
    assert table["gait"].nunique() == 8
    assert len(table) == 22 * 8 - 1  # the last has no pose at its end
    assert "commands are held: windows lie within one" in table.attrs["bayeshunt"]["notes"]
    assert table[["command_0", "command_1"]].to_numpy().tolist() == told[::rows][:-1].tolist()
    assert table["previous_gait"].iloc[1:].tolist() == table["gait"].iloc[:-1].tolist()
    if rows == 10:
        assert table["distance"].to_numpy() == pytest.approx(told[::10][:-1].mean(axis=1), abs=1e-3)


def test_commands_held_for_half_a_time_step_are_not_held() -> None:
    told = np.repeat(np.arange(40.0), 5)
    log = pd.DataFrame({"time": np.arange(200) / 10, "x": 0.01 * np.arange(200), "y": 0.0, "yaw": 0.0,
                        "command_0": told, "run": 0})  # fmt: skip
    table = bh.gaits_from_log(log, time_step=1.0, gaits=3)
    assert "commands change: windows take means" in table.attrs["bayeshunt"]["notes"]


def test_a_misspelt_held_is_guessed(tmp_path) -> None:
    drive().to_csv(tmp_path / "log.csv", index=False)
    log = bh.read_log(tmp_path / "log.csv")
    with pytest.raises(DataError, match=r"column 'hold' is missing.*did you mean 'held'"):
        bh.gaits_from_log(log, time_step=1.0, gaits="hold")
    windows = log.rename(columns={"command_0": "cmd_left", "command_1": "cmd_right"})
    with pytest.raises(DataError, match=r"column 'hold' is missing.*did you mean 'held'"):
        bh.gaits_from_windows(windows, time_step=1.0, gaits="hold")


@pytest.mark.parametrize(
    ("change", "arguments", "says"),
    [
        (degrees, {"angle": "rad"}, r"column 'yaw' is read in radians, .*angle='deg' \(--angle deg\)"),
        (lambda d: named(degrees(d), yaw="yaw_rad"), {}, r"read in radians, .*\(--angle deg\)"),
        (lambda d: d.assign(yaw=d.yaw + 20 * (d.index > 900)), {}, r"jumps by 20.* \(--angle deg\)"),
        (lambda d: named(degrees(d), yaw="yaw [deg]"), {"angle": "rad"}, r"says deg by its name.*\(--angle deg\)"),
        (lambda d: named(d, yaw="yaw_rad"), {"angle": "deg"}, r"says rad by its name.*\(--angle rad\)"),
        (lambda d: named(d, x="px_mm", y="py_mm"), {"unit": "m"}, r"px_mm, py_mm say mm .*\(--unit mm\)"),
    ],
)  # fmt: skip
def test_a_unit_that_the_log_contradicts_is_warned_of(change, arguments, says: str, tmp_path) -> None:
    log = change(drive())
    log.to_csv(tmp_path / "log.csv", index=False)
    with pytest.warns(bh.DataWarning, match=says) as caught:
        bh.read_log(tmp_path / "log.csv", pose=tuple(log.columns[1:4]), **arguments)
    assert len(caught) == 1
    assert "\n" not in str(caught[0].message)


def test_units_that_agree_are_not_warned_of(tmp_path, recwarn) -> None:
    wide = drive().assign(yaw=lambda d: d.yaw + 100)  # unwrapped, after many turns
    named(wide, x="px_m", y="py_m", yaw="yaw_rad").to_csv(tmp_path / "log.csv", index=False)
    bh.read_log(tmp_path / "log.csv", pose=("px_m", "py_m", "yaw_rad"), unit="m", angle="rad")
    assert not recwarn.list
