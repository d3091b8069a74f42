"""The benchmarks' own command: tables, JSON, and a failure that is told and counted."""

import importlib
import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture
def main(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT))  # benchmarks are no part of the installed package
    return importlib.import_module("benchmarks.__main__")


def test_every_benchmark_renders_its_own_figures(main):
    for name in main.BENCHMARKS:
        assert (ROOT / "benchmarks" / f"{name}.py").is_file()
        text = (ROOT / "benchmarks" / f"{name}.py").read_text()
        assert "\ndef report(facts: dict[str, Any]) -> str:" in text, f"{name} has no report of its figures"


@pytest.mark.parametrize("name", sorted(path.stem for path in (ROOT / "benchmarks").glob("[!_]*.py")))
def test_every_benchmark_finds_what_it_measures(main, name):
    """Its module is imported: what was renamed under it is missed at once; libraries that it stands beside may lack."""
    try:
        assert importlib.import_module(f"benchmarks.{name}").__doc__
    except ModuleNotFoundError as error:
        if error.name.partition(".")[0] in ("bayeshunt", "benchmarks"):
            raise
        pytest.skip(f"no {error.name} here")


@pytest.mark.slow
def test_compiled_parts_are_those_of_the_package():
    """Its hunts are held to the package's own by the benchmark itself."""
    pytest.importorskip("numba")
    command = [sys.executable, "-m", "benchmarks.compiled", "--runs", "1", "--rounds", "1", "--json"]
    ran = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr[-2000:]
    assert json.loads(ran.stdout)["evaluation"]["hunts"] == 35


def test_a_failure_is_told_and_counted(main, monkeypatch, tmp_path, capsys):
    figures = {"hunts": 7, "one_worker_s": 2.0, "two_workers_s": 1.0, "speed_up": 2.0, "cores": 2}
    monkeypatch.setattr(main, "run", lambda name: {"error": "no numba"} if name == "compiled" else figures)
    monkeypatch.setattr(sys, "argv", ["x", "--only", "compiled", "evaluation", "--out", str(tmp_path / "f.json")])
    assert main.main() == 1
    printed = capsys.readouterr().out
    assert "== compiled: failed: no numba" in printed
    assert "speed-up 2.00 on 2 cores" in printed
    assert json.loads((tmp_path / "f.json").read_text())["evaluation"] == figures


@pytest.mark.slow
def test_a_benchmark_runs():
    command = [sys.executable, "-m", "benchmarks", "--json", "--only", "physics"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=True)
    rows = json.loads(done.stdout)["physics"]["rows"]
    assert {row["arena"] for row in rows} == {"walled", "open"}
    assert all(row["hunt_us"] > 0 and row["bare_us"] > 0 for row in rows)
