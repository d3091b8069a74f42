"""Code blocks of the manual's pages, in the order in which a reader meets them."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).parents[2]
PAGES = sorted(path for path in (ROOT / "docs").rglob("*.md"))
#: Commands whose work --runs bounds.
COUNTED = ("evaluate", "sweep", "tradeoff", "figures")
_BLOCK = re.compile(
    r"(?P<mark><!-- elsewhere: [^>]+-->\n)?^```(?P<kind>\w*)\n(?P<text>.*?)^```$", re.DOTALL | re.MULTILINE
)


class Block(NamedTuple):
    """A block: its kind (python, sh, console, toml), its text, and whether the page says it runs elsewhere."""

    kind: str
    text: str
    elsewhere: bool


def blocks(page: Path) -> list[Block]:
    """All blocks of a page."""
    found = _BLOCK.finditer(page.read_text(encoding="utf-8"))
    return [Block(block["kind"], block["text"], bool(block["mark"])) for block in found]


def lines(block: Block) -> Iterator[tuple[list[str], str | None]]:
    """Words of every line that calls bayeshunt, and the file that its output goes to."""
    text = re.sub(r"\\\n\s*", " ", block.text)
    prompts = block.kind == "console"
    for line in text.splitlines():
        if prompts and not line.startswith("$ "):
            continue
        words = shlex.split(line.removeprefix("$ "), comments=True)
        if words[:1] == ["bayeshunt"]:
            target = words[words.index(">") + 1] if ">" in words else None
            yield words[1 : words.index(">")] if ">" in words else words[1:], target


def few(words: list[str]) -> list[str]:
    """The same command with one run, where --runs says how many."""
    if not any(word in COUNTED for word in words[:3]):
        return words
    if "--runs" in words:
        place = words.index("--runs") + 1
        return [*words[:place], "1", *words[place + 1 :]]
    return [*words, "--runs", "1"]


def run_page(page: Path, folder: Path, bayeshunt: Callable[..., tuple[str, str]]) -> int:
    """Run all blocks of a page in their order in one folder; return how many."""
    names: dict[str, Any] = {}
    ran = 0
    for block in blocks(page):
        if block.elsewhere:
            continue
        if block.kind == "python":
            with contextlib.redirect_stdout(io.StringIO()):  # or the next command would seem to have printed it
                exec(compile(block.text, page.name, "exec"), names)
            ran += 1
        elif block.kind == "toml" and (name := re.match(r"# (\S+\.toml)\n", block.text)):
            (folder / name[1]).write_text(block.text, encoding="utf-8")
        elif block.kind in ("sh", "console"):
            for words, target in lines(block):
                out, _ = bayeshunt(*few(words))
                if target:
                    (folder / target).write_text(out, encoding="utf-8")
                ran += 1
    return ran
