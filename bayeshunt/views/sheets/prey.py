"""The sheet of a prey model: each transition seen, how often, where it leads; every row opens."""

from __future__ import annotations

import hashlib
import math
import re
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from bayeshunt.core.errors import NothingObservedError
from bayeshunt.core.units import degrees, label, length, true_minus
from bayeshunt.models.target.prey import PreyModel
from bayeshunt.views import grounds
from bayeshunt.views.drawings import maps, svg
from bayeshunt.views.notebook.html import Html, join, tag
from bayeshunt.views.sheets.panels import side
from bayeshunt.views.sheets.sheet import Drawn, Note, Opening, Printed, Sheet, Table
from bayeshunt.views.sheets.tables import MOST_ROWS

__all__ = ["expected", "prey_map", "prey_model", "prey_table"]

#: Rows of the table in text.
_PRINTED = 12


def prey_model(prey: PreyModel) -> Sheet:
    """Return the prey table: each transition seen, how often, and where it leads."""
    title = "Prey model: P(Distance, Angle, Heading)"
    subtitle = f"{prey.observations} transitions, in the prey's own frame one time-step earlier"
    if prey.is_empty:
        return Sheet(title, subtitle, (), [Note("Nothing observed yet, so nothing can be predicted.")])
    cells = prey_table(prey)
    opening = Opening(partial(_panels, prey, title), cells)
    facts = [*expected(prey), *_conditions(prey)]
    return Sheet(title, subtitle, facts, [Drawn(lambda: prey_map(prey), opening, beside=True), Printed(cells.lines)])


def expected(prey: PreyModel) -> list[tuple[str, str]]:
    """Return the mean transition in words; nothing if the headings seen leave no mean."""
    try:
        mean = prey.predict(1)
    except NothingObservedError:
        return []
    return [
        ("expected next distance", length(mean.distance)),
        ("expected angle", f"{degrees(mean.angle, 1)} clockwise"),
        ("expected heading", f"{degrees(mean.heading, 1)} clockwise"),
    ]


def _conditions(prey: PreyModel) -> list[tuple[str, str]]:
    """What the next steps depend on besides, where a model was fitted so."""
    known = prey.conditions
    if known is None:
        return []
    facts = [("time-step", f"{known.time_step:g} s")]
    if known.speed is not None:
        facts.append(("also counted by", "the prey's own speed, and while it stands for how long it has stood"))
    if known.residual is not None:
        base = known.residual.base.replace("_", " ")
        facts.append(
            (
                "also counted",
                f"what {base} misses over {known.residual.steps} steps, by {known.residual.seen} places seen",
            )
        )
    return facts


def _seen(prey: PreyModel) -> pd.DataFrame:
    """The cells seen, the most frequent first, with the centre that each leads to [m, rad, rad]."""
    centres = np.array(prey.cells()).reshape(-1, 4)[:, :3].T
    frame = prey.cpt().assign(**dict(zip(("far", "bearing", "turn"), centres, strict=True)))
    return frame.sort_values("count", ascending=False, kind="stable")


def _panels(prey: PreyModel, title: str) -> tuple[dict[int, str], Html]:
    """A panel for each row of the table: its rule with its numbers, its interval, and where it leads."""
    frame = _seen(prey).head(MOST_ROWS)
    group = f"bh-{hashlib.sha256(repr(prey.cells()).encode()).hexdigest()[:10]}"
    ids = {at: f"{group}-{at}" for at in range(len(frame))}
    rows = zip(ids, frame.index, frame.to_dict("records"), strict=True)
    made = (
        side(ids[at], [title, true_minus(", ".join(map(label, bins)))], *_opened(prey, row)) for at, bins, row in rows
    )
    return ids, join(made)


def _opened(prey: PreyModel, cell: dict[Any, Any]) -> list[Html]:
    """What a cell of the prey table is made of, in sentences."""
    seen, count = _count(prey.observations), _count(cell["count"])
    ahead, right = cell["far"] * math.cos(cell["bearing"]), cell["far"] * math.sin(cell["bearing"])
    said = (
        f"P = {count} / {seen} = {cell['probability']:.4g}",
        f"95 % interval {grounds.cell_within(cell['low'], cell['high'])}",
        f"{count} of {seen} transitions fell into this cell: at its centre {length(ahead)} ahead and {length(right)} "
        f"to the right of where the prey was one time-step earlier, turned by {degrees(cell['turn'])}.",
        "The table keeps counts alone; each transition of a hunt is in episode.frame, observed_*.",
    )
    return [tag("p", true_minus(line)) for line in said]


def prey_table(prey: PreyModel) -> Table:
    """Return the cells seen, the most frequent first."""
    frame = _seen(prey)
    columns = (frame[name].tolist() for name in ("probability", "count", "low", "high"))
    rows = [
        [*map(_short, bins), f"{p:.3f}", _count(n), f"{low:.3f} to {high:.3f}"]
        for bins, p, n, low, high in list(zip(frame.index, *columns, strict=True))[:MOST_ROWS]
    ]
    rest = len(frame) - len(rows)
    more = f"and {rest} rarer cells" if rest else ""
    return Table(["Distance", "Angle", "Heading", "P", "count", "95 % interval"], rows, left_out=more, most=_PRINTED)


def _short(bin_name: str) -> str:
    """A bin as people read it; bounds of more than three decimals, of bins that rows have chosen, to three digits."""
    return re.sub(r"\d+\.\d{4,}", lambda found: f"{float(found.group()):.3g}", label(bin_name))


def _count(number: float) -> str:
    """A count in words; an expected one to three digits."""
    return f"{number:.0f}" if number == int(number) else f"{number:.3g}"


def prey_map(prey: PreyModel) -> Html:
    """Return where the prey's steps led, as arrows in its own earlier frame (heading up)."""
    cells = np.array(prey.to_dict()["counts"])[:, :3].astype(int)
    weights = np.array(prey.to_dict()["counts"])[:, 3]
    axes = prey.axes
    reach = (cells[:, 0] + 0.5) * axes.distance.width
    angles, headings = axes.angle.centres[cells[:, 1]], axes.heading.centres[cells[:, 2]]
    right, ahead = reach * np.sin(angles), reach * np.cos(angles)
    window = maps.Window.around([0.0, *right], [0.0, *ahead], size=240, least=float(reach.max()))
    parts = [window.robot(0, 0, math.pi / 2, svg.FAINT, "the prey one time-step earlier", 9)]
    for i in np.argsort(weights, kind="stable")[-400:]:
        size = 4 + 8 * math.sqrt(weights[i] / weights.max())
        hint = f"{_count(weights[i])} of {prey.observations} transitions"
        parts.append(window.robot(right[i], ahead[i], math.pi / 2 - headings[i], svg.PREY, hint, size))
    return svg.drawing(window.width, window.height, *parts, window.ruler(), label="Where the prey's steps led")
