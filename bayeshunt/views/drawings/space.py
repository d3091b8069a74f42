"""A table of free space as a drawing: every cell in the shade of P(free), counts and interval at hand."""

from __future__ import annotations

import math

from bayeshunt.core.units import length
from bayeshunt.models.arena.free_space import FreeSpace
from bayeshunt.views.drawings import svg
from bayeshunt.views.drawings.maps import Window
from bayeshunt.views.notebook.html import Html, tag

__all__ = ["space_map"]

#: Of a larger table the cells that were counted least are left out.
_MOST_CELLS = 6000


def space_map(space: FreeSpace) -> Html:
    """Return the cells from above, the hunter's start in their midst, its heading up."""
    table = space.table().assign(counts=lambda t: t["visits"] + t["hits"])
    table = table.nlargest(_MOST_CELLS, "counts", keep="first")
    window = Window.around(-table["y"], table["x"], size=460, least=4 * space.cell)
    side = space.cell * window.scale
    parts = []
    for cell in table.to_dict("records"):
        across, up = window.at(-cell["y"], cell["x"])
        hint = (
            f"{length(cell['x'])} ahead, {length(cell['y'])} to the left: P(free) {cell['p_free']:.2f} "
            f"({cell['low']:.2f} to {cell['high']:.2f}), {cell['visits']} visits, {cell['hits']} hits"
        )
        free = cell["p_free"] >= 0.5
        colour, shade = (svg.CATCH, cell["p_free"]) if free else (svg.PREY, 1.0 - cell["p_free"])
        parts.append(
            svg.box(
                across - side / 2, up - side / 2, side, side, hint, fill=colour, fill_opacity=f"{0.1 + 0.6 * shade:.2f}"
            )
        )
    parts += [window.robot(0, 0, math.pi / 2, svg.INK, "where the hunter started", 8), window.ruler(), _legend(window)]
    return svg.drawing(window.width, window.height, *parts, label="Where the hunter can be, cell by cell")


def _legend(window: Window) -> Html:
    y, x = window.height - 7, window.width - 150
    return tag(
        "g", svg.box(x, y - 9, 10, 10, fill=svg.CATCH, fill_opacity="0.7"), svg.text(x + 15, y, "free"),
        svg.box(x + 52, y - 9, 10, 10, fill=svg.PREY, fill_opacity="0.7"), svg.text(x + 67, y, "blocked"),
    )  # fmt: skip
