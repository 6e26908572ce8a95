"""Escape text for Markdown, so that nothing in a spec or file name acts as markup."""

from __future__ import annotations

from heuncli.base.text_safety import escape

# Characters with a meaning anywhere in a line. Brackets alone, such as those of units, have none: a link needs more.
MARKUP = r"(?i)([\\`*_{<#|~&$]|!(?=\[)|\](?=[(\[:])|\[(?=\^)|:(?=//)|(?<=www)\.|(?<=[a-z0-9])@(?=[a-z0-9]))"
LINE_START_MARKUP = r"^(\d*)([-+=.)>\[])"  # with a meaning at its beginning only


def escape_markdown(text: str) -> str:
    """Escape a text within a line, such as a cell."""
    import re  # imported here, as most commands write no markdown

    return re.sub(MARKUP, r"\\\1", escape(text))


def escape_line(text: str) -> str:
    """Escape a text at the beginning of a line, where more characters act as markup."""
    import re

    return re.sub(LINE_START_MARKUP, r"\1\\\2", escape_markdown(text).strip())


def fence_text(text: str, language: str = "text") -> str:
    """Put a text of several lines between fences that are longer than any in it."""
    fence = "```"
    while fence in text:
        fence += "`"
    return f"{fence}{language}\n{text}\n{fence}"
