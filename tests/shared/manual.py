"""The README and the pages of the manual, as the tests of them read them."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
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
