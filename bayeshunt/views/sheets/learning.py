"""The sheet of a table being learned."""

from __future__ import annotations

from bayeshunt.models.comparison.learning import Learning
from bayeshunt.views.sheets.sheet import Note, Sheet, Table

__all__ = ["learning"]


def learning(shown: Learning) -> Sheet:
    """Return what was known after some numbers of rows, and what one more row of each gait is expected to tell."""
    at = sorted({max(1, len(shown) * share // 100) for share in (5, 10, 25, 50, 100)})
    coverage, widths = shown.coverage(at), shown.widths(at)
    rows = [
        [int(one["n"]), int(one["gaits"]), int(one["coordinates"]), f"{width:.3f}"]
        for one, width in zip(coverage.to_dict("records"), widths["width"], strict=True)
    ]
    bits = shown.babble_next()
    return Sheet(
        "Learning",
        f"{len(shown)} rows of {len(shown.gaits)} gaits",
        [("babble next", f"{bits.index[0]}, {bits.iloc[0]:.3f} bits")],
        [
            Table(["rows", "gaits", "coordinates", "mean width of intervals"], rows),
            Table(["gait", "expected bits of one more row"], [[gait, f"{value:.3f}"] for gait, value in bits.items()]),
            Note("learning.widget, or learning.save('learning.html'): a slider over the rows."),
        ],
    )
