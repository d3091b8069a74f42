"""What opening every number costs: ``python -m benchmarks.inspection [--json] [--only intervals graded ...]``.

- intervals: how sure an answer is, against one query of pgmpy on the same evidence, in turns, for every structure;
- graded: how many learned coordinates of preset "slippery" answer with less than 0.999, by babbling seed;
- network: from a click on a state until its page is laid out again and until that is painted, every structure and alarm
  (37 nodes), and what it costs all processes of the browser together (Linux);
- replay: two hunts that ran their 60 s in step on one page: its size, and how long until it can be played;
- report: the page of 3,500 hunts with five planners;
- differences: the share of cells that ``compare`` marks between two babblings of one robot;
- active (only where asked for; some minutes): held-out loss of tables that were babbled actively and at random.

The pages are opened in a headless Chromium (extra ``test``); what needs one is left out where there is none.
"""

from __future__ import annotations

import os
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import bayeshunt as bh
from bayeshunt.experiments.scores import mean_interval
from bayeshunt.experiments.studies.active import compare_babbling
from benchmarks.command import command, quiet_pgmpy, show

STRUCTURES = ("naive", "tan", "joint", "previous_gait", "learned")
ROWS, ANSWERS, CLICKS, OPENINGS, BABBLINGS, PAIRS = 2000, 60, 25, 5, 20, 10
#: What is reported as graded: the most probable gait has less.
GRADED = 0.999


def fitted(structure: str, seed: int = 0) -> bh.ForwardModel:
    """The shipped Khepera's model in a structure; of the gait before with the rows' own order."""
    robot = bh.load_robot("khepera")
    frame = bh.babble(robot, ROWS, seed)
    return bh.ForwardModel.fit(frame, robot.gaits, 0.0 if structure == "naive" else 0.1, structure=structure)


def seconds(work: Callable[[], Any]) -> float:
    """Processor seconds of one call, which other programs do not disturb."""
    start = time.process_time()
    work()
    return time.process_time() - start


def intervals() -> list[dict[str, Any]]:
    """One row per structure: milliseconds of an interval and of pgmpy's query, medians, and their ratio.

    An interval keeps the quantiles of the cells that it has met, so the first of a cell costs more: the greatest stands
    beside the median.
    """
    from pgmpy.inference import VariableElimination

    rows, rng = [], np.random.default_rng(0)
    for structure in STRUCTURES:
        model = fitted(structure)
        inverse, engine = bh.InverseModel(model), VariableElimination(model.network)
        table = inverse.table()
        chosen = table.iloc[rng.choice(len(table), min(ANSWERS, len(table)), replace=False)]
        answers = [inverse.posterior(d, a) for d, a in zip(chosen["distance"], chosen["angle"], strict=True)]
        pairs = []
        for answer in answers:
            query = partial(engine.query, ["Gait"], evidence=answer.evidence, show_progress=False)
            pairs.append((seconds(answer.interval), seconds(query)))
        ours, theirs = np.array(pairs[2:]).T  # the first two make what is kept
        rows.append(
            {
                "structure": structure, "answers": len(ours), "interval_ms": 1e3 * float(np.median(ours)),
                "pgmpy_ms": 1e3 * float(np.median(theirs)), "queries": float(np.median(ours / theirs)),
                "queries_at_most": float(np.max(ours) / np.median(theirs)),
            }
        )  # fmt: skip
    return rows


def graded() -> dict[str, Any]:
    """Shares of learned coordinates whose best gait has less than :data:`GRADED`, by babbling seed, and of all."""
    robot, shares, few, all_ = bh.load_experiment("slippery").robot, [], 0, 0
    for seed in range(BABBLINGS):
        model = bh.ForwardModel.fit(bh.babble(robot, ROWS, seed), robot.gaits)
        best = bh.InverseModel(model).table()[list(model.gaits.names)].to_numpy().max(axis=1)
        shares.append(float(np.mean(best < GRADED)))
        few, all_ = few + int((best < GRADED).sum()), all_ + len(best)
    return {"rows": ROWS, "below": GRADED, "coordinates": all_, "share": few / all_, "by_seed": shares}


