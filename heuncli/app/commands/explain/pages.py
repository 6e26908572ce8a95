"""The pages of the manual: read one, find a section, list its sections, parse the error codes of the page on codes."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path

from heuncli.app.cli.registry import COMMANDS
from heuncli.base.named_tuples import NamedTuple

FOLDER = Path(__file__).parents[3] / "manual"
# in reading order; the pages of commands in the order of COMMANDS
PAGES = tuple(dict.fromkeys((
    "commands", "format", "howto", "elements", "python", "results", "signs", "open", "stresses", "collectives", "rest",
    *(command.page for command in COMMANDS), "accuracy", "codes", "impacts", "limits", "theory", "equations",
    "references", "decisions", "speed", "developing", "contributing", "words", "index",
)))  # fmt: skip
FENCED = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)
HEADING = re.compile(r"^(#+) (.*)$", re.MULTILINE)
CONTENTS_WIDTH = 100
SECTION = re.compile(r"^### (\S+)\n\n(.*?)(?=^### |\Z)", re.MULTILINE | re.DOTALL)
ROW = re.compile(r"^\| `([a-z0-9-]+)` \| (.*?) \| (.*?) \|$", re.MULTILINE)
LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")


class ManualSection(NamedTuple):
    """A section of a page: from its heading to the next heading of the same or a higher level."""

    page: str
    heading: str
    level: int
    text: str

    @property
    def request(self) -> str:
        """What to type to see it; the first section of a page is the page."""
        return make_request(self.page, self.heading if self.level > 1 else "")


def make_request(page: str, heading: str = "") -> str:
    """Return what to type to see a page, or a section of it."""
    return f'heun explain "{page} {heading.lower()}"' if heading else f"heun explain {page}"


def read_page(page: str) -> str:
    """Read the text of a page."""
    return (FOLDER / f"{page}.md").read_text(encoding="utf-8")


def read_summary(page: str) -> str:
    """Return the subject of a page: the line below its title."""
    return read_page(page).split("\n", 3)[2]


@cache
def read_sections(page: str) -> tuple[ManualSection, ...]:
    """Return the sections of a page in their order; the first is the page itself."""
    text = read_page(page)
    plain = FENCED.sub(lambda found: "." * len(found[0]), text)  # a comment in a spec is not a heading
    headings = [(found.start(), len(found[1]), found[2]) for found in HEADING.finditer(plain)]
    ends = [
        next((start for start, other, _ in headings[number + 1 :] if other <= level), len(text))
        for number, (_, level, _) in enumerate(headings)
    ]
    return tuple(
        ManualSection(page, heading, level, text[start:end].rstrip("\n") + "\n")
        for (start, level, heading), end in zip(headings, ends, strict=True)
    )


def make_anchor(heading: str) -> str:
    """Return the anchor of a heading in links: letters, digits and hyphens, spaces as hyphens."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def find_section(page: str, name: str) -> ManualSection | None:
    """Return the section with a heading or an anchor, in any case; else the only one that begins like that."""
    anchor = make_anchor(name.strip())
    sections = read_sections(page)[1:]
    exact = next((section for section in sections if make_anchor(section.heading) == anchor), None)
    alike = [section for section in sections if anchor and make_anchor(section.heading).startswith(anchor)]
    return exact or (alike[0] if len(alike) == 1 else None)


def list_sections(page: str) -> str:
    """List the sections of a page: a line for each main section, with the sections in it."""
    lines = ["".join(_list_group(group)) for group in _group_by_main(read_sections(page)[1:])]
    wrapped = (textwrap.wrap(line, CONTENTS_WIDTH, subsequent_indent="    ", break_on_hyphens=False) for line in lines)
    head = f'Sections of this page; heun explain "{page} SECTION" shows one of them:\n\n'
    return head + "".join(f"  {line}\n" for group in wrapped for line in group)


def _group_by_main(sections: Sequence[ManualSection]) -> Iterator[Sequence[ManualSection]]:
    """Group each section of level 2 with the deeper ones in it."""
    starts = [number for number, section in enumerate(sections) if section.level == 2]
    for start, end in zip(starts, [*starts[1:], len(sections)], strict=True):
        yield sections[start:end]


def _list_group(group: Sequence[ManualSection]) -> Iterator[str]:
    main, *inner = (section.heading for section in group)
    yield main
    if inner:
        yield f": {', '.join(inner)}"


def parse_codes(page: str) -> dict[str, str]:
    """Return every code with its explanation."""
    rows = {code: f"{says}\n\nRemedy: {cure}\n" for code, says, cure in ROW.findall(page)}
    texts = rows | dict(SECTION.findall(page))
    return {code: f"# {code}\n\n" + LINK.sub(r"\1", text) for code, text in texts.items()}
