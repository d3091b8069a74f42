"""What a newcomer gives by mistake is answered by one line that names the mistake and the fix."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.core.errors import ConfigError, DataError, DataWarning, InputError
from bayeshunt.core.units import in_unit


@pytest.fixture
def windows() -> pd.DataFrame:
    """Six windows of a robot that runs a metre, its commands in degrees per second."""
    commands = [(112.4, 112.6), (99.6, -250.0), (0.5, -0.25)] * 2
    left, right = zip(*commands, strict=True)
    return pd.DataFrame({"cmd_left": left, "cmd_right": right, "x": 1.0, "y": 0.0, "yaw": 0.0})


@pytest.fixture
def walk(tmp_path) -> str:
    """A file of tracks as ``ingest tracks`` writes it."""
    from bayeshunt.data import tracks

    time = np.arange(40) / 10
    frame = pd.DataFrame({"id": 1, "time": time, "x": 0.02 * np.arange(40) + 0.001 * np.sin(7 * time), "y": 0.0})
    frame.to_csv(tmp_path / "walk.csv", index=False)
    tracks.save(bh.read_tracks(tmp_path / "walk.csv", unit="m"), tmp_path / "walk.parquet")
    return "walk.parquet"


@pytest.mark.parametrize(
    ("commands", "names"),
    [
        ([[112.4, 112.6], [99.6, -250.0]], ["+112/+113", "+99.6/-250"]),
        ([[2.11, -7.5], [0.0, 100.0]], ["+2.1/-7.5", "+0/+100"]),
        ([[1.0, 0.00002], [1.0, -0.00003]], ["+1/+0.00002", "+1/-0.00003"]),
        ([[123456.0, 1.0], [123457.0, 1.0]], ["+123456/+1", "+123457/+1"]),
        ([[-0.0, 1e-17], [1.0, 1.0]], ["+0/+0", "+1/+1"]),
    ],
)
def test_gaits_are_named_by_numbers_that_can_be_read(commands, names) -> None:
    table = pd.DataFrame(commands, columns=["cmd_left", "cmd_right"]).assign(x=1.0, y=0.0, yaw=0.0)
    assert bh.gaits_from_windows(table, time_step=1.0, gaits=5)["gait"].tolist() == names


def test_a_body_in_millimetres_is_noticed(windows) -> None:
    with pytest.warns(DataWarning, match=r"120 m, but no gait goes beyond 1 m.*if it is in millimetres, give 0\.12"):
        bh.gaits_from_windows(windows, time_step=1.0, gaits="held", body_length=120)


def test_a_gait_in_milliseconds_is_noticed(windows) -> None:
    with pytest.warns(DataWarning, match=r"time_step: one of 1000 s; if it is in milliseconds, give 1$"):
        bh.gaits_from_windows(windows, time_step=1000, gaits="held")


def test_a_gait_longer_than_ten_hunts_is_refused_before_any_work() -> None:
    with pytest.warns(DataWarning):
        settings = bh.load_experiment("paper", {"robot.gait_duration": 3328})
    with pytest.raises(ConfigError, match=r"3328 s, but a hunt ends after 60 s; .*milliseconds, give 3\.328"):
        settings.check_arena("open")


def test_tables_of_another_kind_are_named(walk, tmp_path, bayeshunt) -> None:
    _, err = bayeshunt("fit", walk, "--out", "m.json", status=2)
    assert "tracks of people or animals, not of a robot's gaits; give them to bayeshunt prey fit" in err
    bayeshunt("babble", "--steps", "5", "--out", "b.parquet", "-q")
    _, err = bayeshunt("prey", "fit", "b.parquet", "--out", "p.json", status=2)
    assert "a babbling table of a robot, not tracks; give it to bayeshunt fit" in err
    assert not (tmp_path / "m.json").exists()


def test_columns_are_suggested(walk, tmp_path) -> None:
    file = tmp_path / "walk.csv"
    with pytest.raises(InputError, match=r"unknown meaning 'tiem'.*did you mean 'time'"):
        bh.read_tracks(file, unit="m", columns={"tiem": "time"})
    with pytest.raises(DataError, match=r"column 'tme' is missing.*did you mean 'time'"):
        bh.read_tracks(file, unit="m", columns={"time": "tme"})
    pd.read_csv(file).drop(columns="time").to_csv(tmp_path / "still.csv", index=False)
    with pytest.raises(InputError, match=r"rows per second.*--rate.*--columns time=NAME"):
        bh.read_tracks(tmp_path / "still.csv", unit="m")


def test_the_next_line_takes_the_time_step_that_is_suggested(walk, bayeshunt) -> None:
    out, _ = bayeshunt("ingest", "tracks", "walk.csv", "--unit", "m", "--out", "again.parquet")
    assert "median step of the others 20 mm" in out
    assert "bayeshunt prey fit again.parquet --time-step 0.1 --out prey.json" in out
    bayeshunt("prey", "fit", "again.parquet", "--time-step", "0.1", "--out", "prey.json")


def test_small_lengths_are_shown_in_millimetres() -> None:
    assert in_unit(0.0031) == (1000.0, "mm")
    assert in_unit(1.2) == (1.0, "m")
    assert in_unit(0.5, "px") == (1.0, "px")
