"""What legs change: the tables of ``docs/legs.md``.

``python -m benchmarks.legs SECTION ... [--runs 30] [--keep FOLDER]``, with sections

- ``main``: the preset's own rows, in the open and (at most 15 runs) among walls;
- ``weighing``: planners that weigh costs against ``planning`` that may not change its gait in a plan;
- ``transitions``: changes allowed in a plan and the price of one, with both structures;
- ``counter``: the quadruped of other patterns, and what its loss is due to;
- ``thinking``: success over the depth of a plan where thinking takes time;
- ``belief``: ``belief`` against ``intercept``;
- ``shares``: learned coordinates at which the best gait is not certain;
- ``gains``: what the gait before tells, held out, by rows, back-off and bins; two gaits before;
- ``physics``: processor time of legs, and what the physics step changes.

Each prints a markdown table. Hunts are paired by the seeds they share (exact sign test over those that only one of two
caught; mean differences with Student's 95 % interval); ``--keep`` keeps them, to make a table again at once.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from scipy.stats import binomtest

from bayeshunt.config.loading import load_experiment, load_robot
from bayeshunt.experiments.protocol import learn_model
from bayeshunt.experiments.run.runner import evaluate
from bayeshunt.experiments.scores import mean_interval, wilson_interval
from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.models.body.inverse import InverseModel
from bayeshunt.views.figures.sweep import sweep_figure
from bayeshunt.worlds.babbling import babble
from benchmarks import legs_physics, legs_tables

BOTH = ("naive", "previous_gait")


@dataclass(frozen=True)
class Row:
    """A planner of preset ``legs``. given: settings of the experiment that are changed."""

    planner: str
    structure: str = "previous_gait"
    given: dict[str, Any] = field(default_factory=dict)
    arena: str = "open"

    @property
    def label(self) -> str:
        """The planner and what was changed."""
        changed = [f"{key.removeprefix('planner.planning.')} {value}" for key, value in self.given.items()]
        where = [] if self.arena == "open" else [self.arena]
        return ", ".join([self.planner, self.structure, *changed, *where])


@cache
def _model(settings: str, seed: int) -> ForwardModel:
    return learn_model(load_experiment("legs", json.loads(settings)), seed)


class Hunts:
    """Hunts of rows, each made once. keep: a folder where they stay; None: nowhere."""

    def __init__(self, runs: int, seed: int, keep: Path | None) -> None:
        self.runs, self.seed, self.keep = runs, seed, keep
        self._made: dict[str, pd.DataFrame] = {}

    def of(self, row: Row, runs: int | None = None) -> pd.DataFrame:
        """Return a row's hunts, indexed by bearing and run."""
        over = {"model.structure": row.structure, "protocol.runs": runs or self.runs, **row.given}
        name = json.dumps([row.planner, row.arena, self.seed, over], sort_keys=True)
        place = None if self.keep is None else self.keep / f"{hashlib.sha256(name.encode()).hexdigest()[:16]}.parquet"
        if name not in self._made and place is not None and place.is_file():
            self._made[name] = pd.read_parquet(place)
        if name not in self._made:
            learned = {k: v for k, v in over.items() if k.startswith(("model.", "robot"))}
            frame = evaluate(
                load_experiment("legs", over), seed=self.seed, jobs=1, planners=[row.planner], arenas=[row.arena],
                model=_model(json.dumps(learned, sort_keys=True), self.seed),
            )  # fmt: skip
            self._made[name] = frame.set_index(["theta", "run"])
            if place is not None:
                place.parent.mkdir(parents=True, exist_ok=True)
                self._made[name].to_parquet(place)
        return self._made[name]


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
    yield _against_base(hunts, rows)


def weighing(hunts: Hunts) -> Iterator[str]:
    """Yield planners that weigh costs."""
    yield _against_base(hunts, [_BASE, Row("frugal"), Row("intercept")])


