"""What every figure shares: type, colours, bodies and axes in the hunter's frame, saving.

Figures are made without pyplot, so that no window, backend or global state is touched.
"""

from __future__ import annotations

import functools
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, ParamSpec

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon

from bayeshunt.files.atomic import replace_atomically
from bayeshunt.views import theme

__all__ = ["FORMATS", "MARKERS", "PLANNERS", "body", "frame_axes", "save", "shorten", "solid", "styled", "write"]

INK, FAINT, LINE, BAR = (theme.COLOURS[name][0] for name in ("ink", "faint", "line", "bar"))
CHOSEN, HUNTER, PREY, CATCH = (theme.COLOURS[name][0] for name in ("chosen", "hunter", "prey", "good"))
#: A colour and a marker for each planner.
PLANNERS = tuple(light for light, _ in theme.PLANNERS)
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
#: Formats that :func:`save` writes.
FORMATS = ("png", "svg")

_STYLE: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 8.5,
    "axes.titlesize": 9.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 8.5,
    "axes.edgecolor": FAINT,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "legend.frameon": False,
    "figure.facecolor": "white",
    "text.parse_math": False,  # a gait may be called "$1"
    "svg.fonttype": "path",
    "svg.hashsalt": "bayeshunt",  # the same figure gives the same file
}

_Given = ParamSpec("_Given")


def styled(draw: Callable[_Given, Figure]) -> Callable[_Given, Figure]:
    """Let a function that returns a Figure draw in the common style."""

    @functools.wraps(draw)
    def wrapper(*args: _Given.args, **kwargs: _Given.kwargs) -> Figure:
        with mpl.rc_context(_STYLE):
            figure = draw(*args, **kwargs)
            # Settled once: laying out again at every save would move things by fractions of a pixel.
            figure.draw_without_rendering()
            figure.set_layout_engine("none")
            return figure

    return wrapper


def save(figure: Figure, folder: str | os.PathLike[str], name: str) -> list[Path]:
    """Write ``figure`` as ``name.png`` (200 dots per inch) and ``name.svg``; returns the paths written."""
    paths = [Path(folder) / f"{name}.{kind}" for kind in FORMATS]
    for path in paths:
        write(figure, path)
    return paths


def write(figure: Figure, path: Path) -> None:
    """Write ``figure`` as the ending of its name says, ".png" (200 dots per inch) or ".svg", replaced atomically."""
    kind = path.suffix.lower().removeprefix(".")
    with mpl.rc_context(_STYLE), replace_atomically(path) as temporary:
        figure.savefig(temporary, format=kind, dpi=200, metadata={"Date": None} if kind == "svg" else None)


def frame_axes(axes: Axes, *, across: str = "to the right [mm]", up: str = "ahead [mm]") -> None:
    """Make axes a map in millimetres: equal scales, both directions named."""
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel(across)
    axes.set_ylabel(up)
    axes.grid(color=LINE, linewidth=0.5)
    axes.set_axisbelow(True)


def body(axes: Axes, right: float, ahead: float, heading: float, diameter: float, colour: str, **style: Any) -> None:
    """Draw a robot [mm, radians clockwise from up] as a disc with a line to its front."""
    radius = diameter / 2
    look = {"fill": False, "linewidth": 1.2, "zorder": 4, **style}
    axes.add_patch(Circle((right, ahead), radius, edgecolor=colour, **look))
    tip = (right + radius * np.sin(heading), ahead + radius * np.cos(heading))
    line = {"linewidth": look["linewidth"], "zorder": look["zorder"], "alpha": look.get("alpha")}
    axes.plot([right, tip[0]], [ahead, tip[1]], color=colour, solid_capstyle="round", **line)


def solid(corners: np.ndarray) -> Polygon:
    """Return an obstacle by its corners [V, 2], to be added to axes."""
    return Polygon(corners, facecolor=FAINT, alpha=0.55, edgecolor="none", zorder=1.5)


def shorten(name: str, length: int = 22) -> str:
    """Return ``name`` on one line, cut to ``length`` characters."""
    printable = "".join(c if c.isprintable() else "?" for c in str(name))
    return printable if len(printable) <= length else printable[: length - 1] + "…"
