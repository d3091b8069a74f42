"""The command line as a user runs it, and the evaluation that the promises are tried on."""

import os
import subprocess
import sys
from pathlib import Path

#: The evaluation that is killed, hashed and repeated: 700 hunts.
SEVEN_HUNDRED = ("--planner", "prediction", "--planner", "planning", "--arena", "open", "--runs", "50", "--seed", "1")


def command(*arguments):
    """The command line of ``bayeshunt ARGUMENTS``."""
    return [sys.executable, "-m", "bayeshunt", *map(str, arguments)]


def run(*arguments, hash_seed="0"):
    """Run a command to its end; it must succeed."""
    environment = {**os.environ, "PYTHONHASHSEED": hash_seed}
    done = subprocess.run(command(*arguments), env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done


def children(pid):
    """Process ids of the processes that any thread of ``pid`` has started (Linux)."""
    lists = [task.joinpath("children").read_text().split() for task in Path(f"/proc/{pid}/task").iterdir()]
    return [int(child) for some in lists for child in some]
