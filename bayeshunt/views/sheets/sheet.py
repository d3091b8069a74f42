"""One way to show a thing: a title, facts by name, and parts, as text for a terminal or as HTML for a notebook.

Every thing that shows itself has one function that returns its sheet. A part is a table, bars, or a note that both
forms show, or something that only one of them can: a drawing, a fold.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, Protocol

from bayeshunt.core.units import bounds, true_minus
from bayeshunt.views.notebook.html import Html, card, facts, fold, join, row, table, tag
from bayeshunt.views.terminal.text_tables import align, clean, printable

__all__ = ["Bars", "Drawn", "Note", "Opening", "Part", "Printed", "Sheet", "Table"]

_WIDTH = 100  # columns of running text, at most
_BAR = 24  # characters of a full bar


class Part(Protocol):
    """What a sheet is made of."""

    def lines(self) -> list[str]:
        """Return it as lines of text; none if text cannot show it."""

    def html(self) -> Html | None:
        """Return it as HTML; None if it is for text only."""


class Table(NamedTuple):
    """Rows under named columns; the first cell names its row.

    lit: rows that stand out. words: columns set to the left. left_out: what else there is. most: rows of text.
    opens: the panel of each row that has one, by its id.
    """

    columns: Sequence[str]
    rows: Sequence[Sequence[Any]]
    lit: frozenset[int] = frozenset()
    words: frozenset[int] = frozenset({0})
    left_out: str = ""
    most: int = 60
    opens: dict[int, str] | None = None

    def lines(self) -> list[str]:
        """Return aligned lines; names are cut."""
        rows = [[clean(cell, 40 if at else 24) for at, cell in enumerate(cells)] for cells in self.rows[: self.most]]
        rest = len(self.rows) - len(rows)
        more = [f"({text})" for text in (f"and {rest} more rows" if rest else "", self.left_out) if text]
        return [*align(self.columns, rows, left=set(self.words)), *more]

    def html(self) -> Html:
        """Return a scrolling table with its note."""
        left = [i in self.words for i in range(len(self.columns))]
        rows = [
            row(
                _button(cells[0], i, self.opens),
                (_cell(cell, at) for cell, at in zip(cells[1:], left[1:], strict=True)),
                lit=i in self.lit,
            )
            for i, cells in enumerate(self.rows)
        ]
        note = tag("div", self.left_out, class_="bh-note") if self.left_out else None
        return join([table(self.columns, rows, words=self.words), note])


class Bars(NamedTuple):
    """Probabilities by name, one of which may stand out.

    within: the interval of each, low and high; None where nobody knows. opens: the panel of each, by its id.
    """

    shares: dict[str, float]
    lit: str | None = None
    within: dict[str, tuple[float, float]] | None = None
    opens: dict[str, str] | None = None

    def lines(self) -> list[str]:
        """Return a line per name: name, bar, probability."""
        names = {name: clean(name) for name in self.shares}
        width = max(map(len, names.values()))
        return [
            f"{names[n]:<{width}}  {'█' * round(p * _BAR):<{_BAR}}  {self._said(n)}" for n, p in self.shares.items()
        ]

    def _said(self, name: str) -> str:
        """The probability and, where it is known, between what it may lie: "1.0000 (0.24 to 1)"."""
        return f"{self.shares[name]:.4f}" + (f" ({bounds(*self.within[name])})" if self.within else "")

    def html(self) -> Html:
        """Return a bar chart."""
        top = max([*self.shares.values(), 1e-300])
        end = max([top, *(high for _, high in (self.within or {}).values())])
        rows = []
        for name, share in self.shares.items():
            said = f"{share:.4f}"
            # the shortest bar is still a stub, which would contradict a printed zero
            bar = tag("span", class_="bh-bar", style=f"width:{100 * share / top:.1f}%") if float(said) else ""
            inner = tag("div", bar, self._whisker(name, top), class_="bh-scale", style=f"width:{100 * top / end:.1f}%")
            rows.append(
                row(
                    _button(name, name, self.opens),
                    [tag("td", inner, class_="bh-track"), self._said(name)],
                    lit=name == self.lit,
                )
            )
        heads = ["Gait", "", "probability" if self.within is None else "probability (95 % interval)"]
        return table(heads, rows, class_="bh-bars")

    def _whisker(self, name: str, top: float) -> Any:
        """A line over the bar from the low to the high end of its interval."""
        if self.within is None:
            return ""
        low, high = self.within[name]
        place = f"left:{100 * low / top:.1f}%;width:{100 * (high - low) / top:.1f}%"
        return tag("span", class_="bh-whisker", style=place)


class Opening(NamedTuple):
    """Bars or a table whose names open panels, made only when HTML is asked for.

    make: returns the id of each one's panel, and the panels.
    """

    make: Callable[[], tuple[dict[Any, str], Html]]
    shown: Bars | Table

    def lines(self) -> list[str]:
        """Return them as lines."""
        return self.shown.lines()

    def html(self) -> Html:
        """Return them and their panels."""
        ids, panels = self.make()
        return join([self.shown._replace(opens=ids).html(), panels])


class Note(NamedTuple):
    """A sentence or two."""

    words: str

    def lines(self) -> list[str]:
        """Return it filled."""
        return textwrap.wrap(printable(self.words), _WIDTH)

    def html(self) -> Html:
        """Return it in small type."""
        return tag("div", self.words, class_="bh-note")


class Drawn:
    """Parts of HTML that text has not, made only when HTML is asked for; side by side, or in a fold with a title.

    content: parts, pieces of HTML, or functions that return one.
    """

    def __init__(self, *content: Any, title: str | None = None, beside: bool = False, opened: bool = False) -> None:
        self._content, self._title, self._beside, self._opened = content, title, beside, opened

    def lines(self) -> list[str]:
        """Return nothing."""
        return []

    def html(self) -> Html:
        """Return them."""
        made = [piece() if callable(piece) else piece for piece in self._content]
        parts = [piece.html() if hasattr(piece, "html") else piece for piece in made]
        shown = tag("div", *parts, class_="bh-two") if self._beside else join(parts)
        return shown if self._title is None else fold(self._title, shown, open_=self._opened)


class Printed(NamedTuple):
    """A part of text that HTML has in another form, made only when text is asked for."""

    make: Callable[[], Sequence[str]]

    def lines(self) -> list[str]:
        """Return its lines."""
        return list(self.make())

    def html(self) -> None:
        """Return nothing."""


class Sheet(NamedTuple):
    """One thing to show: a title, what it is, facts by name, and parts in their order."""

    title: str
    subtitle: str = ""
    pairs: Sequence[tuple[str, Any]] = ()
    parts: Sequence[Part | None] = ()

    def text(self) -> str:
        """Return it as lines of text, without anything that a terminal would obey."""
        joint = "\n" if ":" in self.title else ": "  # one colon in a line is enough
        heads = f"{self.title}{joint}{self.subtitle}".splitlines() if self.subtitle else [self.title]
        width = max((len(name) for name, _ in self.pairs), default=0)
        lines = [line for head in heads for line in textwrap.wrap(printable(" ".join(head.split())), _WIDTH)]
        for name, value in self.pairs:
            filled = textwrap.wrap(printable(" ".join(str(value).split())), _WIDTH, subsequent_indent=" " * (width + 2))
            lines += [f"{name:<{width}}  {filled[0] if filled else ''}".rstrip(), *filled[1:]]
        for part in self.parts:
            some = part.lines() if part is not None else []
            lines += ["", *some] if some else []
        return "\n".join(line.rstrip() for line in lines)

    def html(self) -> str:
        """Return it as a display of its own: a plain str, as every notebook takes it."""
        known = facts((name, true_minus(str(value))) for name, value in self.pairs) if self.pairs else None
        return str(card(self.title, self.subtitle, known, *(part.html() for part in self.parts if part is not None)))


def _button(name: Any, key: Any, opens: dict[Any, str] | None) -> Any:
    """A name, which opens its panel where it has one."""
    if opens is None or key not in opens:
        return name
    return tag("button", name, type="button", popovertarget=opens[key])


def _cell(cell: Any, left: bool) -> Any:
    if isinstance(cell, Html):
        return cell
    text = true_minus(str(cell))
    return tag("td", text, class_="bh-left") if left else text
