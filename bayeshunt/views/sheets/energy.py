"""What gaits cost, as a table whose rows open."""

from __future__ import annotations

import hashlib
from functools import partial
from typing import Any

import pandas as pd

from bayeshunt.models.body.forward import ForwardModel
from bayeshunt.views.notebook.html import Html, join, tag
from bayeshunt.views.sheets.panels import babbled_list, side
from bayeshunt.views.sheets.sheet import Opening, Table

__all__ = ["energy"]

_MOST_BABBLED = 12  # rows of a gait


def energy(model: ForwardModel) -> Opening:
    """Return a row per gait, which opens: what it costs, with its interval, and after which gait least and most."""
    return Opening(partial(_panels, model), _table(model))


def _table(model: ForwardModel) -> Table:
    frame, rows = model.energy(), []
    alone = frame["previous_gait"].isna().any()
    for name in model.gaits.names:
        own = frame[frame["gait"] == name]
        whole = own[own["previous_gait"].isna()] if alone else own
        pairs = own[own["previous_gait"].notna() & (own["rows"] > 1)] if alone else own.iloc[:0]
        least, most = (pairs["mean_j"].idxmin(), pairs["mean_j"].idxmax()) if len(pairs) else (None, None)
        rows.append([name, *_cost(whole), *(_after(pairs, at) for at in (least, most))])
    heads = ["gait", "rows", "mean J", "95 %", "least after", "most after"]
    return Table(heads, rows, words=frozenset({0, 3, 4, 5}), most=len(rows))


def _cost(cell: pd.DataFrame) -> list[object]:
    if not len(cell) or not cell["rows"].iloc[0]:
        return [0, "never babbled", ""]
    row = cell.iloc[0]
    return [int(row["rows"]), f"{row['mean_j']:.3g}", f"{row['low_j']:.3g} to {row['high_j']:.3g}"]


def _after(pairs: pd.DataFrame, at: Any) -> str:
    if at is None:
        return ""
    row: Any = pairs.loc[at]
    return f"{row['previous_gait']}: {row['mean_j']:.3g} ({row['rows']} rows)"


def _panels(model: ForwardModel) -> tuple[dict[int, str], Html]:
    """A panel for each gait: its mean with its interval, whatever went before and after each gait, and rows."""
    frame, made, ids = model.energy(), [], {}
    key = hashlib.sha256(repr(frame.to_dict("list")).encode()).hexdigest()[:10]
    for at, name in enumerate(model.gaits.names):
        ids[at] = f"bh-{key}-{at}"
        own = frame[frame["gait"] == name].to_dict("records")
        said = [tag("p", _sentence(cell)) for cell in own if cell["rows"]] or [tag("p", "Never babbled.")]
        rows = babbled_list(model.rows("Gait", name), _MOST_BABBLED, f"Rows of {name}") if len(model.data) else None
        made.append(side(ids[at], ["Energy of each gait", name], *said, rows))
    return ids, join(made)


def _sentence(cell: dict[Any, Any]) -> str:
    """One cell of the table: "1.52 J, the mean of 430 rows, 95 % interval 1.50 to 1.54 J, spread 0.21 J"."""
    before = "" if pd.isna(cell["previous_gait"]) else f"After {cell['previous_gait']}: "
    rows = "one row" if cell["rows"] == 1 else f"{cell['rows']} rows"
    sure = "" if pd.isna(cell["low_j"]) else f", 95 % interval {cell['low_j']:.3g} to {cell['high_j']:.3g} J"
    spread = "" if pd.isna(cell["sd_j"]) else f", spread {cell['sd_j']:.2g} J"
    return f"{before}{cell['mean_j']:.3g} J, the mean of {rows}{sure}{spread}"
