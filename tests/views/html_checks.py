"""Reading HTML strictly: every tag closed in order, every attribute once; and names that would do harm."""

from __future__ import annotations

from html.parser import HTMLParser

#: Gait names that would do harm in HTML, in a terminal, in mathematical text or in markup.
NASTY = (
    "<script>alert(1)</script>", '"><img src=x onerror=alert(1)>', "&lt;b&gt; & co", "$\\frac{1}{", "[/red][bold]",
    "\x1b[31mred\nnew line", "'single' style=x", "</style></details></table>", "-->", "x" * 150,
)  # fmt: skip

VOID = {"input", "br", "hr", "meta", "img", "link", "source", "col", "wbr", "area", "base", "embed", "param", "track"}


class Reader(HTMLParser):
    """Collects (tag, attributes, text) of every element; raises AssertionError at the first fault."""

    def __init__(self, html: str) -> None:
        super().__init__(convert_charrefs=True)
        self.open: list[dict] = []
        self.elements: list[dict] = []
        self.text = ""
        self.feed(html)
        self.close()
        assert not self.open, f"never closed: {[e['tag'] for e in self.open]}"
        assert not self.rawdata, f"left over: {self.rawdata[:80]!r}"

    def handle_starttag(self, tag: str, attrs: list) -> None:
        names = [name for name, _ in attrs]
        assert len(names) == len(set(names)), f"<{tag}> has an attribute twice: {names}"
        parents = tuple(e["tag"] for e in self.open)
        element = {"tag": tag, "attributes": dict(attrs), "text": "", "parents": parents}
        self.elements.append(element)
        if tag not in VOID:
            self.open.append(element)

    def handle_endtag(self, tag: str) -> None:
        assert self.open, f"</{tag}> closes nothing"
        assert self.open[-1]["tag"] == tag, f"</{tag}> closes <{self.open[-1]['tag']}>"
        self.open.pop()

    def handle_data(self, data: str) -> None:
        assert self.open or not data.strip(), f"text outside every element: {data[:40]!r}"
        for element in self.open:
            element["text"] += data
        if not any(element["tag"] == "style" for element in self.open):
            self.text += data

    def handle_comment(self, data: str) -> None:
        raise AssertionError(f"a comment: {data[:40]!r}")

    def handle_decl(self, decl: str) -> None:
        raise AssertionError(f"a declaration: {decl[:40]!r}")

    unknown_decl = handle_pi = handle_decl

    def find(self, tag: str, class_: str | None = None) -> list[dict]:
        """Elements called ``tag``, of a class if given."""
        found = [e for e in self.elements if e["tag"] == tag]
        return [e for e in found if class_ is None or class_ in (e["attributes"].get("class") or "").split()]
