"""The sheet of two models compared."""

from __future__ import annotations

from functools import partial

import numpy as np

from bayeshunt.core.units import label
from bayeshunt.models.comparison.compare import Comparison
from bayeshunt.views.drawings.differences import answers_map, signed_table
from bayeshunt.views.drawings.maps import gait_key
from bayeshunt.views.sheets.sheet import Drawn, Note, Sheet, Table

__all__ = ["comparison"]

_ANSWERS = "What each coordinate answers, first and second model; outlined where another gait is most probable"


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
    moved, whole = int(found.answers["changed"].sum()), len(found.answers)
    pairs.append(("answers", f"another gait is most probable in {moved} of {whole} coordinates"))
    note = Note("Second model less the first. Shown are the cells whose interval excludes 0.")
    table = Table(heads, rows, words=frozenset({0, 1, 2})) if rows else None
    maps = (partial(answers_map, found, after=after) for after in (False, True))
    drawn = [Drawn(*maps, lambda: gait_key(found.models[0]), title=_ANSWERS, beside=True, opened=True)]
    for variable, frame in found.difference.items():
        if np.abs(np.nan_to_num(frame.to_numpy())).max() > 0:
            given = " | Gait" if variable != "Gait" else ""
            drawn.append(
                Drawn(partial(signed_table, found, variable), title=f"P({variable}{given}): second less first")
            )
    return Sheet("Two models compared", "", pairs, [table, note, *drawn])
