"""A report as a page: one file, without scripts, nothing fetched. Whatever a spec says is text in it, never markup.

Every text goes through `escaped`, every element through `element`: nothing else writes a `<`, but for the pictures,
which are SVG of our own and escape what they hold themselves.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from heuncli.base.foreign_text import shown
from heuncli.output.client_report.parts import (
    Chapter,
    ClientReport,
    Drawing,
    Facts,
    Listing,
    Part,
    ReportCell,
    ReportTable,
    Sentence,
    Verbatim,
)
from heuncli.output.drawing.layout import laid_out
from heuncli.output.drawing.picture import escaped as escaped_for_xml
from heuncli.output.drawing.picture import svg

STYLE = Path(__file__).with_name("report.css")
POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"
LONG = 34  # letters of a cell that goes on in a second line
ALONE = ("meta", "br")  # elements that have no end


def as_html(report: ClientReport) -> str:
    """The page, in UTF-8."""
    head = [
        element("meta", charset="utf-8"),
        element("meta", name="viewport", content="width=device-width, initial-scale=1"),
        element("meta", http_equiv="Content-Security-Policy", content=POLICY),
        element("title", escaped(report.title)),
        element("style", "\n" + STYLE.read_text(encoding="utf-8")),
    ]
    body = element("header", element("h1", escaped(report.title)) + _parts(report.lead) + _contents(report.chapters))
    body += "\n" + "\n".join(_chapter(number, chapter) for number, chapter in enumerate(report.chapters, 1))
    whole = element("head", "\n".join(head)) + "\n" + element("body", element("main", body))
    return "<!DOCTYPE html>\n" + element("html", whole, lang="en") + "\n"


def escaped(text: str) -> str:
    """A text as it stands between tags or between quotes: what is unseen is shown as an escape."""
    return escaped_for_xml(shown(text)).replace('"', "&quot;").replace("'", "&#39;")


def element(tag: str, content: str = "", /, **attributes: str) -> str:
    """An element of content that is markup already; attributes are escaped here, `class_` is `class`."""
    given = "".join(
        f' {key.rstrip("_").replace("_", "-")}="{escaped(value)}"' for key, value in attributes.items() if value
    )
    return f"<{tag}{given}>" if tag in ALONE else f"<{tag}{given}>{content}</{tag}>"


def _contents(chapters: Sequence[Chapter]) -> str:
    """The list of chapters, which lead to them."""
    links = (element("li", element("a", escaped(chapter.title), href=f"#{chapter.name}")) for chapter in chapters)
    return element("nav", element("ol", "".join(links)), aria_label="Contents")


def _chapter(number: int, chapter: Chapter) -> str:
    title = element("h2", f"{number}&ensp;{escaped(chapter.title)}")
    return element("section", title + "\n" + _parts(chapter.parts), id=chapter.name)


def _parts(parts: Iterable[Part]) -> str:
    return "\n".join(WRITTEN[type(part)](part) for part in parts)


def _sentence(part: Sentence) -> str:
    return element("p", escaped(part.text), class_="" if part.mood == "plain" else part.mood)


def _facts(part: Facts) -> str:
    rows = (element("dt", escaped(label)) + element("dd", escaped(text)) for label, text in part.rows)
    return element("dl", "".join(rows))


def _listing(part: Listing) -> str:
    title = element("h3", escaped(part.title)) if part.title else ""
    return title + element("ul", "".join(element("li", escaped(item)) for item in part.items))


def _grid(part: ReportTable) -> str:
    """A table; its head is repeated on every page that it goes over."""
    kinds = ["left" if column.align == "left" else "" for column in part.columns]
    heads = [element("th", escaped(column.head), scope="col", class_=kind)
             for column, kind in zip(part.columns, kinds, strict=True)]  # fmt: skip
    name, _, rest = part.caption.partition("  ")
    table = ""
    if part.columns:
        body = "\n".join(_row(row, kinds) for row in part.rows)
        table = element("thead", element("tr", "".join(heads))) + "\n" + element("tbody", body)
        table = element("div", element("table", table, aria_label=name), class_="wide")
    caption = element("h3", escaped(name) + (" " + element("small", escaped(rest)) if rest else ""))
    notes = "".join(element("li", escaped(note)) for note in part.notes)
    return element("div", caption + "\n" + table + (element("ul", notes, class_="notes") if notes else ""))


def _row(row: Sequence[ReportCell] | str, kinds: Sequence[str]) -> str:
    if isinstance(row, str):
        name, _, rest = row.partition("  ")
        text = escaped(name) + (" " + element("small", escaped(rest)) if rest else "")
        return element("tr", element("th", text, colspan=str(len(kinds)), scope="colgroup"), class_="across")
    cells = (_cell(cell, kind) for cell, kind in zip(row, kinds, strict=True))
    return element("tr", "".join(cells), class_="begins" if row[0].text else "")


def _cell(cell: ReportCell, kind: str) -> str:
    text = escaped(cell.text)
    kinds = " ".join(filter(None, (kind, "long" * (len(cell.text) > LONG))))
    return element("td", element("strong", text) if cell.governs else text, class_=kinds)


def _drawing(part: Drawing) -> str:
    """A picture as a part of the page; its declaration as a file of its own is left out."""
    named = laid_out(part.figure)._replace(title=part.caption)
    picture = svg(named).partition("?>\n")[2]
    return element("figure", picture + element("figcaption", escaped(part.caption)))


def _verbatim(part: Verbatim) -> str:
    lines = "".join(element("li", element("code", escaped(line))) for line in part.text.split("\n"))
    return element("ol", lines, class_="text")


WRITTEN: dict[type[Part], Callable[[Any], str]] = {
    Sentence: _sentence, Facts: _facts, Listing: _listing, ReportTable: _grid, Drawing: _drawing, Verbatim: _verbatim,
}  # fmt: skip
