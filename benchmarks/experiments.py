"""What the results store, the workers and large tables cost.

Run:  python benchmarks/experiments.py store      an evaluation with and without a folder, in turns
      python benchmarks/experiments.py workers    two workers against one, in turns (needs a quiet machine)
      python benchmarks/experiments.py babble     seconds a row, up to --rows
      python benchmarks/experiments.py fit        seconds a row and memory, 1e5 rows up to --rows
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import bayeshunt as bh
from bayeshunt.data import babbling_table
from bayeshunt.experiments.studies.babbling import babble_to_file
from bayeshunt.files import parquet
from bayeshunt.models.counting.streaming import count_tables, open_tables


def learn() -> bh.ForwardModel:
    """The model that every evaluation here uses."""
    robot = bh.load_robot("khepera")
    return bh.ForwardModel.fit(bh.babble(robot, 2000, 0), robot.gaits)


def compare(one: Callable[[], float], two: Callable[[], float], rounds: int) -> tuple[float, float, float]:
    """Median seconds of each, and the median of the ratios two / one of neighbours in time."""
    pairs = []
    for number in range(rounds):
        first, second = (one, two) if number % 2 == 0 else (two, one)
        a, b = first(), second()
        pairs.append((a, b) if number % 2 == 0 else (b, a))
    ratios = [b / a for a, b in pairs]
    return statistics.median(a for a, _ in pairs), statistics.median(b for _, b in pairs), statistics.median(ratios)


def store(options: argparse.Namespace) -> None:
    """Processor time: other programs on the machine disturb it less than the clock."""
    model = learn()

    def run(out: Path | None) -> float:
        start = time.process_time()
        bh.evaluate("paper", runs=options.runs, seed=0, model=model, out=out)
        return time.process_time() - start

    def kept() -> float:
        with tempfile.TemporaryDirectory() as folder:
            return run(Path(folder))

    run(None)
    without, with_store, ratio = compare(lambda: run(None), kept, options.rounds)
    hunts = 42 * options.runs
    print(
        f"{hunts} hunts, {options.rounds} rounds: {without:.2f} s without, {with_store:.2f} s with: ratio {ratio:.4f}"
    )


def workers(options: argparse.Namespace) -> None:
    """The clock, from call to result; workers are warm after the first round."""
    model = learn()

    def run(jobs: int) -> float:
        with tempfile.TemporaryDirectory() as folder:
            start = time.perf_counter()
            bh.evaluate("paper", runs=options.runs, seed=0, model=model, jobs=jobs, out=folder)
            return time.perf_counter() - start

    run(2)
    one, two, ratio = compare(lambda: run(1), lambda: run(2), options.rounds)
    print(f"{42 * options.runs} hunts: {one:.2f} s with one worker, {two:.2f} s with two: {1 / ratio:.2f} times")


def babble(options: argparse.Namespace) -> None:
    """Babbling into a file, processor time of one process."""
    rows = 1000
    while rows <= options.rows:
        with tempfile.TemporaryDirectory() as folder:
            path, start = Path(folder) / "b.parquet", time.process_time()
            babble_to_file("khepera", rows, 0, path)
            seconds, size = time.process_time() - start, path.stat().st_size
        print(f"{rows:>12,} rows  {1e6 * seconds / rows:8.1f} us a row  {size / rows:6.1f} bytes a row", flush=True)
        rows *= 10


def fit(options: argparse.Namespace) -> None:
    """Counting a table of repeated rows: 100,000 babbled ones, as many times as it takes.

    Processor time of all threads.
    """
    robot = bh.load_robot("khepera")
    frame = bh.babble(robot, options.babbled, 0)
    group = babbling_table.to_arrow(frame.loc[frame.index.repeat(parquet.ROW_GROUP // len(frame))])
    mark, rows = parquet.digest(group), parquet.ROW_GROUP
    while rows <= options.rows:
        with tempfile.TemporaryDirectory() as folder:
            path, times = Path(folder) / "b.parquet", rows // group.num_rows
            record = frame.attrs[babbling_table.PROVENANCE_KEY]
            parquet.write_groups(group.schema, (group for _ in range(times)), [mark] * times, record, path)
            start = time.process_time()
            joint, _ = count_tables(open_tables([path]), robot.gaits)
            counted = time.process_time() - start
            bh.ForwardModel.from_counts(joint)
            fitted = time.process_time() - start - counted
        print(
            f"{joint.total:>12,} rows  counting {counted:7.2f} s = {1e6 * counted / rows:.2f} us a row, then fitting "
            f"{fitted:.2f} s; most memory so far {peak_megabytes():.0f} MB",
            flush=True,
        )
        rows *= 10


def peak_megabytes() -> float:
    """Largest resident memory of this process up to now [MB] (Linux)."""
    line = next(x for x in Path("/proc/self/status").read_text().splitlines() if x.startswith("VmHWM"))
    return int(line.split()[1]) / 1e3


def main() -> None:
    """Parse the options and run one part."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parts = {"store": store, "workers": workers, "babble": babble, "fit": fit}
    parser.add_argument("part", choices=parts)
    parser.add_argument("--runs", type=int, default=10, help="per bearing")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--rows", type=int, default=1_000_000)
    parser.add_argument("--babbled", type=int, default=10_000, help="distinct rows of the table to fit")
    options = parser.parse_args()
    parts[options.part](options)


if __name__ == "__main__":
    main()
