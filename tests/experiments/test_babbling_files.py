"""Large babbling tables: shards by seed, the same bytes at any number of workers and after an interruption."""

import numpy as np
import pytest

from bayeshunt.core.errors import DataError, FolderInUseError, InputError
from bayeshunt.data import babbling_table
from bayeshunt.experiments.studies.babbling import babble_to_file, kept_rows, shard_seed
from bayeshunt.files.locks import FolderLock
from bayeshunt.worlds.babbling import babble

WHAT = {"robot": "khepera", "steps": 130, "seed": 3, "shard_rows": 50}


def test_a_small_table_is_the_one_in_memory(tmp_path):
    gaits = babble_to_file("khepera", 50, 3, tmp_path / "t.parquet", shard_rows=50)
    frame = babbling_table.load(tmp_path / "t.parquet")
    assert frame.equals(babbling_table.load(tmp_path / "t.parquet"))
    expected = babble("khepera", 50, 3)
    assert frame.attrs == expected.attrs
    np.testing.assert_array_equal(frame["distance"], expected["distance"])
    assert gaits == sorted(expected["gait"].unique())


def test_shards_are_tables_of_their_own_seeds(tmp_path):
    path = tmp_path / "t.parquet"
    babble_to_file(**WHAT, path=path)
    frame = babbling_table.load(path)
    assert frame["step"].tolist() == list(range(130))
    for number, rows in enumerate((50, 50, 30)):
        part = frame.iloc[50 * number :][:rows]
        again = babble("khepera", rows, shard_seed(3, number))
        np.testing.assert_array_equal(part["distance"], again["distance"])
        assert part["gait"].tolist() == again["gait"].tolist()
    assert list(tmp_path.iterdir()) == [path]


def test_workers_and_interruptions_change_no_byte(tmp_path):
    one, two, three = (tmp_path / f"{name}.parquet" for name in ("one", "two", "three"))
    babble_to_file(**WHAT, path=one)
    babble_to_file(**WHAT, path=two, jobs=2)

    def interrupt(_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        babble_to_file(**WHAT, path=three, progress=interrupt)
    assert not three.exists()
    kept = sorted(p.name for p in (tmp_path / "three.parquet.shards").glob("*.parquet"))
    assert kept == ["000000.parquet"]
    assert [kept_rows(path) for path in (one, three)] == [0, 50]
    ended = []
    babble_to_file(**WHAT, path=three, progress=ended.append)
    assert ended == [50, 50, 30]
    assert one.read_bytes() == two.read_bytes() == three.read_bytes()


def test_shards_of_another_table_are_refused(tmp_path):
    path = tmp_path / "t.parquet"
    folder = tmp_path / "t.parquet.shards"
    folder.mkdir()
    babble_to_file("khepera", 50, 9, folder / "000000.parquet", shard_rows=50)
    with pytest.raises(DataError, match="is a shard of another table; remove it"):
        babble_to_file(**WHAT, path=path)
    assert kept_rows(path) == 50
    (folder / "000000.parquet").write_bytes(b"nonsense")
    assert kept_rows(path) == 0  # asked when a babbling is stopped: no time for a traceback
    with pytest.raises(DataError, match="cannot be read as a shard of the table"):
        babble_to_file(**WHAT, path=path)
    assert not path.exists()


def test_only_what_it_made_is_removed(tmp_path):
    folder = tmp_path / "t.parquet.shards"
    folder.mkdir()
    (folder / ".000001.parquet.abc.tmp").touch()  # left by a worker that was killed
    (folder / "notes.txt").write_text("of the user")
    babble_to_file(**WHAT, path=tmp_path / "t.parquet")
    assert [p.name for p in folder.iterdir()] == ["notes.txt"]


def test_a_path_that_cannot_be_written_is_refused_before_the_work(tmp_path):
    (tmp_path / "t.parquet").mkdir()
    worked = []
    with pytest.raises(InputError, match="is a folder"):
        babble_to_file(**WHAT, path=tmp_path / "t.parquet", progress=worked.append)
    assert not worked
    assert [p.name for p in tmp_path.iterdir()] == ["t.parquet"]


def test_a_second_process_is_refused(tmp_path):
    folder = tmp_path / "t.parquet.shards"
    folder.mkdir()
    with FolderLock(folder), pytest.raises(FolderInUseError, match="another process is at work"):
        babble_to_file(**WHAT, path=tmp_path / "t.parquet")


@pytest.mark.parametrize("change", [{"steps": 0}, {"seed": -1}, {"jobs": 0}, {"shard_rows": 9}, {"shard_rows": 10**6}])
def test_nonsense_is_refused(tmp_path, change):
    with pytest.raises(InputError, match="expected"):
        babble_to_file(**{**WHAT, **change}, path=tmp_path / "t.parquet")
    assert not list(tmp_path.iterdir())
