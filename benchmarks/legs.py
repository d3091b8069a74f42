"""What legs change: the tables of ``docs/legs.md``.

``python -m benchmarks.legs [SECTION ...] [--seeds 0 1 2]``, with sections

- ``main``: the preset's own rows, in the open (at least 700 hunts) and among walls;
- ``weighing``: planners that weigh costs against ``planning`` that may not change its gait in a plan;
- ``transitions``: changes allowed in a plan and the price of one, with both structures;
- ``counter``: the quadruped of other patterns, and what its loss is due to;
- ``thinking``: success over the depth of a plan where thinking takes time;
- ``belief``: ``belief`` against ``intercept``;
- ``shares``: learned coordinates at which the best gait is not certain;
- ``gains``: what the gait before tells, held out, by rows, back-off and bins; two gaits before;
- ``puppy``: Puppy's babbling and its hunts (extra ``mujoco``);
- ``physics``: processor time of legs, and what the physics step changes.

Each prints a markdown table, and puts it into ``benchmarks/results/legs.md``. Hunts are paired by the seeds they share
(exact sign test over those that only one of two caught; mean differences with Student's 95 % interval). Each hunt is
made once and kept in ``legs.csv`` beside it, so that the command goes on where it was stopped; ``--out`` keeps them
elsewhere. About 40 minutes of processor time in all.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from scipy.stats import binomtest

from bayeshunt.config.loading import load_robot
from bayeshunt.experiments.scores import mean_interval, wilson_interval
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel
from bayeshunt.views.figures.sweep import sweep_figure
from bayeshunt.worlds.babbling import babble
from benchmarks import legs_physics, legs_tables
from benchmarks.legs_hunts import Hunts, Row

BOTH = ("naive", "previous_gait")
RESULTS = Path(__file__).parent / "results"
#: Hunts of each bearing and seed: seven bearings and three seeds make 714, 210 and 105.
MANY, SOME, FEW = 34, 10, 5
PUPPY = {"robot": "puppy", "model.babbling_steps": 2000}


def caught(hunts: pd.DataFrame) -> str:
    """Caught of all, and its 95 % Wilson interval."""
    number, total = int(hunts["caught"].sum()), len(hunts)
    low, high = wilson_interval(number, total)
    return f"{number} of {total} = {100 * number / total:.1f} % ({100 * low:.1f} to {100 * high:.1f})"


def means(hunts: pd.DataFrame) -> list[str]:
    """Mean time, energy and changes of gait."""
    return [f"{hunts['time'].mean():.1f} s", f"{hunts['energy'].mean():.1f} J", f"{hunts['transitions'].mean():.1f}"]


def paired(hunts: pd.DataFrame, other: pd.DataFrame) -> list[str]:
    """Against another row on the same seeds: only this, only the other, p; seconds and joules more or less."""
    one, two = hunts.align(other, join="inner", axis=0)
    mine, theirs = (one["caught"] & ~two["caught"]).sum(), (~one["caught"] & two["caught"]).sum()
    p = binomtest(int(mine), int(mine + theirs)).pvalue if mine + theirs else 1.0
    return [
        f"{mine} / {theirs}, {p:.2g}",
        *(difference(one[c] - two[c], u) for c, u in (("time", "s"), ("energy", "J"))),
    ]


def difference(values: pd.Series, unit: str) -> str:
    """A mean difference with its 95 % interval."""
    low, high = mean_interval(values.to_numpy(dtype=float))
    return f"{values.mean():+.2f} ±{(high - low) / 2:.2f} {unit}"


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A markdown table."""
    lines = [" | ".join(row) for row in [heads, ["---"] * len(heads), *rows]]
    return "\n".join(f"| {line} |" for line in lines)


_BASE = Row("planning", "naive", {"planner.planning.max_transitions": 0})


def transitions(hunts: Hunts) -> Iterator[str]:
    """Yield changes allowed, priced."""
    rows = [
        Row("planning", structure, {"planner.planning.max_transitions": changes, **_priced(price)})
        for structure in BOTH for changes in (0, 1, 2) for price in (0.0, 1.0, 3.0)
    ]  # fmt: skip
    rows += [Row(planner, given={"cost.energy": 1.0}) for planner in ("planning", "intercept")]
    yield _against_base(hunts, rows, SOME)


def weighing(hunts: Hunts) -> Iterator[str]:
    """Yield planners that weigh costs."""
    yield _against_base(hunts, [_BASE, Row("frugal"), Row("intercept")], MANY)


def _against_base(hunts: Hunts, rows: Sequence[Row], runs: int) -> str:
    base = hunts.of(_BASE, runs)
    heads = ["row", "caught", "time", "energy", "changes", "only this / only naive, 0, p", "time", "energy"]
    return table(heads, ([r.label, caught(f := hunts.of(r, runs)), *means(f), *paired(f, base)] for r in rows))


