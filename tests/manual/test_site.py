"""The manual's site: everything public stands on it, nothing on it is dead, and it needs no network."""

import os
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag

import pytest

import bayeshunt

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "docs" / "building"))
made = pytest.importorskip("made", reason="needs nbformat")
docstrings = pytest.importorskip("docstrings", reason='needs the extra "docs"')


def test_every_public_name_is_in_the_reference():
    pages = made.api_pages()
    on_pages = "\n".join(pages.values())
    for name in set(bayeshunt.__all__) - {"__version__", "protocols"}:
        assert f"[`bh.{name}`]" in pages["reference/index.md"], name
        assert f'heading: "bh.{name}"' in on_pages, name
    assert "::: bayeshunt.protocols" in on_pages


def test_every_command_and_option_is_in_the_reference(bayeshunt):
    page = made.commands_page()
    assert not re.search(r"(?<!\\)\[[^\]]*\] ?\[", page), "two brackets in a row would be a link"
    for name, command in made.commands():
        assert f"## {name} {{" in page, name
        section = page.split(f"## {name} {{")[1].split("\n## ")[0]
        for parameter in command.params:
            if "--help" not in parameter.opts and not parameter.hidden:
                word = parameter.opts[0] if parameter.opts[0].startswith("-") else parameter.name
                assert f"`{word}`" in section, (name, word)


def test_every_help_has_an_example():
    for name, command in made.commands():
        assert "Example:" in (command.help or ""), name


def test_docstrings_become_lists():
    text = "Fit.\n\nframe: columns,\n    and rows.\nprior: see :meth:`~x.fit`.\nRaises InputError."
    expected = "Fit.\n\n\n- `frame`: columns,\n    and rows.\n- `prior`: see `x.fit`.\n\nRaises InputError."
    assert docstrings.as_markdown(text, {"frame", "prior"}) == expected
    assert docstrings.as_markdown("Note: no list.", {"frame"}) == "Note: no list."


class _Page(HTMLParser):
    """Anchors of a page, what it links to, and what it loads."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = {name: value or "" for name, value in attrs}
        self.anchors |= {found[key] for key in ("id", "name") if key in found}
        if tag == "a" and "href" in found:
            self.links.append(found["href"])
        if tag in ("script", "img", "iframe", "source") and "src" in found:
            self.loads.append(found["src"])
        if tag == "link" and found.get("rel") in ("stylesheet", "icon"):
            self.loads.append(found["href"])


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The site, its notebooks not run."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder)]
    environment = {**os.environ, "BAYESHUNT_GALLERY": "sources", "NO_MKDOCS_2_WARNING": "1"}
    ran = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr[-3000:]
    assert "WARNING" not in ran.stderr
    return folder


def test_a_warning_of_the_build_is_an_error():
    """mkdocs counts warnings by its logger, which --quiet silences: then --strict lets all of them pass."""
    lines = [line.partition("#")[0] for line in (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines()]
    (build,) = [line for line in lines if "mkdocs build" in line]
    assert "--strict" in build
    assert "quiet" not in build
    assert " -q" not in build


@pytest.mark.slow
def test_no_link_is_dead_and_nothing_comes_from_a_network(site):
    pages = {path: _Page(path.read_text(encoding="utf-8")) for path in site.rglob("*.html")}
    assert len(pages) > 30
    dead, foreign = [], []
    for path, page in pages.items():
        if path.name == "404.html":  # it is served for any place, and links from the root
            continue
        foreign += [(path.name, load) for load in page.loads if "://" in load or load.startswith("//")]
        local = [load for load in page.loads if not load.startswith("data:")]
        for link in [*page.links, *local]:
            target, anchor = urldefrag(unquote(link))
            if "://" in target or target.startswith(("mailto:", "data:", "javascript:")):
                continue
            there = (path.parent / target.partition("?")[0]).resolve() if target else path
            if not there.is_file() or (anchor and there in pages and anchor not in pages[there].anchors):
                dead.append((path.relative_to(site).as_posix(), link))
    assert not foreign
    assert not dead


@pytest.mark.slow
def test_every_page_in_docs_is_reached_from_the_bar(site):
    start = _Page((site / "index.html").read_text(encoding="utf-8"))
    reached = {urldefrag(link)[0] for link in start.links}
    for page in (ROOT / "docs").rglob("*.md"):
        assert page.relative_to(ROOT / "docs").with_suffix(".html").as_posix() in reached | {"index.html"}, page.name
