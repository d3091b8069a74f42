"""Reading XMLBIF 0.3, as pgmpy, pyAgrum, JavaBayes, GeNIe and Weka write it.

Nothing outside the file is read, and no entity is taken: a file cannot grow while it is parsed.
Source: http://www.cs.cmu.edu/~fgcozman/Research/InterchangeFormat/.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any
from xml.parsers import expat

from bayeshunt.core.errors import InputError
from bayeshunt.models.formats.network_tables import Definition, NetworkTables, Source, Variable, assemble, few, numbers

__all__ = ["read"]


@dataclass
class _Element:
    """An element, its line, its own text in pieces, and what is inside it."""

    tag: str
    line: int
    pieces: list[str] = field(default_factory=list)
    inside: list[_Element] = field(default_factory=list)

    @property
    def words(self) -> list[str]:
        return "".join(self.pieces).split()

    @property
    def text(self) -> str:
        """The text; blanks around it are none of it, those within it are made one."""
        return " ".join(self.words)

    def all(self, *tags: str) -> list[_Element]:
        return [element for element in self.inside if element.tag in tags]


def read(data: bytes, name: str) -> NetworkTables:
    """Return the network in the bytes of an XMLBIF file called ``name``; InputError in one line if there is none."""
    source = Source(name)
    if not data.strip(b"\xef\xbb\xbf \t\r\n"):
        raise InputError(f"{name}: holds no network (the file is empty)")
    root = _parse(data, source)
    if root.tag != "BIF":
        raise source.error(root.line, f"not a readable XMLBIF network: expected the element BIF, got {few([root.tag])}")
    networks = root.all("NETWORK")
    if len(networks) != 1:
        raise source.error(root.line, f"expected one NETWORK within BIF, got {len(networks)}")
    variables = [_variable(element, source) for element in networks[0].all("VARIABLE")]
    return assemble(variables, [_definition(e, source) for e in networks[0].all("DEFINITION")], source)


def _parse(data: bytes, source: Source) -> _Element:
    """The elements of a document, without its attributes."""
    top = _Element("", 0)
    open_elements = [top]
    parser = expat.ParserCreate()
    parser.buffer_text = True

    def start(tag: str, _attributes: Any) -> None:
        element = _Element(tag, parser.CurrentLineNumber)
        open_elements[-1].inside.append(element)
        open_elements.append(element)

    def refuse(*_entity: Any) -> None:
        raise source.error(
            parser.CurrentLineNumber, "not a readable XMLBIF network: it declares or uses entities of its own"
        )

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _tag: open_elements.pop()
    parser.CharacterDataHandler = lambda text: open_elements[-1].pieces.append(text)
    parser.EntityDeclHandler = refuse
    parser.SkippedEntityHandler = refuse  # one that a document type elsewhere would declare
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        reason = f"it is not well-formed XML: {expat.ErrorString(error.code)}"
        raise source.error(error.lineno, f"not a readable XMLBIF network ({reason})") from None
    except (LookupError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise source.error(
            1, "not a readable XMLBIF network (an encoding that is not known; save it as UTF-8)"
        ) from None
    return top.inside[0]


def _one(element: _Element, tag: str, what: str, source: Source) -> str:
    """The text of the one element of a kind within another."""
    found = element.all(tag)
    if len(found) != 1:
        raise source.error(element.line, f"{what}: expected one {tag}, got {len(found)}")
    return found[0].text


def _variable(element: _Element, source: Source) -> Variable:
    name = _one(element, "NAME", "VARIABLE", source)
    return Variable(name, tuple(state.text for state in element.all("OUTCOME", "VALUE")), element.line)


def _definition(element: _Element, source: Source) -> Definition:
    child = _one(element, "FOR", "DEFINITION", source)
    parents = tuple(parent.text for parent in element.all("GIVEN"))
    what = f"table of {few([child])}"
    strange = [inner for inner in element.inside if inner.tag not in ("FOR", "GIVEN", "TABLE", "PROPERTY")]
    if strange:
        raise source.error(strange[0].line, f"{what}: the element {few([strange[0].tag])} is not known")
    tables = element.all("TABLE")
    if len(tables) != 1:
        raise source.error(element.line, f"{what}: expected one TABLE, got {len(tables)}")
    if tables[0].inside:
        inner = tables[0].inside[0]
        raise source.error(inner.line, f"{what}: expected probabilities, got the element {few([inner.tag])}")
    words = "".join(tables[0].pieces).replace(",", " ").split()
    return Definition(child, parents, element.line, numbers(words, source, tables[0].line, what), child_first=False)