def _priced(price: float) -> dict[str, float]:
    return {"cost.transitions": price} if price else {}


def main_rows(hunts: Hunts) -> Iterator[str]:
    """Yield the preset's rows with both structures, in both arenas."""
    lines = []
    for arena, planner in (
        ("open", "planning"),
        ("open", "intercept"),
        ("walled", "planning"),
        ("walled", "intercept"),
    ):
        runs = MANY if arena == "open" else SOME
        naive, known = (hunts.of(Row(planner, structure, arena=arena), runs) for structure in BOTH)
        cells = [", ".join([caught(row), *means(row)[:2]]) for row in (naive, known)]
        lines.append([f"{planner}, {arena}", *cells, *paired(known, naive)])
    yield table(["", "naive", "previous_gait", "only previous / only naive, p", "time", "energy"], lines)


_MIXED = "benchmarks/quadruped_mixed.toml"


def counter(hunts: Hunts) -> Iterator[str]:
    """Yield the quadruped that bounds straight on, trots in curves and walks on the spot."""
    changed: list[tuple[str, dict[str, Any]]] = [
        ("as it is", {}),
        ("64 samples", {"planner.planning.samples": 64}),
        ("at most 3 gaits ahead", {"planner.planning.depth": 3}),
        ("one gait ahead", {"planner.planning.depth": 1}),
        ("no change in a plan", {"planner.planning.max_transitions": 0}),
        ("two changes in a plan", {"planner.planning.max_transitions": 2}),
    ]
    lines = []
    for arena in ("open", "walled"):
        for name, given in changed if arena == "open" else (changed[0], changed[4]):
            naive, known = (hunts.of(Row("planning", s, {"robot": _MIXED, **given}, arena), FEW) for s in BOTH)
            lines.append([f"{name}, {arena}", *map(caught, (naive, known)), paired(known, naive)[0],
                          *(means(row)[2] for row in (naive, known))])  # fmt: skip
    heads = ["planning", "naive", "previous_gait", "only previous / only naive, p"]
    yield table([*heads, "changes, naive", "changes, previous_gait"], lines)


_DEPTHS, _SECONDS = (1, 2, 4, 6, 10), (0.0, 0.005, 0.02)


def _thought(hunts: Hunts, depth: int, seconds: float) -> pd.DataFrame:
    slow = {"protocol.thinking": "nodes", "protocol.seconds_per_node": seconds} if seconds else {}
    return hunts.of(Row("planning", given={"planner.planning.depth": depth, **slow}), SOME)


def thinking(hunts: Hunts) -> Iterator[str]:
    """Yield success over depth where a node takes no time, 5 ms and 20 ms."""
    lines = []
    for seconds in _SECONDS:
        rows = [_thought(hunts, depth, seconds) for depth in _DEPTHS]
        shares = [int(row["caught"].sum()) for row in rows]
        best = int(np.argmax(shares))
        cells = [f"**{100 * s / len(r):.0f}**" if i == best else f"{100 * s / len(r):.0f}"
                 for i, (s, r) in enumerate(zip(shares, rows, strict=True))]  # fmt: skip
        lines.append([f"{1000 * seconds:g} ms", *cells, caught(rows[best]), paired(rows[best], rows[-1])[0]])
    heads = ["a node", *(f"depth {d}" for d in _DEPTHS), "the best depth", "only it / only depth 10, p"]
    yield table(heads, lines)


def thinking_frame(hunts: Hunts) -> pd.DataFrame:
    """Return the same as a sweep has it, for its figure: a line per time that a node takes."""
    records = []
    for seconds in _SECONDS:
        for depth in _DEPTHS:
            row = _thought(hunts, depth, seconds)
            chance, time = wilson_interval(int(row["caught"].sum()), len(row)), mean_interval(row["time"].to_numpy())
            records.append({
                "planner.planning.depth": depth, "arena": "open", "planner": f"{1000 * seconds:g} ms a node",
                "success": row["caught"].mean(), "ci_low": chance[0], "ci_high": chance[1],
                "mean_time_s": row["time"].mean(), "mean_time_s_low": time[0], "mean_time_s_high": time[1],
            })  # fmt: skip
    return pd.DataFrame(records)


def belief(hunts: Hunts) -> Iterator[str]:
    """Yield ``belief`` against ``intercept``."""
    lines = []
    bodies: dict[str, dict[str, Any]] = {
        "hexapod_mixed": {}, "hexapod": {"robot": "hexapod"}, "quadruped": {"robot": "quadruped"}, "puppy": PUPPY,
    }  # fmt: skip
    for robot, given in bodies.items():
        one, two = (hunts.of(Row(planner, given=given), SOME) for planner in ("belief", "intercept"))
        lines.append([robot, caught(one), caught(two), *paired(one, two)])
    yield table(["robot", "belief", "intercept", "only belief / only intercept, p", "time", "energy"], lines)


