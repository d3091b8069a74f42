"""The babbling table: validation, provenance, round trip."""

import numpy as np
import pandas as pd
import pytest

from bayeshunt.core.bins import EffectAxes
from bayeshunt.core.errors import DataError
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.data import babbling_table
from bayeshunt.files import parquet

GOOD = pd.DataFrame({"gait": ["a", "b"], "distance": [0.1, 0.2], "angle": [0.0, -1.0], "heading": [3.0, 0.0]})


def changed(**columns):
    return GOOD.assign(**columns)


@pytest.mark.parametrize(
    ("frame", "message"),
    [
        (GOOD.drop(columns="angle"), "column 'angle' is missing"),
        (GOOD.iloc[:0], "no rows"),
        (changed(distance=[0.1, np.nan]), "row 1: distance is nan; expected a finite number"),
        (changed(heading=[np.inf, 0.0]), "row 0: heading is inf"),
        (changed(distance=[0.1, -0.2]), "row 1: distance is -0.2; expected metres >= 0"),
        (changed(angle=["x", "y"]), "column 'angle' holds"),
        (changed(gait=["a", None]), "row 1: gait is empty"),
        (changed(gait=["a", "z"]), "row 1: gait 'z' is not in the repertoire; expected one of a, b"),
    ],
)
def test_what_is_wrong_is_said_with_its_place(frame, message):
    with pytest.raises(DataError, match=message):
        babbling_table.validate(frame, ["a", "b"])


def test_a_good_table_passes():
    babbling_table.validate(GOOD, ["a", "b"])
    babbling_table.validate(with_paths(12), ["a", "b"])


def with_paths(points):
    """The good table with part-way poses."""
    return changed(**dict.fromkeys(babbling_table.path_column_names(points), 0.5))


@pytest.mark.parametrize(
    ("lost", "message"),
    [
        (["path_02_right"], "column 'path_02_right' is missing; part-way poses need forward, right and heading"),
        (["path_01_right", "path_02_right", "path_03_right"], "column 'path_01_right' is missing"),
        (["path_01_forward", "path_01_right", "path_01_heading"], "column 'path_01_forward' is missing"),
    ],
)
def test_a_lost_part_of_a_pose_does_not_shift_the_others(lost, message):
    with pytest.raises(DataError, match=message):
        babbling_table.validate(with_paths(3).drop(columns=lost))


@pytest.mark.parametrize("wrong", [None, [1, 2], {"gait": ["a"]}])
def test_what_is_no_table_is_refused(wrong):
    with pytest.raises(DataError, match=f"table: expected a pandas DataFrame, got {type(wrong).__name__}"):
        babbling_table.validate(wrong)


@pytest.mark.parametrize("read", [babbling_table.load, babbling_table.Batches])
def test_what_is_no_name_is_refused(read):
    with pytest.raises(DataError, match="expected the name of a file made by: bayeshunt babble; got 3"):
        read(3)


def test_a_column_that_stands_twice_is_refused():
    for name in ("gait", "distance"):
        with pytest.raises(DataError, match=f"column '{name}' stands twice"):
            babbling_table.validate(pd.concat([GOOD, GOOD[[name]]], axis=1))


def test_round_trip_keeps_rows_and_provenance(tmp_path):
    path = tmp_path / "t.parquet"
    babbling_table.save(GOOD, path, {"seed": 3})
    again = babbling_table.load(path)
    pd.testing.assert_frame_equal(again, GOOD, check_dtype=False)
    assert again.attrs[babbling_table.PROVENANCE_KEY] == {"seed": 3}
    first = path.read_bytes()
    babbling_table.save(GOOD, path, {"seed": 3})
    assert path.read_bytes() == first
    assert list(tmp_path.iterdir()) == [path]


def test_indices_by_hand():
    axes = EffectAxes.standard(0.1)  # bins of 1 cm and 10 degrees
    gaits = GaitRepertoire.of(["b", "a"])
    indices = babbling_table.discretise(changed(distance=[0.105, 0.0]), gaits, axes)
    zero = axes.angle.index(0.0)
    assert indices[0].tolist() == [1, 10, zero, axes.heading.index(3.0)]
    assert indices[1].tolist() == [0, 0, axes.angle.index(-1.0), zero]


@pytest.mark.parametrize("kind", ["object", "str", "string", "category"])
def test_positions_of_names_however_they_are_stored(kind):
    values = pd.Series(["b", "a", "z", None, "b"], dtype=kind)
    assert babbling_table.positions(values, ["a", "b", "c"]).tolist() == [1, 0, -1, -1, 1]
    assert babbling_table.positions(values[:0], ["a"]).tolist() == []


def test_an_unknown_gait_is_named_with_the_row_of_the_whole_table(tmp_path, monkeypatch):
    monkeypatch.setattr(parquet, "ROW_GROUP", 1)
    path = tmp_path / "t.parquet"
    babbling_table.save(changed(gait=["a", "z"]), path, {})
    with pytest.raises(DataError, match="row 1: gait 'z'"):
        list(babbling_table.Batches(path).of(["a", "b"]))


def test_path_columns_are_found_in_order():
    names = babbling_table.path_column_names(12)
    assert babbling_table.path_columns(reversed([*names, "gait", "path_x_forward"])) == names


def test_angles_that_were_not_wrapped_are_angles(khepera_frame):
    angle, heading = khepera_frame["angle"], khepera_frame["heading"]
    turned = khepera_frame.assign(angle=angle + 2 * np.pi, heading=heading - 2 * np.pi)
    babbling_table.validate(turned)
    with pytest.raises(DataError, match="expected radians"):
        babbling_table.validate(turned.assign(angle=np.degrees(angle)))
