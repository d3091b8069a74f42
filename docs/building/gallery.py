"""Notebooks, run and rendered: what they show lives in the manual, their sources stay stripped.

A notebook is run again only when it or the package has changed; what it showed is kept in build/cache.
``BAYESHUNT_GALLERY=sources`` renders them without running them.
"""

from __future__ import annotations

import hashlib
import os
import re
import sys
from functools import cache
from pathlib import Path

import nbformat

ROOT = Path(__file__).parents[2]
CACHE = ROOT / "build" / "cache"
_OUTPUTS: dict[str, list[str]] = {}


@cache
def package_hash() -> str:
    """SHA-256 of the package's sources."""
    found = hashlib.sha256()
    for path in sorted((ROOT / "bayeshunt").rglob("*")):
        if path.is_file() and path.suffix not in (".pyc", ".pyo"):
            found.update(path.read_bytes())
    return found.hexdigest()


def cached(key: str, suffix: str) -> Path:
    """The place where something made by this package from ``key`` is kept."""
    CACHE.mkdir(parents=True, exist_ok=True)
    return CACHE / (hashlib.sha256((package_hash() + key).encode()).hexdigest()[:24] + suffix)


def executed(path: Path) -> nbformat.NotebookNode:
    """A notebook with what its cells show."""
    kept = cached(path.read_text(encoding="utf-8"), ".ipynb")
    if kept.exists():
        return nbformat.read(kept, as_version=4)
    notebook = nbformat.read(path, as_version=4)
    if os.environ.get("BAYESHUNT_GALLERY") == "sources":
        return notebook
    from nbclient import NotebookClient

    print(f"running {path.name}", file=sys.stderr, flush=True)
    NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(path.parent)}}).execute()
    nbformat.write(notebook, kept)
    return notebook


def notebooks() -> list[Path]:
    """Those that stand in notebooks/, in their order; solutions after them."""
    return [*sorted((ROOT / "notebooks").glob("*.ipynb")), *sorted((ROOT / "notebooks").glob("*/*.ipynb"))]


def page_name(path: Path) -> str:
    """The name of a notebook's page, with that of its folder where it is not notebooks/ itself."""
    return path.stem if path.parent.name == "notebooks" else f"{path.parent.name}_{path.stem}"


def pages() -> dict[str, str]:
    """A page for each notebook, and one that lists them."""
    made, lines = {}, []
    for path in notebooks():
        notebook = executed(path)
        place = f"gallery/{page_name(path)}.md"
        made[place] = page_of(notebook, place)
        title = notebook.cells[0].source.splitlines()[0].removeprefix("# ")
        question = re.search(r"\*\*(.+?)\*\*", notebook.cells[0].source, re.DOTALL)
        lines.append(f"| [{title}]({page_name(path)}.md) | {' '.join(question[1].split()) if question else ''} |")
    made["gallery/index.md"] = "\n".join([
        "# Gallery", "",
        "The notebooks in `notebooks/`, run from start to end when this manual was built. To turn their knobs, start",
        "them yourself: `pip install \".[notebook]\"`, then `jupyter lab notebooks`.", "",
        "| notebook | its question |", "| --- | --- |", *lines, "",
    ])  # fmt: skip
    return made


def page_of(notebook: nbformat.NotebookNode, place: str) -> str:
    """Markdown of a notebook, with a mark where a cell shows something."""
    shown = _OUTPUTS.setdefault(place, [])
    shown.clear()
    parts = []
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            parts.append(cell.source)
            continue
        if cell.cell_type == "code":
            parts.append(f"```python\n{cell.source}\n```")
            for html in filter(None, map(html_of, cell.get("outputs", []))):
                parts.append(f'<div class="output" markdown="0">OUTPUT-{len(shown)}-OF-A-CELL</div>')
                shown.append(html)
    return "\n\n".join(parts) + "\n"


def html_of(output: nbformat.NotebookNode) -> str:
    """What a cell showed, as HTML."""
    from html import escape

    if output.output_type == "stream":
        return f"<pre><code>{escape(output.text)}</code></pre>" if output.name == "stdout" else ""
    if output.output_type == "error":
        raise RuntimeError("a notebook with an error")
    data = output.get("data", {})
    if "application/vnd.jupyter.widget-view+json" in data and "text/html" not in data:
        return "<p><em>A widget: it moves where the notebook runs.</em></p>"
    if "text/html" in data:
        html = "".join(data["text/html"])
        return re.sub(r'<table[^>]*class="dataframe"[^>]*>', "<table>", html)
    for kind in ("image/png", "image/jpeg"):
        if kind in data:
            alt = output.get("metadata", {}).get(kind, {}).get("alt") or data.get("text/plain", "a figure")
            return f'<img src="data:{kind};base64,{data[kind].strip()}" alt="{escape(str(alt), quote=True)}">'
    if "image/svg+xml" in data:
        return "".join(data["image/svg+xml"])
    return f"<pre><code>{escape(''.join(data.get('text/plain', '')))}</code></pre>"


def with_outputs(html: str, place: str) -> str:
    """The page with what its cells showed in place of the marks."""
    shown = _OUTPUTS.get(place, [])
    return re.sub(r"OUTPUT-(\d+)-OF-A-CELL", lambda found: shown[int(found[1])], html)
