"""The README and the pages of the manual, as the tests of them read them."""

from __future__ import annotations

import re
from pathlib import Path

from tests.shared.folders import ROOT

FOLDER = ROOT / "heuncli" / "manual"
README = "README"
TEXTS = {README: (ROOT / "README.md").read_text(encoding="utf-8")} | {
    path.stem: path.read_text(encoding="utf-8") for path in sorted(FOLDER.glob("*.md"))
}
FENCED = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)


def blocks(name: str, language: str) -> list[str]:
    """The fenced blocks of a page in a language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", TEXTS[name], re.MULTILINE | re.DOTALL)


def file_of(name: str) -> Path:
    """The file of a page."""
    return ROOT / "README.md" if name == README else FOLDER / f"{name}.md"


def headings(name: str) -> list[str]:
    """The headings of a page, without their marks."""
    return re.findall(r"^#+ (.*)$", FENCED.sub("", TEXTS[name]), re.MULTILINE)


def anchor(heading: str) -> str:
    """Where links to a heading lead: its letters, digits and hyphens, spaces as hyphens."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def below(text: str, heading: str) -> tuple[int, int]:
    """Where the text below a heading begins and ends, up to the next heading of any kind."""
    plain = FENCED.sub(lambda found: "." * len(found[0]), text)
    begun = re.search(rf"^#+ {re.escape(heading)}$", plain, re.MULTILINE)
    assert begun is not None, f"there is no heading {heading}"
    ended = re.compile(r"^#", re.MULTILINE).search(plain, begun.end())
    return begun.end(), ended.start() if ended else len(text)


def tables_below(text: str, heading: str) -> list[str]:
    """The tables that stand below a heading."""
    start, end = below(text, heading)
    return re.findall(r"(?:^\|.*\n)+", text[start:end], re.MULTILINE)
