# ruff: noqa: E501
"""Corrupted files of every format: read, or refused in one line; never a traceback."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import bayeshunt as bh
from bayeshunt.core.errors import BayesHuntError

pytestmark = pytest.mark.slow

FILES = 1000


def tidy(path: Path) -> Path:
    n = np.arange(60)
    pd.DataFrame({"frame": n, "id": n // 30, "x": n * 0.1, "y": n * 0.2, "heading": 0.1}).to_csv(path, index=False)
    return path


def plain(path: Path) -> Path:
    np.savetxt(
        path, np.column_stack([np.arange(60) * 10, np.arange(60) // 30, np.arange(60.0), np.arange(60.0)]), fmt="%g"
    )
    return path


def parquet(path: Path) -> Path:
    pd.read_csv(tidy(path.with_suffix(".csv"))).to_parquet(path)
    return path


def trex(path: Path) -> Path:
    np.savez_compressed(path, X=np.arange(60.0), Y=np.arange(60.0), ANGLE=np.zeros(60), frame_rate=[30.0])
    return path


def pose(path: Path) -> Path:
    columns = pd.MultiIndex.from_product([["net"], ["nose", "tail"], ["x", "y", "likelihood"]])
    pd.DataFrame(np.random.default_rng(0).random((40, 6)), columns=columns).to_csv(path)
    return path


def sleap(path: Path) -> Path:
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w") as file:
        file["tracks"] = np.random.default_rng(0).random((2, 2, 1, 40))
        file["track_names"], file["node_names"] = [b"a", b"b"], [b"thorax"]
    return path


def pose_h5(path: Path) -> Path:
    pytest.importorskip("tables")
    columns = pd.MultiIndex.from_product(
        [["net"], ["nose", "tail"], ["x", "y", "likelihood"]], names=["scorer", "bodyparts", "coords"]
    )
    pd.DataFrame(np.random.default_rng(0).random((40, 6)), columns=columns).to_hdf(path, key="df_with_missing")
    return path


def trajnet(path: Path) -> Path:
    rows = (f'{{"track": {{"f": {10 * n}, "p": {n // 30}, "x": {0.1 * n:.2f}, "y": 1.5}}}}' for n in range(60))
    path.write_text("\n".join(['{"scene": {"id": 0, "p": 1, "s": 0, "e": 290, "fps": 2.5}}', *rows]))
    return path


def bag(path: Path) -> Path:
    pytest.importorskip("rosbags")
    from test_ros_bags import bag as made

    return made(path.parent, 1).rename(path)


def log(path: Path) -> Path:
    n = np.arange(200)
    pd.DataFrame({"time": n * 0.05, "x": n * 0.01, "y": 0.0, "yaw": 0.0, "left": n // 50, "right": 1}).to_csv(
        path, index=False
    )
    return path


def as_tracks(path: Path) -> pd.DataFrame:
    return bh.read_tracks(path, rate=10, unit="px")


def as_log(path: Path) -> pd.DataFrame:
    return bh.gaits_from_log(bh.read_log(path), time_step=1.0, gaits="held")


@pytest.mark.parametrize(
    ("make", "name", "read"),
    [(tidy, "t.csv", as_tracks), (plain, "t.txt", as_tracks), (parquet, "t.parquet", as_tracks), (trex, "t_id1.npz", as_tracks),
     (pose, "p.csv", as_tracks), (sleap, "s.h5", as_tracks), (pose_h5, "d.h5", as_tracks), (trajnet, "t.ndjson", as_tracks), (bag, "b.bag", as_log), (log, "log.csv", as_log)],
)  # fmt: skip
def test_damage_is_one_line(make: Callable, name: str, read: Callable, tmp_path: Path) -> None:
    good = make(tmp_path / name).read_bytes()
    rng = np.random.default_rng(7)
    messages = []
    for _ in range(FILES):
        bad = bytearray(good)
        for _ in range(rng.integers(1, 5)):
            kind, at = rng.integers(4), int(rng.integers(len(bad)))
            if kind == 0:
                bad[at] = int(rng.integers(256))
            elif kind == 1:
                del bad[at:]
                bad += b"x" * (not bad)
            elif kind == 2:
                del bad[at : at + int(rng.integers(1, 20))]
                bad += b"x" * (not bad)
            else:
                bad[at:at] = bytes(rng.integers(0, 256, size=int(rng.integers(1, 9)), dtype=np.uint8))
        (tmp_path / name).write_bytes(bytes(bad))
        try:
            table = read(tmp_path / name)
        except BayesHuntError as error:
            messages.append(str(error))
        else:
            assert np.isfinite(
                table.select_dtypes("number").drop(columns=["heading", "confidence"], errors="ignore")
            ).all(axis=None)
    assert messages
    assert not [text for text in messages if "\n" in text]
