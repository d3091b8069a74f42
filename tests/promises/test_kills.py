"""50 SIGKILLs across 700 hunts: nothing committed is lost, and the results are the same bytes."""

import contextlib
import os
import signal
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from promise_cases import SEVEN_HUNDRED, children, command, run

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not sys.platform.startswith("linux"), reason="finds worker processes in /proc"),
]

KILLS = 50
EXPORTS = ("hunts.parquet", "summary.json", "summary.md")


def committed(folder):
    """Every row in the database now."""
    path = folder / "hunts.sqlite"
    if not path.exists():
        return set()
    try:
        with contextlib.closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True, timeout=30)) as connection:
            return set(connection.execute("SELECT * FROM hunts"))
    except sqlite3.OperationalError as error:
        if "no such table" in str(error) or "unable to open" in str(error):  # it is only just being made
            return set()
        raise


def workers_of(process):
    """Process ids of the worker processes."""
    try:
        return [c for c in children(process.pid) if b"LokyProcess" in Path(f"/proc/{c}/cmdline").read_bytes()]
    except OSError:
        return []


class Victim:
    """An evaluation that is started again whenever it is not running."""

    def __init__(self, line):
        self.line, self.process, self.starts = line, None, 0

    def alive(self):
        if self.process is not None and self.process.poll() is not None:
            assert self.process.returncode in (0, -signal.SIGKILL), self.process.stderr.read()
            self.process = None
        if self.process is None:
            self.starts += 1
            self.process = subprocess.Popen(
                self.line, start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
            )
        return self.process

    def kill(self, rng):
        """Kill one worker, or the parent alone, or everybody; return what was killed."""
        workers = workers_of(self.process)
        kind = str(rng.choice(["worker", "worker", "parent", "group"])) if workers else "group"
        with contextlib.suppress(ProcessLookupError):
            if kind == "worker":
                os.kill(int(rng.choice(workers)), signal.SIGKILL)
            elif kind == "parent":
                os.kill(self.process.pid, signal.SIGKILL)
            else:
                os.killpg(self.process.pid, signal.SIGKILL)
        if kind != "worker":
            self.process.wait()
        return kind


def wait_for(folder, count, victim, seconds=None):
    """Wait until ``count`` hunts are committed, ``seconds`` have gone by or the evaluation has ended."""
    start = time.monotonic()
    while len(committed(folder)) < count and victim.process.poll() is None:
        waited = time.monotonic() - start
        if seconds is not None and waited > seconds:
            return
        assert waited < 120, "no progress"
        time.sleep(0.003)


def test_fifty_kills_lose_nothing(model_file, tmp_path, figure):
    whole, folder = tmp_path / "whole", tmp_path / "killed"
    what = ["evaluate", *SEVEN_HUNDRED, "--model", model_file, "--jobs", "2", "--quiet", "--out"]
    run(*what, whole)
    rng = np.random.default_rng(50)
    victim, tally = Victim(command(*what, folder)), {"worker": 0, "parent": 0, "group": 0}
    for kill in range(KILLS):
        victim.alive()
        have = len(committed(folder))
        step = max(1, 2 * (690 - have) // (KILLS - kill + 25))  # leaves about a third for the last start
        # One in ten is killed by the clock, most of these while it starts; never so late that all is over.
        seconds = rng.uniform(0.0, 1.5) if rng.random() < 0.1 else None
        wait_for(folder, have + int(rng.integers(1, step + 1)), victim, seconds)
        time.sleep(rng.uniform(0.0, 0.01))
        before = committed(folder)
        tally[victim.kill(rng)] += 1
        assert before <= committed(folder)
    left = len(committed(folder))
    assert left < 700, "it was over before the last kill"
    victim.alive().wait()
    if victim.process.returncode:
        run(*what, folder)
    rows = committed(folder)
    assert len(rows) == 700
    assert before <= rows
    for name in EXPORTS:
        assert (folder / name).read_bytes() == (whole / name).read_bytes()
    figure(
        f"c. {KILLS} kills ({tally['worker']} of a worker, {tally['parent']} of the parent, {tally['group']} of the "
        f"group), {victim.starts} starts, {left} of 700 hunts before the last start: 0 committed hunts lost, "
        "3 result files equal byte for byte"
    )