def shares(hunts: Hunts) -> Iterator[str]:
    """Yield how many learned coordinates leave the gait in doubt."""
    lines = []
    for name in ("khepera", "hexapod", "hexapod_mixed", "quadruped", "puppy"):
        robot = load_robot(name)
        frame = babble(robot, 2000, seed=hunts.seeds[0])
        for prior, structure in ((0.0, "naive"), (0.03, "naive"), (0.03, "previous_gait")):
            backoff = 5.0 if structure == "previous_gait" else None
            model = ForwardModel.fit(frame, robot.gaits, prior, structure=structure, backoff=backoff)
            parts = [model] if backoff is None else [model.after(gait) for gait in model.gaits]
            best = np.concatenate([InverseModel(part).table()[list(model.gaits.names)].max(axis=1) for part in parts])
            doubt, clear = (best < 0.99).mean(), float(np.median(best))
            lines.append([name, structure, f"{prior:g}", str(len(best)), f"{100 * doubt:.1f} %", f"{clear:.4f}"])
    yield table(["robot", "structure", "prior", "coordinates", "best gait below 0.99", "median of the best"], lines)


def gains(hunts: Hunts) -> Iterator[str]:
    """Yield held-out gains."""
    yield from legs_tables.report(table)


def puppy(hunts: Hunts) -> Iterator[str]:
    """Yield Puppy's babbling, and its hunts."""
    lines = []
    for seed in hunts.seeds:
        started = time.process_time()
        falls = int(babble("puppy", 2000, seed)["falls"].sum())
        lines.append([str(seed), f"{time.process_time() - started:.1f} s", f"{falls} = {falls / 20:.2f} %"])
    yield table(["2,000 gaits, seed", "processor time", "falls"], lines)
    found = [(s, hunts.of(Row("intercept", s, PUPPY), MANY if s != "naive" else SOME)) for s in BOTH]
    yield table(
        ["intercept", "caught", "time", "energy", "changes", "falls a hunt"],
        ([s, caught(row), *means(row), f"{row['falls'].mean():.2f}"] for s, row in found),
    )


def physics(hunts: Hunts) -> Iterator[str]:
    """Yield processor times and what the step changes."""
    yield from legs_physics.report(hunts.seeds[0], table)


SECTIONS: dict[str, Callable[[Hunts], Iterator[str]]] = {
    "main": main_rows, "weighing": weighing, "transitions": transitions, "counter": counter, "thinking": thinking,
    "belief": belief, "puppy": puppy, "gains": gains, "shares": shares, "physics": physics,
}  # fmt: skip


def _kept(path: Path) -> dict[str, str]:
    """The sections that a page of results has."""
    parts = path.read_text().split("\n## ")[1:] if path.is_file() else []
    return {name: text.strip() for name, text in (part.split("\n", 1) for part in parts)}


def publish(path: Path, name: str, text: str) -> None:
    """Put a section into the page of results, in place of what it had there."""
    found = _kept(path) | {name: text}
    sections = [f"## {one}\n\n{found[one]}\n" for one in SECTIONS if one in found]
    head = "# Legs\n\nMade by `python -m benchmarks.legs`; [docs/legs.md](../../docs/legs.md) says what it means.\n"
    path.write_text("\n".join([head, *sections]))


def main() -> None:
    """Print the tables asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sections", nargs="*", choices=[*SECTIONS, []], metavar="SECTION")
    parser.add_argument("--seeds", type=int, nargs="+", default=[0, 1, 2], help="of the babbling and of the hunts")
    parser.add_argument("--out", type=Path, metavar="FOLDER", default=RESULTS, help="where hunts and tables are kept")
    parser.add_argument("--figure", type=Path, metavar="FILE", help="draw success over depth, of section thinking")
    options = parser.parse_args()
    hunts = Hunts(options.seeds, options.out / "legs.csv")
    for name in options.sections or SECTIONS:
        started, texts = time.process_time(), []
        for text in SECTIONS[name](hunts):
            texts.append(text)
            print(f"\n## {name}\n\n{text}", flush=True)
        publish(options.out / "legs.md", name, "\n\n".join(texts))
        print(f"\n{time.process_time() - started:.0f} s of processor time", flush=True)
    if options.figure is not None:
        with mpl.rc_context({"font.family": "DejaVu Sans"}):
            sweep_figure(thinking_frame(hunts)).savefig(options.figure, dpi=150)


if __name__ == "__main__":
    main()
