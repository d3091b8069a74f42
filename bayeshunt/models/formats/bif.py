"""Reading BIF, the interchange format 0.15, as bnlearn, pgmpy, pyAgrum, SamIam and JavaBayes write it.

Names may be quoted; commas, and the bar before the parents, may be left out, as the format has it. A list of states is
split at its commas, or at blanks, whichever gives as many states as are declared; so names may hold blanks and
brackets, and commas within quotes. Source: Cozman, "The Interchange Format for Bayesian Networks" (1998),
https://www.cs.washington.edu/dm/vfml/appendixes/bif.htm.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Sequence
from typing import NamedTuple, NoReturn

from bayeshunt.core.errors import InputError
from bayeshunt.models.formats.network_tables import (
    Definition,
    NetworkTables,
    Row,
    Source,
    Variable,
    assemble,
    few,
    numbers,
)

__all__ = ["Token", "read"]

_TOKEN = re.compile(
    r"""(?P<comment>//[^\n]*|/\*.*?\*/)"""
    r"""|"(?:[^"\\]|\\.)*"|[{}()\[\],;|]|(?:(?!//|/\*)[^\s{}()\[\],;|])+|/\*""",
    re.DOTALL,
)
_CLOSING = {"{": "}", "(": ")"}


class Token(NamedTuple):
    """A piece of the text and where it begins."""

    text: str
    start: int


def read(data: bytes, name: str) -> NetworkTables:
    """Return the network in the bytes of a BIF file called ``name``; InputError in one line if there is none."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise Source(name).error(line, "not a readable BIF network: it is no text in UTF-8") from None
    return _Parser(text, name).network()


class _Parser:
    """Recursive descent over the tokens of one file."""

    def __init__(self, text: str, name: str) -> None:
        self.source = Source(name)
        self._newlines = [match.start() for match in re.finditer("\n", text)]
        self._tokens = [Token(m[0], m.start()) for m in _TOKEN.finditer(text) if m["comment"] is None]
        self._next = 0
        self._within = "the network"
        self._variables: list[Variable] = []
        self._definitions: list[Definition] = []

    def network(self) -> NetworkTables:
        """Parse the whole file."""
        if not self._tokens:
            raise InputError(f"{self.source.name}: holds no network (the file is empty)")
        blocks = {"network": self._header, "variable": self._variable, "probability": self._probability}
        while self._next < len(self._tokens):
            token = self._take()
            if token.text not in blocks:
                self._fail(token, "expected 'network', 'variable' or 'probability'")
            self._within = f"the {token.text} that begins on line {self._line(token)}"
            blocks[token.text](token)
        return assemble(self._variables, self._definitions, self.source)

    # --- blocks -------------------------------------------------------------------------------

    def _header(self, start: Token) -> None:
        if start is not self._tokens[0]:
            self._fail(start, "expected one network, at the beginning")
        self._until("{")
        while (token := self._take()).text != "}":
            self._property(token, "'property' or '}'")

    def _variable(self, start: Token) -> None:
        name, states = _joined(self._until("{")), None
        while (token := self._take()).text != "}":
            if token.text != "type":
                self._property(token, "'type', 'property' or '}'")
            elif states is not None:
                self._fail(token, f"variable {name}: a second type")
            else:
                states = self._states(name)
        if states is None:
            raise self.source.error(self._line(start), f"variable {name} has no type with its states")
        self._variables.append(Variable(name, states, self._line(start)))

    def _states(self, name: str) -> tuple[str, ...]:
        """What follows "type": discrete [ 2 ] { go, turn };"""
        self._expect("discrete", f"variable {name}: ")
        token, size = self._take(), None
        if token.text == "[":
            count = self._take()
            if not count.text.isdecimal():
                self._fail(count, f"variable {name}: expected the number of states")
            size = int(count.text)
            self._expect("]")
            token = self._take()
        if token.text != "{":
            self._fail(token, f"variable {name}: expected '{{' before the states")
        listed = self._region("{")
        self._expect(";", f"variable {name}: ")
        splits = _splits(listed)
        if size is None:
            return splits[0]
        for states in splits:
            if len(states) == size:
                return states
        text = f"variable {name}: {size} states are declared and {len(splits[0])} listed ({few(splits[0])})"
        hint = "; names that hold commas need quotes" if len(splits[0]) > size else ""
        raise self.source.error(self._line(token), text + hint)

    def _probability(self, start: Token) -> None:
        self._expect("(")
        head, line = self._region("("), self._line(start)
        bar = next((i for i, token in enumerate(head) if token.text == "|"), None)
        if bar is None:  # the bar may be left out: then the first is the child
            child, *parents = _splits(head)[0] or ("",)
        else:
            child, parents = _joined(head[:bar]), list(_splits(head[bar + 1 :])[0])
        self._expect("{")
        self._definitions.append(self._table(child, tuple(parents), line))

    def _table(self, child: str, parents: tuple[str, ...], line: int) -> Definition:
        """The rows up to the closing brace."""
        whole, rows = None, []
        what = f"table of {child}"
        while (token := self._take()).text != "}":
            at = self._line(token)
            if token.text == "table":
                if whole is not None:
                    self._fail(token, f"{what}: a second 'table'")
                whole = self._numbers(what, at)
            elif token.text == "default":
                rows.append(Row(None, self._numbers(what, at), at))
            elif token.text == "(":
                label = _label(self._region("("), len(parents))
                rows.append(Row(label, self._numbers(f"{what}, row ({few(label)})", at), at))
            else:
                self._property(token, "'table', 'default', a row such as (go), 'property' or '}'")
        if whole is not None and rows:
            raise self.source.error(rows[0].line, f"{what}: both 'table' and rows")
        return Definition(child, parents, line, whole, True, tuple(rows))

    def _numbers(self, what: str, line: int) -> list[float]:
        words = []
        while (token := self._take()).text != ";":
            if token.text in "{}()[]|":
                self._fail(token, f"{what}: expected a probability or ';'")
            if token.text != ",":
                words.append(token.text)
        return numbers(words, self.source, line, what)

    def _property(self, token: Token, expected: str) -> None:
        """Skip what other programs keep for themselves."""
        if token.text != "property":
            self._fail(token, f"expected {expected}")
        self._until(";")

    # --- tokens -------------------------------------------------------------------------------

    def _take(self) -> Token:
        if self._next == len(self._tokens):
            raise self.source.error(len(self._newlines) + 1, f"the file ends within {self._within}")
        token = self._tokens[self._next]
        self._next += 1
        return token

    def _expect(self, text: str, what: str = "") -> None:
        token = self._take()
        if token.text != text:
            self._fail(token, f"{what}expected {text!r}")

    def _until(self, text: str) -> list[Token]:
        """The tokens before the next ``text``, which is passed over."""
        found: list[Token] = []
        while (token := self._take()).text != text:
            found.append(token)
        return found

    def _region(self, opening: str) -> list[Token]:
        """The tokens up to the bracket that closes ``opening``, which is passed over."""
        found: list[Token] = []
        depth = 1
        while True:
            token = self._take()
            depth += {opening: 1, _CLOSING[opening]: -1}.get(token.text, 0)
            if not depth:
                return found
            found.append(token)

    def _line(self, token: Token) -> int:
        return bisect_right(self._newlines, token.start) + 1

    def _fail(self, token: Token, expected: str) -> NoReturn:
        raise self.source.error(self._line(token), f"{expected}, got {few([token.text])!r}")


def _label(tokens: Sequence[Token], parents: int) -> tuple[str, ...]:
    """The parents' states that a row is for."""
    ways = _splits(tokens)
    return next((way for way in ways if len(way) == parents), ways[0])


