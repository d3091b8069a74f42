"""A reader of the manual: types every block of a page, in order, in one folder.

Hunts are fewer than the page says (``few``), as ``--help`` of the commands allows. Commands that set things up (pip,
pytest, ruff) are what .ci/run itself gives: it is looked up that it does. Nothing else is left out.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import os
import re
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from blocks import ROOT, SHELLS, Block, Line, lines

import bayeshunt as bh

#: Commands whose work --runs bounds.
COUNTED = ("evaluate", "sweep", "tradeoff", "figures")
#: Arguments that make a benchmark short.
SHORT = {
    "benchmarks": ["--only", "physics"],
    "benchmarks.fleeing": ["--hunter", "planning", "--runs", "1", "--seed", "0", "--table", "fleeing.csv"],
    "benchmarks.race": ["--work", "race", "--only", "planning-babbled-open-20-0-paper-30"],
    "benchmarks.worlds": ["paper", "--arena", "walled", "--planner", "prediction", "--runs", "1"],
}
CI = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
EXTRAS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]


def few(words: list[str]) -> list[str]:
    """The same command with one run, where --runs says how many; few walkers, permutations, steps of babbling legs."""
    words = [*words]
    for option, least in (("--runs", "1"), ("--walkers", "4"), ("--permutations", "19")):
        if option in words:
            words[words.index(option) + 1] = least
    if any(word in COUNTED for word in words[:3]) and "--runs" not in words:
        words += ["--runs", "1"]
    if "--plugin" in words and "evaluate" in words:  # of a library that a stub may stand for, here alone
        words += ["--jobs", "1"]
    if "legs" in words or "robot=hexapod" in words:  # whose preset babbles 10,000 gaits for every model
        words += ["--set", "model.babbling_steps=600"]
    return words


def few_python(text: str) -> str:
    """The same block with one run, few seeds and steps of a learner."""
    text = re.sub(r"\bruns=\d+", "runs=1", text)
    text = re.sub(r"\bseeds=range\(\d+\)", "seeds=range(1)", text)
    text = re.sub(r"\brange\(1000, 1\d+\)", "range(1000, 1004)", text)
    return text.replace(".learn(100_000)", ".learn(100)")


class Reader:
    """Runs blocks; ``bayeshunt`` runs the command line as typed and returns what it printed."""

    def __init__(self, folder: Path, bayeshunt: Callable[..., tuple[str, str]]) -> None:
        self.folder, self.bayeshunt = folder, bayeshunt
        self.names: dict[str, Any] = {}
        self.waiting: list[subprocess.Popen[bytes]] = []

    def read(self, block: Block) -> int:
        """Run a block; how many things it ran."""
        if block.kind == "python":
            return self.python(block.text)
        if block.kind == "toml":
            return self.settings(block.text)
        return sum(self.run(line) for line in lines(block)) if block.kind in SHELLS else 0

    def python(self, text: str) -> int:
        """Run Python in the names of the blocks before; keep one that names a file for the commands after."""
        if named := re.match(r"# (\S+\.py)\n", text):
            return (self.folder / named[1]).write_text(text, encoding="utf-8")
        with contextlib.redirect_stdout(io.StringIO()):  # or the next command would seem to have printed it
            exec(compile(few_python(text), "a block", "exec"), self.names)
        return 1

    def settings(self, text: str) -> int:
        """Keep settings under the name in their first line; see that they are settings of an experiment."""
        named = re.match(r"# (\S+\.toml)\n", text)
        path = self.folder / (named[1] if named else "settings.toml")
        found = tomllib.loads(text)
        path.write_text(text if "base" in found or "gait" in found else 'base = "paper"\n' + text, encoding="utf-8")
        bh.load_robot(path) if "gait" in found else bh.load_experiment(path)
        return 1

    def run(self, line: Line) -> int:
        """Run a command."""
        if line.program == "bayeshunt":
            return self.bayeshunt_line(line)
        if line.program == "dask":
            return self.start([str(Path(sys.executable).with_name("dask")), *line.words[1:]])
        if line.program == "sha256sum":
            assert len({hashlib.sha256((self.folder / name).read_bytes()).digest() for name in line.words[1:]}) == 1
            return 1
        if line.program == "python" and line.words[1] == "-m":
            return self.benchmark(line.words[2], line.words[3:])
        assert is_set_up(line), f"nobody runs {line.words}"
        return 1

    def bayeshunt_line(self, line: Line) -> int:
        """Run a command of ours; where the page shows an error after it, that is what it must say."""
        words = few(line.words[1:])
        if line.background:
            self.start([sys.executable, "-m", "bayeshunt", *line.words[1:]])
            return self.wait_for(line.words[line.words.index("--out") + 1])
        status = 0 if not line.error else 1 if "another process" in line.error else 2
        out, err = self.bayeshunt(*words, status=status)
        if line.error:
            assert " ".join(line.error.split()) in " ".join(err.split())
        if line.target:
            (self.folder / line.target).write_text(out, encoding="utf-8")
        return 1

    def start(self, words: list[str]) -> int:
        """Start what goes on beside the reader."""
        log = (self.folder / "other_terminal.log").open("ab")
        self.waiting.append(subprocess.Popen(words, cwd=self.folder, stdout=log, stderr=log))
        return 1

    def wait_for(self, results: str) -> int:
        """Wait until an evaluation in another terminal is at work."""
        begun = self.folder / results / "hunts.sqlite"
        for _ in range(600):
            if begun.exists() and "running" in "".join(self.bayeshunt("status", results)):
                return 1
            assert self.waiting[-1].poll() is None, (self.folder / "other_terminal.log").read_text()
            time.sleep(0.1)
        raise AssertionError(f"{results} was never at work")

    def benchmark(self, module: str, words: list[str]) -> int:
        """Run a benchmark, shortened."""
        for name in re.findall(r"\S+/", " ".join(words)):
            (self.folder / name).mkdir(parents=True, exist_ok=True)
        given = [word for word in words if not word.startswith("paper,")]
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        command = [sys.executable, "-m", module, *given, *SHORT[module]]
        ran = subprocess.run(command, cwd=self.folder, env=environment, capture_output=True, text=True, check=False)
        assert ran.returncode == 0, ran.stderr[-2000:]
        return 1

    def close(self) -> None:
        """End what goes on beside the reader."""
        for process in self.waiting[::-1]:
            process.terminate()
            process.wait(timeout=30)


def is_set_up(line: Line) -> bool:
    """Whether a line sets things up, is right about it, and .ci/run does the same."""
    program, words = line.program, line.words
    if program == "pip":
        asked = ",".join(re.findall(r"\.\[([\w,]+)\]", " ".join(words)))
        return "install" in words and all(extra in EXTRAS for extra in asked.split(",") if extra)
    if program == "jupyter":
        return "jupyterlab" in " ".join(EXTRAS["notebook"]) and (ROOT / words[-1]).is_file()
    if program == "bash":
        return (ROOT / words[1]).is_file()
    if program == "python3":
        return words[1:3] == ["-m", "venv"]
    return f".venv/bin/{program}" in CI
