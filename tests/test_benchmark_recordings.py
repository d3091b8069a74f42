"""The benchmark of recordings: what counts as met, scenes by their files, and a table that holds every figure."""

import importlib
from pathlib import Path

import numpy as np
import pytest

from bayeshunt.core.errors import InputError

ROOT = Path(__file__).parents[1]


@pytest.fixture
def recordings(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT))  # benchmarks are no part of the installed package
    return importlib.import_module("benchmarks.recordings")


def test_a_target_is_met_at_or_below_it(recordings) -> None:
    figures = (("a", 0.31, 0.31, 0.3, 0.32, 9, "m"), ("b", 0.32, 0.31), ("c", 1.0, None))
    rows = [recordings.line(*figure) for figure in figures]
    assert [row["met"] for row in rows] == [True, False, None]
    lines = recordings.report({"part": rows}).splitlines()
    assert lines[2:] == [
        "| a | 0.31 m | 0.3 to 0.32 | 9 | <= 0.31 | yes |",
        "| b | 0.32  |  | 0 | <= 0.31 | no |",
        "| c | 1  |  | 0 |  |  |",
    ]


def test_scenes_are_files_unless_they_are_the_public_ones(recordings, tmp_path) -> None:
    def walk(name: str) -> None:
        steps = np.arange(30)
        rows = [f"{10 * i} {who} {0.5 * i} {who}" for who in (1, 2) for i in steps]
        (tmp_path / name).write_text("\n".join(rows) + "\n")

    walk("one.txt")
    with pytest.raises(InputError, match="two or more"):
        recordings.scenes(tmp_path)
    walk("two.txt")
    tracks = recordings.scenes(tmp_path)
    assert sorted(tracks["scene"].unique()) == ["one", "two"]
    assert tracks["id"].nunique() == 4
    for names in recordings._SCENES.values():
        for name in names:
            walk(f"pedestrians_{name}.txt")
    tracks = recordings.scenes(tmp_path)
    assert sorted(tracks["scene"].unique()) == sorted(recordings._SCENES)
    assert tracks.loc[tracks["scene"] == "univ", "id"].nunique() == 4
