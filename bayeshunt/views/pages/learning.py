"""The page of a table being learned: a slider over its rows, and what the model knew after each."""

from __future__ import annotations

from typing import Any

import numpy as np

from bayeshunt.core.bins import EFFECTS
from bayeshunt.core.units import label, true_minus
from bayeshunt.models.comparison.learning import Learning
from bayeshunt.views.pages.page import embed, number, render

__all__ = ["learning_data", "learning_html"]

_MOST_ROWS = 20_000  # that a page holds; of a longer table the first


def learning_html(learning: Learning) -> str:
    """Return a self-contained page: tables that fill, intervals, coverage, held-out log-loss, what to babble next."""
    return render(
        "learning.html.j2", ["page.css", "learning.css"], ["dom.js", "learning.js", "learning_page.js"],
        title=f"Learning from {len(learning):,} rows", data=embed(learning_data(learning)),
    )  # fmt: skip


def learning_data(learning: Learning) -> dict[str, Any]:
    """Return plain values for JSON.

    rows: [gait, distance bin, angle bin, heading bin] of each, one after the other. curves: what was measured after
    ``at`` rows. next: bits by gait that one more row of it is expected to tell, after ``at`` rows.
    """
    cells, axes = learning.cells(_MOST_ROWS)
    at = sorted({*np.geomspace(1, len(cells), 18).astype(int).tolist()})
    coverage, widths = learning.coverage(at), learning.widths(at)
    curves = {
        "coordinates learned": (at, coverage["coordinates"].tolist()),
        "mean width of a cell's 95 % interval": (at, widths["width"].tolist()),
    }
    if len(learning) >= 10:
        losses = learning.log_loss([n for n in at if n <= 0.8 * len(learning)])
        curves["held-out log-loss [nat per row]"] = (losses["n"].tolist(), losses["log_loss"].tolist())
    names = list(learning.gaits.names)
    bits = [learning.babble_next(n).reindex(names).tolist() for n in at]
    return {
        "gaits": names,
        "tables": [
            {"name": name, "labels": [true_minus(label(text)) for text in axes[name].labels]} for name in EFFECTS
        ],
        "rows": cells.ravel().tolist(),
        "at": at,
        "curves": [{"name": k, "at": n, "values": [number(v, 5) for v in values]} for k, (n, values) in curves.items()],
        "next": [[number(v, 4) for v in values] for values in bits],
    }
