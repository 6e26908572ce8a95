"""The paper of a printed document: its size, and what stands at the head and foot of each page."""

from __future__ import annotations

from typing import Literal

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape

PAPERS = {"a4": "A4", "letter": "letter"}  # words of --paper -> names of CSS


class Sheet(NamedTuple):
    """The paper format, and the left and right texts of the page header (not on the first page)."""

    paper: Literal["a4", "letter"] = "a4"
    is_landscape: bool = False
    head: str = ""
    head_right: str = ""
    foot: str = ""


A4 = Sheet()


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
    return f"\n@page {{\n  size: {size};\n" + "\n".join(rules) + "\n}\n" + first


def quote_css(text: str) -> str:
    """Quote a text for CSS, with every character but letters and digits of ASCII as its number."""
    safe = (c if c.isascii() and c.isalnum() else f"\\{ord(c):06x}" for c in escape(text))
    return '"' + "".join(safe) + '"'
