"""What a robot learned of an arena, as a file to look at: a page or a figure."""

from __future__ import annotations

import os
from pathlib import Path

from bayeshunt.core.arguments import checked
from bayeshunt.core.errors import InputError, shown
from bayeshunt.files.atomic import check_path, write_text
from bayeshunt.models.arena.free_space import FreeSpace
from bayeshunt.models.arena.rooms import RoomModel
from bayeshunt.views.notebook.display import page

__all__ = ["write_map"]


@checked
def write_map(room: RoomModel | FreeSpace, path: str | os.PathLike[str]) -> None:
    """Write what a robot learned of an arena as a page (.html) or a figure (.png, .svg), replaced atomically.

    Raises InputError for a name that ends as something else.
    """
    if not isinstance(room, (RoomModel, FreeSpace)):
        raise InputError(f"room: expected a RoomModel or a FreeSpace, got {shown(room)}")
    given = Path(check_path(path, "the name of a file to write", InputError))
    if given.suffix.lower() == ".html":
        write_text(given, page(room))
    elif given.suffix.lower() in (".png", ".svg"):
        from bayeshunt.views.figures.space import free_space
        from bayeshunt.views.figures.style import write

        write(free_space(room), given)
    else:
        raise InputError(f"{given}: expected a file name that ends in .html, .png or .svg")
