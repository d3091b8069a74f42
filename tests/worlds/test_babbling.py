"""The babbling table: balanced, repeatable, right-handed, and the shipped file made again."""

from pathlib import Path

import numpy as np
import pytest

from bayeshunt.config.loading import load_robot
from bayeshunt.core.errors import InputError
from bayeshunt.data import babbling_table
from bayeshunt.experiments.store import identity
from bayeshunt.worlds.babbling import babble

DATA = Path(__file__).parents[2] / "data" / "khepera_babbling.parquet"


@pytest.mark.parametrize("robot", ["khepera", "car"])
def test_conformance(robot):
    frame = babble(robot, 45, 7)
    names = load_robot(robot).gaits.names
    babbling_table.validate(frame, names)
    assert len(frame) == 45
    assert frame.equals(babble(robot, 45, 7))
    assert not frame.equals(babble(robot, 45, 8))
    counts = frame["gait"].value_counts()
    assert set(counts.index) == set(names)
    assert counts.max() - counts.min() <= 1
    assert frame["previous_gait"].iloc[1:].tolist() == frame["gait"].iloc[:-1].tolist()
    assert (frame["distance"] >= 0).all()
    for column in ("angle", "heading"):
        assert frame[column].between(-np.pi, np.pi).all()


def test_right_is_clockwise_and_left_is_not():
    means = babble("khepera", 200, 0).groupby("gait")[["angle", "heading"]].mean()
    assert (means.loc["tight right"] > 0.3).all()
    assert (means.loc["tight left"] < -0.3).all()
    assert (means.loc["straight"].abs() < 0.2).all()


def test_part_way_poses_lead_to_the_end():
    frame = babble("khepera", 100, 0)
    straight = frame[frame["gait"] == "straight"]
    forward = straight[[c for c in babbling_table.path_columns(frame.columns) if c.endswith("forward")]].to_numpy()
    assert forward.shape[1] == 12
    assert (np.diff(forward, axis=1) > 0).all()
    np.testing.assert_allclose(forward[:, 5] / straight["distance"], 6 / 13, atol=0.06)


def test_the_shipped_data_set_can_be_made_again_to_the_last_bit(tmp_path):
    shipped = babbling_table.load(DATA)
    record = shipped.attrs[babbling_table.PROVENANCE_KEY]
    frame = babble(record["robot"]["name"], record["steps"], record["seed"])
    assert frame.equals(shipped[frame.columns])
    made = frame.attrs[babbling_table.PROVENANCE_KEY]
    assert made.keys() == record.keys()
    assert made["versions"].keys() == record["versions"].keys()
    same = [key for key in record if key != "versions"]  # the libraries may be others
    assert [made[key] for key in same] == [record[key] for key in same]
    files = [tmp_path / "one.parquet", tmp_path / "two.parquet"]
    for file in files:
        babbling_table.save(frame, file)
    assert files[0].read_bytes() == files[1].read_bytes()
    assert babbling_table.load(files[0]).equals(shipped)


def test_the_record_names_the_version_that_box2d_gives_of_itself(monkeypatch):
    """Another package may bring the same library: what is installed under which name does not matter."""
    monkeypatch.setattr("Box2D.__version__", "9.9.9")
    assert babble("khepera", 10, 0).attrs[babbling_table.PROVENANCE_KEY]["versions"]["box2d"] == "9.9.9"
    assert identity._version.__wrapped__("box2d") == "9.9.9"


def test_numbers_of_numpy_are_numbers(tmp_path):
    frame = babble("khepera", np.int64(20), np.int32(3))
    assert frame.equals(babble("khepera", 20, 3))
    babbling_table.save(frame, tmp_path / "t.parquet")
    assert babbling_table.load(tmp_path / "t.parquet").attrs[babbling_table.PROVENANCE_KEY]["seed"] == 3


@pytest.mark.parametrize(("steps", "seed"), [(0, 0), (-5, 0), (2.5, 0), (True, 0), (10, -1), (10, "x")])
def test_nonsense_is_refused(steps, seed):
    with pytest.raises(InputError, match="expected a whole number"):
        babble("khepera", steps, seed)
