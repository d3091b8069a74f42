"""What was reported, in words: beside what came out here, with the tests of the difference."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

__all__ = ["TESTS", "p_text", "p_values", "sentences"]

#: How the p-values of a table come about.
TESTS = (
    "p: two-sided; Fisher's exact test of the counts, z test of the mean times (the paper's spread taken to be ours)."
)


def p_text(p: float | None) -> str:
    """Return a p-value for a table; "" where nothing was tested."""
    if p is None:
        return ""
    return "<0.001" if p < 0.001 else f"{p:.2g}" if p < 0.0995 else f"{p:.2f}"


def p_values(rows: Iterable[Mapping[str, Any]]) -> dict[tuple[str, str, float | None], str]:
    """Return the p-value of each tested success, in words, by planner, arena and bearing (None: all bearings).

    rows: of :func:`bayeshunt.experiments.reported.compare`.
    """
    tested = (row for row in rows if row["p_success"] is not None)
    return {(row["planner"], row["arena"], row["theta"]): p_text(row["p_success"]) for row in tested}


def sentences(rows: Iterable[Mapping[str, Any]]) -> list[str]:
    """Return a line for each total whose mean time was reported, or whose share was printed as another one.

    rows: of :func:`bayeshunt.experiments.reported.compare`.
    """
    lines = []
    for row in rows:
        parts = []
        if row["paper_mean_time_s"] is not None:
            test = "" if row["p_time"] is None else f": z {row['z_time']:.2f}, p {p_text(row['p_time'])}"
            parts.append(f"mean time {row['mean_time_s']:.2f} s, the paper's {row['paper_mean_time_s']:g} s{test}")
        if row["paper_printed"] is not None:
            printed = f"the paper prints its {row['paper_caught']} of {row['paper_runs']} as {row['paper_printed']:.1%}"
            parts.append(f"{printed} (it is {row['paper_success']:.2%})")
        if parts:
            lines.append(f"{row['planner']}, {row['arena']}: {'; '.join(parts)}.".replace("%", " %"))
    return lines