def _splits(tokens: Sequence[Token]) -> list[tuple[str, ...]]:
    """The ways to read a list, likeliest first: at commas outside brackets, at any comma, at blanks, as one name."""
    ways = [_words(tokens), (_joined(tokens),)]
    if any(token.text == "," for token in tokens):
        ways = [_at_commas(tokens, brackets=True), _at_commas(tokens, brackets=False), *ways]
    return ways


def _words(tokens: Sequence[Token]) -> tuple[str, ...]:
    """Every piece between blanks or commas."""
    groups: list[list[Token]] = []
    end = -1
    for token in tokens:
        if token.text == ",":
            end = -1
            continue
        if token.start == end and token.text[0] != '"':
            groups[-1].append(token)
        else:
            groups.append([token])
        end = _end(token) if token.text[0] != '"' else -1
    return tuple(map(_joined, groups))


def _at_commas(tokens: Sequence[Token], *, brackets: bool) -> tuple[str, ...]:
    groups: list[list[Token]] = [[]]
    depth = 0
    for token in tokens:
        depth += {"(": 1, "[": 1, "{": 1, ")": -1, "]": -1, "}": -1}.get(token.text, 0)
        if token.text == "," and not (brackets and depth > 0):
            groups.append([])
        else:
            groups[-1].append(token)
    return tuple(_joined(group) for group in groups if group)


def _end(token: Token) -> int:
    return token.start + len(token.text)


def _joined(tokens: Sequence[Token]) -> str:
    """The name that some tokens make: a quoted one without its quotes; several as they stand, blanks made one."""
    if len(tokens) == 1 and len(tokens[0].text) > 1 and tokens[0].text[0] == tokens[0].text[-1] == '"':
        return " ".join(re.sub(r"\\(.)", r"\1", tokens[0].text[1:-1], flags=re.DOTALL).split())
    parts = [
        token.text if not i or token.start == _end(tokens[i - 1]) else f" {token.text}"
        for i, token in enumerate(tokens)
    ]
    return "".join(parts)
