"""Text as markdown shows it: what a spec or a file name says is text there, never markup."""

from __future__ import annotations

from heuncli.base.foreign_text import shown

# What means something anywhere in a line. Brackets alone, such as those of units, do not: a link needs what follows.
MARKUP = r"(?i)([\\`*_{<#|~&$]|!(?=\[)|\](?=[(\[:])|\[(?=\^)|:(?=//)|(?<=www)\.|(?<=[a-z0-9])@(?=[a-z0-9]))"
BEGINS = r"^(\d*)([-+=.)>\[])"  # and at its beginning


def escape_markdown(text: str) -> str:
    """A text within a line, such as a cell, that is shown as it is."""
    import re  # begun without: most commands write no markdown

    return re.sub(MARKUP, r"\\\1", shown(text))


def escape_line(text: str) -> str:
    """A text at the beginning of a line, where more means something."""
    import re

    return re.sub(BEGINS, r"\1\\\2", escape_markdown(text).strip())


def fence_text(text: str, language: str = "text") -> str:
    """A text of several lines as it is, between fences that it does not hold itself."""
    fence = "```"
    while fence in text:
        fence += "`"
    return f"{fence}{language}\n{text}\n{fence}"
