"""How a model or a plan shows itself, without knowing who draws it.

A class that shows itself derives from :class:`Displayed`. Which module draws is arranged by the package itself with
:func:`arrange`, by name, and that module is imported when something is shown for the first time: models and planners
never see the views, and a robot that hunts without a screen never loads them.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from bayeshunt.core.errors import InputError

if TYPE_CHECKING:
    import os

__all__ = ["Bundled", "Displayed", "Instrument", "arrange", "bundle", "save", "to_html", "to_text", "widget"]

#: Module that offers ``to_html(thing)`` and ``to_text(thing)``; None: nobody draws.
_drawer: str | None = None


def arrange(module: str | None) -> None:
    """Let ``module`` draw everything that shows itself; None: nobody draws.

    The module offers ``to_html(thing) -> str`` and ``to_text(thing) -> str``, and of things that have them
    ``widget(thing)``, ``bundle(thing)`` and ``save(thing, path)``.
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


class Displayed:
    """Shows itself: as text where it is printed, as a card in a notebook."""

    __slots__ = ()

    def __str__(self) -> str:
        return to_text(self)

    def _repr_html_(self) -> str | None:
        return to_html(self)


class Instrument(Displayed):
    """Shows itself as a widget in a notebook, and as a page."""

    _widget: Any = None

    @property
    def widget(self) -> Any:
        """It as a widget, made once; what may be set in it follows the picture.

        Raises InputError if anywidget is not installed.
        """
        if self._widget is None:
            self._widget = widget(self)
        return self._widget

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write it as one HTML page that needs neither a kernel nor the internet, replaced atomically."""
        save(self, path)

    def _repr_mimebundle_(self, **options: Any) -> Any:
        return bundle(self, **options)

    def _display_(self) -> Any:
        """What marimo asks for first."""
        return Bundled(self)


def widget(thing: Any) -> Any:
    """Return ``thing`` as a widget; InputError where widgets cannot be."""
    return import_module(_drawing()).widget(thing)


def bundle(thing: Any, **options: Any) -> Any:
    """Return what a notebook shows of a thing that has a widget: it, and what else there is where no kernel runs."""
    return None if _drawer is None else import_module(_drawer).bundle(thing, **options)


class Bundled:
    """A thing whose widget is to be shown where a notebook would take its card: marimo prefers ``_repr_html_``."""

    def __init__(self, thing: Any) -> None:
        self.thing = thing

    def _repr_mimebundle_(self, **options: Any) -> Any:
        return bundle(self.thing, **options)


def save(thing: Any, path: str | os.PathLike[str]) -> None:
    """Write ``thing`` as one HTML page, replaced atomically."""
    import_module(_drawing()).save(thing, path)


def _drawing() -> str:
    if _drawer is None:
        raise InputError("nobody draws: bayeshunt itself was not imported")
    return _drawer
