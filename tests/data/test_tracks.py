"""Tracks of every format come in as one table; rate, unit and direction are the user's; damage is one line."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.core.errors import DataError, InputError
from bayeshunt.data import tracks as tracks_file

RATE = 10.0


@pytest.fixture
def walk() -> pd.DataFrame:
    """Two walkers, 40 rows each at 10 per second, the second stands from row 20 on."""
    n = np.arange(40)
    one = pd.DataFrame({"frame": n, "id": 1, "x": 0.1 * n, "y": 0.02 * n})
    two = pd.DataFrame({"frame": n + 5, "id": 2, "x": 3.0, "y": 0.1 * np.minimum(n, 20)})
    return pd.concat([one, two], ignore_index=True)


def test_tidy_csv_with_other_names_and_separators(walk: pd.DataFrame, tmp_path) -> None:
    expected = None
    for i, (names, sep, decimal) in enumerate(
        [({}, ",", "."), ({"x": "Pos X [m]", "y": "Pos Y [m]", "id": "TrackId", "frame": "Frame"}, ";", ","),
         ({"x": "x_m", "y": "y_m", "id": "agent", "frame": "frame_id"}, "\t", ".")]
    ):  # fmt: skip
        path = tmp_path / f"t{i}.csv"
        walk.rename(columns=names).to_csv(path, index=False, sep=sep, decimal=decimal, encoding="utf-8-sig")
        table = bh.read_tracks(path, rate=RATE, unit="m")
        assert list(table.columns) == list(tracks_file.COLUMNS)
        assert table["scene"].unique().tolist() == [path.stem]
        expected = table if expected is None else expected
        pd.testing.assert_frame_equal(table.drop(columns="scene"), expected.drop(columns="scene"))
    assert expected["id"].tolist() == [1] * 40 + [2] * 40
    assert expected["time"].iloc[:3].tolist() == pytest.approx([0.0, 0.1, 0.2])
    assert expected["y"].iloc[10] == pytest.approx(0.2)


def test_frame_id_x_y_without_header_steps_by_ten(walk: pd.DataFrame, tmp_path) -> None:
    path = tmp_path / "scene.txt"
    walk.assign(frame=walk.frame * 10).to_csv(path, sep=" ", header=False, index=False)
    table = bh.read_tracks(path, rate=RATE, unit="cm")
    assert np.diff(table["time"].iloc[:40]) == pytest.approx(0.1)  # one row after the other, whatever frames count
    assert table["x"].iloc[39] == pytest.approx(0.039)


def test_rate_and_unit_are_refused_unless_given_and_the_claim_is_shown(walk: pd.DataFrame, tmp_path) -> None:
    path = tmp_path / "t.csv"
    walk.to_csv(path, index=False)
    with pytest.raises(InputError, match="unit is not given"):
        bh.read_tracks(path, rate=RATE)
    with pytest.raises(InputError, match="rate is not given"):
        bh.read_tracks(path, unit="m")
    np.savez(tmp_path / "animal_id3.npz", X=np.arange(9.0), Y=np.arange(9.0), frame_rate=[30.0], cm_per_pixel=[0.02])
    with pytest.raises(InputError, match="the file says 30 per second"):
        bh.read_tracks(tmp_path / "animal_id3.npz", unit="px")
    with pytest.raises(InputError, match=r"0\.02 cm per pixel"):
        bh.read_tracks(tmp_path / "animal_id3.npz", rate=5)
    table = bh.read_tracks(tmp_path / "animal_id3.npz", rate=5, unit="px")
    assert table["time"].iloc[1] == pytest.approx(0.2)  # the user's rate wins
    assert "the file says 30" in " ".join(table.attrs["bayeshunt"]["notes"])
    assert table["id"].unique().tolist() == [3]
    assert table["unit"].unique().tolist() == ["px"]
    assert "unit" not in bh.read_tracks(tmp_path / "animal_id3.npz", rate=5, unit="px", scale=0.001)


@pytest.mark.parametrize(("unit", "kept"), [("cm", "m"), ("px", "px")])
def test_an_ingested_file_knows_its_unit_its_scenes_and_its_licence(
    unit: str, kept: str, walk: pd.DataFrame, tmp_path, bayeshunt
) -> None:
    for name in ("b", "a"):
        walk.to_csv(tmp_path / f"{name}.csv", index=False)
    given = ("--rate", "10", "--unit", unit, "--licence", "CC BY 4.0", "--cite", "Walker 2024")
    bayeshunt("ingest", "tracks", "b.csv", "a.csv", *given, "--out", "t.parquet")
    table, written = bh.read_tracks(tmp_path / "t.parquet"), tracks_file.load(tmp_path / "t.parquet")
    pd.testing.assert_frame_equal(
        table, written, check_like=True
    )  # y is not turned over again, scenes keep their names
    assert table["scene"].unique().tolist() == ["b", "a"]
    record = table.attrs["bayeshunt"]
    assert (record["unit"], record["licence"], record["citation"]) == (kept, "CC BY 4.0", "Walker 2024")
    assert [source["file"] for source in record["sources"]] == ["b.csv", "a.csv"]
    assert len(record["sources"][0]["sha256"]) == 64
    pd.testing.assert_frame_equal(bh.read_tracks(tmp_path / "t.parquet", unit=kept), table)
    with pytest.raises(InputError, match=rf"x and y are in {kept}, .* got unit 'mm'"):
        bh.read_tracks(tmp_path / "t.parquet", unit="mm")


def test_a_table_of_another_program_is_still_asked_for_its_unit(walk: pd.DataFrame, tmp_path) -> None:
    walk.assign(time=walk.frame / 10, scene="s").to_parquet(tmp_path / "t.parquet")
    with pytest.raises(InputError, match="unit is not given"):
        bh.read_tracks(tmp_path / "t.parquet")


def test_y_down_mirrors_places_and_headings(walk: pd.DataFrame, tmp_path) -> None:
    path = tmp_path / "t.csv"
    walk.assign(heading=90.0).to_csv(path, index=False)
    with pytest.raises(InputError, match="degrees=True"):
        bh.read_tracks(path, rate=RATE, unit="m")
    down = bh.read_tracks(path, rate=RATE, unit="m", y="down", degrees=True)
    up = bh.read_tracks(path, rate=RATE, unit="m", degrees=True)
    assert down["y"].tolist() == (-up["y"]).tolist()
    assert down["heading"].iloc[0] == pytest.approx(-math.pi / 2)
    assert up["heading"].iloc[0] == pytest.approx(math.pi / 2)


def test_rows_left_out_are_counted_by_reason(walk: pd.DataFrame, tmp_path) -> None:
    walk = pd.concat([walk.astype({"x": object}), walk.iloc[[3]]], ignore_index=True)
    walk.loc[5, "x"] = "lost"
    path = tmp_path / "t.csv"
    walk.to_csv(path, index=False)
    table = bh.read_tracks(path, rate=RATE, unit="m")
    assert len(table) == 79
    assert table.attrs["bayeshunt"]["dropped"] == {"no place": 1, "same id and time": 1}


def dlc(multi: bool) -> pd.DataFrame:
    people = ["mouse1", "mouse2"] if multi else [None]
    columns = [
        ("net", *([who] if who else []), part, name)
        for who in people
        for part in ("nose", "tail")
        for name in ("x", "y", "likelihood")
    ]
    names = ["scorer", *(["individuals"] if multi else []), "bodyparts", "coords"]
    values = np.arange(10)[:, None] + np.arange(len(columns)) * 10.0
    values[:, 2::3] = [1.0, 0.0] * (len(columns) // 6)
    return pd.DataFrame(values, columns=pd.MultiIndex.from_tuples(columns, names=names))


@pytest.mark.parametrize("multi", [False, True])
def test_deeplabcut_csv(multi: bool, tmp_path) -> None:
    path = tmp_path / "pose.csv"
    dlc(multi).to_csv(path)
    table = bh.read_tracks(path, rate=30, unit="px")
    assert table["id"].unique().tolist() == (["mouse1", "mouse2"] if multi else [0])
    assert table["x"].iloc[:3].tolist() == [0.0, 1.0, 2.0]  # the tail has no confidence
    assert table["y"].iloc[0] == -10.0
    tail = bh.read_tracks(path, rate=30, unit="px", keypoint="tail")
    assert tail["x"].iloc[0] == pytest.approx(30.0)
    with pytest.raises(InputError, match="nose, tail"):
        bh.read_tracks(path, rate=30, unit="px", keypoint="wing")


@pytest.mark.parametrize("layout", ["table", "fixed"])
def test_deeplabcut_hdf5_is_read_without_unpickling(layout: str, tmp_path) -> None:
    pytest.importorskip("h5py")
    pytest.importorskip("tables")
    path = tmp_path / "pose.h5"
    dlc(False).to_hdf(path, key="df_with_missing", format=layout)
    dlc(False).to_csv(tmp_path / "pose.csv")
    one, two = (bh.read_tracks(p, rate=30, unit="px") for p in (path, tmp_path / "pose.csv"))
    pd.testing.assert_frame_equal(one, two)


def test_a_pickled_object_is_never_made() -> None:
    import pickle

    from bayeshunt.data.readers.hdf5 import plain_values

    assert plain_values(pickle.dumps([("net", "nose", "x")], 0)) == [("net", "nose", "x")]
    with pytest.raises(ValueError, match="which is not read"):
        plain_values(pickle.dumps([pd.Timestamp(0)]))


def test_trex_refuses_pickles(tmp_path) -> None:
    np.savez(tmp_path / "bad.npz", X=np.array([{}], dtype=object), Y=np.arange(1.0))
    with pytest.raises(DataError, match="pickled objects"):
        bh.read_tracks(tmp_path / "bad.npz", rate=5, unit="px")


def test_sleap_analysis_file(tmp_path) -> None:
    h5py = pytest.importorskip("h5py")
    places = np.zeros((2, 2, 1, 6))
    places[0, 0, 0], places[1, 1, 0] = np.arange(6), np.arange(6) * 2
    places[1, :, 0, 3] = np.nan
    with h5py.File(tmp_path / "s.analysis.h5", "w") as file:
        file["tracks"] = places
        file["track_names"] = [b"a", b"b"]
        file["node_names"] = [b"thorax"]
    table = bh.read_tracks(tmp_path / "s.analysis.h5", rate=10, unit="px", y="up")
    assert table.groupby("id").size().to_dict() == {"a": 6, "b": 5}
    assert table.query("id == 'b'")["y"].tolist() == [0.0, 2.0, 4.0, 8.0, 10.0]


def test_a_dataset_of_positions() -> None:
    xarray = pytest.importorskip("xarray")
    places = np.stack([np.arange(8.0), 2 * np.arange(8.0)], axis=1)
    for dims, shape in ((("time", "space"), (8, 2)), (("time", "space", "keypoints", "individuals"), (8, 2, 1, 1))):
        data = xarray.Dataset({"position": (dims, places.reshape(shape))}, {"space": ["x", "y"]})
        table = bh.tracks(data, rate=4, unit="mm", y="up")
        assert table["time"].iloc[1] == 0.25
        assert table["y"].iloc[-1] == pytest.approx(0.014)
    with pytest.raises(InputError, match="xarray Dataset"):
        bh.tracks(pd.DataFrame(), rate=4, unit="mm")


def test_a_reader_of_ones_own(walk: pd.DataFrame, tmp_path, monkeypatch) -> None:
    from bayeshunt.data.readers import registry

    monkeypatch.setattr(registry, "_READERS", dict(registry._READERS))

    class Mine:
        name = "mine"

        def accepts(self, path, head):
            return path.suffix == ".mine"

        def read(self, path, *, columns, keypoint):
            return registry.Found(walk)

    bh.register_reader("mine", Mine)
    (tmp_path / "a.mine").write_text("anything")
    assert len(bh.read_tracks(tmp_path / "a.mine", rate=1, unit="m")) == 80
    with pytest.raises(InputError, match="unknown reader"):
        bh.read_tracks(tmp_path / "a.mine", rate=1, unit="m", reader="yours")
    with pytest.raises(InputError, match="class or function"):
        bh.register_reader("mine", "text")


def test_report(walk: pd.DataFrame, tmp_path, bayeshunt) -> None:
    holes = walk.drop(index=[10, 11, 12])
    holes.to_csv(tmp_path / "t.csv", index=False)
    out, _ = bayeshunt("ingest", "tracks", "t.csv", "--rate", "10", "--unit", "m", "--out", "t.parquet")
    assert "77 rows of 2 individuals, 1 gaps" in out
    back = tracks_file.load(tmp_path / "t.parquet")
    assert back.attrs["bayeshunt"]["sources"][0]["rate"] == 10.0
    facts = bh.track_report(back)
    assert (facts.ids, facts.runs, facts.time_step) == (2, 3, pytest.approx(0.1))
    assert facts.standing == pytest.approx(19 / 74)
    bayeshunt("ingest", "tracks", "t.csv", "--unit", "m", "--out", "t.parquet", status=2)
    plain = ("ingest", "tracks", "t.csv", "--unit", "m", "--rate", "5", "--out", "t.parquet")
    bayeshunt(*plain, "--columns", "x:a", status=2)


def test_transitions_in_ones_own_frame(walk: pd.DataFrame, tmp_path) -> None:
    walk.to_csv(tmp_path / "t.csv", index=False)
    table = bh.read_tracks(tmp_path / "t.csv", rate=RATE, unit="m")
    rows = bh.transitions(table, time_step=0.2, seen=3, steps=2)
    one = rows[rows["id"] == 1]
    assert one["distance"].to_numpy() == pytest.approx(2 * math.hypot(0.1, 0.02))
    assert one["angle"].to_numpy() == pytest.approx(0, abs=1e-9)
    assert one["speed"].to_numpy() == pytest.approx(math.hypot(0.1, 0.02) / 0.1)
    assert one["past_02_forward"].dropna().to_numpy() == pytest.approx(-4 * math.hypot(0.1, 0.02))
    still = rows[(rows["id"] == 2) & (rows["time"] > 2.8)]
    assert still["distance"].to_numpy() == pytest.approx(0)
    assert still["heading"].to_numpy() == pytest.approx(0)  # it stands, and keeps its direction
    with pytest.raises(InputError, match="less than"):
        bh.transitions(table, time_step=0.01)
    with pytest.raises(DataError, match="column 'id' is missing"):
        bh.transitions(table.drop(columns="id"))


def test_a_right_turn_is_clockwise() -> None:
    x, y = np.array([0, 1, 2, 2, 2.0]), np.array([0, 0, 0, -1, -2.0])
    table = pd.DataFrame({"id": 0, "time": np.arange(5.0), "x": x, "y": y})
    rows = bh.transitions(table, seen=2, steps=1)
    assert rows["angle"].tolist() == pytest.approx([0, math.pi / 2, 0])
    assert rows["heading"].tolist() == pytest.approx([0, math.pi / 2, 0])
    assert rows["future_01_right"].tolist() == pytest.approx([0, 1, 0], abs=1e-12)


@pytest.mark.parametrize(
    ("text", "problem"),
    [("", "empty"), ("a\nb\n", "no separator"), ("frame,id,x\n1,1,2\n", "no column 'y'"), ("1 2 3\n", "3 columns"),
     ("x,y,frame\n1,2,3\n1,2,3,4,5\n", "cells")],
)  # fmt: skip
def test_bad_text_is_one_line(text: str, problem: str, tmp_path) -> None:
    (tmp_path / "t.csv").write_text(text)
    with pytest.raises(DataError, match=problem) as caught:
        bh.read_tracks(tmp_path / "t.csv", rate=1, unit="m")
    assert "\n" not in str(caught.value)


def test_several_rows_at_one_time_without_an_id_are_refused(walk: pd.DataFrame, tmp_path) -> None:
    path = tmp_path / "t.csv"
    walk.rename(columns={"id": "fish"}).to_csv(path, index=False)
    with pytest.raises(DataError, match=r"several rows at one time \(70 of 80\) .*--columns id=NAME") as caught:
        bh.read_tracks(path, rate=RATE, unit="m")
    assert "\n" not in str(caught.value)
    assert bh.read_tracks(path, rate=RATE, unit="m", columns={"id": "fish"})["id"].nunique() == 2
    one = walk[walk.id == 1].drop(columns="id")
    pd.concat([one, one.iloc[[3, 9]]]).to_csv(path, index=False)
    assert bh.read_tracks(path, rate=RATE, unit="m").attrs["bayeshunt"]["dropped"] == {"same id and time": 2}


def test_a_unit_that_the_columns_contradict_is_warned_of(walk: pd.DataFrame, tmp_path) -> None:
    path = tmp_path / "t.csv"
    walk.rename(columns={"x": "x_mm", "y": "y_mm"}).to_csv(path, index=False)
    with pytest.warns(bh.DataWarning, match=r"x and y are in mm, but they are read in m .*\(--unit mm\)"):
        bh.read_tracks(path, rate=RATE, unit="m")


def test_neither_rate_nor_unit_is_one_line_for_both(walk: pd.DataFrame, tmp_path) -> None:
    path = tmp_path / "t.txt"
    walk.to_csv(path, sep=" ", header=False, index=False)
    with pytest.raises(InputError, match=r"neither rate \(rows per second\) nor unit is given; .*--rate.*--unit m\|cm"):
        bh.read_tracks(path)


def test_lines_of_json_as_trajnet_has_them(walk: pd.DataFrame, tmp_path) -> None:
    path = tmp_path / "scene.ndjson"
    lines = ['{"scene": {"id": 0, "p": 1, "s": 0, "e": 390, "fps": 2.5, "tag": 4}}']
    lines += [f'{{"track": {{"f": {10 * r.frame:.0f}, "p": {r.id:.0f}, "x": {r.x}, "y": {r.y}}}}}'
              for r in walk.itertuples()]  # fmt: skip
    lines.append('{"track": {"f": 0, "p": 1, "x": 9, "y": 9, "prediction_number": 0, "scene_id": 0}}')
    path.write_text("\n".join(lines))
    with pytest.raises(InputError, match=r"the file says 2\.5 per second"):
        bh.read_tracks(path, unit="m")
    table = bh.read_tracks(path, rate=2.5, unit="m")
    assert table.attrs["bayeshunt"]["reader"] == "trajnet"
    assert "1 rows of predictions are left out" in table.attrs["bayeshunt"]["notes"]
    assert table["id"].tolist() == [1] * 40 + [2] * 40
    assert table[["x", "y"]].to_numpy() == pytest.approx(walk[["x", "y"]].to_numpy())
    assert np.diff(table["time"].iloc[:40]) == pytest.approx(0.4)
    for wrong, problem in (
        ('{"track": {"f": 0, "p": 1, "x": "a", "y": 0}}', "line 3: x is 'a'; expected a number"),
        ('{"track": [1, 2]}', "line 3: neither a scene nor a track"),
        ("[" * 5000, "line 3: neither a scene nor a track"),
        ('{"track": {"f": 0, "p": null, "x": 0, "y": 0}}', "line 3: p is None"),
    ):
        path.write_text("\n".join([*lines[:2], wrong]))
        with pytest.raises(DataError, match=problem):
            bh.read_tracks(path, rate=2.5, unit="m")
    path.write_text(lines[0])
    with pytest.raises(DataError, match="holds no track"):
        bh.read_tracks(path, rate=2.5, unit="m")


def test_degrees_and_dates_that_the_names_tell(walk: pd.DataFrame, tmp_path) -> None:
    dates = pd.Timestamp("2024-05-03 09:12:00") + pd.to_timedelta(walk.frame / RATE, unit="s")
    table = walk.assign(datetime=dates.dt.strftime("%Y-%m-%d %H:%M:%S.%f"), orientation_deg=270.0).drop(columns="frame")
    table.to_csv(tmp_path / "gps.csv", index=False)
    read = bh.read_tracks(tmp_path / "gps.csv", unit="m")
    assert read["time"].iloc[:3].tolist() == pytest.approx([0.0, 0.1, 0.2])
    assert read["heading"].to_numpy() == pytest.approx(-math.pi / 2)
    epochs = table.assign(datetime=1_700_000_000_000 + walk.frame * 100).rename(columns={"datetime": "timestamp"})
    epochs.to_csv(tmp_path / "epochs.csv", index=False)
    assert bh.read_tracks(tmp_path / "epochs.csv", unit="m")["time"].to_numpy() == pytest.approx(
        read["time"].to_numpy()
    )


def test_places_that_the_file_doubts_are_said(walk: pd.DataFrame, tmp_path) -> None:
    walk.assign(likelihood=np.where(walk.frame % 20, 0.9, 0.1)).to_csv(tmp_path / "t.csv", index=False)
    notes = bh.read_tracks(tmp_path / "t.csv", rate=RATE, unit="m").attrs["bayeshunt"]["notes"]
    assert any("4 rows have a confidence below 0.5" in note and "--least-confidence 0.5" in note for note in notes)
    kept = bh.read_tracks(tmp_path / "t.csv", rate=RATE, unit="m", least_confidence=0.5)
    assert len(kept) == 76
    assert not any("confidence below" in note for note in kept.attrs["bayeshunt"]["notes"])
