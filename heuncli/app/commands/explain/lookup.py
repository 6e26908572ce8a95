"""Look a word up in the manual: engineering terms, the index, options of commands, paths of results, and headings.

A place that treats the word comes before one that only mentions it: first the terms and subjects that are the word,
then headings, then keys, types, results, units and options; last those that contain it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence

from heuncli.app.commands.explain.pages import (
    PAGES,
    ManualSection,
    explain_path,
    find_section,
    make_request,
    read_page,
    read_sections,
)
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results_schema import NOT_YET, ROWS, is_share

TABLES = ("words", "index")  # pages whose tables lead from words to places
OPTION = re.compile(r"(?<![\w`-])--?[a-zA-Z][\w-]*")
LINK = re.compile(r"\[([^]]*)\]\((\w+)\.md(?:#([\w-]+))?\)")
SUBJECTS, RESULTS, OPTIONS = "Subjects", "Paths", "Options"
UNITS = "Units, functions, methods"
MAX_MENTIONS = 3
MAX_ALSO = 8


class Place(NamedTuple):
    """A place of the manual that treats a word: a page, a section of it, or a path of the results."""

    page: str
    heading: str = ""
    path: str = ""

    @property
    def request(self) -> str:
        """What to type to see it."""
        return f"heun explain {self.path}" if self.path else make_request(self.page, self.heading)


class Row(NamedTuple):
    """A row of a table: the page and heading it is below, its first cell, the other cells."""

    page: str
    heading: str
    name: str
    text: str

    @property
    def names(self) -> list[str]:
        """The words of the first cell."""
        return [name.strip(" `") for name in self.name.split(",")]

    @property
    def rank(self) -> int:
        """The order in which tables are searched: words and subjects, keys and the like, results, options."""
        late = {RESULTS: 2, UNITS: 3, OPTIONS: 4}
        return 0 if self.page == "words" or self.heading == SUBJECTS else late.get(self.heading, 1)

    def list_places(self) -> Iterator[Place]:
        """Yield the places that it leads to."""
        if self.heading == RESULTS:
            yield from (Place("results", RESULTS, path) for path in self.text.split() if "." in path)
        elif self.heading == OPTIONS:
            yield from (Place("commands", heading) for heading in self.text.split("; "))
        for text, page, anchor in () if self.heading in (RESULTS, OPTIONS) else LINK.findall(self.text):
            section = find_section(page, anchor) if anchor else None
            yield Place(page, section.heading if section else text if anchor else "")


def read_rows() -> list[Row]:
    """Read the rows that lead from words to places: of the tables, of the results, and of the options of commands."""
    tables = [
        Row(page, section.heading, *map(str.strip, line[2:].rstrip("|").split(" | ", 1)))
        for page in TABLES
        for section in read_sections(page)
        if section.level == 2
        for line in _list_rows(section.text)
    ]
    results = [Row("results", RESULTS, word, " ".join(paths)) for word, paths in _group_results().items()]
    options = [Row("commands", OPTIONS, word, "; ".join(commands)) for word, commands in _group_options().items()]
    return [*tables, *results, *options]


def _group_results() -> dict[str, list[str]]:
    """Group the paths of the results by their last word; those of contributions by cause come last."""
    paths: dict[str, list[str]] = {}
    for row in sorted((row for row in ROWS if row.meaning != NOT_YET), key=is_share):
        paths.setdefault(row.path.rpartition(".")[2], []).append(row.path)
    return paths


def _group_options() -> dict[str, list[str]]:
    """Group the sections on commands by the options in their tables."""
    sections: dict[str, list[str]] = {}
    for section in read_sections("commands"):
        cells = (line.split(" | ", 1)[0] for line in _list_rows(section.text) if section.level == 2)
        for option in dict.fromkeys(word for cell in cells for word in OPTION.findall(cell.replace("`", " "))):
            sections.setdefault(option, []).append(section.heading)
    return sections


def _list_rows(text: str) -> list[str]:
    """Return the rows of the tables in a text, without their heads."""
    lines = text.splitlines()
    return [
        line for line, after in zip(lines, [*lines[1:], ""], strict=True) if line[:2] == "| " and after[:3] != "|--"
    ]


def find_places(word: str) -> list[Place]:
    """Return the places that treat a word, the main one first; empty if it is unknown."""
    rows = read_rows()
    exact = sorted((row for row in rows if is_named(word, row.names)), key=lambda row: row.rank)
    first = [place for row in exact if row.rank == 0 for place in row.list_places()]
    others = [place for row in exact if row.rank > 0 for place in row.list_places()]
    loose = [place for row in rows if row.rank == 0 and contains(row.name, word) for place in row.list_places()]
    return list(dict.fromkeys((*first, *find_headings(word), *others, *loose)))


def find_headings(word: str) -> list[Place]:
    """Return the sections, and pages, with this heading; first those that are spelt like it."""
    found = [
        section
        for page in PAGES
        for section in read_sections(page)
        if page != "codes" and is_named(word, [section.heading])
    ]
    found.sort(key=lambda section: (section.heading != word, section.heading.lower() != word.lower()))
    return [Place(section.page, section.heading if section.level > 1 else "") for section in found]


def find_terms(word: str, main: Place) -> list[Row]:
    """Return the rows of the page of words on a term; if nothing is called that, those that contain it."""
    rows = read_rows()
    exact = [row for row in rows if is_named(word, row.names)]
    terms = [row for row in exact if row.page == "words"]
    if exact or find_headings(word):
        return terms
    return [row for row in rows if row.page == "words" and contains(row.name, word) and main in row.list_places()]


def find_mentions(word: str) -> list[str]:
    """Return what to type to see the first sections in which a word occurs."""
    found = (
        section.request
        for page in PAGES
        if page != "codes" and contains(read_page(page), word)
        for section in _find_innermost(page)
        if contains(section.text, word)
    )
    return [request for request, _ in zip(found, range(MAX_MENTIONS), strict=False)]


def _find_innermost(page: str) -> Iterable[ManualSection]:
    """Yield the sections of a page that contain no other one."""
    sections = read_sections(page)
    following = [*sections[1:], sections[0]]
    return (each for each, after in zip(sections, following, strict=True) if after.level <= each.level)


def list_names() -> list[str]:
    """List the words that can be looked up: pages, headings, and names in tables."""
    headings = (section.heading for page in PAGES for section in read_sections(page))
    return list(dict.fromkeys((*PAGES, *headings, *(name for row in read_rows() for name in row.names))))


def is_named(word: str, names: Iterable[str]) -> bool:
    """Whether a word is one of these, in singular or plural, in any case."""
    sought = _normalise(word)
    return any(_normalise(name) == sought for name in names)


def _normalise(name: str) -> str:
    """Return a name without case, marks, hyphens and the plural's s."""
    words = re.sub(r"[`_\-\s]+", " ", name.lower()).split()
    return " ".join(
        word[:-1] if len(word) > 3 and word.endswith("s") and not word.endswith("ss") else word for word in words
    )


