"""Assessments of strange tables: scores of what can be scored, or one line that names what is wrong."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.cli import main
from bayeshunt.models.assessment.rows import set_aside

TWO = bh.GaitRepertoire((bh.Gait("go"), bh.Gait("turn")), body_length=0.057, duration=3.0)


def rows(number: int, seed: int = 0) -> pd.DataFrame:
    rng = np.random.default_rng(seed)
    return pd.DataFrame(
        {
            "gait": [("go", "turn")[i % 2] for i in range(number)],
            "distance": rng.uniform(0.0, 0.2, number),
            "angle": rng.uniform(-3.0, 3.0, number),
            "heading": rng.uniform(-3.0, 3.0, number),
        }
    )


def alike(number: int) -> pd.DataFrame:
    return rows(number).assign(gait="go", distance=0.1, angle=0.0, heading=0.0)


def assess(frame: pd.DataFrame, **settings) -> bh.Assessment:
    found = bh.assess(frame, TWO, **{"permutations": 5, **settings})
    assert np.isfinite(found.structures["log_loss"]).all()
    assert str(found)
    assert found._repr_html_()
    return found


@pytest.mark.parametrize("structure", ["naive", "tan", "joint", "learned"])
def test_rows_that_are_all_alike_are_learned(structure: str) -> None:
    model = bh.ForwardModel.fit(alike(20), TWO, 0.03, structure=structure)
    assert model.predict("go").distance == pytest.approx(0.1)
    if structure == "learned":
        assert model.structure.edges == ()


def test_rows_that_are_all_alike_are_scored() -> None:
    found = assess(alike(10), folds=5)
    # 8 rows learned, all in the bin of the other two: (8 + a) / (8 + S a), S bins: 2 of Distance, 36 of a turn
    bins = found.settings["bins"]
    loss = -sum(np.log((8 + 0.03) / (8 + bins[v] * 0.03)) for v in ("Distance", "Angle", "Heading"))
    assert found.structures.loc["naive", "log_loss"] == pytest.approx(loss, rel=1e-12)
    assert found.found["learned"].edges == ()


def test_two_rows_and_one_gait_are_scored() -> None:
    assert assess(rows(2), folds=2).settings["rows"] == 2
    assert assess(rows(30).assign(gait="go")).confusion.to_numpy()[1].tolist() == [0, 0]


@pytest.mark.parametrize(
    ("number", "says"),
    [(0, "the table has no rows"), (1, "the table has one row"), (4, "from 2 to 4 .the rows., got 5")],
)
def test_too_few_rows_are_one_line(number: int, says: str) -> None:
    with pytest.raises(bh.InputError, match=says):
        bh.assess(rows(number), TWO)


@pytest.mark.parametrize("far", [10.0, 500.0, 1e9])
def test_a_row_that_no_gait_can_have_made_is_named_and_the_others_are_scored(far: float) -> None:
    frame = rows(300)
    frame.loc[17, "distance"] = far
    found = assess(frame)
    without = assess(frame.drop(index=17))
    assert found.settings == without.settings
    pd.testing.assert_frame_equal(found.structures, without.structures)
    assert found.notes[0].startswith(
        f"Row 17 is left out: {far:g} m away, where nine tenths of the rows end within 0.1"
    )
    assert found.notes[1:] == without.notes


def test_several_such_rows_are_named() -> None:
    frame = rows(300)
    frame.loc[[3, 5, 7, 11, 13, 17, 19], "distance"] = 40.0
    assert assess(frame).notes[0].startswith("Rows 3, 5, 7, 11, 13 and 2 more are left out: 40 m away")


def test_a_wide_table_keeps_its_rows() -> None:
    axes = bh.EffectAxes.standard(0.057)
    for frame in (rows(50), rows(50).assign(distance=np.linspace(0, 500, 50)), rows(2).assign(distance=[0.1, 500])):
        kept, notes = set_aside(frame, axes)
        assert kept is frame
        assert notes == []


def test_a_structure_whose_table_is_too_large_is_left_out_and_said() -> None:
    frame = rows(40).assign(distance=np.linspace(0, 60, 40))
    found = assess(frame)
    assert list(found.structures.index) == ["naive", "tan", "learned"]
    assert [note for note in found.notes if note.startswith("joint is left out: structure 'joint' needs a table of")]
    with pytest.raises(bh.InputError, match="structure 'joint' needs a table of"):
        assess(frame, structures=["joint"])


def test_a_table_that_is_too_wide_to_score_names_its_farthest_row() -> None:
    with pytest.raises(bh.InputError, match=r"^row 39: distance is 100000 m, 17,543,860 distance bins of 0\.0057 m"):
        assess(rows(40).assign(distance=np.linspace(0, 1e5, 40)))


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ({"structures": "tan"}, r"structures: expected a list of names, such as \['tan'\], got 'tan'"),
        ({"structures": 3}, r"structures: expected a list of names, such as \['tan'\], got 3"),
        ({"structures": [3]}, "unknown structure 3"),
        ({"axes": 36}, "axes: expected an EffectAxes"),
        ({"model": "m.json"}, "model: expected a ForwardModel, got 'm.json'"),
    ],
)
def test_arguments_of_the_wrong_kind_are_one_line(settings: dict, says: str) -> None:
    with pytest.raises(bh.InputError, match=f"^{says}"):
        bh.assess(rows(20), None if "model" in settings else TWO, **settings)


@pytest.mark.parametrize("frame", ["x.parquet", None, 3])
def test_a_table_of_the_wrong_kind_is_one_line(frame) -> None:
    with pytest.raises(bh.InputError, match=r"^table: expected a pandas DataFrame"):
        bh.assess(frame)


def test_who_typed_no_command_is_told_of_none(tmp_path, capsys, monkeypatch) -> None:
    with pytest.raises(bh.InputError, match="does not say which robot made it; give its gaits: assess") as caught:
        bh.assess(rows(20))
    assert "--" not in str(caught.value)
    bh.save_dataset(rows(20), tmp_path / "table.parquet")
    monkeypatch.setattr("sys.argv", ["bayeshunt", "assess", str(tmp_path / "table.parquet")])
    with pytest.raises(SystemExit, match="0"):  # the command takes the gaits from the table
        main()
    assert "held-out" in capsys.readouterr().out.lower()
