"""What there is to choose from, in a terminal: planners, robots, prey and presets."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from typing import Any

from rich.text import Text

from bayeshunt.views.terminal.terminal import out
from bayeshunt.views.terminal.text_tables import TextTable, folding, toml_text, word

__all__ = ["names_table", "planner_page", "planners_table"]

_WIDTH = 100  # columns of running text, at most
_SOME = 16  # and at least


def names_table(columns: Sequence[str], rows: Iterable[Sequence[str]], notes: Iterable[str]) -> None:
    """Print a row for each thing there is, the name first and what it is last, and notes below."""
    table = TextTable(*map(word, columns[:-1]), folding(columns[-1], _SOME))
    for row in rows:
        table.row(*row)
    table.print(out)
    for note in notes:
        out.print(note, style="dim")


def planners_table(found: Sequence[Any]) -> None:
    """Print a row for each planner: its name, what it cannot do without, what it is."""
    rows = [
        (f.name + ("" if f.ab_initio else " *"), _needs(f), f.summary + ("" if f.shipped else " (yours)"))
        for f in found
    ]
    notes = ["* Not ab initio: given more than it learns within the run (a bound, or earlier experience)."]
    files = {command: f"{command} --out FILE" for f in found for command in f.needs.values() if command}
    notes += [f"A file that a planner needs is made by {', '.join(files.values())}."] if files else []
    notes += ["Settings, range and reference of one: bayeshunt planners NAME"]
    names_table(("planner", "needs", "what it does"), rows, notes)


def _needs(facts: Any) -> str:
    needs = [f"file: {name}" for name in facts.needs]
    return ", ".join([*needs, *(["the future"] if facts.needs_future else [])])


def planner_page(facts: Any) -> None:
    """Print all that is known of one planner: what it does, its settings, and how to change one."""
    width = min(_WIDTH, out.width)
    out.print(Text(f"{facts.name}: {facts.summary}.", style="bold"), width=width)
    if facts.details:
        out.print()
        for paragraph in facts.details.split("\n\n"):
            out.print(_filled(paragraph, width), end="\n\n")
    pairs = [("ab initio", "yes" if facts.ab_initio else "no: given more than it learns within the run")]
    pairs += [
        ("needs", f"{name}, a file made by {command or 'you'} --out FILE") for name, command in facts.needs.items()
    ]
    pairs += [("needs", "the prey's true future, which only an evaluation hands in")] if facts.needs_future else []
    pairs += [("reference", facts.reference)] if facts.reference else []
    for name, text in pairs:
        out.print(Text(textwrap.fill(text, width, initial_indent=f"{name:<11}", subsequent_indent=" " * 11)))
    if not facts.settings:
        out.print("It has no settings.")
        return
    out.print()
    table = TextTable(word("setting"), *map(folding, ("type", "range", "default", "meaning")))
    for s in facts.settings:
        table.row(s.name, s.kind, s.range, toml_text(s.default), s.meaning)
    table.print(out)
    _how_to_set(facts)


def _how_to_set(facts: Any) -> None:
    """Print how one setting is changed, on the command line and in a settings file."""
    some = next((s for s in facts.settings if s.default is not None), facts.settings[0])
    value = "FILE" if some.kind == "file" else toml_text(some.default)
    plugin = "" if facts.shipped else "--plugin FILE.py "
    out.print(
        f"Change one:  bayeshunt {plugin}evaluate --planner {facts.name} "
        f"--set planner.{facts.name}.{some.name}={value}",
        soft_wrap=True,
    )
    out.print("or in a settings file, given with --config:")
    quoted = f'"{value}"' if some.kind in ("file", "text") else value
    out.print(f'  base = "paper"\n\n  [planner.{facts.name}]\n  {some.name} = {quoted}')


def _filled(paragraph: str, width: int) -> Text:
    """A paragraph filled to ``width``; lists and indented lines stay as they are."""
    lines = paragraph.splitlines()
    kept = any(line.startswith((" ", "-")) or line[:2].rstrip(".").isdigit() for line in lines)
    return Text(paragraph if kept else textwrap.fill(" ".join(lines), width))
