"""A full disk, a folder that cannot be written, Ctrl-C: one line, an exit status, nothing half-written."""

import os
import resource
import signal
import subprocess
import sys
import time

import pytest

from bayeshunt.experiments.store.status import status

pytestmark = pytest.mark.skipif(os.name != "posix", reason="uses resource limits and signals")

EXPORTS = ("hunts.parquet", "summary.json", "summary.md")


@pytest.fixture(scope="module")
def model_file(khepera_model, tmp_path_factory):
    path = tmp_path_factory.mktemp("model") / "model.json"
    khepera_model.save(path)
    return path


def start(*arguments, limit=None):
    """Start a command; no file that it writes may grow beyond ``limit`` bytes, as on a full disk."""

    def prepared():
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # who runs the tests in the background ignores it, and so would we
        if limit is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    line = [sys.executable, "-m", "bayeshunt", *map(str, arguments)]
    return subprocess.Popen(
        line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=prepared, start_new_session=True
    )


def run(*arguments, limit=None):
    process = start(*arguments, limit=limit)
    output, errors = process.communicate()
    return process.returncode, output, errors


def evaluation(model_file, out):
    return ("evaluate", "--model", model_file, "--planner", "reactive", "--arena", "open", "--runs", "10", "--jobs",
            "1", "--quiet", "--out", out)  # fmt: skip


@pytest.mark.slow
def test_a_full_disk_stops_the_evaluation_and_room_lets_it_go_on(model_file, tmp_path):
    whole, full = tmp_path / "whole", tmp_path / "full"
    code, _, errors = run(*evaluation(model_file, full), limit=140_000)
    assert code == 1
    assert errors.count("\n") == 1
    assert "cannot be used (" in errors
    assert "every hunt that has ended is kept" in errors
    assert 0 < status(full).ended < 70
    assert not any((full / name).exists() for name in EXPORTS)
    for folder in (full, whole):
        assert run(*evaluation(model_file, folder))[0] == 0
    for name in EXPORTS:
        assert (full / name).read_bytes() == (whole / name).read_bytes()


@pytest.mark.parametrize(
    "arguments",
    [
        ("babble", "--steps", "400", "--quiet", "--out", "b.parquet"),
        pytest.param(("fit", "in.parquet", "--quiet", "--out", "m.json"), marks=pytest.mark.slow),
    ],
)
def test_a_full_disk_leaves_no_half_written_file(arguments, tmp_path, khepera_frame, monkeypatch):
    from bayeshunt.data import babbling_table

    monkeypatch.chdir(tmp_path)
    babbling_table.save(khepera_frame, "in.parquet")
    code, output, errors = run(*arguments, limit=4096)
    assert (code, output) == (1, "")
    assert errors.count("\n") == 1
    assert "cannot be written" in errors
    assert [p.name for p in tmp_path.iterdir()] == ["in.parquet"]


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs a folder that nobody can write to")
@pytest.mark.parametrize(
    "arguments",
    [("evaluate", "--runs", "1", "--out", "/proc/results"), ("babble", "--steps", "20", "--out", "/proc/b.parquet")],
)
def test_a_folder_that_cannot_be_written(arguments):
    code, output, errors = run(*arguments, "--quiet")
    assert code in (1, 2)
    assert output == ""
    assert errors.count("\n") == 1
    assert arguments[-1] in errors


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.slow)])
def test_stopped_by_a_signal(model_file, tmp_path, number):
    arguments = [*evaluation(model_file, tmp_path / "r"), "--runs", "500", "--jobs", "2"]
    process = start(*arguments)
    end = time.monotonic() + 60
    while time.monotonic() < end and not ended(tmp_path / "r"):
        time.sleep(0.05)
    if number == signal.SIGINT:
        os.killpg(process.pid, number)  # as a terminal does: everybody gets it
    else:
        process.send_signal(number)
    output, errors = process.communicate(timeout=60)
    assert (process.returncode, output) == (130, "")
    kept = status(tmp_path / "r").ended
    assert errors == (
        f"bayeshunt: stopped; {kept} of 3500 hunts are kept in {tmp_path / 'r'}; give the same line again to go on\n"
    )
    assert 0 < kept < 3500


def ended(folder):
    from bayeshunt.core.errors import BayesHuntError

    try:
        return status(folder).ended
    except BayesHuntError:
        return 0
