"""What mkdocs is told: pages made from the program beside those that stand in docs/, the order of all, and links."""

from __future__ import annotations

import posixpath
import re
from pathlib import Path
from typing import Any

import gallery
import made
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[2]
_LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)#\s]*)(#[^)\s]*)?\)")
_MATH = re.compile(r"\$\$(.+?)\$\$", re.DOTALL)

#: Sections of the manual: title, and which pages it takes, in this order; a page goes into the first that takes it.
SECTIONS = (
    ("Start", ["index.md"]),
    ("Your path", ["paths/robot.md", "paths/tracks.md", "paths/teach.md", "paths/*"]),
    ("How to", ["howto/*"]),
    ("Guides", ["road.md", "*.md"]),
    ("Gallery", ["gallery/index.md", "gallery/*"]),
    ("Catalogue", ["catalogue/*"]),
    ("Reference", ["reference/commands.md", "reference/settings.md", "reference/index.md", "reference/*"]),
    ("Benchmarks", ["benchmarks/*"]),
    ("Project", ["project/changelog.md", "project/public.md", "project/*"]),
)


def site_place(repository: str) -> str | None:
    """Return the page of the site that a file of the repository became, None where there is none."""
    kept = {
        "README.md": "index.md", "CHANGELOG.md": "project/changelog.md", "CONTRIBUTING.md": "project/contributing.md",
        "data/README.md": "project/data.md", "notebooks": "gallery/index.md",
    }  # fmt: skip
    if repository in kept:
        return kept[repository]
    folder, name = posixpath.split(repository)
    if folder == "benchmarks/results" and name.endswith(".md"):
        return f"benchmarks/{name}"
    if folder.startswith("notebooks") and name.endswith(".ipynb"):
        return f"gallery/{gallery.page_name(Path(repository))}.md"
    return repository.removeprefix("docs/") if repository.startswith("docs/") else None


def relinked(text: str, repository: str, place: str) -> str:
    """Return the Markdown of a file of the repository with its links as the site has them."""

    def link(found: re.Match[str]) -> str:
        picture, said, target, anchor = found[1], found[2], found[3], found[4] or ""
        if not target or "://" in target or target.startswith("mailto:"):
            return found[0]
        there = site_place(posixpath.normpath(posixpath.join(posixpath.dirname(repository), target)))
        if there is None:
            return f"`{said.strip('`')}`"  # a file of the repository that is no page
        return f"{picture}[{said}]({posixpath.relpath(there, posixpath.dirname(place) or '.')}{anchor})"

    parts = re.split(r"(^```.*?^```[ ]*$|`[^`\n]+`)", text, flags=re.DOTALL | re.MULTILINE)
    return "".join(part if number % 2 else _LINK.sub(link, part) for number, part in enumerate(parts))


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that are made, and order all."""
    for place, text in {**made.pages(), **gallery.pages()}.items():
        files.append(File.generated(config, place, content=text))
    for path, place in repository_pages():
        text = relinked(path.read_text(encoding="utf-8"), path.relative_to(ROOT).as_posix(), place)
        files.append(File.generated(config, place, content=text))
    config.nav = ordered([file.src_uri for file in files.documentation_pages()])
    return files


def repository_pages() -> list[tuple[Path, str]]:
    """Pages that stand elsewhere in the repository, and their places."""
    found = [ROOT / "CHANGELOG.md", ROOT / "CONTRIBUTING.md", ROOT / "data" / "README.md"]
    found += sorted((ROOT / "benchmarks" / "results").glob("*.md"))
    return [(path, str(site_place(path.relative_to(ROOT).as_posix()))) for path in found]


def ordered(places: list[str]) -> list[dict[str, str | list[str]]]:
    """Every page in its section."""
    left, sections = sorted(places), []
    for title, patterns in SECTIONS:
        taken = []
        for pattern in patterns:
            for place in [p for p in left if fits(p, pattern)]:
                left.remove(place)
                taken.append(place)
        if taken:
            sections.append({title: taken[0] if taken == ["index.md"] else taken})  # the first page is the home
    return [*sections, *([{"More": left}] if left else [])]


def fits(place: str, pattern: str) -> bool:
    """Whether a page is of a pattern; a star stays within its folder."""
    return posixpath.dirname(place) == posixpath.dirname(pattern) and Path(place).match(pattern)


def on_page_markdown(markdown: str, page: Page, **_: Any) -> str:
    """Links of pages in docs/ that leave it; formulas as MathML, which needs nothing from a network."""
    if page.file.generated_by is None:
        markdown = relinked(markdown, f"docs/{page.file.src_uri}", page.file.src_uri)
    from latex2mathml.converter import convert

    return _MATH.sub(lambda formula: convert(formula[1].strip(), display="block"), markdown)


def on_page_content(html: str, page: Page, **_: Any) -> str:
    """What the cells of a notebook showed."""
    return gallery.with_outputs(html, page.file.src_uri)
