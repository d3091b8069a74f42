"""What a network file says, as plain data: variables, states, parents, tables; and all that can be wrong with it.

The readers of BIF and XMLBIF hand over what they found with the lines where it stands; :func:`assemble` turns it into
tables or says in one line what contradicts, misses or exceeds. Letters: K states of a variable.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter
from typing import NamedTuple

import numpy as np

from bayeshunt.core.errors import InputError
from bayeshunt.models.counting.cells import MAX_TABLE_CELLS

__all__ = [
    "ROUNDING",
    "Definition",
    "NetworkTables",
    "Row",
    "Source",
    "Variable",
    "assemble",
    "duplicate",
    "few",
    "numbers",
]

#: Columns of a file may miss 1 by this much, since programs round what they write; they are rescaled.
ROUNDING = 1e-3
#: An error lists this many names, and the number of the others.
_FEW = 5


class Variable(NamedTuple):
    """A variable as declared, and the line where that is."""

    name: str
    states: tuple[str, ...]
    line: int


class Row(NamedTuple):
    """P(child | parents) for one combination of the parents' states; ``states`` None: for all that have no row."""

    states: tuple[str, ...] | None
    values: list[float]
    line: int


class Definition(NamedTuple):
    """The table of one variable: whole (``values``), or in rows.

    child_first: the child varies slowest in ``values`` (BIF), else fastest (XMLBIF); parents keep their order.
    """

    child: str
    parents: tuple[str, ...]
    line: int
    values: list[float] | None
    child_first: bool
    rows: tuple[Row, ...] = ()


@dataclass(frozen=True)
class NetworkTables:
    """A discrete Bayesian network, in the file's order of variables and states.

    states: of each variable. parents: of each variable. tables: P(variable | parents) [K, ...parents], float64,
    not negative; a column may miss 1 by ``ROUNDING``.
    """

    states: Mapping[str, tuple[str, ...]]
    parents: Mapping[str, tuple[str, ...]]
    tables: Mapping[str, np.ndarray]

    @property
    def edges(self) -> tuple[tuple[str, str], ...]:
        """(parent, child) of every edge."""
        return tuple((parent, child) for child, parents in self.parents.items() for parent in parents)


class Source:
    """The file that is read, for messages."""

    def __init__(self, name: str) -> None:
        self.name = name

    def error(self, line: int, text: str) -> InputError:
        """Return the error that says what is wrong on a line."""
        return InputError(f"{self.name}, line {line}: {text}")


def few(names: Iterable[str]) -> str:
    """Return some of many names in one line: "a, b, c, d, e and 408 more"."""
    shown = [_short(name) for name in names]
    rest = len(shown) - _FEW
    return ", ".join(shown) if rest <= 1 else f"{', '.join(shown[:_FEW])} and {rest} more"


def numbers(words: Sequence[str], source: Source, line: int, what: str) -> list[float]:
    """Return probabilities; InputError for a word that is no number, or one that is negative or not finite."""
    try:
        if any("_" in word or not word.isascii() for word in words):  # Python would take 1_0
            raise ValueError
        values = list(map(float, words))
    except ValueError:
        wrong = next(word for word in words if not _is_number(word))
        raise source.error(line, f"{what}: expected a probability, got {_short(wrong)!r}") from None
    for value in values:
        if not (value >= 0 and value < math.inf):
            raise source.error(line, f"{what}: {value:g} is no probability")
    return values


def assemble(variables: Sequence[Variable], definitions: Sequence[Definition], source: Source) -> NetworkTables:
    """Return the network; InputError in one line for anything that is missing, given twice or contradictory."""
    if not variables:
        raise InputError(f"{source.name}: holds no network (no variable is declared)")
    declared: dict[str, Variable] = {}
    for variable in variables:
        _check_variable(variable, declared, source)
        declared[variable.name] = variable
    states = {name: variable.states for name, variable in declared.items()}
    defined: dict[str, Definition] = {}
    for found in definitions:
        _check_definition(found, states, defined, source)
        defined[found.child] = found
    for name, variable in declared.items():
        if name not in defined:
            raise source.error(variable.line, f"variable {_short(name)} has no table")
    parents = {name: defined[name].parents for name in declared}
    try:
        tuple(TopologicalSorter(parents).static_order())
    except CycleError as error:
        circle = " -> ".join(map(_short, reversed(error.args[1])))
        raise source.error(defined[error.args[1][0]].line, f"the edges run in a circle: {circle}") from None
    return NetworkTables(states, parents, {name: _table(defined[name], states, source) for name in declared})


def _check_variable(variable: Variable, declared: Mapping[str, Variable], source: Source) -> None:
    name = _short(variable.name)
    if not variable.name:
        raise source.error(variable.line, "a variable without a name")
    if variable.name in declared:
        first = declared[variable.name].line
        raise source.error(variable.line, f"variable {name} is declared twice (first on line {first})")
    if not variable.states:
        raise source.error(variable.line, f"variable {name} has no states")
    twice = duplicate(variable.states)
    if twice is not None:
        raise source.error(variable.line, f"variable {name}: the state {_short(twice)!r} is named twice")
    if "" in variable.states:
        raise source.error(variable.line, f"variable {name}: a state without a name")


