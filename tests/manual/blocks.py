"""Code blocks of the manual's pages, in the order in which a reader meets them."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
#: Every page of the manual that is written by hand.
PAGES = sorted([
    *(ROOT / "docs").rglob("*.md"), *(ROOT / "benchmarks" / "results").glob("*.md"), ROOT / "data" / "README.md",
    ROOT / "README.md", ROOT / "CONTRIBUTING.md",
])  # fmt: skip
NOTEBOOKS = sorted((ROOT / "notebooks").rglob("*.ipynb"))
SHELLS = ("sh", "console")
#: Kinds of blocks that a page may have; ``text`` is no code: output, a diagram.
KINDS = (*SHELLS, "python", "toml", "text")
_BLOCK = re.compile(r"^```(?P<kind>[^\n]*)\n(?P<text>.*?)^```$", re.DOTALL | re.MULTILINE)
_PROMPT = re.compile(r"(?:terminal \d )?\$ ")


class Block(NamedTuple):
    """A block: its kind and its text."""

    kind: str
    text: str


class Line(NamedTuple):
    """A command of a block: its words, the file its output goes to, and the error that the page shows after it."""

    words: list[str]
    target: str | None = None
    error: str | None = None
    background: bool = False  # it goes on while the reader does: another terminal, or &

    @property
    def program(self) -> str:
        """What is called, wherever it is installed."""
        return Path(self.words[0]).name


def blocks(page: Path) -> list[Block]:
    """All blocks of a page."""
    return [Block(found["kind"], found["text"]) for found in _BLOCK.finditer(page.read_text(encoding="utf-8"))]


def notebook_blocks(path: Path) -> list[Block]:
    """Code of a notebook's cells, without magics, and blocks that stand in its text, in order."""
    found = []
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        source = "".join(cell["source"])
        if cell["cell_type"] == "code":
            found.append(Block("python", re.sub(r"^%.*$", "", source, flags=re.MULTILINE)))
        else:
            found += [Block(block["kind"], block["text"]) for block in _BLOCK.finditer(source)]
    return found


def name_of(page: Path) -> str:
    """Its place in the repository."""
    return page.relative_to(ROOT).as_posix()


def lines(block: Block) -> Iterator[Line]:
    """Every command of a shell block."""
    shown = re.sub(r"\\\n\s*", " ", block.text).splitlines()
    for number, line in enumerate(shown):
        prompt = _PROMPT.match(line)
        if block.kind == "console" and not prompt:
            continue
        after = shown[number + 1] if number + 1 < len(shown) else ""
        error = after if block.kind == "console" and after.startswith("bayeshunt: ") else None
        server = line.startswith(("terminal 1", "terminal 2"))
        command = line[prompt.end() :] if prompt and block.kind == "console" else line
        for part in command.split(" && "):
            words = shlex.split(part, comments=True)
            background = server or words[-1:] == ["&"]
            words = words[:-1] if words[-1:] == ["&"] else words
            target = words[words.index(">") + 1] if ">" in words else None
            if words:
                yield Line(words[: words.index(">")] if ">" in words else words, target, error, background)


def inline(page: Path) -> Iterator[list[str]]:
    """Words of every command that stands in a sentence, in backquotes."""
    text = _BLOCK.sub("", page.read_text(encoding="utf-8"))
    for said in re.findall(r"`bayeshunt ([^`]+)`", text):
        if "..." not in said:
            yield shlex.split(" ".join(said.split()))