def network(browser: Any) -> list[dict[str, Any]]:
    """One row per network: milliseconds from a click until all of it is worked out and laid out again, and painted.

    A frame is painted up to 1/60 s after it is asked for. ``processor_ms``: what a click costs all processes of the
    browser, which other programs on the machine do not add to; NaN where there is no /proc.
    """
    rows = []
    for name, made in {**{s: (lambda s=s: fitted(s)) for s in STRUCTURES}, "alarm": alarm}.items():
        page = opened(browser, lambda path, made=made: bh.Network(made()).save(path))
        page.wait_for_timeout(300)
        before = processor_ms()
        taken = np.array([page.evaluate(CLICK, 7 * at) for at in range(CLICKS)])
        spent = (processor_ms() - before) / CLICKS
        laid, painted = taken.T
        rows.append(
            {
                "network": name, "clicks": CLICKS, "median_ms": float(np.median(laid)), "most_ms": float(laid.max()),
                "painted_median_ms": float(np.median(painted)), "painted_p95_ms": float(np.quantile(painted, 0.95)),
                "processor_ms": spent,
            }
        )  # fmt: skip
    return rows


#: Milliseconds from a click on a state until everything that it changes has been worked out and laid out again, and
#: until the frame that shows it has been painted.
CLICK = """(at) => new Promise((done) => {
  const states = document.querySelectorAll(".bh-network .state"), before = performance.now();
  states[at % states.length].click();
  document.body.getBoundingClientRect();
  const laid = performance.now() - before, painted = new MessageChannel();
  painted.port1.onmessage = () => done([laid, performance.now() - before]);
  requestAnimationFrame(() => painted.port2.postMessage(null));
})"""


def processor_ms() -> float:
    """Processor time of everything that this process started, in milliseconds; NaN where there is no /proc."""
    spent: dict[int, int] = {}
    children: dict[int, list[int]] = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue  # it has ended
        children.setdefault(int(fields[1]), []).append(int(stat.parent.name))
        spent[int(stat.parent.name)] = int(fields[11]) + int(fields[12])
    found, left = 0, [os.getpid()]
    while left:
        own = children.get(left.pop(), [])
        found += sum(spent[one] for one in own)
        left += own
    return 1e3 * found / os.sysconf("SC_CLK_TCK") if spent else float("nan")


def alarm() -> Any:
    """pgmpy's copy of the network ALARM (Beinlich et al., 1989)."""
    from pgmpy.utils import get_example_model

    return get_example_model("alarm")


def replay(browser: Any) -> dict[str, Any]:
    """Bytes of the page of two hunts that were not caught, and milliseconds until it can be played."""
    model = fitted("naive")
    hunts = [bh.hunt("paper", bh.make_planner(n, model), arena="open", theta=t, seed=0) for n, t in LONG_HUNTS]
    if any(hunt.caught for hunt in hunts):
        raise RuntimeError("a hunt that was to last 60 s ended in a catch: choose others")
    size, ready = [], []
    for _ in range(OPENINGS):
        page = opened(browser, lambda path: bh.write_replay(hunts, path, model=model), size)
        page.wait_for_selector("[data-part=play]")
        ready.append(page.evaluate("performance.getEntriesByType('navigation')[0].domContentLoadedEventEnd"))
    return {"hunts": len(hunts), "bytes": size[0], "openings": OPENINGS, "interactive_ms": sorted(ready)}


LONG_HUNTS = (("reactive", 1.0), ("reactive", 4.0))


def big_report() -> dict[str, Any]:
    """Bytes of the report of 3,500 hunts: five planners, two arenas, seven bearings, fifty runs."""
    planners = ["reactive", "prediction", "planning", "constant_velocity", "intercept"]
    settings = bh.load_experiment("oses2010")
    hunts = bh.evaluate(settings, planners=planners, runs=50, seed=0)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "report.html"
        bh.write_report(hunts, path)
        return {"hunts": len(hunts), "planners": len(planners), "bytes": path.stat().st_size}


def differences() -> list[dict[str, Any]]:
    """One row per robot: cells that ``compare`` marks between two babblings of it, of all cells of such pairs."""
    rows = []
    for name in ("khepera", "hexapod"):
        robot, marked, held, shares = bh.load_robot(name), 0, 0, []
        for pair in range(PAIRS):
            models = [bh.ForwardModel.fit(bh.babble(robot, ROWS, 2 * pair + i), robot.gaits) for i in (0, 1)]
            found = bh.compare(*models)
            shares.append(found.share)
            marked += len(found.cells)
            # of one robot both have the bins up to the nearer of their farthest rows
            held += sum(_held(*(model.counts(variable) for model in models)) for variable in found.marked)
        rows.append(
            {
                "robot": name, "pairs": PAIRS, "share": float(np.mean(shares)), "most_in_a_pair": max(shares),
                "share_of_cells_with_rows": marked / held,
            }
        )  # fmt: skip
    return rows


def _held(one: pd.DataFrame, two: pd.DataFrame) -> int:
    """How many cells hold rows in one of two tables."""
    return int((one.add(two, fill_value=0) > 0).to_numpy().sum())