def _check_definition(
    found: Definition, states: Mapping[str, Sequence[str]], defined: Mapping[str, Definition], source: Source
) -> None:
    child = _short(found.child)
    for name in (found.child, *found.parents):
        if name not in states:
            kind = "variable" if name == found.child else f"table of {child}: parent"
            known = few(states)
            raise source.error(found.line, f"{kind} {_short(name)!r} is not declared; the file has {known}")
    if found.child in defined:
        first = defined[found.child].line
        raise source.error(found.line, f"the table of {child} is given twice (first on line {first})")
    twice = duplicate(found.parents)
    if twice is not None:
        raise source.error(found.line, f"table of {child}: the parent {_short(twice)} is named twice")
    cells = math.prod(len(states[name]) for name in (found.child, *found.parents))
    if cells > MAX_TABLE_CELLS:
        raise source.error(found.line, f"table of {child}: {cells:,} cells; the most is {MAX_TABLE_CELLS:,}")


def _table(found: Definition, states: Mapping[str, tuple[str, ...]], source: Source) -> np.ndarray:
    """P(child | parents) [K, ...parents], checked."""
    own, given = len(states[found.child]), [len(states[parent]) for parent in found.parents]
    if found.values is None:
        values = np.moveaxis(_of_rows(found, states, source), -1, 0)
    else:
        cells = own * math.prod(given)
        if len(found.values) != cells:
            raise source.error(
                found.line, f"table of {_short(found.child)}: {len(found.values)} probabilities; expected {cells}"
            )
        shape = [own, *given] if found.child_first else [*given, own]
        values = np.array(found.values).reshape(shape)
        values = values if found.child_first else np.moveaxis(values, -1, 0)
    totals = values.sum(axis=0)
    wrong = np.argwhere(~(np.abs(totals - 1.0) <= ROUNDING))
    if len(wrong):
        place = tuple(wrong[0].tolist())
        chosen = tuple(states[parent][i] for parent, i in zip(found.parents, place, strict=True))
        line = next((row.line for row in found.rows if row.states == chosen), found.line)
        text = f"table of {_short(found.child)}{_given(chosen)} is not a distribution: it sums to {totals[place]:.6g}"
        raise source.error(line, text)
    return values


def _of_rows(found: Definition, states: Mapping[str, tuple[str, ...]], source: Source) -> np.ndarray:
    """P(child | parents) [...parents, K] of a table that is given in rows."""
    child, own = _short(found.child), len(states[found.child])
    positions = [{state: i for i, state in enumerate(states[parent])} for parent in found.parents]
    values = np.full([len(known) for known in positions] + [own], np.nan)
    lines: dict[tuple[int, ...] | None, int] = {}
    for row in found.rows:
        name = "the default row" if row.states is None else f"row{_given(row.states)}"
        if len(row.values) != own:
            raise source.error(row.line, f"table of {child}, {name}: {len(row.values)} probabilities; expected {own}")
        place = None if row.states is None else _place(row, positions, found, source)
        if place in lines:
            raise source.error(row.line, f"table of {child}: {name} is given twice (first on line {lines[place]})")
        lines[place] = row.line
        if place is not None:
            values[place] = row.values
    default = next((row.values for row in found.rows if row.states is None), None)
    missing = np.isnan(values).any(axis=-1)
    if default is not None:
        values[missing] = default
    elif missing.any():
        place = tuple(np.argwhere(missing)[0].tolist())
        chosen = tuple(states[parent][i] for parent, i in zip(found.parents, place, strict=True))
        raise source.error(
            found.line, f"table of {child}: no row{_given(chosen)}" if chosen else f"{child} has no table"
        )
    return values


def _place(row: Row, positions: Sequence[Mapping[str, int]], found: Definition, source: Source) -> tuple[int, ...]:
    """Where a row stands in the table."""
    child, named = _short(found.child), row.states or ()
    if len(named) != len(positions):
        text = f"table of {child}, row{_given(named)}: {len(named)} states for {len(positions)} parents"
        raise source.error(row.line, text)
    for state, known, parent in zip(named, positions, found.parents, strict=True):
        if state not in known:
            text = f"table of {child}, row{_given(named)}: {_short(parent)} has no state {_short(state)!r}"
            raise source.error(row.line, f"{text}; it has {few(known)}")
    return tuple(known[state] for state, known in zip(named, positions, strict=True))


def duplicate(names: Iterable[str]) -> str | None:
    """Return the first name that comes a second time, or None."""
    seen: set[str] = set()
    for name in names:
        if name in seen:
            return name
        seen.add(name)
    return None


def _given(states: Sequence[str]) -> str:
    return f" ({few(states)})" if states else ""


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return word.isascii() and "_" not in word


def _short(text: str) -> str:
    """A name from a file that may be anything, fit for one line."""
    plain = "".join(c if c.isprintable() else "?" for c in text)
    return plain if len(plain) <= 40 else f"{plain[:37]}..."
