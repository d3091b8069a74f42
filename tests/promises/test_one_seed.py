"""One seed gives one SHA-256: 1 and 2 workers, loky and dask, three hash seeds, a killed dask worker."""

import hashlib
import os
import re
import signal
import subprocess
import sys
import time

import pytest
from promise_cases import children, command, run

pytestmark = pytest.mark.slow

WHAT = ("evaluate", "--runs", "3", "--seed", "7", "--quiet")


def sha(folder):
    return hashlib.sha256((folder / "hunts.parquet").read_bytes()).hexdigest()


def test_one_seed_is_one_hash(tmp_path, figure):
    pytest.importorskip("distributed")
    ways = {
        "1 process": ("--jobs", "1"),
        "2 loky workers": ("--jobs", "2"),
        "2 dask workers": ("--jobs", "2", "--scheduler", "local"),
    }
    hashes = {}
    for name, options in ways.items():
        for hash_seed in ("0", "1", "4294967295"):
            folder = tmp_path / f"{name}-{hash_seed}".replace(" ", "-")
            run(*WHAT, *options, "--out", folder, hash_seed=hash_seed)
            hashes[name, hash_seed] = sha(folder)
    assert len(set(hashes.values())) == 1, hashes
    figure(
        f"f. {len(hashes)} ways (1 process, 2 loky, 2 dask; 3 hash seeds): one SHA-256, {hashes.popitem()[1][:16]}..."
    )


def line_in(log, pattern):
    """Wait until a line of a log matches, and return the match."""
    for _ in range(600):
        found = re.search(pattern, log.read_text())
        if found:
            return found
        time.sleep(0.1)
    raise AssertionError(log.read_text())


@pytest.fixture
def cluster(tmp_path):
    """A dask scheduler and two workers in processes of their own; yields its address and the workers' logs."""
    pytest.importorskip("distributed")
    started, logs = [], []

    def start(name, *arguments):
        log = tmp_path / f"{name}.log"
        with log.open("w") as stream:
            line = [sys.executable, "-m", "distributed.cli.dask_" + arguments[0], *arguments[1:], "--no-dashboard"]
            started.append(subprocess.Popen(line, stderr=stream, stdout=stream, start_new_session=True, cwd=tmp_path))
        return log

    log = start("scheduler", "scheduler", "--port", "0", "--host", "127.0.0.1")
    address = line_in(log, r"Scheduler at:\s+(tcp://\S+)")[1]
    for number in range(2):
        logs.append(start(f"worker{number}", "worker", address, "--nthreads", "1"))
    for log in logs:
        line_in(log, "Registered to")
    yield address, started[1:], logs
    for process in started:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="finds worker processes in /proc")
def test_a_killed_dask_worker_changes_nothing(tmp_path, model_file, cluster, figure):
    address, nannies, logs = cluster
    what = (*WHAT[:1], "--runs", "30", "--seed", "7", "--quiet", "--model", model_file)
    run(*what, "--jobs", "1", "--out", tmp_path / "alone")
    line = command(*what, "--scheduler", address, "--out", tmp_path / "far")
    process = subprocess.Popen(line, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    while not far_begun(tmp_path / "far"):
        assert process.poll() is None, process.stderr.read()
        time.sleep(0.05)
    for pid in children(nannies[0].pid):
        os.kill(pid, signal.SIGKILL)
    assert process.poll() is None, "it was over before the kill"
    assert process.wait() == 0, process.stderr.read()
    line_in(logs[0], "was killed by signal 9")
    assert sha(tmp_path / "far") == sha(tmp_path / "alone")
    figure("f. scheduler and two workers by address, one worker killed on the way: the same SHA-256")


def far_begun(folder):
    """Whether some hunts have arrived."""
    from bayeshunt.core.errors import BayesHuntError
    from bayeshunt.experiments.store.status import status

    try:
        return status(folder).ended > 0
    except BayesHuntError:
        return False
