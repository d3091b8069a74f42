"""20,000 hunts in one go: is memory flat, and what does the store cost?

Run:  python benchmarks/long_run.py [--hunts 20000] [--jobs 2] [--out FOLDER]

Prints the resident memory of every process at each 1,000 hunts (Linux), then the store's cost per
hunt: the processor time of committing all these hunts again to a fresh store, over that of hunting.
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from pathlib import Path

import bayeshunt as bh
from bayeshunt.config.loading import load_experiment
from bayeshunt.episodes.loop import run_hunt
from bayeshunt.experiments.protocol import plan_hunts
from bayeshunt.experiments.store.database import HuntDatabase, Numbered

PLANNERS, ARENAS = ("prediction", "planning"), ("walled", "open")


def megabytes(pid: int) -> float:
    """Resident memory of a process [MB]."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def workers() -> list[int]:
    """Process ids of the joblib workers of this process."""
    lists = [task.joinpath("children").read_text().split() for task in Path("/proc/self/task").iterdir()]
    children = {int(child) for some in lists for child in some}
    return sorted(c for c in children if b"LokyProcess" in Path(f"/proc/{c}/cmdline").read_bytes())


class Watch:
    """Prints a line every ``every`` hunts."""

    def __init__(self, every: int) -> None:
        self.every, self.ended, self.start, self.rows = every, 0, time.perf_counter(), []

    def __call__(self, count: int) -> None:
        before, self.ended = self.ended, self.ended + count
        if before // self.every == self.ended // self.every:
            return
        sizes = [megabytes(os.getpid()), *map(megabytes, workers())]
        self.rows.append(sizes)
        rate = self.ended / (time.perf_counter() - self.start)
        print(f"{self.ended:>8,} hunts  {rate:6.1f}/s   MB: " + "  ".join(f"{s:6.1f}" for s in sizes), flush=True)


def commit_seconds(folder: Path, fresh: Path, hunts: list[Numbered]) -> float:
    """Seconds that committing every hunt of ``folder`` one by one takes in a fresh store."""
    with HuntDatabase.open(folder) as database:
        results, identity, model = database.results()[0], database.identity, database.model
    with HuntDatabase.create(fresh, identity, model) as database, database.sink.opened() as writer:
        start = time.process_time()
        for hunt in hunts:
            writer.add(hunt, results[hunt.number])
        return time.process_time() - start


def hunt_seconds(settings: bh.ExperimentSettings, model: bh.ForwardModel, hunts: list[Numbered]) -> float:
    """Processor time [s] of a hunt without any store, over a sample."""
    planners = {name: bh.make_planner(name, model, **settings.planner.get(name, {})) for name in PLANNERS}
    start = time.process_time()
    for _, task in hunts:
        run_hunt(settings, planners[task.planner], task.arena, task.theta, task.seed)
    return (time.process_time() - start) / len(hunts)


def main() -> None:
    """Parse the options, run, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--hunts", type=int, default=20_000)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", type=Path, default=None)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.out or Path(scratch) / "long"
        runs = -(-options.hunts // (7 * len(PLANNERS) * len(ARENAS)))
        settings = load_experiment("paper", {"protocol.runs": runs})
        robot = bh.load_robot("khepera")
        model = bh.ForwardModel.fit(bh.babble(robot, 2000, 0), robot.gaits)
        watch, start = Watch(1000), time.perf_counter()
        what = {"planners": PLANNERS, "arenas": ARENAS, "model": model, "out": folder}
        frame = bh.evaluate(settings, seed=0, jobs=options.jobs, progress=watch, **what)
        seconds = time.perf_counter() - start
        hunts = [Numbered(n, task) for n, task in enumerate(plan_hunts(settings, PLANNERS, ARENAS, 0))]
        (Path(scratch) / "fresh").mkdir()
        commit = commit_seconds(folder, Path(scratch) / "fresh", hunts) / len(hunts)
        size = (folder / "hunts.sqlite").stat().st_size
        hunt = hunt_seconds(settings, model, hunts[:: max(1, len(hunts) // 200)])
    third, last = watch.rows[len(watch.rows) // 3], watch.rows[-1]
    print(f"{len(frame):,} hunts in {seconds:.0f} s with {options.jobs} workers; {size / len(frame):.0f} bytes a hunt")
    growth = ", ".join(f"{b - a:+.1f}" for a, b in zip(third, last, strict=False))
    print(f"memory from a third of the way to the end, each process [MB]: {growth}")
    print(f"store: {1e6 * commit:.0f} us of {1e3 * hunt:.2f} ms a hunt = {commit / hunt:.2%}")


if __name__ == "__main__":
    main()
