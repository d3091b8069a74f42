"""Sheets of what a robot learns of an arena: its walls, and where it can be."""

from __future__ import annotations

import math

from bayeshunt.core.units import length
from bayeshunt.models.arena.free_space import FreeSpace
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.views.drawings.space import space_map
from bayeshunt.views.sheets.sheet import Drawn, Note, Part, Printed, Sheet, Table

__all__ = ["free_space", "room"]

#: Cells in the table beside the map.
_LEAST_SURE = 60


def room(shown: RoomModel) -> Sheet:
    """Return a room: walls in a table, free space as a map."""
    table = (shown.normals.tolist(), shown.offsets.tolist(), shown.lengths.tolist(), shown.blocked.tolist())
    rows = [
        [f"{math.degrees(math.atan2(-y, x)) + 0.0:.0f}°", length(offset), length(along), touches]
        for (x, y), offset, along, touches in zip(*table, strict=True)
    ]
    walls: Part = Note("No walls were met.")
    if rows:
        walls = Table(("wall at bearing", "distance", "touched along", "touches"), rows)
    parts = [walls, *([] if shown.space is None else _parts(shown.space))]
    subtitle = f"{len(rows)} wall{'' if len(rows) == 1 else 's'}, in the frame in which the hunter started"
    return Sheet("Room", subtitle, () if shown.space is None else _facts(shown.space), parts)


def free_space(shown: FreeSpace) -> Sheet:
    """Return a table of free space: as a map, and its cells."""
    return Sheet("Free space", "where the hunter's centre can be", _facts(shown), _parts(shown))


def _facts(space: FreeSpace) -> list[tuple[str, str]]:
    return [
        ("cell", length(space.cell)),
        ("visited", f"{int((space.visits > 0).sum()):,} cells, {int(space.visits.sum()):,} visits"),
        ("stopped", f"at {int((space.hits > 0).sum()):,} cells, {int(space.hits.sum()):,} hits"),
    ]


def _parts(space: FreeSpace) -> list[Part]:
    cells = space.table()
    order = (cells["low"] - cells["high"]).argsort(kind="stable").to_numpy()[:_LEAST_SURE]
    rows = [
        [length(x), length(y), int(visits), int(hits), f"{chance:.2f}", f"{low:.2f} to {high:.2f}"]
        for x, y, visits, hits, chance, low, high in cells.to_numpy(dtype=float)[order].tolist()
    ]
    columns = ("ahead", "to the left", "visits", "hits", "P(free)", "95 % interval")
    rest = len(cells) - len(rows)
    table = Table(columns, rows, left_out=f"{rest:,} cells that are surer" if rest else "", most=12)
    words = Note(
        "P(free) = (visits + 0.05) / (visits + hits + 0.5), with its Beta interval: a cell that was never visited is "
        "taken to be blocked, more or less."
    )
    least = Drawn(table, title="The cells that are least sure")
    return [Drawn(lambda: space_map(space)), words, least, Printed(table.lines)]
