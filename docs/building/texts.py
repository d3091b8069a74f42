"""Docstrings and help as Markdown."""

from __future__ import annotations

import inspect
import re
import textwrap
from typing import Any

_ROLE = re.compile(r":[a-z]+:`~?\.?([^`]+)`")


def without_roles(text: str) -> str:
    """Text whose roles, :func:`name` and the like, are code."""
    return _ROLE.sub(r"`\1`", text)


def first_line(thing: Any) -> str:
    """The first line of its docstring, fit for a cell of a table."""
    line = (inspect.getdoc(thing) or "").splitlines()[:1]
    return without_roles(line[0] if line else "").replace("|", "\\|")


def escaped(text: str) -> str:
    """Text for a cell of a table."""
    return " ".join(str(text).split()).replace("|", "\\|").replace("<", "&lt;").replace("*", "\\*")


def plain(text: str) -> str:
    """A docstring's text as Markdown."""
    return without_roles(textwrap.dedent(text)).replace("``", "`")
