"""Docstrings as this project writes them, as Markdown: "name: meaning" lines become a list, roles become code."""

from __future__ import annotations

import re
from typing import Any

from griffe import Class, Extension, Function, Object
from texts import without_roles

__all__ = ["HouseStyle", "as_markdown"]

_ENTRY = re.compile(r"^(\*{0,2}\w+(?:, \*{0,2}\w+)*): (.*)$")


def as_markdown(text: str, names: set[str]) -> str:
    """Return a docstring whose lines "name: meaning" of these names are list items."""
    lines: list[str] = []
    inside = False
    for line in without_roles(text).splitlines():
        entry = _ENTRY.match(line)
        if entry and {name.strip("* ") for name in entry[1].split(",")} <= names:
            if not inside:
                lines.append("")
            said = ", ".join(f"`{name.strip()}`" for name in entry[1].split(","))
            lines.append(f"- {said}: {entry[2]}")
            inside = True
        elif inside and line and not line.startswith(" "):
            lines += ["", line]
            inside = False
        else:
            lines.append(line)
            inside = inside and bool(line)
    return "\n".join(lines)


class HouseStyle(Extension):
    """Rewrites every docstring that is read."""

    def on_object(self, *, obj: Object, **_: Any) -> None:
        """Rewrite one."""
        if obj.docstring is None:
            return
        names = {parameter.name for parameter in obj.parameters} if isinstance(obj, Function) else set(obj.members)
        if isinstance(obj, Class) and "__init__" in obj.members and isinstance(obj.members["__init__"], Function):
            names |= {parameter.name for parameter in obj.members["__init__"].parameters}
        obj.docstring.value = as_markdown(obj.docstring.value, names)
