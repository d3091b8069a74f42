"""Gait labels that are not text, and how columns may store them: the same counts as of text."""

from decimal import Decimal

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest

import bayeshunt as bh
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.data import babbling_table

AXES = bh.EffectAxes.standard(0.1)


def table(labels):
    return pd.DataFrame(
        {"gait": labels, "distance": [0.11, 0.12, 0.2, 0.21], "angle": [0.1, 0.2, -1, -1.1], "heading": [0.0, 0, 1, 1]}
    )


TEXTS = {
    "ints": (pd.Series([0, 0, 1, 1]), ["0", "1"]),
    "floats": (pd.Series([0.5, 0.5, 1.5, 1.5]), ["0.5", "1.5"]),
    "bools": (pd.Series([False, False, True, True]), ["False", "True"]),
    "bytes": (pd.Series([b"go", b"go", b"turn", b"turn"]), ["go", "turn"]),
    "categories": (pd.Series(pd.Categorical([3, 3, 7, 7])), ["3", "7"]),
    "nullable": (pd.Series([0, 0, 1, 1], dtype="Int64"), ["0", "1"]),
    "arrow ints": (pd.Series([0, 0, 1, 1], dtype=pd.ArrowDtype(pa.int64())), ["0", "1"]),
    "arrow text": (pd.Series(["a", "a", "b", "b"], dtype=pd.ArrowDtype(pa.string())), ["a", "b"]),
    "arrow dictionary": (
        pd.Series(["a", "a", "b", "b"]).astype(pd.ArrowDtype(pa.dictionary(pa.int32(), pa.string()))),
        ["a", "b"],
    ),
}


@pytest.mark.parametrize("kind", TEXTS)
def test_labels_count_as_their_text(kind, tmp_path):
    labels, names = TEXTS[kind]
    frame, plain = table(labels), table([names[0]] * 2 + [names[1]] * 2)
    own = list(dict.fromkeys(labels))  # the labels themselves name the gaits as well
    model, expected = (
        bh.ForwardModel.fit(frame, own, axes=AXES),
        bh.ForwardModel.fit(plain, names, axes=AXES),
    )
    assert model.gaits.names == tuple(names)
    assert model == expected
    assert model.update(frame) == expected.update(plain)
    assert model.log_likelihood(frame) == expected.log_likelihood(plain)
    assert model.with_data(frame).gaits == expected.gaits
    assert model.predict(own[1]) == expected.predict(names[1])
    bh.save_dataset(frame, tmp_path / "t.parquet")
    assert bh.load_dataset(tmp_path / "t.parquet")["gait"].tolist() == plain["gait"].tolist()


def test_a_table_is_assessed_however_its_labels_are_stored(khepera_frame):
    gaits, plain = bh.load_robot("khepera").gaits, khepera_frame.head(120)
    frame = plain.astype({"gait": pd.ArrowDtype(pa.dictionary(pa.int32(), pa.string()))})
    frame.attrs = plain.attrs
    one, other = (bh.assess(each, gaits, permutations=9, structures=("naive", "tan")) for each in (plain, frame))
    pd.testing.assert_frame_equal(one.structures, other.structures)
    pd.testing.assert_frame_equal(one.independence, other.independence)


@pytest.mark.parametrize("label", [[1], {"a": 1}, (1, 2), object(), float("inf")])
def test_what_is_no_name_is_one_line(label):
    frame = table(pd.Series([label] * 4, dtype=object))
    with pytest.raises(bh.DataError, match=r"^table: row 0: gait is .*frame\['gait'\]\.astype\(str\)$"):
        babbling_table.validate(frame)


@pytest.mark.parametrize("label", [0, np.int64(0), np.float64(0.5), b"a", True])
def test_a_gait_of_any_plain_label_is_named_by_text(label):
    gait = bh.Gait(label)
    assert isinstance(gait.name, str)
    assert GaitRepertoire.of([label]).index(label) == 0
    assert GaitRepertoire((gait,)).names == (gait.name,)


@pytest.mark.parametrize("label", [None, [1], float("nan"), {}])
def test_a_gait_without_a_name_is_refused(label):
    with pytest.raises(bh.InputError, match=r"^gait: expected a name, got .*astype\(str\)$"):
        bh.Gait(label)


@pytest.mark.parametrize(
    ("column", "values", "holds"),
    [
        ("distance", [True, False, True, True], "bool"),
        ("distance", ["0.1", "0.2", "0.1", "0.1"], "str"),
        ("angle", np.array([1j, 0, 0, 0]), "complex128"),
        ("heading", pd.to_datetime(["2020-01-01"] * 4), "datetime64"),
        ("angle", pd.Series(["0.1", 0.2, 0.1, 0.1], dtype=object), "mixed"),
    ],
)
def test_columns_that_are_no_numbers_are_refused(column, values, holds):
    with pytest.raises(bh.DataError, match=rf"^table: column '{column}' holds {holds}.*; expected numbers"):
        babbling_table.validate(table(["a"] * 4).assign(**{column: values}))