def _against_base(hunts: Hunts, rows: Sequence[Row]) -> str:
    base = hunts.of(_BASE)
    heads = ["row", "caught", "time", "energy", "changes", "only this / only naive, 0, p", "time", "energy"]
    return table(heads, ([r.label, caught(f := hunts.of(r)), *means(f), *paired(f, base)] for r in rows))


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
        runs = hunts.runs if arena == "open" else min(hunts.runs, 15)
        naive, known = (hunts.of(Row(planner, structure, arena=arena), runs) for structure in BOTH)
        lines.append([f"{planner}, {arena}", caught(naive), caught(known), *paired(known, naive)])
    yield table(["", "naive", "previous_gait", "only previous / only naive, p", "time", "energy"], lines)


def counter(hunts: Hunts) -> Iterator[str]:
    """Yield the quadruped that bounds straight on, trots in curves and walks on the spot."""
    robot = str(Path(__file__).parent / "quadruped_mixed.toml")
    changed: list[tuple[str, dict[str, Any]]] = [
        ("as it is", {}),
        ("no change in a plan", {"planner.planning.max_transitions": 0}),
        ("two changes in a plan", {"planner.planning.max_transitions": 2}),
        ("at most 3 gaits ahead", {"planner.planning.depth": 3}),
        ("64 samples", {"planner.planning.samples": 64}),
    ]
    lines = []
    for arena in ("open", "walled"):
        for name, given in changed if arena == "open" else changed[:2]:
            rows = [hunts.of(Row("planning", s, {"robot": robot, **given}, arena)) for s in BOTH]
            lines.append([f"{name}, {arena}", *map(caught, rows), paired(rows[1], rows[0])[0]])
    yield table(["planning", "naive", "previous_gait", "only previous / only naive, p"], lines)


_DEPTHS, _SECONDS = (1, 2, 4, 6, 10), (0.0, 0.005, 0.02)


def _thought(hunts: Hunts, depth: int, seconds: float) -> pd.DataFrame:
    slow = {"protocol.thinking": "nodes", "protocol.seconds_per_node": seconds} if seconds else {}
    return hunts.of(Row("planning", given={"planner.planning.depth": depth, **slow}))


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
    for robot in ("hexapod_mixed", "hexapod", "quadruped"):
        given = {} if robot == "hexapod_mixed" else {"robot": robot}
        one, two = (hunts.of(Row(planner, given=given)) for planner in ("belief", "intercept"))
        lines.append([robot, caught(one), caught(two), *paired(one, two)])
    yield table(["robot", "belief", "intercept", "only belief / only intercept, p", "time", "energy"], lines)


def shares(hunts: Hunts) -> Iterator[str]:
    """Yield how many learned coordinates leave the gait in doubt."""
    lines = []
    for name in ("khepera", "hexapod", "hexapod_mixed", "quadruped", "puppy"):
        robot = load_robot(name)
        frame = babble(robot, 2000, seed=hunts.seed)
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
    yield from legs_tables.report(hunts.seed, table)


def physics(hunts: Hunts) -> Iterator[str]:
    """Yield processor times and what the step changes."""
    yield from legs_physics.report(hunts.seed, table)


SECTIONS: dict[str, Callable[[Hunts], Iterator[str]]] = {
    "main": main_rows, "weighing": weighing, "transitions": transitions, "counter": counter, "thinking": thinking,
    "belief": belief, "shares": shares, "gains": gains, "physics": physics,
}  # fmt: skip


def main() -> None:
    """Print the tables asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sections", nargs="*", choices=[*SECTIONS, []], metavar="SECTION")
    parser.add_argument("--runs", type=int, default=30, help="hunts of each of the seven bearings")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="keep the hunts there")
    parser.add_argument("--figure", type=Path, metavar="FILE", help="draw success over depth, of section thinking")
    options = parser.parse_args()
    hunts = Hunts(options.runs, options.seed, options.keep)
    for name in options.sections or SECTIONS:
        started = time.process_time()
        for text in SECTIONS[name](hunts):
            print(f"\n## {name}\n\n{text}", flush=True)
        print(f"\n{time.process_time() - started:.0f} s of processor time", flush=True)
    if options.figure is not None:
        with mpl.rc_context({"font.family": "DejaVu Sans"}):
            sweep_figure(thinking_frame(hunts)).savefig(options.figure, dpi=150)


if __name__ == "__main__":
    main()
