"""One way to lay out a table as text, in a terminal or in a string: no number is ever cut or folded.

A table that is too wide for its terminal gives way in this order: columns that fold take more lines, the
widest first, down to what they keep at least or to their longest number or word; after that the lines outgrow the
terminal, which wraps them. Columns of words (to be copied, or to tell rows apart) and of numbers stay whole.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from io import StringIO
from typing import Any, NamedTuple

from rich import box
from rich.cells import cell_len
from rich.console import Console
from rich.table import Table
from rich.text import Text

__all__ = [
    "Column",
    "TextTable",
    "align",
    "clean",
    "folding",
    "number",
    "printable",
    "string_console",
    "toml_text",
    "word",
]

#: The rule below the head for terminals that have no lines to draw with.
_PLAIN_HEAD = box.Box("    \n    \n -- \n    \n    \n    \n    \n    \n", ascii=True)
_LONGEST = 24  # characters of a word that no column cuts
_WIDE = 100_000  # characters: room for any table


class Column(NamedTuple):
    """A column: its head, and whether it is set to the right and may fold, to no fewer characters than ``least``."""

    name: str
    right: bool = False
    folds: bool = False
    least: int = 8


def folding(name: str, least: int = 8) -> Column:
    """Return a column of names or running text, the one that gives way in a narrow terminal."""
    return Column(name, folds=True, least=least)


def word(name: str) -> Column:
    """Return a column whose words stay whole."""
    return Column(name)


def number(name: str) -> Column:
    """Return a column of numbers."""
    return Column(name, right=True)


def toml_text(value: Any) -> str:
    """Return a value as TOML writes it, text without its quotes and lists without their brackets; "none" if it is."""
    if value is None or isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (list, tuple)):
        return ", ".join(map(toml_text, value))
    return f"{value:g}" if isinstance(value, float) else "" if value == {} else str(value)


class TextTable:
    """A table to print or to put into a string.

    columns: names alone are columns of numbers. title: a line above. ruled: with a line below the head.
    head: whether there is one.
    """

    def __init__(
        self, *columns: Column | str, title: str = "", style: str = "italic", ruled: bool = True, head: bool = True
    ) -> None:
        self.columns = [number(c) if isinstance(c, str) else c for c in columns]
        self.title, self.style, self.ruled, self.head = title, style, ruled, head
        self.rows: list[tuple[list[Text], str | None]] = []
        self.sections: set[int] = set()

    def row(self, *cells: Any, style: str | None = None) -> None:
        """Add a row; cells are taken as they are written, without markup."""
        texts = [cell if isinstance(cell, Text) else Text(str(cell)) for cell in cells]
        if len(texts) != len(self.columns):
            raise ValueError(f"{len(texts)} cells for {len(self.columns)} columns")
        self.rows.append((texts, style))

    def section(self) -> None:
        """Leave a gap before the next row."""
        self.sections.add(len(self.rows))

    def print(self, console: Console) -> None:
        """Print the table as wide as the console, or as wide as its numbers need."""
        if self.title:
            console.print(Text(self.title, style=self.style), soft_wrap=True)
        console.print(self._fitted(console), crop=False)

    def lines(self) -> list[str]:
        """Return the lines of the table, as wide as it need be, without trailing blanks."""
        page = string_console(_WIDE)
        self.print(page)
        return [line.rstrip() for line in page.file.getvalue().splitlines()]  # type: ignore[attr-defined]

    def _fitted(self, console: Console) -> Table:
        """The table for a console, its widths chosen."""
        widths, leasts = self._widths()
        table = self._table(console, widths)
        spare = console.measure(table, options=console.options.update(max_width=_WIDE)).maximum - console.width
        while spare > 0 and (foldable := [i for i, width in enumerate(widths) if width > leasts[i]]):
            widths[max(foldable, key=widths.__getitem__)] -= 1
            spare -= 1
        table = self._table(console, widths)
        if spare > 0:
            table.width = console.width + spare
        return table

    def _widths(self) -> tuple[list[int], list[int]]:
        """The characters that each column would take, and those that it keeps at least."""
        widths, leasts = [], []
        for index, column in enumerate(self.columns):
            cells = [*([column.name] if self.head else []), *(cells[index].plain for cells, _ in self.rows)]
            widest = max((cell_len(line) for cell in cells for line in cell.splitlines()), default=0)
            words = [(part, cell_len(part)) for cell in cells for word in cell.split() for part in _pieces(word)]
            numbers = [size if any(map(str.isdigit, part)) else min(size, _LONGEST) for part, size in words]
            widths.append(widest)
            leasts.append(min(widest, max(column.least, *numbers, 0)) if column.folds else widest)
        return widths, leasts

    def _table(self, console: Console, widths: list[int]) -> Table:
        rule = _PLAIN_HEAD if console.options.ascii_only else box.SIMPLE_HEAD
        padding = (0, 1 if self.ruled else 2, 0, 0)
        table = Table(box=rule if self.ruled else None, show_header=self.head, pad_edge=False, padding=padding)
        for column, width in zip(self.columns, widths, strict=True):
            justify: Any = "right" if column.right else "left"
            table.add_column(Text(column.name), justify=justify, overflow="fold", no_wrap=not column.folds, width=width)
        for place, (cells, style) in enumerate(self.rows):
            if place in self.sections:
                table.add_section()
            broken = (
                _broken(c, w) if column.folds else c for c, w, column in zip(cells, widths, self.columns, strict=True)
            )
            table.add_row(*broken, style=style)
        return table


def _pieces(word: str) -> list[str]:
    """The pieces of a name that may stand in lines of their own: "proportional_" and "navigation"."""
    return re.split(r"(?<=_)(?=[^_])", word)


def _broken(cell: Text, width: int) -> Text:
    """A cell whose names that are wider than ``width`` are broken where their pieces end, not amid a word."""
    if "_" not in cell.plain or all(cell_len(word) <= width for word in cell.plain.split()):
        return cell
    words = ("\n".join(_pieces(word)) if cell_len(word) > width else word for word in cell.plain.split(" "))
    return Text(" ".join(words), style=cell.style)


def string_console(width: int) -> Console:
    """Return a console whose ``file`` is a string in memory, without colours."""
    return Console(
        file=StringIO(), width=width, color_system=None, highlight=False, markup=False, force_jupyter=False,
        force_terminal=False, legacy_windows=False,
    )  # fmt: skip


def align(head: Sequence[str], rows: Sequence[Sequence[str]], *, left: set[int] | None = None) -> list[str]:
    """Return lines of a table with two spaces between columns; columns ``left`` are left-aligned."""
    lefts = {0} if left is None else left
    table = TextTable(*(word(name) if i in lefts else number(name) for i, name in enumerate(head)), ruled=False)
    for row in rows:
        table.row(*row)
    return table.lines()


def clean(name: Any, length: int = 24) -> str:
    """Return a name on one line, without control characters that a terminal would obey, cut to ``length``."""
    text = printable(name)
    return text if len(text) <= length else text[: length - 1] + "…"


def printable(text: Any) -> str:
    """Return text on one line, without control characters that a terminal would obey."""
    return "".join(c if c.isprintable() else "�" for c in str(text))
