"""The sheet of two models compared."""

from __future__ import annotations

from bayeshunt.core.units import label
from bayeshunt.models.comparison.compare import Comparison
from bayeshunt.views.sheets.sheet import Note, Sheet, Table

__all__ = ["comparison"]


def comparison(found: Comparison) -> Sheet:
    """Return the cells that differ by more than chance, the largest difference first, and the edges that changed."""
    total, cells = sum(frame.size for frame in found.difference.values()), found.cells
    edges = (("edges added", found.edges_added), ("edges removed", found.edges_removed))
    pairs: list[tuple[str, object]] = [("cells", f"{len(cells)} of {total} differ by more than chance")]
    pairs += [(name, ", ".join(f"{a} > {b}" for a, b in some)) for name, some in edges if some]
    rows = [
        [r["variable"], label(r["state"]), r["gait"], f"{r['difference']:+.3f}", f"{r['low']:+.3f} to {r['high']:+.3f}"]
        for r in cells.to_dict("records")
    ]
    heads = ["table", "bin", "gait", "difference", f"{100 * found.level:g} % interval"]
    note = Note("Second model less the first. Shown are the cells whose interval excludes 0.")
    table = Table(heads, rows, words=frozenset({0, 1, 2})) if rows else None
    return Sheet("Two models compared", "", pairs, [table, note])
