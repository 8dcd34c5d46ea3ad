"""A strict reader of pages: every element is closed where it must be, and nothing lies elsewhere."""

from __future__ import annotations

from html.parser import HTMLParser

_VOID = {"meta", "img", "br", "hr", "link", "source"}  # have no end
_WITHIN = {"tr": "table", "td": "tr", "th": "tr", "figcaption": "figure", "summary": "details"}
_BLOCKS = {"p", "table", "pre", "figure", "details", "h1", "h2", "div"}  # not in a paragraph
_FOREIGN = {"script", "link", "iframe", "object", "embed"}
_LOADS = {"src", "href", "srcset", "data", "poster", "action", "background"}


class StrictReader(HTMLParser):
    """errors: what is wrong with a page; sources: what it loads; words: its text."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.errors: list[str] = []
        self.sources: list[str] = []
        self.words = ""
        self._open: list[str] = []
        self.feed(page)
        self.close()
        self.errors += [f"<{tag}> is not closed" for tag in self._open]

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        parent = self._open[-1] if self._open else "nothing"
        if tag in _FOREIGN or _WITHIN.get(tag, parent) != parent or (parent == "p" and tag in _BLOCKS):
            self.errors.append(f"<{tag}> in <{parent}>")
        self.sources += [str(value) for name, value in attrs if name in _LOADS]
        if tag not in _VOID:
            self._open.append(tag)

    def handle_data(self, data: str) -> None:
        self.words += data

    def handle_endtag(self, tag: str) -> None:
        if not self._open or self._open.pop() != tag:
            self.errors.append(f"</{tag}> closes nothing")

    def unknown_decl(self, data: str) -> None:
        self.errors.append(f"<!{data}")
