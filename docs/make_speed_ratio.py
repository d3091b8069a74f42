"""Draw docs/images/speed_ratio.png: success and catch time against the prey's speed.

python docs/make_speed_ratio.py [--runs 20] [--seed 0] [--jobs 1] [--table sweep.csv]

The sweep takes some minutes; ``--table`` draws what ``bayeshunt sweep --axis speed_ratio --out`` wrote instead.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import matplotlib as mpl
import pandas as pd

import bayeshunt as bh
from bayeshunt.views.figures.sweep import sweep_figure

OUT = Path(__file__).parent / "images" / "speed_ratio.png"
PLANNERS = ("prediction", "planning", "intercept_walls", "omniscient", "kinematic_limit")


def main() -> None:
    """Sweep or read, and draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--table", type=Path)
    options = parser.parse_args()
    if options.table is not None:
        frame = pd.read_csv(options.table)
    else:
        frame = bh.sweep(
            "paper", runs=options.runs, seed=options.seed, jobs=options.jobs, planners=PLANNERS, arenas=["open"]
        )
    with mpl.rc_context({"font.family": "DejaVu Sans"}):
        sweep_figure(frame).savefig(OUT, dpi=150)
    print(f"{OUT}: {OUT.stat().st_size} bytes")


if __name__ == "__main__":
    main()
