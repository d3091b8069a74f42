"""Learning by trial against babbling, on one axis: gaits executed.

``python -m benchmarks.race [--work FOLDER] [--only TEXT] [--list] [--report]``   (extras ``rl`` and ``bench``)

Hunters that babble 20 to 2,000 gaits, and DQN and PPO that learn from 1,000 to a million gaits of hunting, all on the
same hunts of preset "paper" in both arenas; then in changed settings, on legs and with a camera. A job that is done is
kept in the work folder: the same command goes on where it was stopped. Writes ``benchmarks/results/race.csv``,
``race.md`` beside it and the figure of the manual. About 20 minutes of processor time.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from benchmarks.race.jobs import JOBS, Job, Row, run

ROOT = Path(__file__).parents[2]


def main() -> None:
    """Run what is missing, and report what there is."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--work", type=Path, default=ROOT / "build" / "race", help="what is done is kept here")
    parser.add_argument("--only", default="", help="only jobs whose name holds this text, and no report")
    parser.add_argument("--list", action="store_true", help="say which jobs there are, and which are done")
    parser.add_argument("--report", action="store_true", help="run nothing; report what is done")
    options = parser.parse_args()
    jobs = [job for job in JOBS if options.only in job.name]
    done = {job for job in jobs if (options.work / f"{job.name}.json").exists()}
    if options.list:
        for job in jobs:
            print("done   " if job in done else "missing", job.name)
        return
    found = [run(job, options.work) for job in jobs if job in done] if options.report else race(jobs, options.work)
    if not options.only:
        from benchmarks.race.report import write

        write(found, ROOT)


def race(jobs: list[Job], work: Path) -> list[tuple[Row, list[float]]]:
    """Run all, with a bar; a line for each as soon as it is through."""
    found = []
    columns = TextColumn("{task.description}"), BarColumn(), TextColumn("{task.completed:,.0f}/{task.total:,.0f}")
    with Progress(*columns, TimeElapsedColumn()) as bar:
        whole, one = bar.add_task("jobs", total=len(jobs)), bar.add_task("", total=1)
        for job in jobs:
            bar.update(one, description=job.name, total=job.gaits, completed=0)
            fresh = not (work / f"{job.name}.json").exists()
            found.append(run(job, work, lambda steps: bar.update(one, completed=steps)))
            row = found[-1][0]
            if fresh:
                bar.print(f"{job.name:58} {row.caught:3}/{row.hunts} {row.mean_s:6.2f} s   learning {row.cpu_s:.1f} s")
            bar.advance(whole)
    return found


if __name__ == "__main__":
    main()
