"""All benchmarks: ``python -m benchmarks [--json] [--only physics ...]``. Each is a process of its own.

Every figure is a ratio or stands beside its peer, measured in one run. The machine should be quiet.
"""

from __future__ import annotations

import argparse
import json
import platform
import subprocess
import sys
from typing import Any

#: Name -> what it measures; ``python -m benchmarks.NAME`` runs one alone.
BENCHMARKS = {
    "inference": "answers of the inverse model and fitting, against pgmpy and pyAgrum",
    "planning": "search orders, and a decision of every planner",
    "physics": "a physics step of a hunt, against bare Box2D and LunarLander",
    "evaluation": "the paper's five rows, with one worker and two",
}


def run(name: str, as_json: bool) -> tuple[str, str | None]:
    """Return what a benchmark printed and, if it failed, its last line of complaint."""
    command = [sys.executable, "-m", f"benchmarks.{name}", *(["--json"] if as_json else [])]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode == 0:
        return done.stdout.strip(), None
    return done.stdout.strip(), (done.stderr.strip().splitlines() or [f"exit status {done.returncode}"])[-1]


def main() -> int:
    """Run all, print one report; 1 if any failed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", action="store_true", help="print the figures as JSON")
    parser.add_argument("--only", nargs="+", choices=list(BENCHMARKS), default=list(BENCHMARKS))
    options = parser.parse_args()
    facts: dict[str, Any] = {"machine": platform.machine(), "python": platform.python_version()}
    failed = False
    for name in options.only:
        printed, error = run(name, options.json)
        failed |= error is not None
        if options.json:
            facts[name] = {"error": error} if error else json.loads(printed)
        else:
            print(f"== {name}: {BENCHMARKS[name]}\n{printed}\n" if error is None else f"== {name}: failed: {error}\n")
    if options.json:
        print(json.dumps(facts))
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
