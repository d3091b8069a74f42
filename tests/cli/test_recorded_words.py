"""What the commands say of recordings: options as they are typed, and rows that are few."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest


@pytest.fixture
def log(folder):
    """Ten seconds of a robot that turns on the spot half the time, its columns named as nobody foresees."""
    yaw = np.repeat([0.0, 90.0, 180.0, -90.0, 0.0], 20)
    frame = pd.DataFrame({"t": np.arange(100) * 0.1, "east": np.arange(100) * 0.01, "north": 0.0, "nose": yaw})
    frame.assign(a=np.repeat([1.0, 2.0], 50), b=1.0).to_csv(folder / "log.csv", index=False)


NAMED = ("--pose", "east,north,nose", "--command", "a,b")
ASKED = {
    (): "name them: --pose X,Y,YAW and --command L,R",
    NAMED: "degrees or radians? say it: --angle rad|deg",
    (*NAMED, "--angle", "degrees"): "unknown unit of angles 'degrees'; did you mean 'deg'?",
}


@pytest.mark.parametrize("words", ASKED, ids=len)
def test_what_is_asked_for_is_said_as_it_is_typed(words, log, bayeshunt):
    _, err = bayeshunt("ingest", "log", "log.csv", "--time-step", "1", *words, "--out", "o.parquet", status=2)
    assert err.endswith(f"{ASKED[words]}\n")


def test_few_rows_are_said(log, bayeshunt):
    line = ("ingest", "log", "log.csv", "--time-step", "1", *NAMED, "--angle", "deg", "--out", "o.parquet")
    out, _ = bayeshunt(*line)
    assert "rows of 2 gaits; 4 to 5 rows a gait are few" in out
    assert out.endswith("next: bayeshunt fit o.parquet --prior 0.03 --out model.json\n")
