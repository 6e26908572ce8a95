"""Write a document as one HTML file without scripts and without external resources, for the screen or for paper.

Text from a spec is never markup."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any, Literal

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape
from heuncli.output.documents.document import (
    Brand,
    Cell,
    Chapter,
    Drawing,
    Facts,
    Listing,
    OutputDocument,
    OutputTable,
    Part,
    Sentence,
    Verbatim,
    format_cell,
    has_content,
    is_governing,
    use_decimal_comma,
)
from heuncli.output.drawing.layout import lay_out
from heuncli.output.drawing.shapes import Text, to_svg
from heuncli.output.drawing.shapes import escape_xml as escaped_for_xml

STYLE = Path(__file__).with_name("document.css")
POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"
FILLS = {"": "", "page": "fills", "columns": "fills columns", "half": "fills"}  # of a table -> classes
MAX_WHOLE_ROWS = 20  # of a table that is kept on one page
TALL_HEIGHT = 480.0  # pixels of a first figure that has a key of its numbers below, and gets more of the page
LONG_CELL = 34  # characters; a longer cell may wrap
VOID_TAGS = ("meta", "br", "img")  # tags without an end tag
LOW_FIGURES = """@media print { /* landscape: the machine and the summary on the first page, a figure on one page */
  figure.first svg, figure.first.tall svg { max-height: 65mm; }
  figure svg { max-height: 145mm; }
}
"""
PAPERS = {"a4": "A4", "letter": "letter"}  # words of --paper -> names of CSS


class Sheet(NamedTuple):
    """The paper format, and the left and right texts of the page header (not on the first page)."""

    paper: Literal["a4", "letter"] = "a4"
    is_landscape: bool = False
    head: str = ""
    head_right: str = ""
    foot: str = ""


A4 = Sheet()


def render_html(document: OutputDocument, sheet: Sheet = A4) -> str:
    """Render the document as HTML, to be written in UTF-8; its chapters follow the other parts.

    sheet: the paper on which it is printed
    """
    parts = list(document.parts)
    chapters = [part for part in parts if isinstance(part, Chapter)]
    brand = [part for part in parts if isinstance(part, Brand)]
    lead = [Facts(document.facts), *(part for part in parts if not isinstance(part, (Chapter, Brand)))]
    head_elements = [
        make_element("meta", charset="utf-8"),
        make_element("meta", name="viewport", content="width=device-width, initial-scale=1"),
        make_element("meta", http_equiv="Content-Security-Policy", content=POLICY),
        make_element("title", escape_text(document.title or "")),
        make_element("style", "\n" + STYLE.read_text(encoding="utf-8") + make_page_style(sheet)),
    ]
    body = make_element(
        "header",
        _render_parts(brand) + make_element("h1", escape_text(document.title or "")) + _render_parts(lead),
    )
    body += "\n" + _render_parts(chapters)
    page = make_element("head", "\n".join(head_elements)) + "\n" + make_element("body", make_element("main", body))
    return "<!DOCTYPE html>\n" + make_element("html", page, lang="en") + "\n"


def escape_text(text: str) -> str:
    """Escape a text for use between tags or between quotes; invisible characters are shown as escape sequences."""
    return escaped_for_xml(escape(text)).replace('"', "&quot;").replace("'", "&#39;")


def make_element(tag: str, content: str = "", /, **attributes: str) -> str:
    """Make an element. The content is markup already; attributes are escaped here, `class_` is written as `class`."""
    attribute_text = "".join(
        f' {key.rstrip("_").replace("_", "-")}="{escape_text(value)}"' for key, value in attributes.items() if value
    )
    return f"<{tag}{attribute_text}>" if tag in VOID_TAGS else f"<{tag}{attribute_text}>{content}</{tag}>"


def _render_chapter(number: str, chapter: Chapter) -> str:
    """Render a chapter; a chapter within one has a smaller title."""
    title = make_element(f"h{2 + number.count('.')}", f"{number}&ensp;{escape_text(chapter.title)}")
    return make_element("section", title + "\n" + _render_parts(chapter.parts, f"{number}."), id=chapter.name)


def _render_parts(parts: Iterable[Part], prefix: str = "") -> str:
    """Render the parts; prefix: the number of the chapter that they belong to, before those of its own chapters."""
    texts = []
    number = 0
    halves: list[str] = []
    for part in filter(has_content, parts):
        if len(halves) == 2 or (halves and not _is_half(part)):
            texts.append(make_element("div", "".join(halves), class_="pair"))
            halves = []
        if isinstance(part, Chapter):
            number += 1
            texts.append(_render_chapter(f"{prefix}{number}", part))
        else:
            (halves if _is_half(part) else texts).append(RENDERERS[type(part)](part))
    if halves:
        texts.append(make_element("div", "".join(halves), class_="pair"))
    return "\n".join(texts)


def _is_half(part: Part) -> bool:
    """Return whether a part is a figure or a table that stands beside another."""
    return (isinstance(part, Drawing) and part.place == "half") or (
        isinstance(part, OutputTable) and part.fill == "half"
    )


def _render_sentence(part: Sentence) -> str:
    return make_element("p", escape_text(part.text), class_="" if part.mood == "plain" else part.mood)


def _render_facts(part: Facts) -> str:
    rows = (make_element("dt", escape_text(label)) + make_element("dd", escape_text(text)) for label, text in part.rows)
    if part.is_block:
        cells = (make_element("div", make_element("dt", escape_text(label)) + make_element("dd", escape_text(text)))
                 for label, text in part.rows)  # fmt: skip
        return make_element("dl", "".join(cells), class_="block")
    return make_element("dl", "".join(rows))


def _render_brand(part: Brand) -> str:
    logo = make_element("img", src=part.logo, alt="logo") if part.logo else ""
    words = make_element("span", escape_text(part.company)) + make_element("span", escape_text(part.project))
    return make_element("div", logo + words, class_="brand")


def _render_listing(part: Listing) -> str:
    title = make_element("h3", escape_text(part.title)) if part.title else ""
    return title + make_element("ul", "".join(make_element("li", escape_text(item)) for item in part.items))


def render_table(part: OutputTable) -> str:
    """Render a table under its heading, if it has one; its head is repeated on every printed page that it extends
    over.
    """
    kinds = ["" if column.is_number else "left" for column in part.columns]
    heads = [make_element("th", escape_text(column.title), scope="col", class_=kind)
             for column, kind in zip(part.columns, kinds, strict=True)]  # fmt: skip
    table = ""
    if part.columns:
        body = "\n".join(_render_row(row, kinds) for row in part.rows)
        table = make_element("thead", make_element("tr", "".join(heads))) + "\n" + make_element("tbody", body)
        label = part.heading.partition("  ")[0]
        table = make_element("table", table, aria_label=label)
        table = make_element(
            "div", table, class_=" ".join(filter(None, ("wide", FILLS[part.fill], _choose_break(part))))
        )
    caption = make_element("h3", _render_heading(part.heading)) if part.heading else ""
    notes = "".join(make_element("li", escape_text(note)) for note in part.notes)
    return make_element("div", caption + "\n" + table + (make_element("ul", notes, class_="notes") if notes else ""))


def _choose_break(part: OutputTable) -> str:
    """Return the class of a table that is kept on one page."""
    return "whole" if len(part.rows) <= MAX_WHOLE_ROWS * (2 if part.fill == "columns" else 1) else ""


def _render_heading(text: str) -> str:
    """Render a heading; what stands after two blanks is smaller."""
    name, _, rest = text.partition("  ")
    return escape_text(name) + (" " + make_element("small", escape_text(rest)) if rest else "")


def _render_row(row: Sequence[Cell] | str, kinds: Sequence[str]) -> str:
    if isinstance(row, str):
        title = make_element("th", _render_heading(row), colspan=str(len(kinds)), scope="colgroup")
        return make_element("tr", title, class_="across")
    cells = (_render_cell(cell, kind) for cell, kind in zip(row, kinds, strict=True))
    return make_element("tr", "".join(cells), class_="begins" if format_cell(row[0]) else "")


def _render_cell(cell: Cell, kind: str) -> str:
    text = format_cell(cell)
    kinds = " ".join(filter(None, (kind, "long" * (len(text) > LONG_CELL))))
    content = escape_text(text)
    return make_element("td", make_element("strong", content) if is_governing(cell) else content, class_=kinds)


def _render_drawing(part: Drawing) -> str:
    """Render a figure as inline SVG, without its XML declaration."""
    figure = (lay_out(part.figure) if part.width is None else lay_out(part.figure, part.width))._replace(
        title=part.caption
    )
    if part.has_decimal_comma:
        shapes = [
            shape._replace(text=use_decimal_comma(shape.text)) if isinstance(shape, Text) else shape
            for shape in figure.shapes
        ]
        figure = figure._replace(shapes=shapes)
    markup = to_svg(figure).partition("?>\n")[2]
    caption = make_element("figcaption", escape_text(part.caption)) if part.caption else ""
    is_tall = part.place == "first" and figure.height > TALL_HEIGHT
    return make_element("figure", markup + caption, class_=part.place + " tall" * is_tall)


def _render_verbatim(part: Verbatim) -> str:
    if not part.is_numbered:
        return make_element("pre", "\n".join(map(escape_text, part.text.split("\n"))))
    lines = "".join(make_element("li", make_element("code", escape_text(line))) for line in part.text.split("\n"))
    return make_element("ol", lines, class_="text")


RENDERERS: dict[type[Part], Callable[[Any], str]] = {
    Sentence: _render_sentence,
    Facts: _render_facts,
    Brand: _render_brand,
    Listing: _render_listing,
    OutputTable: render_table,
    Drawing: _render_drawing,
    Verbatim: _render_verbatim,
}


def make_page_style(sheet: Sheet) -> str:
    """Make the style of pages: size, heads and feet. Every text is written in escapes, so that none is a rule."""
    size = f"{PAPERS[sheet.paper]} {'landscape' if sheet.is_landscape else 'portrait'}"
    font = "font: 8pt sans-serif; color: #555"
    boxes = {
        "top-left": (sheet.head, "width: 75%; vertical-align: bottom; padding-bottom: 3mm"),
        "top-right": (sheet.head_right, "vertical-align: bottom; padding-bottom: 3mm"),
        "bottom-left": (sheet.foot, "width: 75%; vertical-align: top; padding-top: 3mm"),
    }
    rules = [f"  @{name} {{ content: {quote_css(text)}; {font}; {place} }}"
             for name, (text, place) in boxes.items() if text]  # fmt: skip
    rules.append(
        f'  @bottom-right {{ content: counter(page) " / " counter(pages); {font}; vertical-align: top; '
        "padding-top: 3mm }"
    )
    first = "@page :first {\n  @top-left { content: none }\n  @top-right { content: none }\n}\n"
    low = LOW_FIGURES if sheet.is_landscape else ""
    return f"\n@page {{\n  size: {size};\n" + "\n".join(rules) + "\n}\n" + first + low


def quote_css(text: str) -> str:
    """Quote a text for CSS, with every character but letters and digits of ASCII as its number."""
    safe = (c if c.isascii() and c.isalnum() else f"\\{ord(c):06x}" for c in escape(text))
    return '"' + "".join(safe) + '"'
