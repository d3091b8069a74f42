"""Nothing is ever half-written."""

import os
import stat

import pytest

from bayeshunt.core.errors import BayesHuntError, DataError, InputError
from bayeshunt.files.atomic import check_source, replace_atomically, write_text


def test_a_failure_leaves_the_old_file(tmp_path):
    path = tmp_path / "f.txt"
    write_text(path, "old")
    with pytest.raises(RuntimeError), replace_atomically(path) as temporary:  # noqa: PT012
        temporary.write_text("half")
        raise RuntimeError
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_missing_folder_is_one_line(tmp_path):
    with pytest.raises(BayesHuntError, match="cannot write here"):
        write_text(tmp_path / "no" / "f.txt", "x")


def test_a_name_that_is_too_long_is_one_line(tmp_path):
    with pytest.raises(BayesHuntError, match=r"cannot be written \(File name too long\)"):
        write_text(tmp_path / ("a" * 300), "x")


def test_a_link_stays_a_link_and_its_file_is_replaced(tmp_path):
    (tmp_path / "elsewhere").mkdir()
    file, link = tmp_path / "elsewhere" / "f.txt", tmp_path / "link.txt"
    for _ in range(2):  # a link to nothing yet, and to a file
        link.unlink(missing_ok=True)
        link.symlink_to(file)
        write_text(link, "new")
        assert link.is_symlink()
        assert file.read_text() == "new"
    assert list(file.parent.iterdir()) == [file]


def test_what_is_no_file_is_left_as_it_is(tmp_path):
    pipe, link, loop = tmp_path / "pipe", tmp_path / "link", tmp_path / "loop"
    os.mkfifo(pipe)
    link.symlink_to(pipe)
    loop.symlink_to(loop)
    for path in (pipe, link, loop):
        with pytest.raises(InputError, match="is not a regular file"):
            write_text(path, "x")
    with pytest.raises(InputError, match="is a folder"):
        write_text(tmp_path, "x")
    assert stat.S_ISFIFO(pipe.lstat().st_mode)
    assert loop.is_symlink()
    assert sorted(tmp_path.iterdir()) == [link, loop, pipe]


def test_a_command_is_suggested_only_for_a_name_that_is_free(tmp_path):
    with pytest.raises(DataError, match=r"no such file; make one with: bayeshunt babble --out '.*my table\.parquet'"):
        check_source(tmp_path / "my table.parquet", "bayeshunt babble", DataError)
    with pytest.raises(DataError, match="expected the name of a file made by: bayeshunt babble; got 3"):
        check_source(3, "bayeshunt babble", DataError)
    os.mkfifo(tmp_path / "pipe")
    for path, kind in ((tmp_path, "is a folder"), (tmp_path / "pipe", "is not a regular file")):
        with pytest.raises(DataError, match=f"{kind}; give a file made by: bayeshunt babble$"):
            check_source(path, "bayeshunt babble", DataError)
