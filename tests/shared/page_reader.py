"""A page of HTML as a strict reader sees it: every element closed, in order; its texts, its tables as rows of cells."""

from __future__ import annotations

from html.parser import HTMLParser

ALONE = {"meta", "br", "img"}
OURS = {  # elements of the pages that heun writes
    "html", "head", "meta", "title", "style", "body", "main", "header", "nav", "ol", "ul", "li", "a", "section", "h1",
    "h2", "h3", "small", "p", "dl", "dt", "dd", "div", "table", "thead", "tbody", "tr", "th", "td", "strong", "code",
    "figure", "figcaption", "span", "svg", "desc", "rect", "polyline", "polygon", "circle", "text",
}  # fmt: skip


class PageReader(HTMLParser):
    """What stands in a page; asserts that its elements nest."""

    def __init__(self, page: str) -> None:
        super().__init__(convert_charrefs=True)
        self.open: list[str] = []
        self.tags: set[str] = set()
        self.attributes: set[tuple[str, str]] = set()
        self.links: list[str] = []
        self.ids: list[str] = []
        self.texts: list[str] = []
        self.by_tag: dict[str, list[str]] = {}
        self.rows: list[list[str]] = []
        self.bold: set[tuple[int, int]] = set()  # row and place in it
        self.feed(page)
        self.close()
        assert not self.open, f"not closed: {self.open}"

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        self.attributes |= {(tag, name) for name, _ in attrs}
        given = dict(attrs)
        self.ids += [given["id"] or ""] if "id" in given else []
        self.links += [given[name] or "" for name in ("href", "src") if name in given]
        if tag not in ALONE:
            self.open.append(tag)
            self.by_tag.setdefault(tag, []).append("")
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
        if tag == "strong" and "td" in self.open:
            self.bold.add((len(self.rows) - 1, len(self.rows[-1]) - 1))

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        self.attributes |= {(tag, name) for name, _ in attrs}

    def handle_endtag(self, tag: str) -> None:
        assert self.open and self.open[-1] == tag, f"</{tag}> closes {self.open[-1:]}"
        self.open.pop()

    def handle_data(self, data: str) -> None:
        self.texts.append(data)
        for tag in set(self.open):
            self.by_tag[tag][-1] += data
        if "tr" in self.open and ("td" in self.open or "th" in self.open):
            self.rows[-1][-1] += data
