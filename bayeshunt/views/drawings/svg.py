"""Small pieces of SVG in the colours of the theme, drawn without any graphics library.

Colours are CSS variables, so that one drawing serves the light and the dark theme.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

from bayeshunt.views.notebook.html import Html, tag

__all__ = ["CATCH", "arrow", "box", "disc", "drawing", "line", "shorten", "text"]

INK, FAINT, LINE, PANEL = "var(--bh-ink)", "var(--bh-faint)", "var(--bh-line)", "var(--bh-panel)"
BAR, CHOSEN, HUNTER, PREY = "var(--bh-bar)", "var(--bh-chosen)", "var(--bh-hunter)", "var(--bh-prey)"
CATCH = "var(--bh-good)"


def drawing(width: float, height: float, *content: Any, label: str) -> Html:
    """Return a drawing of ``width`` x ``height`` pixels; ``label`` is what a screen reader says."""
    size = {"viewBox": f"0 0 {width:g} {height:g}", "width": f"{width:g}", "height": f"{height:g}"}
    return tag("svg", *content, xmlns="http://www.w3.org/2000/svg", role="img", aria_label=label, **size)


def text(x: float, y: float, content: str, *, anchor: str = "start", faint: bool = False, **style: Any) -> Html:
    """Return a line of text whose baseline starts (or is centred, or ends) at (x, y)."""
    look = "bh-faint" if faint else None
    return tag("text", content, x=_n(x), y=_n(y), text_anchor=anchor, class_=look, **style)


def box(x: float, y: float, width: float, height: float, title: str | None = None, **style: Any) -> Html:
    """Return a rectangle; ``title`` shows on hover."""
    hint = None if title is None else tag("title", title)
    return tag("rect", hint, x=_n(x), y=_n(y), width=_n(width), height=_n(height), **style)


def disc(x: float, y: float, radius: float, title: str | None = None, **style: Any) -> Html:
    """Return a circle; ``title`` shows on hover."""
    hint = None if title is None else tag("title", title)
    return tag("circle", hint, cx=_n(x), cy=_n(y), r=_n(radius), **style)


def line(points: Iterable[Sequence[float]], **style: Any) -> Html:
    """Return straight lines through ``points``."""
    path = " ".join(f"{_n(x)},{_n(y)}" for x, y in points)
    return tag("polyline", points=path, **{"fill": "none", **style})


def arrow(x: float, y: float, to_x: float, to_y: float, *, head: float = 7.0, colour: str = FAINT) -> Html:
    """Return an arrow from (x, y) to (to_x, to_y)."""
    direction = math.atan2(to_y - y, to_x - x)
    sides = [(to_x - head * math.cos(direction + s), to_y - head * math.sin(direction + s)) for s in (0.42, -0.42)]
    tip = " ".join(f"{_n(a)},{_n(b)}" for a, b in [(to_x, to_y), *sides])
    shaft = (to_x - 0.8 * head * math.cos(direction), to_y - 0.8 * head * math.sin(direction))
    body = line([(x, y), shaft], stroke=colour, stroke_width="1.4")
    return tag("g", body, tag("polygon", points=tip, fill=colour))


def shorten(name: str, length: int) -> str:
    """Return ``name`` cut to ``length`` characters."""
    return name if len(name) <= length else name[: length - 1] + "…"


def _n(value: float) -> str:
    """A coordinate in hundredths of a pixel, without needless digits."""
    return f"{float(value):.2f}".rstrip("0").rstrip(".")
