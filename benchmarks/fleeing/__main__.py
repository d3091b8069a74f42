"""How much of our hunters' success survives a prey that learns to flee.

``python -m benchmarks.fleeing [PREY ...] [--hunter NAME ...] [--runs 10] [--seed 0 ...] [--table FILE.csv]
[--figure FILE.png] [--out FILE.json]``

Prey learn by PPO, each against one hunter, 300,000 of its gaits, with three seeds; what they learned is in
``benchmarks/fleeing/preys/``, and a network of numpy runs it, so that this command needs neither torch nor
stable-baselines3. A prey that is named and has no file learns first (the extras ``rl`` and ``bench``). Every hunter
then meets every prey on the same hunts. Rows that the table has with so many --runs, or more, are not made again: the
same command goes on where it was stopped, and further prey or --runs add to the table.

Columns: caught, 95 % Wilson interval, mean time (a miss counts 60 s).
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from bayeshunt.experiments.scores import wilson_interval
from benchmarks.fleeing.cells import HUNTERS, KNOWING, PREYS, Cell, Prey, cell, learn

#: The rows that are published.
TABLE = Path(__file__).parents[1] / "results" / "fleeing.csv"


def score(prey: Prey, hunter: str, given: argparse.Namespace) -> dict[str, Any] | None:
    """Return how a hunter fares against a prey; None for a pair that cannot be."""
    parts = [cell(prey, hunter, seed, given.runs, given.table) for seed in given.seed]
    rows = [row for row in parts if row is not None]
    return summed(rows) if rows else None


def summed(rows: list[Cell]) -> dict[str, Any]:
    """Return rows of one prey and one hunter as one."""
    hunts, caught = sum(row.hunts for row in rows), sum(row.caught for row in rows)
    mean = sum(row.time_s for row in rows) / hunts
    variance = max(0.0, sum(row.square_s2 for row in rows) / hunts - mean * mean)
    low, high = wilson_interval(caught, hunts)
    return {
        "prey": rows[0].prey, "hunter": rows[0].hunter, "runs": hunts, "caught": caught, "low": low, "high": high,
        "mean_time_s": mean, "standard_error_s": (variance / hunts) ** 0.5,
    }  # fmt: skip


def line(facts: dict[str, Any]) -> str:
    """Return one markdown row."""
    return (
        f"| {facts['prey']} | {facts['hunter']}{' *' if facts['hunter'] == KNOWING else ''} | "
        f"{facts['caught']}/{facts['runs']} | {facts['caught'] / facts['runs']:.1%} | {facts['low']:.1%} to "
        f"{facts['high']:.1%} | {facts['mean_time_s']:.1f} ± {facts['standard_error_s']:.1f} |"
    )


def draw(found: list[dict[str, Any]], path: Path) -> None:
    """Draw success, a group of prey beside each other, a mark a hunter."""
    import matplotlib.pyplot as plt

    names = list(dict.fromkeys(facts["prey"] for facts in found))
    hunters = [name for name in HUNTERS if any(facts["hunter"] == name for facts in found)]
    figure, axes = plt.subplots(figsize=(8, 1.0 + 0.55 * len(names)), layout="constrained", facecolor="white")
    colours = ["#777777", "#0b7a75", "#5aa9a3", "#c77d0a", "#b3261e", "#1a1a1a"]
    for place, (name, colour, marker) in enumerate(zip(hunters, colours, "osDv^*", strict=False)):
        mine = {facts["prey"]: facts for facts in found if facts["hunter"] == name}
        at = [i for i, prey in enumerate(names) if prey in mine]
        share = np.array([mine[names[i]]["caught"] / mine[names[i]]["runs"] for i in at])
        ends = np.array([[mine[names[i]][end] for i in at] for end in ("low", "high")])
        axes.errorbar(
            100 * share, np.array(at) + 0.12 * (place - 2.5), xerr=100 * np.abs(ends - share), fmt=marker,
            color=colour, ms=5, capsize=2, lw=1, label=name,
        )  # fmt: skip
    axes.set_yticks(range(len(names)), [_said(name) for name in names])
    for edge in np.arange(len(names) - 1) + 0.5:
        axes.axhline(edge, color="0.9", lw=0.8, zorder=0)
    axes.invert_yaxis()
    axes.set_xlim(-2, 102)
    axes.set_xlabel("caught [%], with 95 % intervals")
    figure.legend(loc="outside upper center", ncols=3, frameon=False)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=150)
    plt.close(figure)


def _said(name: str) -> str:
    """A prey's name as people read it."""
    prey = next(one for one in PREYS if one.name == name)
    kinds = {"paper": "the preset's own", "evader": "evader that ships", "senses": "senses the hunter"}
    kind = f"learned to flee {prey.hunter}, {prey.seed}" if prey.hunter else kinds[name.rpartition("_")[0]]
    return f"{kind}, {prey.arena}"


def main() -> None:
    """Train and hunt what is missing, print, draw."""
    known = {prey.name: prey for prey in PREYS}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("prey", nargs="*", help=f"by default those that need no training; all: {', '.join(known)}")
    parser.add_argument("--hunter", action="append", choices=HUNTERS, help="by default all")
    parser.add_argument("--runs", type=int, default=10, help="per bearing and seed (10)")
    parser.add_argument("--seed", type=int, nargs="+", default=[0, 1, 2], help="by default 0 1 2")
    parser.add_argument("--table", type=Path, default=TABLE, help="rows so far (benchmarks/results/fleeing.csv)")
    parser.add_argument("--figure", type=Path)
    parser.add_argument("--out", type=Path, help="write the figures as JSON into this file")
    given = parser.parse_args()
    if unknown := [name for name in given.prey if name not in known]:
        parser.error(f"unknown prey {unknown[0]!r}: expected some of {', '.join(known)}")
    print("| prey | hunter | caught | success | 95 % interval | mean time [s] |\n| --- | --- | --- | --- | --- | --- |")
    found = []
    for name in given.prey or [name for name, prey in known.items() if not prey.hunter or prey.file.exists()]:
        if known[name].hunter and not known[name].file.exists():
            learn(known[name])
        for hunter in given.hunter or HUNTERS:
            facts = score(known[name], hunter, given)
            if facts is not None:
                found.append(facts)
                print(line(facts), flush=True)
    if given.figure:
        draw(found, given.figure)
    if given.out:
        given.out.write_text(json.dumps({"seeds": given.seed, "rows": found}, indent=1) + "\n")


if __name__ == "__main__":
    main()
