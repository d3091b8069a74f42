"""All benchmarks: ``python -m benchmarks [--out FILE.json] [--json] [--only physics ...]``.

Each is a process of its own, and prints its table as soon as it is through. Every figure is a ratio or
stands beside its peer, measured in one run. The machine should be quiet.
"""

from __future__ import annotations

import argparse
import importlib
import json
import os
import platform
import subprocess
import sys
from pathlib import Path
from typing import Any

#: Name -> what it measures; ``python -m benchmarks.NAME`` runs one alone, with options of its own.
BENCHMARKS = {
    "inference": "answers of the inverse model and fitting, against pgmpy and pyAgrum",
    "planning": "search orders, and a decision of every planner against the time-step",
    "physics": "a physics step of a hunt, against bare Box2D and LunarLander",
    "envs": "a gait through the environment, against the bare world and LunarLander; what imports cost",
    "compiled": "what numba would save, and what it would cost",
    "inspection": "how sure an answer is, against pgmpy's query; size, start and redraw of the pages",
    "evaluation": "the paper's five rows, with one worker and two",
}


def run(name: str) -> dict[str, Any]:
    """Return a benchmark's figures, or {"error": its last line of complaint}."""
    done = subprocess.run([sys.executable, "-m", f"benchmarks.{name}", "--json"], capture_output=True, text=True)
    if done.returncode == 0:
        return json.loads(done.stdout)
    return {"error": (done.stderr.strip().splitlines() or [f"exit status {done.returncode}"])[-1]}


def describe(name: str, facts: dict[str, Any]) -> str:
    """A benchmark's figures as text."""
    if "error" in facts:
        return f"== {name}: failed: {facts['error']}\n"
    return f"== {name}: {BENCHMARKS[name]}\n{importlib.import_module(f'benchmarks.{name}').report(facts)}\n"


def main() -> int:
    """Run all, print one report; 1 if any failed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", action="store_true", help="print the figures as JSON instead of tables")
    parser.add_argument("--out", type=Path, metavar="FILE", help="also write the figures as JSON into this file")
    parser.add_argument("--only", nargs="+", choices=list(BENCHMARKS), default=list(BENCHMARKS))
    options = parser.parse_args()
    facts: dict[str, Any] = {
        "machine": platform.machine(), "cores": os.cpu_count(), "python": platform.python_version(),
    }  # fmt: skip
    for name in options.only:
        facts[name] = run(name)
        if not options.json:
            print(describe(name, facts[name]), flush=True)
    text = json.dumps(facts, indent=1)
    if options.json:
        print(text)
    if options.out is not None:
        options.out.write_text(text + "\n")
    return int(any("error" in facts[name] for name in options.only))


if __name__ == "__main__":
    sys.exit(main())
