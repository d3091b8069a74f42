"""Checksummed records: the same bytes for the same content, and one line for whatever is wrong with a file."""

import json
import os
import stat
import threading

import pytest

from bayeshunt.core.errors import ModelFileError
from bayeshunt.files.atomic import write_text
from bayeshunt.files.records import RecordKind, checksum, digest

KIND = RecordKind("bayeshunt thing", "bayeshunt make thing", (1, 2))


def test_a_record_comes_back_and_is_the_same_bytes_whatever_the_order_of_keys(tmp_path):
    KIND.save({"b": 1.5, "a": [1, 2]}, tmp_path / "one.json")
    KIND.save({"a": [1, 2], "b": 1.5}, tmp_path / "two.json")
    assert (tmp_path / "one.json").read_bytes() == (tmp_path / "two.json").read_bytes()
    assert KIND.load(tmp_path / "one.json") == (2, {"a": [1, 2], "b": 1.5})


def test_checksums_by_hand():
    # printf '{"a":1,"b":[2.5]}' | sha256sum, and with blanks
    content = {"b": [2.5], "a": 1}
    assert checksum(content) == "sha256:1d97f1c6350e2d952e3db713f3d5e3b3992bc269e1e2351d30c1b917ee185bde"
    assert digest(content) == "85aab50d1927ebc07ebe5f0c7ef70a21fde353c2ca2719e08198d43a2c4542ff"


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda r: r.update(kind="another"), "not a bayeshunt thing; give a file made by: bayeshunt make thing"),
        (lambda r: r.update(format=3), "format 3 is newer than 2"),
        (lambda r: r.update(format=True), "format is True; expected 1 or 2"),
        (lambda r: r.update(format=None), "format is None; expected 1 or 2"),
        (lambda r: r["content"].update(a=2), "the checksum does not match"),
        (lambda r: r.pop("content"), "the checksum does not match"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(tmp_path, change, says):
    record = json.loads(KIND.dumps({"a": 1}))
    change(record)
    path = tmp_path / "thing.json"
    path.write_text(json.dumps(record))
    with pytest.raises(ModelFileError) as caught:
        KIND.load(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("text", ["", "[1]", "3", '{"a": NaN}', "{", "[" * 100_000])
def test_what_is_no_record_is_refused(tmp_path, text):
    (tmp_path / "thing.json").write_text(text)
    with pytest.raises(ModelFileError, match=r"thing\.json: not .*; give a file made by: bayeshunt make thing$"):
        KIND.load(tmp_path / "thing.json")


@pytest.mark.skipif(os.name == "nt", reason="permissions of POSIX")
def test_files_get_the_permissions_of_the_process_and_leave_its_mask_alone(tmp_path):
    """Threads that create files while others are written atomically never see a mask of 0."""
    before = os.umask(0o027)
    try:
        seen, done = set(), threading.Event()

        def watch():
            number = 0
            while not done.is_set():
                number += 1
                handle = os.open(tmp_path / f"watched{number % 2}", os.O_CREAT | os.O_WRONLY, 0o666)
                seen.add(stat.S_IMODE(os.fstat(handle).st_mode))
                os.close(handle)
                (tmp_path / f"watched{number % 2}").unlink()

        thread = threading.Thread(target=watch)
        thread.start()
        for number in range(200):
            write_text(tmp_path / "file.txt", str(number))
        done.set()
        thread.join()
        assert stat.S_IMODE((tmp_path / "file.txt").stat().st_mode) == 0o640
        assert seen == {0o640}
    finally:
        os.umask(before)
