"""Babbling tables of any size: shards by seed, babbled by workers, joined into one Parquet file.

Shard k is ``babble(robot, rows, shard_seed(seed, k))``, so the table is the same at any number of
workers. Every finished shard is kept beside the file until all are there; the same call after an
interruption goes on with the shards that are missing.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from bayeshunt.config.loading import load_robot
from bayeshunt.config.schema import PhysicsSettings, RobotSettings
from bayeshunt.core.checks import check_whole
from bayeshunt.core.errors import DataError, InputError
from bayeshunt.data import babbling_table
from bayeshunt.experiments.run import workers
from bayeshunt.experiments.store.export import check_output_folder
from bayeshunt.experiments.store.identity import versions
from bayeshunt.files import parquet
from bayeshunt.files.atomic import check_target
from bayeshunt.files.locks import LOCK_FILE, FolderLock
from bayeshunt.worlds.babbling import babble, provenance

__all__ = ["SHARD_ROWS", "Shard", "babble_shard", "babble_to_file", "kept_rows", "shard_seed"]

#: Rows of a shard; a table of no more rows is one stream and comes from :func:`bayeshunt.babble` itself.
SHARD_ROWS = parquet.ROW_GROUP
_SHARDS = "[0-9]*.parquet"


class Shard(NamedTuple):
    """One part of a table: its number, its rows, the steps before it, its seed, its file."""

    number: int
    rows: int
    first_step: int
    seed: int
    path: Path


def shard_seed(seed: int, shard: int) -> int:
    """Return the seed with which :func:`bayeshunt.babble` makes one shard of a large table."""
    return int(np.random.SeedSequence([seed, shard]).generate_state(1, np.uint64)[0] >> 1)


def babble_to_file(
    robot: str | os.PathLike[str] | RobotSettings,
    steps: int,
    seed: int,
    path: str | os.PathLike[str],
    *,
    jobs: int = 1,
    shard_rows: int = SHARD_ROWS,
    progress: Callable[[int], None] | None = None,
) -> list[str]:
    """Babble ``steps`` gaits into a Parquet file, in memory that does not grow with ``steps``.

    Up to ``shard_rows`` steps (at most 100,000) the table is ``babble(robot, steps, seed)``; beyond,
    shards of so many rows, each from a robot at rest, one row group each. jobs: worker processes, -1
    for one per core. progress: called with the number of steps just done. Returns the gaits executed, sorted.

    Raises InputError for a wrong number, FolderInUseError if another process is making the same file,
    DataError if shards of another table are in the way. What else is in the folder of the shards is left there.
    """
    robot = load_robot(robot)
    physics = robot.physics
    check_whole(steps, "steps", 1)
    check_whole(seed, "seed", 0)
    workers.check_jobs(jobs)
    least = len(robot.gaits)  # so that every shard holds every gait
    if not least <= shard_rows <= SHARD_ROWS:
        raise InputError(f"shard_rows: expected {least} to {SHARD_ROWS}, got {shard_rows}")
    check_target(path)  # hours before it is written
    if steps <= shard_rows:
        frame = babble(robot, steps, seed, physics=physics, progress=progress)
        babbling_table.save(frame, path)
        return sorted(frame["gait"].unique())
    record = {**provenance(robot, physics, steps, seed), "shard_rows": shard_rows}
    folder = check_output_folder(_shard_folder(path))
    with FolderLock(folder):
        shards = list(_shards(steps, seed, shard_rows, folder))
        _babble_missing(partial(babble_shard, robot, physics, record, os.getpid()), shards, record, jobs, progress)
        _join(shards, record, path)
        for made in (*folder.glob(_SHARDS), *folder.glob(f".{_SHARDS}.*.tmp")):  # the latter of workers killed
            made.unlink()
    (folder / LOCK_FILE).unlink(missing_ok=True)
    with contextlib.suppress(OSError):  # what else is in the folder is not ours, and stays with it
        folder.rmdir()
    return sorted(robot.gaits.names)


def kept_rows(path: str | os.PathLike[str]) -> int:
    """Return how many rows of an unfinished table ``path`` are kept in its shards; 0 if there are none."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    rows = 0
    for shard in _shard_folder(path).glob(_SHARDS):
        with contextlib.suppress(pa.ArrowException, OSError):  # a damaged one is named by the next start
            rows += pq.read_metadata(shard).num_rows
    return rows


def _shard_folder(path: str | os.PathLike[str]) -> Path:
    return Path(f"{os.fspath(path)}.shards")


def babble_shard(
    robot: RobotSettings, physics: PhysicsSettings, record: dict[str, Any], parent: int, shard: Shard
) -> Shard:
    """Babble one shard into its file. parent: process that asks."""
    workers.guard_worker(parent)
    workers.check_worker_versions({name: record["versions"][name] for name in ("bayeshunt", "box2d")}, versions())
    frame = babble(robot, shard.rows, shard.seed, physics=physics)
    frame["step"] += shard.first_step
    babbling_table.save(frame, shard.path, _shard_record(record, shard))
    return shard


def _shards(steps: int, seed: int, rows: int, folder: Path) -> Iterator[Shard]:
    for number, first in enumerate(range(0, steps, rows)):
        path = folder / f"{number:06d}.parquet"
        yield Shard(number, min(rows, steps - first), first, shard_seed(seed, number), path)


def _babble_missing(
    call: Callable[[Shard], Shard], shards: Sequence[Shard], record: dict[str, Any], jobs: int,
    progress: Callable[[int], None] | None,
) -> None:  # fmt: skip
    kept = {shard.number for shard in shards if shard.path.exists() and _reader(shard, record)}
    ended: set[int] = set()

    def note(shard: Shard) -> None:
        if progress is not None and shard.number not in ended:
            progress(shard.rows)
        ended.add(shard.number)

    def missing() -> list[Shard]:
        return [shard for shard in shards if shard.number not in ended]

    for shard in shards:
        if shard.number in kept:
            note(shard)
    for shard in workers.work_off(missing, lambda todo: workers.parallel(call, todo, jobs=jobs)):
        note(shard)


def _join(shards: Sequence[Shard], record: dict[str, Any], path: str | os.PathLike[str]) -> None:
    """Write the shards as the row groups of one file."""
    digests = [digest for shard in shards for digest in _reader(shard, record).digests or ()]
    groups = (table for shard in shards for table in _reader(shard, record))
    parquet.write_groups(_reader(shards[0], record).schema, groups, digests, record, path)


def _reader(shard: Shard, record: dict[str, Any]) -> parquet.Reader:
    """Open a shard's file; DataError if it is damaged or of another table."""
    fix = "remove it and give the command again"
    reader = parquet.Reader(shard.path, what="a shard of the table", fix=fix)
    if reader.record != _shard_record(record, shard) or reader.rows != shard.rows:
        raise DataError(f"{shard.path} is a shard of another table; {fix}, or choose another name for the table")
    return reader


def _shard_record(record: dict[str, Any], shard: Shard) -> dict[str, Any]:
    return {**record, "kind": "babbling shard", "shard": shard.number}