NUMBERS = {
    "categories": lambda values: values.astype("category"),
    "decimals": lambda values: values.map(lambda value: Decimal(repr(value))),
    "objects": lambda values: values.astype(object),
    "nullable": lambda values: values.astype("Float64"),
    "arrow": lambda values: values.astype("double[pyarrow]"),
    "sparse": lambda values: values.astype(pd.SparseDtype(float)),
    "long": lambda values: values.astype(np.longdouble),
}


@pytest.mark.parametrize("kind", NUMBERS)
def test_numbers_count_however_they_are_stored(kind, tmp_path):
    plain = table(["a", "a", "b", "b"]).assign(path_01_forward=0.1, path_01_right=0.0, path_01_heading=0.0)
    frame = plain.assign(**{name: NUMBERS[kind](plain[name]) for name in plain.columns[1:]})
    model, expected = (bh.ForwardModel.fit(each, ["a", "b"], axes=AXES) for each in (frame, plain))
    assert model == expected
    assert model.update(frame) == expected.update(plain)
    assert model.log_likelihood(frame) == expected.log_likelihood(plain)
    bh.save_dataset(frame, tmp_path / "t.parquet")
    pd.testing.assert_frame_equal(bh.load_dataset(tmp_path / "t.parquet"), plain)


@pytest.mark.parametrize(
    "note",
    [
        pd.Categorical([1, 2, 1, 2]),
        pd.Categorical([0.5, 1.5, 0.5, 1.5]),
        pd.Categorical([True, False, True, False]),
        pd.Categorical(pd.to_datetime([1, 2, 1, 2], unit="D")),
        pd.Categorical(["x", "y", "x", "y"]),
        pd.period_range("2020", periods=4, freq="D"),
        pd.to_timedelta([1, 2, 3, 4], unit="s"),
        [b"x", b"y", b"x", b"y"],
    ],
)
def test_what_is_written_can_be_read(note, tmp_path):
    bh.save_dataset(table(["a"] * 4).assign(note=note), tmp_path / "t.parquet")
    assert bh.load_dataset(tmp_path / "t.parquet")["note"].tolist() == list(note)


@pytest.mark.parametrize("note", [[{}] * 4, pd.cut(range(4), 2), [1j] * 4], ids=["empty", "intervals", "complex"])
def test_what_cannot_be_written_is_one_line(note, tmp_path):
    with pytest.raises(bh.DataError, match=r"^column 'note' holds values .*astype\(str\)$"):
        bh.save_dataset(table(["a"] * 4).assign(note=note), tmp_path / "t.parquet")
    assert list(tmp_path.iterdir()) == []


def test_the_writer_keeps_the_rules_of_the_command(tmp_path):
    good = table(["a"] * 4)
    with pytest.raises(bh.InputError, match=r"x\.csv: tables are Parquet, not CSV; name it .*x\.parquet"):
        bh.save_dataset(good, tmp_path / "x.csv")
    with pytest.raises(bh.DataError, match="column 'distance' is missing"):
        bh.save_dataset(good[["gait"]], tmp_path / "x.parquet")
    mixed = good.assign(note=[1, "a", 2.0, [3]])
    with pytest.raises(bh.DataError, match=r"^column 'note' holds values of several kinds.*astype\(str\)$"):
        bh.save_dataset(mixed, tmp_path / "x.parquet")
    with pytest.raises(bh.DataError, match=r"^provenance: 'robot' holds what JSON cannot"):
        bh.save_dataset(good, tmp_path / "x.parquet", {"seed": 1, "robot": object()})
    assert list(tmp_path.iterdir()) == []
    record = {"seed": np.int64(3), "share": np.float64(0.5), "seeds": np.arange(2), "by": {"a": np.bool_(True)}}
    bh.save_dataset(good, tmp_path / "x.parquet", record)
    kept = bh.load_dataset(tmp_path / "x.parquet").attrs["bayeshunt"]
    assert kept == {"seed": 3, "share": 0.5, "seeds": [0, 1], "by": {"a": True}}


@pytest.mark.parametrize("values", [[float("nan")], [0.1, float("inf")], float("nan"), float("-inf")])
@pytest.mark.parametrize("axis", [AXES.distance, AXES.angle])
def test_what_is_not_finite_falls_into_no_bin(values, axis):
    with pytest.raises(bh.InputError, match=f"^{axis.name}: expected (a )?finite number"):
        axis.index(values)


@pytest.mark.parametrize("values", [True, [True], "0.1", ["0.1"], 1j, [1j], None, [None], [[1], [2, 3]]])
def test_what_is_no_number_falls_into_no_bin(values):
    with pytest.raises(bh.InputError, match=r"^Distance: expected numbers, got [^\n]+$"):
        AXES.distance.index(values)


def test_labels_of_half_a_turn_are_written_one_way():
    for bins in range(1, 361):
        labels = bh.Axis.full_turn("Angle", bins).labels
        assert "-180 deg" not in labels
        assert len(set(labels)) == bins
