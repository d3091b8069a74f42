"""Checksummed Parquet files: damage is noticed, foreign files are read, files of any size are streamed."""

import json

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from bayeshunt.core.errors import DataError, InputError
from bayeshunt.core.gaits import GaitRepertoire
from bayeshunt.data import babbling_table
from bayeshunt.files import parquet
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.counting.streaming import count_tables, open_tables


def reader(path):
    return parquet.Reader(path, what="a table", fix="make it again")


def test_the_digest_is_of_the_values_not_of_their_layout():
    table = pa.table({"a": [1.0, 2.0, 3.0], "b": ["x", None, "x"]})
    chunked = pa.concat_tables([table.slice(0, 1), table.slice(1)])
    encoded = table.set_column(1, "b", table.column("b").dictionary_encode())
    assert parquet.digest(table) == parquet.digest(chunked) == parquet.digest(encoded)
    others = [
        table.set_column(0, "a", pa.array([1.0, 2.0, np.nextafter(3.0, 4.0)])),
        table.set_column(1, "b", pa.array(["x", "x", None])),
        table.set_column(1, "b", pa.array(["x", "", "x"])),
        table.rename_columns(["a", "c"]),
        table.slice(0, 2),
    ]
    assert len({parquet.digest(other) for other in [table, *others]}) == len(others) + 1


def test_an_altered_record_is_noticed():
    text = parquet.seal({"seed": 0}, ["d"])
    assert parquet.unseal(text) == ({"seed": 0}, ["d"])
    with pytest.raises(ValueError, match="checksum"):
        parquet.unseal(text.replace(b'"seed": 0', b'"seed": 1'))
    with pytest.raises(ValueError, match="checksum"):
        parquet.unseal(text.replace(b'"d"', b'"e"'))


@pytest.mark.parametrize("seal", [3, "x", {}, {"groups": None}, {"groups": 1, "checksum": ""}, {"groups": []}])
def test_checksums_that_make_no_sense_are_one_line(tmp_path, seal):
    table = pa.table({"a": [1.0]}).replace_schema_metadata({parquet.KEY: json.dumps({"seal": seal}).encode()})
    pq.write_table(table, tmp_path / "t.parquet")
    with pytest.raises(DataError, match=r"t\.parquet: cannot be read as a table \(.+\); make it again$"):
        reader(tmp_path / "t.parquet")


def test_content_that_does_not_fit_its_digest_is_refused(tmp_path):
    table = pa.table({"a": [1.0, 2.0]})
    path = tmp_path / "t.parquet"
    parquet.write_groups(table.schema, iter([table]), ["0" * 64], {}, path)
    with pytest.raises(DataError, match="row group 0 does not match its checksum"):
        list(reader(path))


def test_missing_row_groups_are_noticed(tmp_path):
    table = pa.table({"a": [1.0, 2.0]})
    path = tmp_path / "t.parquet"
    parquet.write_groups(table.schema, iter([table]), [parquet.digest(table)] * 2, {}, path)
    with pytest.raises(DataError, match="row groups are missing"):
        reader(path)


@pytest.mark.parametrize("metadata", [{}, {parquet.KEY: json.dumps({"seed": 1}).encode()}])
def test_files_of_others_are_read_as_they_are(tmp_path, metadata):
    table = pa.table({"a": [1.0, 2.0]}).replace_schema_metadata(metadata)
    pq.write_table(table, tmp_path / "t.parquet")
    found, record = parquet.read(tmp_path / "t.parquet", what="a table", fix="")
    assert found.column("a").to_pylist() == [1.0, 2.0]
    assert record == ({"seed": 1} if metadata else None)


@pytest.fixture
def pieces(khepera_frame, tmp_path, monkeypatch):
    """The 400 rows as one file of four row groups, and as three files."""
    monkeypatch.setattr(parquet, "ROW_GROUP", 100)
    whole = tmp_path / "whole.parquet"
    babbling_table.save(khepera_frame, whole)
    cuts = [khepera_frame.iloc[a:b] for a, b in ((0, 37), (37, 250), (250, 400))]
    paths = []
    for number, cut in enumerate(cuts):
        paths.append(tmp_path / f"{number}.parquet")
        cut.attrs = {babbling_table.PROVENANCE_KEY: {"part": number}}
        babbling_table.save(cut, paths[-1])
    return whole, paths


def test_batches_are_small_and_add_up(pieces, khepera_frame):
    batches = list(babbling_table.Batches(pieces[0]).of())
    assert [len(batch) for batch in batches] == [100] * 4
    assert pd.concat(batches).reset_index(drop=True).equals(babbling_table.load(pieces[0]))


def test_the_fit_of_parts_in_any_order_is_the_fit_of_the_whole(pieces, khepera_model, tmp_path):
    whole, parts = pieces
    gaits = khepera_model.gaits
    saved = []
    for paths in ([whole], parts, parts[::-1], [parts[1], parts[2], parts[0]]):
        seen = []
        counts, provenance = count_tables(open_tables(paths), gaits, progress=seen.append)
        model = ForwardModel.from_counts(counts, provenance=provenance)
        assert model == khepera_model
        assert sum(seen) == 400
        assert model.log_likelihood(counts) == khepera_model.log_likelihood(khepera_model.data[0])
        model.save(tmp_path / "m.json")
        saved.append((tmp_path / "m.json").read_bytes())
    assert saved[1] == saved[2] == saved[3]


def test_a_wrong_row_is_named_by_its_place_in_the_file(tmp_path, khepera_frame, monkeypatch):
    monkeypatch.setattr(parquet, "ROW_GROUP", 100)
    wrong = khepera_frame.copy()
    wrong.loc[321, "distance"] = -1.0
    babbling_table.save(wrong, tmp_path / "t.parquet")
    with pytest.raises(DataError, match=r"t\.parquet: row 321: distance is -1\.0"):
        count_tables(open_tables([tmp_path / "t.parquet"]), GaitRepertoire.of(khepera_frame["gait"].unique()))


def test_tables_that_do_not_belong_together_are_refused(tmp_path, khepera_frame):
    paths = [tmp_path / "a.parquet", tmp_path / "b.parquet"]
    for path, robot in zip(paths, ("one", "two"), strict=True):
        babbling_table.save(khepera_frame, path, {"robot": {"name": robot}})
    with pytest.raises(InputError, match="another robot"):
        open_tables(paths)
    with pytest.raises(InputError, match="given twice"):
        open_tables([paths[0], paths[0]])
