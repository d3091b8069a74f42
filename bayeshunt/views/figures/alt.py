"""A figure for a notebook, with the words that a screen reader says in its place."""

from __future__ import annotations

import base64
import io
import os
import sys
from pathlib import Path
from typing import IO, Any

from matplotlib.figure import Figure

from bayeshunt.core.errors import InputError, shown
from bayeshunt.views.notebook.html import tag

__all__ = ["Described", "described"]

_DOTS = 150  # per inch, of the picture
_SHOWN = 96  # per inch, on the screen


class Described:
    """A figure and its alternative text; the last line of a notebook cell shows both.

    figure: matplotlib's. alt: what it shows, in words, for those who cannot see it.
    """

    def __init__(self, figure: Figure, alt: str) -> None:
        if not alt.strip():
            raise InputError("a described figure needs words that say what it shows")
        self.figure, self.alt = figure, alt
        pyplot = sys.modules.get("matplotlib.pyplot")
        if pyplot is not None:
            pyplot.close(figure)  # or the notebook would show it a second time, without its words

    def savefig(self, fname: str | os.PathLike[str] | IO[bytes], **options: Any) -> None:
        """Write the figure to a file, as matplotlib's ``Figure.savefig`` does with the same arguments.

        Raises InputError for a kind of file that no figure is written as.
        """
        kinds = self.figure.canvas.get_supported_filetypes()
        kind = options.get("format") or (
            Path(fname).suffix[1:].lower() if isinstance(fname, (str, os.PathLike)) else ""
        )
        if kind and kind not in kinds:
            raise InputError(f"{shown(fname)}: a figure is not written as {kind!r}; expected one of {', '.join(kinds)}")
        self.figure.savefig(fname, **options)

    def _repr_html_(self) -> str:
        drawn = io.BytesIO()
        self.figure.savefig(drawn, format="png", dpi=_DOTS)
        source = "data:image/png;base64," + base64.b64encode(drawn.getvalue()).decode()
        width = round(self.figure.get_figwidth() * _SHOWN)
        return str(tag("img", alt=self.alt, src=source, width=width, style="max-width:100%;background:white"))

    def __repr__(self) -> str:
        return f"<Figure: {self.alt}>"


def described(figure: Figure, alt: str) -> Described:
    """Return ``figure`` with its alternative text, to be shown by a notebook; InputError for an empty text."""
    return Described(figure, alt)
