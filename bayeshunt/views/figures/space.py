"""The figure of a table of free space."""

from __future__ import annotations

import numpy as np
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from bayeshunt.models.arena.free_space import FreeSpace
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.views.figures.style import CATCH, HUNTER, INK, PREY, body, frame_axes, styled

__all__ = ["free_space"]


@styled
def free_space(shown: FreeSpace | RoomModel) -> Figure:
    """Draw P(free) of every cell that was visited or hit [mm], the hunter's start in their midst, its heading up.

    Of a room, the walls are drawn too, where the hunter's centre is stopped.
    """
    space = shown.space if isinstance(shown, RoomModel) else shown
    figure = Figure(figsize=(4.4, 3.9), layout="constrained")
    axes = figure.subplots()
    if space is not None:
        chance = np.where(space.visits + space.hits > 0, space.probabilities, np.nan)
        columns, rows = (
            1000 * space.cell * (np.arange(size + 1) + first - 0.5)
            for size, first in zip(chance.shape, space.origin, strict=True)
        )
        colours = LinearSegmentedColormap.from_list("free", [PREY, "#ffffff", CATCH])
        mesh = axes.pcolormesh(-rows[::-1], columns, chance[:, ::-1], cmap=colours, vmin=0, vmax=1, rasterized=True)
        bar = figure.colorbar(mesh, ax=axes, shrink=0.8)
        bar.set_label("P(free)")
        known = np.isfinite(chance)
        (first, last), (right, left) = (np.flatnonzero(known.any(axis=axis))[[0, -1]] for axis in (1, 0))
        axes.set_xlim(-rows[left + 2 if left + 2 < len(rows) else -1], -rows[max(right - 1, 0)])
        axes.set_ylim(columns[max(first - 1, 0)], columns[min(last + 2, len(columns) - 1)])
    frame_axes(axes)
    axes.set_aspect("equal", adjustable="box")
    if isinstance(shown, RoomModel):
        for (nx, ny), offset in zip(shown.normals, shown.offsets, strict=True):
            axes.axline(
                (-1000 * ny * offset, 1000 * nx * offset), (-1000 * (ny * offset + nx), 1000 * (nx * offset - ny)),
                color=INK, linewidth=1.2,
            )  # fmt: skip
    body(axes, 0, 0, 0, 2000 * space.cell if space is not None else 57.0, HUNTER)
    axes.set_title("Where the hunter can be")
    return figure
