"""Following recorded walkers: models in pairs, people learned from other scenes."""

from __future__ import annotations

import json

import numpy as np
import pandas as pd
import pytest

from bayeshunt.cli import main
from bayeshunt.core.errors import DataError, InputError
from bayeshunt.experiments.studies.following import follow, summary, walkers_of


def people(seed: int = 0) -> pd.DataFrame:
    """Two scenes of eight walkers at their own pace, 2.5 places a second."""
    rng, parts = np.random.default_rng(seed), []
    for scene in ("one.txt", "two.txt"):
        for number in range(8):
            time = np.arange(26) * 0.4
            bend = np.cumsum(rng.normal(scale=0.08, size=26)) + rng.uniform(0, 6)
            place = np.cumsum(rng.uniform(0.7, 1.3) * 0.4 * np.exp(1j * bend))
            parts.append(pd.DataFrame({"id": number, "time": time, "x": place.real, "y": place.imag, "heading": np.nan,
                                       "confidence": np.nan, "scene": scene}))  # fmt: skip
    return pd.concat(parts, ignore_index=True)


def test_walkers_are_drawn_evenly_and_the_same_every_time() -> None:
    tracks = people()
    chosen = walkers_of(tracks, ["one.txt", "two.txt"], 5, seed=3)
    assert [walker.scene for walker in chosen] == ["one.txt"] * 3 + ["two.txt"] * 2
    assert chosen == walkers_of(tracks, ["one.txt", "two.txt"], 5, seed=3)
    assert len({(walker.scene, walker.individual) for walker in chosen}) == 5
    with pytest.raises(InputError, match=r"did you mean 'one\.txt'"):
        walkers_of(tracks, ["ones.txt"], 5, seed=3)
    with pytest.raises(DataError, match="seen for 60 s on end"):
        walkers_of(tracks, ["one.txt"], 5, seed=3, least=60.0)


@pytest.mark.slow
def test_models_are_compared_on_the_same_walkers() -> None:
    hunts = follow(people(), ["one.txt"], 3, seed=1)
    assert len(set(hunts.groupby("model")["id"].apply(tuple))) == 1
    assert (hunts["time"] <= hunts["limit"] + 1e-9).all()
    assert hunts["company"].between(0, 1).all()
    table = summary(hunts).set_index("model")
    assert table.loc["constant_velocity", "time_differs"] == 0
    assert (table["time_low"] <= table["time_differs"]).all()
    assert (table["caught"] == hunts.groupby("model")["caught"].sum()[table.index]).all()
    pd.testing.assert_frame_equal(hunts, follow(people(), ["one.txt"], 3, seed=1))
    with pytest.raises(InputError, match="more than one scene"):
        follow(people().query("scene == 'one.txt'"), None, 1, models=["conditioned"])
    with pytest.raises(InputError, match="unknown model"):
        follow(people(), models=["count"])


def test_the_command_takes_a_folder(monkeypatch, capfd, tmp_path) -> None:
    for scene, part in people().groupby("scene"):
        part["frame"] = (part["time"] * 10 / 0.4).round().astype(int)
        part[["frame", "id", "x", "y"]].to_csv(tmp_path / str(scene), sep=" ", header=False, index=False)
    line = ["prey", "follow", tmp_path, "--rate", 2.5, "--unit", "m", "--walkers", 2, "--model", "constant_velocity",
            "--scene", "two.txt", "-q", "--model", "counts"]  # fmt: skip

    def run(*words) -> int:
        monkeypatch.setattr("sys.argv", ["bayeshunt", *map(str, words)])
        with pytest.raises(SystemExit) as left:
            main()
        return left.value.code

    assert run(*line, "--out", tmp_path / "hunts.csv") == 0
    assert "2 recorded walkers followed" in capfd.readouterr().out
    assert len(pd.read_csv(tmp_path / "hunts.csv")) == 4
    (tmp_path / "hunts.csv").unlink()
    assert run(*line, "--json") == 0
    assert [row["model"] for row in json.loads(capfd.readouterr().out)] == ["constant_velocity", "counts"]
    assert run("prey", "follow", tmp_path / "nowhere") == 2
    assert "no such folder" in capfd.readouterr().err
    assert run(*line, "--band", "3") == 2
    assert "expected NEAR,FAR" in capfd.readouterr().err