def contains(text: str, word: str) -> bool:
    """Whether a text contains a word, or its plural, as a whole."""
    pattern = rf"(?<!\w){re.escape(word)}s?(?!\w)"
    return re.search(pattern, text, re.IGNORECASE) is not None


def explain_word(word: str) -> str | None:
    """Return the section that treats a word, and a list of the others; None if the word is unknown."""
    places = find_places(word)
    if not places:
        return None
    main, *others = places
    end = "" if main.path else f"\nThis is from: {make_request(main.page)}\n"
    return "".join(map(show_term, find_terms(word, main))) + read_place(main) + end + list_requests(others)


def list_requests(places: Sequence[Place]) -> str:
    """List what to type to see other places; nothing if there are none."""
    return "\nSee also:\n" + "".join(f"  {place.request}\n" for place in places[:MAX_ALSO]) if places else ""


def show_term(row: Row) -> str:
    """Return a row of the page of words: the term and what it is in heun."""
    meaning, _, _ = row.text.rpartition(" | ")
    return f"term     {row.name}\nin heun  {meaning}\n\n"


def read_place(place: Place) -> str:
    """Return the text of a page, a section or the explanation of a path."""
    if place.path:
        return explain_path(place.path) or read_page("results")
    section = find_section(place.page, place.heading) if place.heading else None
    return read_page(place.page) if section is None else section.text