@contextmanager
def chromium() -> Iterator[Any]:
    """A headless Chromium, or None."""
    found = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    try:
        from playwright.sync_api import sync_playwright
    except ModuleNotFoundError:
        found = None
    if found is None:
        yield None
        return
    with sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=found, args=["--no-sandbox"])
        yield running
        running.close()


def opened(browser: Any, save: Callable[[Path], Any], size: list[int] | None = None) -> Any:
    """Save a page and open it in a context of its own."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "page.html"
        save(path)
        if size is not None:
            size.append(path.stat().st_size)
        page = browser.new_context(viewport={"width": 1400, "height": 900}).new_page()
        page.goto(path.as_uri())
    return page


def active() -> list[dict[str, Any]]:
    """One row per robot and number of rows: mean losses [nat per row] and random less active, with the interval."""
    rows = []
    for name, seeds in BABBLED.items():
        for n, losses in compare_babbling(name, seeds=range(seeds)).groupby("n"):
            gain = losses["random"] - losses["active"]
            low, high = mean_interval(gain)
            rows.append(
                {
                    "robot": name, "rows": int(n), "seeds": seeds, "random": float(losses["random"].mean()),
                    "active": float(losses["active"].mean()), "gain": float(gain.mean()), "low": low, "high": high,
                }
            )  # fmt: skip
    return rows


#: Robots babbled actively, and with how many seeds.
BABBLED = {"khepera": 20, "hexapod": 10}

ALONE = {"active": active, "intervals": intervals, "graded": graded, "differences": differences, "report": big_report}
IN_A_BROWSER = {"network": network, "replay": replay}


def measure(only: list[str]) -> dict[str, Any]:
    """The figures of the parts asked for."""
    facts: dict[str, Any] = {name: part() for name, part in ALONE.items() if name in only}
    if not set(only) & set(IN_A_BROWSER):
        return facts
    with chromium() as browser:
        if browser is not None:
            facts |= {name: part(browser) for name, part in IN_A_BROWSER.items() if name in only}
    return facts


def report(facts: dict[str, Any]) -> str:
    """The figures as text."""
    return "\n".join(_lines(facts))


def _lines(facts: dict[str, Any]) -> Iterator[str]:
    for row in facts.get("active", ()):
        yield (
            f"| {row['robot']} | {row['rows']} | {row['seeds']} | {row['random']:.3f} | {row['active']:.3f} | "
            f"{row['gain']:+.3f} ({row['low']:+.3f} to {row['high']:+.3f}) |"
        )
    for row in facts.get("intervals", ()):
        yield (
            f"interval, {row['structure']:<14}{row['interval_ms']:7.2f} ms, pgmpy's query {row['pgmpy_ms']:.2f} ms: "
            f"{row['queries']:.1f} queries, at most {row['queries_at_most']:.1f} ({row['answers']} answers)"
        )
    if found := facts.get("graded"):
        seeds = " ".join(f"{100 * share:.1f}" for share in found["by_seed"])
        yield (
            f"graded answers, slippery, {found['rows']} rows: {100 * found['share']:.1f} % of {found['coordinates']} "
            f"learned coordinates below {found['below']}; by seed {seeds} %"
        )
    for row in facts.get("differences", ()):
        yield (
            f"two babblings of {row['robot']}: {100 * row['share']:.2f} % of cells marked, at most "
            f"{100 * row['most_in_a_pair']:.2f} % in one of {row['pairs']} pairs "
            f"({100 * row['share_of_cells_with_rows']:.1f} % of the cells that hold rows)"
        )
    for row in facts.get("network", ()):
        yield (
            f"network, {row['network']:<14}laid out again after {row['median_ms']:.1f} ms, at most "
            f"{row['most_ms']:.1f}; painted after {row['painted_median_ms']:.1f} ms, 95 % within "
            f"{row['painted_p95_ms']:.1f}; {row['processor_ms']:.0f} ms of processor time ({row['clicks']} clicks)"
        )
    if found := facts.get("replay"):
        ready = " ".join(f"{ms:.0f}" for ms in found["interactive_ms"])
        yield f"replay of {found['hunts']} hunts of 60 s: {found['bytes'] / 1000:.0f} kB, interactive after {ready} ms"
    if found := facts.get("report"):
        yield f"report of {found['hunts']} hunts, {found['planners']} planners: {found['bytes'] / 1e6:.2f} MB"


def main() -> None:
    """Run and print."""
    names = [*ALONE, *IN_A_BROWSER]
    parser = command(__doc__)
    parser.add_argument("--only", nargs="+", choices=names, default=[name for name in names if name != "active"])
    options = parser.parse_args()
    quiet_pgmpy()
    facts = measure(options.only)
    show(facts, report, options)


if __name__ == "__main__":
    main()
