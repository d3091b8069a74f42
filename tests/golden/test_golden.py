"""The golden file: results that stay as they are, to the last bit, while the code around them changes."""

import json

import pytest
from values import FILE, entries, processor, sha

KEPT = json.loads(FILE.read_text(encoding="utf-8"))[processor()]
ENTRIES = entries()


def test_nothing_is_left_out():
    assert sorted(KEPT) == sorted(ENTRIES)


@pytest.mark.parametrize("name", ENTRIES)
def test_result_is_the_same_to_the_last_bit(name):
    assert sha(ENTRIES[name]()) == KEPT[name], f"{name} has changed; see tests/golden/values.py"
