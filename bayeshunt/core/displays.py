"""How a model or a plan shows itself, without knowing who draws it.

A class that shows itself calls :func:`to_html` from its ``_repr_html_`` and :func:`to_text` from its
``__str__``. Which module draws is arranged by the package itself with :func:`arrange`, by name, and
that module is imported when something is shown for the first time: models and planners never see
the views, and a robot that hunts without a screen never loads them.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

__all__ = ["arrange", "to_html", "to_text"]

#: Module that offers ``to_html(thing)`` and ``to_text(thing)``; None: nobody draws.
_drawer: str | None = None


def arrange(module: str | None) -> None:
    """Let ``module`` draw everything that shows itself; None: nobody draws.

    The module offers ``to_html(thing) -> str`` and ``to_text(thing) -> str``.
    """
    global _drawer
    _drawer = module


def to_html(thing: Any) -> str | None:
    """Return ``thing`` as HTML for a notebook, None (the notebook then prints it) if nobody draws."""
    if _drawer is None:
        return None
    html: str | None = import_module(_drawer).to_html(thing)
    return html


def to_text(thing: Any) -> str:
    """Return ``thing`` as plain text of several lines; its ``repr`` if nobody draws."""
    return repr(thing) if _drawer is None else str(import_module(_drawer).to_text(thing))
