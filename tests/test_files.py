"""Nothing is ever half-written."""

import pytest

from bayeshunt.errors import BayesHuntError
from bayeshunt.files import replace_atomically, write_text


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
