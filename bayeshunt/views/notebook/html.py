"""Small pieces of HTML. Whatever is not marked as markup is escaped, so no name can become code."""

from __future__ import annotations

import html
from collections.abc import Container, Iterable, Sequence
from typing import Any

from bayeshunt.views import theme

__all__ = ["Html", "card", "facts", "fold", "join", "number", "probability", "row", "table", "tag"]


class Html(str):
    """Text that is markup already."""

    __slots__ = ()


def tag(name: str, /, *content: Any, **attributes: Any) -> Html:
    """Return ``<name ...>content</name>``; content that is not :class:`Html` is escaped, None left out.

    Attribute names lose a trailing underscore (``class_``), others become hyphens; None leaves one
    out, True writes it without a value.
    """
    parts = [f"<{name}"]
    for key, value in attributes.items():
        if value is None or value is False:
            continue
        key = key.rstrip("_").replace("_", "-")
        parts.append(f" {key}" if value is True else f' {key}="{html.escape(str(value))}"')
    if name in ("input", "img"):  # a void element: no content, no end tag
        return Html("".join(parts) + ">")
    return Html("".join(parts) + ">" + join(content) + f"</{name}>")


def join(content: Iterable[Any]) -> Html:
    """Return pieces one after the other; what is not markup is escaped, None left out."""
    return Html("".join(c if isinstance(c, Html) else html.escape(str(c)) for c in content if c is not None))


def card(title: str, subtitle: str, *content: Any) -> Html:
    """Return a whole display with its style sheet: what ``_repr_html_`` gives."""
    head = [tag("div", title, class_="bh-title"), tag("div", subtitle, class_="bh-sub")]
    return join([tag("style", Html(theme.style())), tag("div", *head, *content, class_="bh")])


def facts(pairs: Iterable[tuple[str, Any]]) -> Html:
    """Return names and values side by side."""
    return tag("dl", *(tag("div", tag("dt", name), tag("dd", value)) for name, value in pairs), class_="bh-facts")


def fold(title: str, *content: Any, open_: bool = False) -> Html:
    """Return content that opens at a click."""
    return tag("details", tag("summary", title), *content, open=open_ or None)


def table(
    columns: Sequence[str], rows: Iterable[Html], *, class_: str | None = None, words: Container[int] = ()
) -> Html:
    """Return a scrolling table with a sticky header; ``rows`` are ``<tr>``, ``words`` the columns set to the left."""
    # An empty heading would be read out as one; an empty cell is passed over.
    heads = (
        tag("th", name, scope="col", class_="bh-left" if i in words else None) if name else tag("td")
        for i, name in enumerate(columns)
    )
    head = tag("thead", tag("tr", *heads))
    # Focusable, so that the keyboard scrolls it; named, so that a screen reader says what has the focus.
    place = {"role": "group", "aria_label": f"table by {columns[0]}, scrolls"}
    return tag("div", tag("table", head, tag("tbody", *rows), class_=class_), class_="bh-scroll", tabindex="0", **place)


def row(name: Any, cells: Iterable[Any], *, lit: bool = False, class_: str | None = None) -> Html:
    """Return a table row: a header cell, then plain cells (``<td>`` elements are kept); it may stand out."""
    plain = (c if isinstance(c, Html) and c.startswith("<td") else tag("td", c) for c in cells)
    return tag("tr", tag("th", name, scope="row"), *plain, class_="bh-lit" if lit else class_)


def number(value: float, digits: int = 3) -> str:
    """Return a number to read: "-" where there is none, a true minus, no needless digits."""
    if value is None or value != value:
        return "-"
    if value in (float("inf"), float("-inf")):
        return "∞" if value > 0 else "−∞"
    return f"{value:.{digits}g}".replace("-", "−")


def probability(value: float) -> str:
    """Return a probability to read: three decimals, "<.001" for the smallest, "·" for 0."""
    if value == 0:
        return "·"
    if value < 0.0005:
        return "<.001"
    return f"{value:.3f}".lstrip("0")
